#!/usr/bin/env python3
"""dea beside FEBio's kept results: results.py DEA [NAME...]         a row per contact, then median, quartiles and the worst per kind
                                 results.py DEA --write           all of them: results.json, and from it the tables of docs/accuracy.md, README.md,
                                                                  docs/figures/population.svg and src/rules/population.inc
                                 results.py DEA [NAME...] --kept FOLDER   with FEBio's results of one's own (kept.py)
                                 results.py DEA --check NAME...   are these still as in results.json?

Each joint is made and solved by dea with the stiffness of FEBio's contact between the surfaces, and compared by dea compare on deformed areas.
Without names: all joints but the untouched ones and the finer meshes; `untouched` names the first. NumPy; --write: Matplotlib, too."""
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
ROOT = HERE.parents[1]
RESULTS = HERE / "results.json"
KEPT = HERE / "kept"
FEBIO = json.loads((KEPT / "febio.json").read_text())
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
    """One row per contact: what it is like as dea's rule `contact-shape` has it, FEBio's headline numbers, dea's difference from them in per cent,
    with the stiffness of FEBio's contact between the surfaces, and plain, as dea runs without it."""
    joint = kept.joint_of(name)
    with tempfile.TemporaryDirectory() as folder:
        work = pathlib.Path(folder)
        model = joints.make(name.removesuffix("_finer"), work, name.endswith("_finer"))
        alone = json.loads(run(dea, "run", model, "--no-xplt", "--states", "last", "-q", "--json", "-"))
        told = lambda code: {f["contact"]: f["values"] for f in alone["finding_values"] if f["code"] == code}  # noqa: E731
        shapes, like = told("contact-shape"), told("contacts-like-this")
        solve = lambda out, *more: run(dea, "run", model, "-o", out, "--overwrite", "--states", "last", "-q", "--inside", *more)  # noqa: E731
        solve(work / "own.xplt")
        restored(work / "own.xplt", kept.unpack((KEPT / f"{name}.xz").read_bytes()), joint, work / "febio.xplt")
        first = compared(dea, work / "own.xplt", work / "febio.xplt")["surfaces"]
        stiffness = [s["files"][1]["interface"]["stiffness"] for s in first if s["files"][1].get("interface")]
        plain = {s["names"][0]: s["regions"][0]["differences"][0]["percent"]["headline"] for s in first if s["files"][1].get("interface")}
        mean = f"{float(np.exp(np.mean(np.log(stiffness)))):.4g}"  # of several contacts: they differ by a tenth
        solve(work / "own.xplt", "--interface-stiffness", mean)
        for surface in compared(dea, work / "own.xplt", work / "febio.xplt")["surfaces"]:
            if not surface["files"][1].get("interface"):
                continue
            region = surface["regions"][0]
            d = region["differences"][0]
            bone = next((row["differences"][0]["max_shear_stress"] for row in surface.get("inside") or [] if row["row"] == "bone"), None)
            contact = next(c["name"] for c in alone["states"][-1]["contacts"] if c["headline"]["surface"] == surface["names"][0])
            yield {"joint": name, "kind": joint.kind, "surface": surface["names"][0], "stiffness": float(mean), **{m: d["percent"]["headline"][m] for m in MEASURES},
                   "plain": {m: plain[surface["names"][0]][m] for m in MEASURES}, "r": d["correlation"],
                   "bone p99": bone and bone["percent"]["p99"], "bone r": bone and bone["correlation"], "febio": {m: region["results"][1]["headline"][m] for m in MEASURES},
                   "shape": shapes[contact], "like": like.get(contact), "seconds": alone["timings"]["total"]}


# ---- tables ----

def finer(row):
    return row["joint"].endswith("_finer")


def untouched(row):
    return row["joint"] in joints.UNTOUCHED


