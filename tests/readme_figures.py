"""Figures that README.md, docs/first_joint.md and the samples' pages give of what dea prints: python3 readme_figures.py DEA SOURCE.

Each row names a page, the sentence or the cell with the figures, the run and where in its JSON they are. A figure must be
what the run gives, rounded as it is printed: one that no longer is, is to be measured again."""
import json
import math
import pathlib
import re
import subprocess
import sys
import tempfile

dea, source = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve()
samples = source / "samples"
runs = {}


def states(model, *options):
    """All states of a run, by their time."""
    if (model, options) not in runs:
        with tempfile.TemporaryDirectory() as folder:
            done = subprocess.run([dea, "run", samples / model, *options, "--json", "-", "-o", f"{folder}/out.xplt"],
                                  capture_output=True, text=True, check=True)
        runs[model, options] = {round(state["time"], 6): state for state in json.loads(done.stdout)["states"]}
    return runs[model, options]


def contact(state, name):
    return next(c for c in state["contacts"] if c["name"] == name)


def force(state, name):
    return math.hypot(*contact(state, name)["force"])


def sinks(state, body):
    return -state["bodies"][body]["translation"][2]


def tension(state, name):
    return next(ligament["force"] for ligament in state["ligaments"] if ligament["name"] == name)


def sideways(state, body):
    """What holds a body: what acts on it, taken back."""
    return math.hypot(*state["bodies"][body]["force"][:2])


NUMBER = r"(-?\d+(?:\.\d+)?)"


def sentences():
    flat = states("sphere_on_flat/sphere_on_flat.feb")
    yield ("sphere_on_flat", f"flows sideways .*?: {NUMBER} N at d = 0.4 mm, and d = {NUMBER} mm under 400 N",
           [force(flat[1.0], "joint"), sinks(flat[2.0], "sphere")])
    ligament = states("ligament/ligament.feb")
    yield "ligament", f"the femur sinks further, {NUMBER} mm under 300 N", [sinks(ligament[1.0], "femur")]
    knee = states("knee/knee.feb")
    first, last = knee[0.1], knee[1.0]
    yield ("knee", f"the quadriceps' force grows from 2 x {NUMBER} N to 2 x {NUMBER} N, the patellofemoral forces from "
           f"{NUMBER} and {NUMBER} N to {NUMBER} and {NUMBER} N",
           [tension(first, "vastus medialis"), tension(last, "vastus medialis"), *(
               force(state, f"{side} patellofemoral") for state in (first, last) for side in ("medial", "lateral"))])
    chain = states("chain/chain.feb")[1.0]
    yield "chain", f"sideways forces on the ends, {NUMBER} and {NUMBER} N", [sideways(chain, "bone 1"), sideways(chain, "bone 10")]


def hip_table():
    """Rows of the table of samples/hip, and its three columns."""
    columns = [states("hip/hip_walking.feb", *options) for options in
               ((), ("--law", "linear"), ("--law", "linear", "--springs-at", "bone"))]
    columns = [run[max(run)] for run in columns]
    rows = {
        "p99": lambda c: c["headline"]["p99"], "mean": lambda c: c["headline"]["mean"],
        "area": lambda c: c["headline"]["area"], "peak": lambda c: c["headline"]["peak"],
        "threshold of these": lambda c: c["headline"]["above"], "p99, springs": lambda c: c["p99_pressure"],
        "mean, springs": lambda c: c["mean_pressure"], "median, springs": lambda c: c["median_pressure"],
        "area, springs": lambda c: c["contact_area"], "peak, springs": lambda c: c["peak_pressure"],
        "area, facets > 0": lambda c: c["facet_contact_area"], "peak, facets > 0": lambda c: c["facet_peak_pressure"],
    }
    for name, value in rows.items():
        yield ("hip", rf"\| {re.escape(name)} \| {NUMBER} \S+ \| {NUMBER} \S+ \| {NUMBER} \S+ \|",
               [value(state["contacts"][0]) for state in columns])
    three = rf"\({NUMBER}, {NUMBER}, {NUMBER}\) mm"
    yield ("hip", rf"\| motion of the femur \| {three} \| {three} \| {three}",
           [v for state in columns for v in state["bodies"]["femur"]["translation"]])


