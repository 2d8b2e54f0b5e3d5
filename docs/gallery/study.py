# Which property of the cartilage matters
# 32 hips with modulus, Poisson's ratio and thickness drawn at random, and how pressure follows each.
# files: samples/hip/hip_walking.feb
import febiodea

factors = {"E": "E={uniform(8,16)}", "poisson": "nu={uniform(0.40,0.47)}", "thickness": "thickness-scale={uniform(0.8,1.2)}"}
study = febiodea.Study("hip_walking.feb", factors, sample=("sobol", 32, 1), states="last")
table = study.run("study.db").to_pandas()
table = table[table.solved == 1]
print(table[[*factors, "headline_p99"]].corr("spearman")["headline_p99"].round(2))
axes = table.plot.scatter("E", "headline_p99", c="thickness", colormap="viridis", xlabel="E [MPa]", ylabel="p99 of contact pressure [MPa]")
axes.figure.savefig("study.svg")