def joints_within(rows, of=lambda r: r):
    """Of how many joints p99 is within 6 % and mean and area within 4 %, in all contacts; of how many there are."""
    names = sorted({r["joint"] for r in rows})
    good = [n for n in names if all(abs(of(r)["p99"]) <= 6 and max(abs(of(r)["mean"]), abs(of(r)["area"])) <= 4 for r in rows if r["joint"] == n)]
    return len(good), len(names)


def signed(x):
    return f"{round(float(x), 1) + 0.0:+.1f}"  # no -0.0


def spread(x):
    x = np.array(x)
    return f"{signed(np.median(x))}, {signed(np.quantile(x, .25))} to {signed(np.quantile(x, .75))}, {signed(x[np.abs(x).argmax()])}"


def summary(rows):
    lines = ["| [%]: median, quartiles, worst | joints, contacts | " + " | ".join(MEASURES) + " | largest shear stress at the bone, p99 | r: median, least | joints within 6, 4, 4 % |", "|---" * (len(MEASURES) + 5) + "|"]
    groups = [(kind, [r for r in rows if r["kind"] == kind]) for kind in joints.COUNTS]
    groups += [("all", rows), ("of them never looked at before", [r for r in rows if untouched(r)])]
    for title, some in groups:
        if not some:
            continue
        r = np.array([s["r"] for s in some])
        good, of = joints_within(some)
        lines.append(f"| {title} | {of}, {len(some)} | " + " | ".join(spread([s[m] for s in some]) for m in MEASURES) + f" | {spread([s['bone p99'] for s in some])} | {np.median(r):.4f}, {r.min():.4f} | {good} of {of} |")
    return lines


def every(rows):
    lines = ["| joint | facets across | width in thicknesses | strain [%] | force at edges [%] | nu | moduli | " + " | ".join(f"{m} [%]" for m in MEASURES) + " | r | largest shear stress at the bone, p99 [%], r |", "|---" * 13 + "|"]
    for r in rows:
        s = r["shape"]
        title = r["joint"] + (" " + r["surface"].split()[0] if r["kind"] == "knee" else "") + (", not looked at before" if untouched(r) else "")
        lines.append(f"| {title} | {s['across']:.0f} | {s['width']:.1f} | {s['strain']:.0f} | {s['edge']:.0f} | {s['nu']:.2f} | {s['ratio']:.1f} | " + " | ".join(signed(r[m]) for m in MEASURES) +
                     f" | {r['r']:.4f} | {signed(r['bone p99'])}, {r['bone r']:.3f} |")
    return lines


def against_itself(rows):
    """FEBio's finer mesh and higher penalty against its own normal one, and dea against both."""
    lines = ["| joint | FEBio, finer, from FEBio: p99, mean, area, peak [%] | dea by itself from FEBio | both finer | dea with FEBio's give from FEBio | both finer |", "|---" * 6 + "|"]
    for fine in filter(finer, rows):
        normal = next(r for r in rows if r["joint"] == fine["joint"].removesuffix("_finer") and r["surface"] == fine["surface"])
        cells = [[100 * (fine["febio"][m] / normal["febio"][m] - 1) for m in MEASURES], [normal["plain"][m] for m in MEASURES], [fine["plain"][m] for m in MEASURES],
                 [normal[m] for m in MEASURES], [fine[m] for m in MEASURES]]
        title = normal["joint"] + (" " + fine["surface"].split()[0] if fine["kind"] == "knee" else "")
        lines.append(f"| {title} | " + " | ".join(", ".join(signed(x) for x in cell) for cell in cells) + " |")
    return lines


PREDICTORS = {"facets across, doubled": lambda s: np.log2(s["across"]), "width in thicknesses, doubled": lambda s: np.log2(s["width"]), "10 % more strain": lambda s: s["strain"] / 10,
              "10 % more force at edges": lambda s: s["edge"] / 10, "nu .1 more": lambda s: s["nu"] / 0.1, "ratio of moduli, doubled": lambda s: np.log2(s["ratio"])}


