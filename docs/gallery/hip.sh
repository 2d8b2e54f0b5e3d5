# The hip of a person who walks
# Contact pressure on the socket at the instant of the largest load.
# files: samples/hip/hip_walking.feb
dea info hip_walking.feb
dea run hip_walking.feb --csv hip.csv
dea plot hip_walking_dea.xplt --title "Hip, walking" -o hip.svg