def first_joint():
    """docs/first_joint.md: every line that it shows stands in the sample's file or is printed; how it differs with FEBio's give in dea."""
    page = (source / "docs/first_joint.md").read_text()
    model, febio = samples / "hip/hip_walking.feb", samples / "hip/hip_walking_febio.xplt"
    with tempfile.TemporaryDirectory() as folder:
        def answer(*words):
            return subprocess.run([dea, *words], cwd=folder, capture_output=True, text=True, check=True).stdout

        stiffness = re.search(r"--interface-stiffness (\S+) puts", page)[1]
        printed = [answer("info", model), answer("run", model, "-o", "hip_walking_dea.xplt"), answer("compare", "hip_walking_dea.xplt", febio)]
        answer("run", model, "--interface-stiffness", stiffness, "-o", "give.xplt")
        differs = {name: abs(float(percent)) for name, percent in
                   re.findall(r"^(p99|mean|area) .* (\S+)%$", answer("compare", "give.xplt", febio), re.M)}
    lines = {"xml": model.read_text(), "": "\n".join(printed)}
    known = {kind: {line.strip() for line in text.splitlines()} for kind, text in lines.items()}
    balanced = {line.rpartition(" ")[0] for line in known[""] if " Balanced " in line}  # another compiler leaves another residual
    shown = [(kind, line.strip()) for kind, block in re.findall(r"^```(\w*)\n(.*?)^```$", page, re.M | re.S) for line in block.splitlines()]
    faults.extend(f"docs/first_joint.md: shows what is not {'in ' + model.name if kind else 'printed'}: {line}" for kind, line in shown
                  if line not in known[kind] and line.rpartition(" ")[0] not in balanced)
    if len(shown) < 60:
        faults.append(f"docs/first_joint.md: found {len(shown)} lines that it shows, expected more")
    yield ("docs/first_joint.md", rf"p99 then differs by {NUMBER} %, the mean by less, the area by {NUMBER} %", [differs["p99"], differs["area"]])
    if differs["mean"] > differs["p99"]:
        faults.append("docs/first_joint.md: the mean differs by more than p99")


def wrong(printed, value):
    """Not the value, rounded to the digits that are printed."""
    return abs(float(printed) - value) > 0.51 * 10.0 ** -len(printed.partition(".")[2])


def worked_example():
    """README: the last line of the run's table, and its differences from FEBio's result beside the model."""
    def answer(*words):
        return subprocess.run([dea, *words], cwd=folder, capture_output=True, text=True, check=True).stdout

    with tempfile.TemporaryDirectory() as folder:
        table = answer("run", samples / "hip/hip_walking.feb", "-o", "dea.xplt").partition("\n\n")[2].partition("\n\n")[0].splitlines()
        if f"```\n{table[0].rstrip()}\n{table[-1].rstrip().rpartition(' ')[0]}" not in readme:  # another compiler leaves another residual
            faults.append(f"README.md: the worked example does not show what the run prints:\n{table[0]}\n{table[-1]}")
        differs = {areas: {name: float(percent) for name, percent in re.findall(
            r"^(p99|mean|area|peak) .* (\S+)%$", answer("compare", "dea.xplt", samples / "hip/hip_walking_febio.xplt", "--areas", areas), re.M)}
            for areas in ("reference", "deformed")}
    yield ("", rf"prints p99 \+{NUMBER} % and area {NUMBER} %; .*? it prints \+{NUMBER} % and {NUMBER} %",
           [differs[areas][name] for areas in ("reference", "deformed") for name in ("p99", "area")])
    # The table of docs/accuracy.md has three loads of this hip, of which this is one
    ranges = re.search(r"^\| dea, law layer \| one hip, [^|]*\| deformed .*\|$", (source / "docs/accuracy.md").read_text(), re.M)[0].split("|")[4:8]
    for (name, value), cell in zip(differs["deformed"].items(), ranges, strict=True):
        least, most = map(float, cell.split(" to "))
        if not least - 0.051 < value < most + 0.051:
            faults.append(f"docs/accuracy.md: {name} of {samples.name}/hip differs by {value:.2f} %, the table says{cell}")


faults, figures = [], 0
readme = (source / "README.md").read_text()
for page, pattern, values in [*worked_example(), *first_joint(), *sentences(), *hip_table()]:
    path = source / page if page.endswith(".md") else samples / page / "README.md" if page else source / "README.md"
    found = re.search(pattern, re.sub(r"\s+", " ", path.read_text()))
    if not found:
        faults.append(f"{path.relative_to(source)}: nothing there like {pattern}")
        continue
    for printed, value in zip(found.groups(), values, strict=True):
        figures += 1
        if wrong(printed, value):
            faults.append(f"{path.relative_to(source)}: {printed} in \"{found.group(0)[:120]}\", the run gives {value:.6g}")
print("\n".join(faults) or f"{figures} figures are what the runs give")
sys.exit(bool(faults))
