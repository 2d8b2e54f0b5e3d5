# Beside FEBio's results
# The same hip by dea and by FEBio 4.11, at the times of FEBio's file, on one scale; what differs, in numbers.
# files: samples/hip/hip_walking.feb samples/hip/hip_walking_febio.xplt
dea run hip_walking.feb --times-from hip_walking_febio.xplt
dea compare hip_walking_dea.xplt hip_walking_febio.xplt
dea plot hip_walking_dea.xplt hip_walking_febio.xplt --label dea --label FEBio -o compare.svg
