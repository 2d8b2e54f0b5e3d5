# A joint in the hand
# A page that solves the joint while one turns it, for any browser, without network.
# files: samples/hip/hip_walking.feb
dea run hip_walking.feb --no-xplt --live live.html
