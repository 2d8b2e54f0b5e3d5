#!/usr/bin/env python3
"""Stress and strain inside the cartilage beside FEBio's: the tables of docs/layer_law.md, section 8. Standard library only.

    docs/developers/inside_febio.py DEA FOLDER     runs DEA on every FOLDER/NAME.feb that has FOLDER/NAME_febio*.xplt beside it, compares
                                        the last states and prints the tables: as they are; with the yielding of FEBio's
                                        contact in series (--interface-stiffness); FEBio with one penalty and with another
"""
import json
import pathlib
import subprocess
import sys
import tempfile

MEASURES = ("max_shear_stress", "first_principal_strain", "third_principal_strain")


def run(*words):
    done = subprocess.run([str(w) for w in words], capture_output=True, text=True)
    if done.returncode != 0:
        raise SystemExit(" ".join(map(str, words)) + "\n" + done.stderr)


def compare(dea, files):
    """Of files by their labels, the last the reference: what dea compare --json says."""
    with tempfile.TemporaryDirectory() as folder:
        out = pathlib.Path(folder) / "c.json"
        labels = [w for label in files for w in ("--label", label)]
        run(dea, "compare", *files.values(), *labels, "-q", "--json", out)
        return json.loads(out.read_text())


def cell(of, below_zero):
    """Correlation, 99th percentile, mean; + is larger in size than the reference."""
    sign = -1 if below_zero else 1
    return "%.3f, %+.0f %%, %+.0f %%" % (of["correlation"], *(sign * of["percent"][k] for k in ("p99", "mean")))


def lines(name, compared, label):
    """Per surface and row of elements: a line of a table for the file of this label."""
    for surface in compared["surfaces"]:
        for row in surface["inside"]:
            found = next(d for d in row["differences"] if d["label"] == label)
            cells = [cell(found[m], m.startswith("third")) for m in MEASURES]
            yield "| %s, %s | at the %s | %d | %s |" % (name, surface["names"][0], row["row"], row["elements"], " | ".join(cells))


def stiffness(compared):
    """What the contact of the reference gives way by, where its pressure is."""
    for surface in compared["surfaces"]:
        for file in surface["files"]:
            if file["label"] == compared["reference"] and file["interface"]:
                return file["interface"]["stiffness"]


def main():
    dea, folder = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve()
    plain, yielding, penalties = [], [], []
    with tempfile.TemporaryDirectory() as work:
        own, soft = pathlib.Path(work) / "own.xplt", pathlib.Path(work) / "soft.xplt"
        for model in sorted(folder.glob("*.feb")):
            results = sorted(folder.glob(model.stem + "_febio*.xplt"))
            if results:
                run(dea, "run", model, "--states", "last", "--inside", "-q", "-o", own, "--overwrite")
            for reference in results:
                name = reference.stem
                compared = compare(dea, {"dea": own, name: reference})
                plain += lines(name, compared, "dea")
                run(dea, "run", model, "--states", "last", "--inside", "-q", "-o", soft, "--overwrite",
                    "--interface-stiffness", stiffness(compared))
                yielding += lines(name, compare(dea, {"dea": soft, name: reference}), "dea")
                for other in results[:results.index(reference)]:
                    # dea's file tells which elements of a secondary surface are pressed
                    both = compare(dea, {"dea": own, other.stem: other, name: reference})
                    penalties += lines("%s less %s" % (other.stem, name), both, other.stem)
    for table in (plain, yielding, penalties):
        print("| model, surface | row | elements | greatest shear | first principal strain | third |\n" + "|---" * 6 + "|")
        print("\n".join(table) + "\n")


if __name__ == "__main__":
    main()