def regression(rows):
    """Least squares of the differences on what a contact is like, all at once; with standard errors."""
    x = np.array([[1.0, *(of(r["shape"]) for of in PREDICTORS.values())] for r in rows])
    lines = ["| changes the difference by [%], +- standard error | " + " | ".join(MEASURES[:3]) + " |", "|---" * 4 + "|"]
    columns, explained = [], []
    for m in MEASURES[:3]:
        y = np.array([r[m] for r in rows])
        b, _, rank, _ = np.linalg.lstsq(x, y, rcond=None)
        left = y - x @ b
        error = np.sqrt(np.diag(np.linalg.pinv(x.T @ x)) * (left @ left) / max(1, len(y) - rank))
        columns.append([f"{c:+.1f} +- {e:.1f}" for c, e in zip(b[1:], error[1:])])
        explained.append(f"{100 * (1 - left @ left / ((y - y.mean()) @ (y - y.mean()))):.0f} %")
    lines += [f"| {name} | " + " | ".join(cells) + " |" for name, *cells in zip(PREDICTORS, *columns)]
    return lines + ["| of the variance explained | " + " | ".join(explained) + " |"]


def plain_spread(rows):
    """The same without that stiffness: the most a reader's own first comparison shows."""
    lines = ["| as dea runs by itself [%]: median, quartiles, worst | contacts | " + " | ".join(MEASURES) + " | joints within 6, 4, 4 % |", "|---" * (len(MEASURES) + 3) + "|"]
    for kind in [*joints.COUNTS, "all"]:
        some = [r for r in rows if kind in (r["kind"], "all")]
        good, of = joints_within(some, lambda r: r["plain"])
        lines.append(f"| {kind} | {len(some)} | " + " | ".join(spread([r["plain"][m] for r in some]) for m in MEASURES) + f" | {good} of {of} |")
    return lines


def alike(a, b):
    """As src/rules/population.cpp has it."""
    near = {"across": (np.log, 0.5), "width": (np.log, 0.5), "strain": (float, 8), "edge": (float, 15), "nu": (float, 0.08), "ratio": (np.log, 0.4)}
    return all(abs(of(a[k]) - of(b[k])) <= within for k, (of, within) in near.items())


def held_out(rows):
    """Of each contact the range over those of other joints that are like it: how often it lies inside."""
    texts = []
    for title, of in (("as dea runs by itself", lambda r: r["plain"]), ("with the give of FEBio's contact", lambda r: r)):
        asked, inside = 0, dict.fromkeys([*MEASURES[:3], "all"], 0)
        for r in rows:
            others = [of(o) for o in rows if o["joint"] != r["joint"] and alike(o["shape"], r["shape"])]
            if len(others) < 10:
                continue
            asked += 1
            hits = {m: min(o[m] for o in others) <= of(r)[m] <= max(o[m] for o in others) for m in MEASURES[:3]}
            for m in hits:
                inside[m] += hits[m]
            inside["all"] += all(hits.values())
        texts.append(f"{title} p99 lies inside the range of the neighbours in {inside['p99']}, mean in {inside['mean']}, area in {inside['area']}, all three in {inside['all']}")
    return [f"With each joint left out of its own neighbours, {asked} contacts have ten or more; of these, {'; '.join(texts)}."]


