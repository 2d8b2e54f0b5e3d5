#!/usr/bin/env python3
"""Prints tables of docs/accuracy.md by running dea. Standard library only.

    docs/developers/tables.py DEA [FOLDER_WITH_FEBIO_RESULTS] [--joint TITLE MODEL.feb FEBIO.xplt]... [--write]

DEA: the built program, e.g. build/release/app/dea. With a folder that holds FEBio's plot files of the hip (see samples/hip), dea's
results are compared with them (dea compare --help has the definitions); models that lie there with FEBio's results are added.
--joint adds a joint of one's own to tables and ranges: its first surface with pressure in both, its own loads, last states.
--write puts the tables into that page, between the lines <!-- tables.py NAME --> and <!-- end NAME -->.
"""
import argparse
import functools
import json
import math
import os
import re
import subprocess
import sys
import tempfile

HERE = os.path.dirname(os.path.abspath(__file__))
SAMPLES = os.path.join(HERE, "..", "..", "samples")


def last_state(dea, model, *options):
    with tempfile.TemporaryDirectory() as folder:
        out = subprocess.run([dea, "run", os.path.join(SAMPLES, model), "--no-xplt", "--states", "last", "-q", "--json", "-",
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

    lines = ["| spheres: springs on | " + " | ".join("%g N: exact | dea | error" % F for F in (100, 2000, 4000)) + " |", "|---" * 10 + "|"]
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
        lines.append("| %s | %s |" % (title, " | ".join(cells)))
    return lines


# PENALTY: the stiffness of the FEA contact, taken from its result by dea compare
VARIANTS = [("law layer", []),
            ("law layer, FEA penalty", ["--interface-stiffness", "PENALTY"]),
            ("linear, articular, curved facets", ["--law", "linear"]),
            ("linear, articular, flat facets", ["--law", "linear", "--facets", "flat"]),
            ("linear, bone, curved facets", ["--law", "linear", "--springs-at", "bone"]),
            ("linear, bone, flat facets", ["--law", "linear", "--springs-at", "bone", "--facets", "flat"])]


HEADLINE = ("p99", "mean", "area", "peak")  # docs/theory.md, 6.1


KINDS = {"hips": "one hip, loads: %d", "balls": "balls: %d", "others": "others: %d"}


def compare(dea, files, labels, surface, areas):
    words = [w for label in labels for w in ("--label", label)] + (["--surface", surface] if surface else [])
    out = subprocess.run([dea, "compare", *files, *words, "--areas", areas, "--threshold", "0.1", "-q", "--json", "-"],
                         check=True, capture_output=True, text=True).stdout
    return json.loads(out)


@functools.lru_cache(maxsize=None)
def penalty_stiffness(dea, path, surface):
    """What dea compare prints for --interface-stiffness: pressure over penetration of FEBio's contact."""
    found = compare(dea, [path, path], ["a", "b"], surface, "deformed")["surfaces"][0]["files"][0]["interface"]
    if not found:
        sys.exit("%s: no gap under pressure, expected a penalty contact" % path)
    return found["stiffness"]


def joints(folder, own):
    """(title, kind, model, options, surface, FEBio's results with their names, the last one to compare with)"""
    hip = os.path.join(SAMPLES, "hip/hip_walking.feb")
    found = [("walking", "hips", hip, ["--force", "femur=432,-262,1834"], "acetabular_articulating",
              [("penalty 50", "hip_walking_febio_penalty50"), ("penalty 20", "hip_walking_febio_penalty20")]),
             ("stairs up", "hips", hip, ["--force", "femur=474,-485,1890"], "acetabular_articulating", [("penalty 20", "hip_stairs_up_febio_penalty20")]),
             ("stairs down", "hips", hip, ["--force", "femur=520,-120,1990"], "acetabular_articulating", [("penalty 20", "hip_stairs_down_febio_penalty20")])]
    for name in ("ball_tight", "ball_loose"):  # no samples: their models lie beside FEBio's results
        model = os.path.join(folder, name + ".feb")
        if folder and os.path.exists(model):
            found.append((name.replace("_", ", "), "balls", model, [], "socket_articulating", [("penalty 30", name + "_febio")]))
    found = [(*j[:5], [(n, os.path.join(folder, f + ".xplt")) for n, f in j[5] if folder and os.path.exists(os.path.join(folder, f + ".xplt"))]) for j in found]
    return found + [(title, "others", model, [], "", [("as given", result)]) for title, model, result in own]


def measure(dea, joint):
    """One row per variant and result of FEBio, FEBio's first: label, measures, and by areas the differences in per cent."""
    title, kind, model, options, surface, references = joint
    with tempfile.TemporaryDirectory() as temporary:
        names, labels, files = [], [], []
        for name, choice in VARIANTS:
            if "PENALTY" in choice and not references:
                continue
            names.append(name)
            if "PENALTY" in choice:
                stiffness = "%.3g" % penalty_stiffness(dea, references[-1][1], surface)
                choice = [stiffness if word == "PENALTY" else word for word in choice]
                name += ", %s" % stiffness
            labels.append("dea, " + name)
            files.append(os.path.join(temporary, "%d.xplt" % len(files)))
            subprocess.run([dea, "run", model, "-o", files[-1], "--overwrite", "--states", "last", "-q", *options, *choice], check=True)
        for name, path in references:
            names.append("FEBio")
            labels.append("FEBio, " + name)
            files.append(path)
        by_areas = {areas: compare(dea, files, labels, surface, areas) for areas in ("reference", "deformed")}
    moved = max((b["differences"] for b in by_areas["reference"]["bodies"]),
                key=lambda all: max(sum(x * x for x in d["translation"]) if d else -1 for d in all), default=[])
    rows = []
    order = list(range(len(labels)))
    first = len(labels) - len(references)
    for i in order[first:][::-1] + order[:first]:  # FEBio first
        row = {"joint": title, "kind": kind, "name": names[i], "label": labels[i], "differs": {}, "share": {}}
        for areas, j in by_areas.items():
            region, facts = j["surfaces"][0]["regions"][0], j["surfaces"][0]["files"][i]
            row["share"][areas] = facts["resultant_over_contact_force"][areas]
            if areas == "reference":
                row["values"] = [region["results"][i]["headline"][name] for name in HEADLINE]
            if references and i + 1 < len(labels):
                d = region["differences"][i]
                row["differs"][areas] = [d["percent"]["headline"][name] for name in HEADLINE]
                if areas == "reference":
                    row["pattern"] = [d["correlation"], d["rms"], d["dice"][1]["dice"]]
                    row["moved"] = moved[i]["translation"] if moved and moved[i] else None
        rows.append(row)
    return rows


def joint_table(rows):
    lines = ["| joint | | %s | r | rms | Dice | p A / force | bone moved by |" % " | ".join(HEADLINE), "|---" * 11 + "|"]
    for row in rows:
        cells = ["%.*f" % (digits, x) for x, digits in zip(row["values"], (2, 2, 0, 2))]
        if row["differs"]:
            cells = ["%s (%+.0f, %+.0f%%)" % (c, r, d) for c, r, d in zip(cells, row["differs"]["reference"], row["differs"]["deformed"])]
            cells += ["%.3f | %.2f | %.3f" % tuple(row["pattern"])]
        else:
            cells += ["|  | "]
        cells.append(", ".join("%.1f%%" % (100 * x) if x else "-" for x in row["share"].values()))
        cells.append(", ".join("%.3f" % (x + 0.0) for x in row["moved"]) if row.get("moved") else "")
        lines.append("| %s | %s | %s |" % (row["joint"], row["label"], " | ".join(cells)))
    return lines


def range_table(rows):
    """Smallest and largest difference over the joints of a kind, with areas of the mesh and deformed."""
    lines = ["| differences from FEBio [%%] | joints | areas | %s | r, least | Dice, least |" % " | ".join(HEADLINE), "|---" * 9 + "|"]
    for name in ["FEBio"] + [v[0] for v in VARIANTS if "flat" not in v[0]]:
        for kind in KINDS:
            of = [r for r in rows if r["name"] == name and r["kind"] == kind and r["differs"]]
            for areas in ("reference", "deformed") if of else ():
                columns = list(zip(*(r["differs"][areas] for r in of)))
                cells = [" to ".join("%+.1f" % (round(x, 1) + 0.0) for x in ((min(c), max(c)) if len(of) > 1 else c)) for c in columns]
                pattern = ["%.3f" % min(r["pattern"][k] for r in of) for k in (0, 2)] if areas == "reference" else ["", ""]
                title = "FEBio, other penalty" if name == "FEBio" else "dea, " + name
                lines.append("| %s | %s | %s | %s |" % (title, KINDS[kind] % len(of), areas, " | ".join(cells + pattern)))
    return lines


def write(tables):
    path = os.path.join(HERE, "..", "accuracy.md")
    with open(path) as f:
        text = f.read()
    for name in tables:
        place = re.compile(r"(<!-- tables\.py %s -->\n).*?(<!-- end %s -->)" % (name, name), re.S)
        if len(place.findall(text)) != 1:
            sys.exit("%s: found no place for the table \"%s\", expected the lines <!-- tables.py %s --> and <!-- end %s -->" % (path, name, name, name))
        text = place.sub(lambda m: m.group(1) + "\n".join(["", *tables[name], "", ""]) + m.group(2), text)
    with open(path, "w") as f:
        f.write(text)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("dea")
    parser.add_argument("folder", nargs="?", default="")
    parser.add_argument("--joint", nargs=3, action="append", default=[], metavar=("TITLE", "MODEL", "RESULT"))
    parser.add_argument("--write", action="store_true")
    a = parser.parse_args()
    if a.write and not a.folder:
        sys.exit("--write: found no folder with FEBio's results, expected one: the tables compare with them")
    rows = [row for joint in joints(a.folder, a.joint) for row in measure(a.dea, joint)]
    tables = {"spheres": spheres(a.dea), "ranges": range_table(rows), "all": joint_table(rows)}
    for name in tables:
        print("\n".join(["", *tables[name]]))
    if a.write:
        write(tables)


if __name__ == "__main__":
    main()
