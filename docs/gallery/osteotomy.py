# The socket of a hip turned about two axes
# p99 of the pressure over 25 positions of the pelvis: a study in Python, as an xarray, as a map.
# files: samples/hip/hip_walking.feb
import febiodea
from matplotlib import pyplot

angles = "{-20:20:10}"
study = febiodea.Study("hip_walking.feb", {"tilt": f"rotate pelvis=0,1,0,{angles}", "version": f"rotate pelvis=0,0,1,{angles}"}, states="last")
cases = study.run("osteotomy.db").to_xarray()
p99 = cases.p99.where(cases.solved == 1)[:, -1, 0].set_index(case=["tilt", "version"]).unstack("case")
p99.attrs, p99.tilt.attrs, p99.version.attrs = {"long_name": "p99 of contact pressure [MPa]"}, {"units": "degrees"}, {"units": "degrees"}
p99.drop_vars(["state", "contact"]).plot.contourf(levels=12)
pyplot.savefig("osteotomy.svg")
