#!/usr/bin/env python3
"""Prints the README's accuracy tables by running dea on the samples. Standard library only.

    docs/tables.py DEA [FOLDER_WITH_FEBIO_RESULTS]

DEA: the built program, e.g. build/release/io/dea. With a folder that holds FEBio's plot files of the hip (see samples/hip), dea's
results are compared with them (dea compare --help has the definitions); models that lie there with FEBio's results are added.
"""
import json
import math
import os
import subprocess
import sys
import tempfile

from xplt_reader import PlotFile

HERE = os.path.dirname(os.path.abspath(__file__))
SAMPLES = os.path.join(HERE, "..", "samples")


def last_state(dea, model, *options):
    with tempfile.TemporaryDirectory() as folder:
        out = subprocess.run([dea, "run", os.path.join(SAMPLES, model), "-o", os.path.join(folder, "x.xplt"), "--states", "last", "-q", "--json", "-",
                              *options], check=True, capture_output=True, text=True).stdout
    return json.loads(out)


def spheres(dea):
    E, nu, h = 11.85, 0.45, 4.0
    M = E * (1 - nu) / ((1 + nu) * (1 - 2 * nu))

    def exact(A, R, sign, F):  # docs/theory.md, section 7.1: F = 2 pi A^2 M u / (3 h) (1 + sign 3 u / (8 R)), peak M u / h
        c = 2 * math.pi * A * A * M / (3 * h)
        a = sign * 3 * c / (8 * R)
        u = F / c if a == 0 else (-c + math.sqrt(c * c + 4 * a * F)) / (2 * a)
        return M * u / h

    print("| spheres: springs on | " + " | ".join("%g N: exact | dea | error" % F for F in (100, 2000, 4000)) + " |")
    print("|---" * 10 + "|")
    rows = [("socket, articular, one layer", "one_layer", 20, 20, -1, []),
            ("ball, articular, one layer", "one_layer", 20, 20, 1, ["--source", "ball"]),
            ("socket, articular, two layers", "two_layers", 22, 22, -1, []),
            ("ball, articular, two layers", "two_layers", 22, 22, 1, ["--source", "ball"]),
            ("socket, at the bone, two layers", "two_layers", 24, 20, -1, ["--springs-at", "bone"]),
            ("ball, at the bone, two layers", "two_layers", 20, 24, 1, ["--springs-at", "bone", "--source", "ball"])]
    for title, model, A, R, sign, options in rows:
        cells = []
        for F in (100, 2000, 4000):
            p = last_state(dea, "spheres/%s.feb" % model, "--law", "linear", "--force", "ball=0,0,%g" % F, *options)["states"][-1]["contacts"][0]["peak_pressure"]
            e = exact(A, R, sign, F)
            cells.append("%.5g | %.5g | %+.2f%%" % (e, p, 100 * (p / e - 1)))
        print("| %s | %s |" % (title, " | ".join(cells)))


# PENALTY: the FEA contact's own compliance, taken from its result
VARIANTS = [("law layer", []),
            ("law layer, FEA penalty", ["--interface-stiffness", "PENALTY"]),
            ("linear, articular, curved facets", ["--law", "linear"]),
            ("linear, articular, flat facets", ["--law", "linear", "--facets", "flat"]),
            ("linear, bone, curved facets", ["--law", "linear", "--springs-at", "bone"]),
            ("linear, bone, flat facets", ["--law", "linear", "--springs-at", "bone", "--facets", "flat"])]


def penalty_stiffness(path, surface):
    """Pressure per penetration of FEBio's contact: total over total, of the facets that carry 0.3 or more."""
    file = PlotFile(path)
    p, gap = file.surface(surface)[1], file.surface(surface, "contact gap")[1]
    return sum(a for a in p if a > 0.3) / sum(g for a, g in zip(p, gap) if a > 0.3)


