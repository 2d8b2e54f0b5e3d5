#!/usr/bin/env python3
"""dea beside FEBio's kept results: results.py DEA [--json FILE] [NAME...]

Each joint is made and solved by dea with the stiffness of FEBio's contact between the surfaces, and compared by dea compare on deformed areas.
Prints a row per contact, then quartiles and the worst per kind. Without names: all that are kept but the untouched ones; `untouched` names these."""
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile

import numpy as np

import joints
import kept

HERE = pathlib.Path(__file__).resolve().parent
MEASURES = ("p99", "mean", "area", "peak")


def restored(template, values, joint, out):
    """FEBio's plot file again, as far as it was kept: dea's of the same mesh with FEBio's numbers in place of its own."""
    plot = kept.PlotFile(str(template))
    data = bytearray(plot.data)
    writer = re.search(rb"FEBioDEA [\d.]+", data)
    data[writer.start():writer.end()] = b"FEBio".ljust(len(writer[0]), b"\0")

    def put(place, array):
        b, e = place
        bytes_ = np.ascontiguousarray(array, "<f4").tobytes()
        if len(bytes_) > e - b:
            raise SystemExit(f"{template}: found {e - b} bytes, expected at least {len(bytes_)}")
        data[b:b + len(bytes_)] = bytes_
    b, e = plot.place(0x01023000, 0x02020300, "displacement", 0)
    moved = np.frombuffer(bytes(data[b:e]), "<f4").reshape(-1, 3).copy()
    first = 0
    for k, patch in enumerate(joint.patches):
        rows, columns = patch.points.shape[:2]
        top = first + joint.layers * rows * columns
        moved[top:top + rows * columns] = values[f"{patch.name}/displacement"]
        first = top + rows * columns
        put(plot.place(0x01024000, 0x02020400, "stress", k + 1), values[f"{patch.name}/stress"])
    put((b, e), moved)
    for region, (_, span) in enumerate(plot.chunks(plot.child(plot.mesh, 0x01043000)), 1):
        b, e = plot.child(span, 0x01043101, 0x01043104)
        name = plot.data[b + 4:e].decode()
        for what in ("pressure", "gap", "force"):
            put(plot.place(0x01025000, 0x02020500, kept.SURFACE[what][0], region), values[f"{name}/{what}"])
    out.write_bytes(data)


def run(*words):
    done = subprocess.run([str(w) for w in words], capture_output=True, text=True)
    if done.returncode not in (0, 1):
        raise SystemExit(f"{' '.join(map(str, words))}: {done.stderr}")
    return done.stdout


def compared(dea, own, febio):
    return json.loads(run(dea, "compare", own, febio, "--areas", "deformed", "--json", "-", "-q"))


def joint_rows(dea, name):
    joint = kept.joint_of(name)
    with tempfile.TemporaryDirectory() as folder:
        work = pathlib.Path(folder)
        model = joints.make(name.removesuffix("_finer"), work, name.endswith("_finer"))
        solve = lambda out, *more: run(dea, "run", model, "-o", out, "--overwrite", "--states", "last", "-q", "--inside", *more)  # noqa: E731
        solve(work / "own.xplt")
        restored(work / "own.xplt", kept.unpack((HERE / "kept" / f"{name}.xz").read_bytes()), joint, work / "febio.xplt")
        first = compared(dea, work / "own.xplt", work / "febio.xplt")["surfaces"]
        stiffness = [s["files"][1]["interface"]["stiffness"] for s in first if s["files"][1].get("interface")]
        mean = f"{float(np.exp(np.mean(np.log(stiffness)))):.4g}"  # of several contacts: they differ by a tenth
        solve(work / "own.xplt", "--interface-stiffness", mean)
        for surface in compared(dea, work / "own.xplt", work / "febio.xplt")["surfaces"]:
            if not surface["files"][1].get("interface"):
                continue
            d = surface["regions"][0]["differences"][0]
            bone = next((row["differences"][0]["max_shear_stress"] for row in surface.get("inside") or [] if row["row"] == "bone"), None)
            yield {"joint": name, "kind": joint.kind, "surface": surface["names"][0], "stiffness": float(mean), **{m: d["percent"]["headline"][m] for m in MEASURES}, "r": d["correlation"],
                   "bone p99": bone and bone["percent"]["p99"], "bone r": bone and bone["correlation"]}


def summary(rows):
    lines = ["| kind | contacts | " + " | ".join(f"{m}: median, quartiles, worst [%]" for m in MEASURES) + " | r: median, least |", "|---" * 7 + "|"]
    kinds = [k for k in joints.COUNTS if any(r["kind"] == k for r in rows)]
    for kind in [*kinds, "all"]:
        some = [r for r in rows if kind in (r["kind"], "all")]
        cells = []
        for m in MEASURES:
            x = np.array([r[m] for r in some])
            cells.append(f"{np.median(x):+.1f}, {np.quantile(x, .25):+.1f} to {np.quantile(x, .75):+.1f}, {x[np.abs(x).argmax()]:+.1f}")
        r = np.array([s["r"] for s in some])
        lines.append(f"| {kind} | {len(some)} | " + " | ".join(cells) + f" | {np.median(r):.4f}, {r.min():.4f} |")
    return lines


def main():
    words, out = sys.argv[1:], None
    if "--json" in words:
        at = words.index("--json")
        out = pathlib.Path(words[at + 1])
        del words[at:at + 2]
    if not words:
        sys.exit(__doc__)
    dea = os.path.abspath(words[0])
    there = [n for n in joints.NAMES if (HERE / "kept" / f"{n}.xz").exists()]
    names = [n for n in there if n in joints.UNTOUCHED] if words[1:] == ["untouched"] else words[1:] or [n for n in there if n not in joints.UNTOUCHED]
    rows = []
    for name in names:
        for row in joint_rows(dea, name):
            rows.append(row)
            print(row["joint"], row["surface"], *(f"{m} {row[m]:+.1f}" for m in MEASURES), f"r {row['r']:.4f}", f"bone p99 {row['bone p99']:+.1f} r {row['bone r']:.3f}" if row["bone p99"] is not None else "", flush=True)
    print("\n".join(summary(rows)))
    if out:
        out.write_text(json.dumps(rows, indent=1) + "\n")


if __name__ == "__main__":
    main()
