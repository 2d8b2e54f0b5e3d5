#!/usr/bin/env python3
"""Prints the README's accuracy tables by running dea on the samples. Standard library only.

    docs/tables.py DEA [FOLDER_WITH_FEBIO_RESULTS]

DEA: the built program, e.g. build/release/io/dea. With a folder that holds FEBio's plot files of the hip (see samples/hip)
their rows are computed from those files, by the same definitions as dea's: largest facet value, largest nodal value (area-weighted
average of the facets around a node), area of whole facets with pressure, reference configuration.
"""
import json
import math
import os
import subprocess
import sys
import tempfile

sys.path.insert(0, os.path.dirname(__file__))
from xplt_reader import PlotFile  # noqa: E402

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
            p = last_state(dea, "spheres/%s.feb" % model, "--force", "ball=0,0,%g" % F, *options)["states"][-1]["contacts"][0]["peak_pressure"]
            e = exact(A, R, sign, F)
            cells.append("%.5g | %.5g | %+.2f%%" % (e, p, 100 * (p / e - 1)))
        print("| %s | %s |" % (title, " | ".join(cells)))


ACTIVITIES = [("walking", "432,-262,1834", ["hip_walking_febio_penalty20", "hip_walking_febio_penalty50"]),
              ("stairs up", "474,-485,1890", ["hip_stairs_up_febio_penalty20"]),
              ("stairs down", "520,-120,1990", ["hip_stairs_down_febio_penalty20"])]


def hip(dea, folder):
    print("\n| hip | | peak, facet | peak, node | mean over nodes, p > 0 | area of facets, p > 0 | position of the femur |")
    print("|---|---|---|---|---|---|---|")
    for title, force, results in ACTIVITIES:
        for result in results:
            path = os.path.join(folder, result + ".xplt") if folder else ""
            if os.path.exists(path):
                f = PlotFile(path)
                facet, node, mean, area = f.pressure_statistics("acetabular_articulating")
                x = f.domain_region("rigid position", 3)
                print("| %s | FEBio, %s | %.2f | %.2f | %.2f | %.0f | %.3f, %.3f, %.3f |" % (title, result.split("_")[-1], facet, node, mean, area, *x))
        for where in ("articular", "bone"):
            for facets in ("curved", "flat"):
                s = last_state(dea, "hip/hip_walking.feb", "--force", "femur=" + force, "--springs-at", where, "--facets", facets)["states"][-1]
                c, b = s["contacts"][0], s["bodies"]["femur"]
                print("| %s | dea, %s, %s facets | %.2f | %.2f | %.2f | %.0f | %.3f, %.3f, %.3f |"
                      % (title, where, facets, c["facet_peak_pressure"], c["nodal_peak_pressure"], c["nodal_mean_pressure"], c["facet_contact_area"], *b["translation"]))


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    spheres(sys.argv[1])
    hip(sys.argv[1], sys.argv[2] if len(sys.argv) > 2 else "")