def against_febio(dea, folder):
    """Every dea variant beside FEBio's result of the same model, in the last state. The last file given is what the others are compared with."""
    def febio(name): return os.path.join(folder, name + ".xplt") if folder else ""
    hip = os.path.join(SAMPLES, "hip/hip_walking.feb")
    models = [("walking", hip, ["--force", "femur=432,-262,1834"], "femur", "acetabular_articulating",
               [("penalty 50", febio("hip_walking_febio_penalty50")), ("penalty 20", febio("hip_walking_febio_penalty20"))]),
              ("stairs up", hip, ["--force", "femur=474,-485,1890"], "femur", "acetabular_articulating", [("penalty 20", febio("hip_stairs_up_febio_penalty20"))]),
              ("stairs down", hip, ["--force", "femur=520,-120,1990"], "femur", "acetabular_articulating", [("penalty 20", febio("hip_stairs_down_febio_penalty20"))])]
    for name in ("ball_tight", "ball_loose"):  # no samples: their models lie beside FEBio's results
        model = os.path.join(folder, name + ".feb")
        if folder and os.path.exists(model):
            models.append((name.replace("_", ", "), model, [], "ball", "socket_articulating", [("penalty 30", febio(name + "_febio"))]))

    print("\n| model | | peak | p99, p > 0.1 | mean, p > 0.1 | area, p > 0.1 | area, p > 0.5 | r | rms | Dice | bone moved by |")
    print("|---" * 11 + "|")
    for title, model, options, body, surface, references in models:
        with tempfile.TemporaryDirectory() as temporary:
            labels, files = [], []
            known = [path for _, path in references if os.path.exists(path)]
            variants = [v for v in VARIANTS if known or "PENALTY" not in v[1]]
            for name, choice in variants:
                if "PENALTY" in choice:
                    stiffness = "%.3g" % penalty_stiffness(known[-1], surface)
                    choice = [stiffness if word == "PENALTY" else word for word in choice]
                    name += ", %s" % stiffness
                labels.append("dea, " + name)
                files.append(os.path.join(temporary, "%d.xplt" % len(files)))
                subprocess.run([dea, "run", model, "-o", files[-1], "--states", "last", "-q", *options, *choice], check=True)
            references = [r for r in references if os.path.exists(r[1])]
            for name, path in references:
                labels.append("FEBio, " + name)
                files.append(path)
            words = [w for label in labels for w in ("--label", label)]
            out = subprocess.run([dea, "compare", *files, *words, "--surface", surface, "--threshold", "0.1", "--threshold", "0.5", "-q", "--json", "-"],
                                 check=True, capture_output=True, text=True).stdout
        j = json.loads(out)
        region = j["surfaces"][0]["regions"][0]
        pose = next(b for b in j["bodies"] if b["name"] == body)
        rows = list(range(len(labels)))
        for i in rows[len(variants):][::-1] + rows[:len(variants)]:  # FEBio first
            low, high = region["results"][i]["nodes"][1:3]
            cells = ["%.2f" % low["peak"], "%.2f" % low["p99"], "%.2f" % low["mean"], "%.0f" % low["area"], "%.0f" % high["area"]]
            if references and i + 1 < len(labels):
                d = region["differences"][i]
                for k, key in enumerate(("peak", "p99", "mean", "area")):
                    cells[k] += " (%+.0f%%)" % d["percent"]["nodes"][1][key]
                cells[4] += " (%+.0f%%)" % d["percent"]["nodes"][2]["area"]
                cells += ["%.3f" % d["correlation"], "%.2f" % d["rms"], "%.3f" % d["dice"][1]["dice"],
                          ", ".join("%.3f" % (x + 0.0) for x in pose["differences"][i]["translation"])]
            else:
                cells += [""] * 4
            print("| %s | %s | %s |" % (title, labels[i], " | ".join(cells)))


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    spheres(sys.argv[1])
    against_febio(sys.argv[1], sys.argv[2] if len(sys.argv) > 2 else "")