def brief(rows):
    blind = [r for r in rows if untouched(r)]
    good, of = joints_within(rows)
    unseen, unseen_of = joints_within(blind)
    febio, own = [FEBIO[r["joint"]]["seconds"] for r in rows], [r["seconds"] for r in rows]
    say = lambda values: (lambda x: f"{signed(np.median(x))} % (nine tenths within {np.quantile(np.abs(x), .9):.1f} %, worst {signed(x[np.abs(x).argmax()])} %)")(np.array(values))  # noqa: E731
    lines = ["| dea less FEBio, in % of FEBio | p99 | mean | area | peak |", "|---" * 5 + "|",
             "| as dea runs by itself | " + " | ".join(say([r["plain"][m] for r in rows]) for m in MEASURES) + " |",
             "| with the give of FEBio's contact between dea's surfaces, too | " + " | ".join(say([r[m] for r in rows]) for m in MEASURES) + " |"]
    itself = lambda r: r["plain"]  # noqa: E731
    return [f"Over {of} joints of {len({r['kind'] for r in rows})} kinds, made from seeds and solved by FEBio {FEBIO[rows[0]['joint']]['version'].rsplit('.', 2)[0]}, in the median contact:", "", *lines, "",
            f"Within 6 % in p99 and 4 % in mean and area: as dea runs by itself {joints_within(rows, itself)[0]} of {of} joints, {joints_within(blind, itself)[0]} of the {unseen_of} that nobody had "
            f"looked at before; with the give of FEBio's contact, which is measured in FEBio's result of the same joint, {good} of {of} and {unseen} of {unseen_of}. Correlation of the maps there: "
            f"{np.median([r['r'] for r in rows]):.3f}. For the last state alone dea took {np.median(own):.1f} s; FEBio, for its 18 steps on one thread, {np.median(febio):.0f} s."]


def times(rows):
    febio, own = np.array([FEBIO[r["joint"]]["seconds"] for r in rows]), np.array([r["seconds"] for r in rows])
    return [f"FEBio {FEBIO[rows[0]['joint']]['version']}: {febio.min():.0f} to {febio.max():.0f} s, in the median {np.median(febio):.0f} s, for 18 steps, two joints at a time on two processors that did other things, too (one thread each, a direct solver). "
            f"dea: {own.min():.2f} to {own.max():.2f} s, in the median {np.median(own):.2f} s, for the last state alone without a plot file, one joint at a time on the same two processors."]


def picture(rows, path):
    import matplotlib
    matplotlib.use("svg")
    matplotlib.rcParams.update({"svg.hashsalt": "population", "svg.fonttype": "none", "font.family": "sans-serif"})
    from matplotlib import pyplot
    figure, axes = pyplot.subplots(1, 3, figsize=(10, 3.6), sharey=True)
    for axis, m, bound in zip(axes, MEASURES, (6, 4, 4)):
        axis.axhspan(-bound, bound, color="0.93")
        axis.axhline(0, color="0.6", linewidth=0.8)
        for k, kind in enumerate(joints.COUNTS):
            some = [r for r in rows if r["kind"] == kind]
            for n, r in enumerate(some):
                x = k + 0.6 * ((n + 0.5) / len(some) - 0.5)
                axis.plot(x, r[m], "o", markersize=5, color="C0", markerfacecolor="white" if untouched(r) else "C0")
        axis.set_xticks(range(len(joints.COUNTS)), list(joints.COUNTS), rotation=45)
        axis.set_title(f"{m}: dea less FEBio [%]", fontsize=10)
    figure.tight_layout()
    figure.savefig(path, metadata={"Date": None})


def population_lines(rows):
    """The table of src/rules/population.cpp."""
    order = ("across", "width", "strain", "edge", "nu", "ratio")
    for r in rows:
        shape = ", ".join(f"{r['shape'][k] / (100 if k in ('strain', 'edge') else 1):.4g}" for k in order)
        errors = ["{" + ", ".join(f"{of[m]:.2f}" for m in MEASURES[:3]) + "}" for of in (r["plain"], r)]
        yield f'{{"{r["joint"]}", {{{shape}}}, {", ".join(errors)}}},'


def put(path, name, lines):
    text = path.read_text()
    place = re.compile(rf"(<!-- population {name} -->\n).*?(<!-- end {name} -->)", re.S)
    if len(place.findall(text)) != 1:
        raise SystemExit(f"{path}: found no place for the table {name}, expected the lines <!-- population {name} --> and <!-- end {name} -->")
    path.write_text(place.sub(lambda m: m[1] + "\n".join(["", *lines, "", ""]) + m[2], text))


def write(rows):
    normal = [r for r in rows if not finer(r)]
    RESULTS.write_text(json.dumps([{k: v for k, v in r.items() if k != "like"} for r in rows], indent=1) + "\n")
    docs = ROOT / "docs/accuracy.md"
    for name, lines in {"kinds": summary(normal), "itself": against_itself(rows), "regression": regression(normal), "times": times(normal), "plain": plain_spread(normal), "held out": held_out(normal), "joints": every(normal)}.items():
        put(docs, name, lines)
    put(ROOT / "README.md", "brief", brief(normal))
    picture(normal, ROOT / "docs/figures/population.svg")
    (ROOT / "src/rules/population.inc").write_text("// made by bench/population/results.py --write: joint, shape, then p99, mean, area against FEBio [%], plain and with the give of its contact\n" + "\n".join(population_lines(normal)) + "\n")


def check(dea, names):
    """Each row as it was written, within what a build and a processor may change; and src/rules has the same numbers."""
    was = json.loads(RESULTS.read_text())
    if (ROOT / "src/rules/population.inc").read_text().splitlines()[1:] != list(population_lines([r for r in was if not finer(r)])):
        raise SystemExit("src/rules/population.inc: found other rows than in results.json, expected those that --write made")
    told = 0
    for name in names:
        for new, old in zip(joint_rows(dea, name), [r for r in was if r["joint"] == name], strict=True):
            for m in MEASURES:
                if not abs(new[m] - old[m]) < 0.1:
                    raise SystemExit(f"{name}, {new['surface']}: found {m} {new[m]:+.2f} %, expected {old[m]:+.2f} % within 0.1")
            like = new["like"]  # what dea run tells has the joint itself among its neighbours
            if like and not all(like[f"{m}_least"] - 0.1 <= new["plain"][m] <= like[f"{m}_most"] + 0.1 for m in MEASURES[:3]):
                raise SystemExit(f"{name}, {new['surface']}: found {like}, expected its own differences within that")
            neighbours = sum(alike(other["shape"], new["shape"]) for other in was if not finer(other))
            if like and like["contacts"] != neighbours:
                raise SystemExit(f"{name}, {new['surface']}: found {like['contacts']:g} neighbours by dea, expected {neighbours}")
            told += like is not None
            print(name, new["surface"], "as it was")
    if not told:
        raise SystemExit("found no contact that dea run tells of others like it, expected one at least")


def main():
    words = sys.argv[1:]
    flags = {w for w in words if w.startswith("--")}
    words = [w for w in words if w not in flags]
    if not words or flags - {"--write", "--check", "--kept"}:
        sys.exit(__doc__)
    if "--kept" in flags:
        global KEPT, FEBIO
        at = sys.argv.index("--kept") + 1
        if at == len(sys.argv) or flags != {"--kept"}:
            sys.exit(__doc__)
        KEPT = pathlib.Path(sys.argv[at])
        words.remove(sys.argv[at])
        FEBIO = json.loads((KEPT / "febio.json").read_text())
    dea = os.path.abspath(words[0])
    there = [n + f for n in joints.NAMES for f in ("", "_finer") if (KEPT / f"{n}{f}.xz").exists()]
    if "--check" in flags:
        return check(dea, words[1:])
    if "--write" in flags:
        names = there
    elif words[1:] == ["untouched"]:
        names = joints.UNTOUCHED
    else:
        names = words[1:] or [n for n in there if n in joints.NAMES and n not in joints.UNTOUCHED]
    if unknown := [n for n in names if n not in there]:
        sys.exit(f"found {', '.join(unknown)}, expected joints that are kept (joints.py list)")
    rows = []
    for name in names:
        for row in joint_rows(dea, name):
            rows.append(row)
            print(row["joint"], row["surface"], *(f"{m} {signed(row[m])}" for m in MEASURES), f"r {row['r']:.4f}", f"bone p99 {row['bone p99']:+.1f} r {row['bone r']:.3f}" if row["bone p99"] is not None else "", flush=True)
    print("\n".join(summary([r for r in rows if not finer(r)] or rows)))
    if "--write" in flags:
        write(rows)


if __name__ == "__main__":
    main()
