"""docs/results.md and what the program writes: python3 results_page.py DEA SOURCE.

Runs the program on samples and fails on a key of JSON or a column of CSV that the page lacks, on one that the page names
and no run writes, and on a null or an empty cell where the page says there is none. What is JSON must be as the schemas say that the program makes of
the page (schemas.py).

A table of the page belongs to the line "In `FILE` at `PLACE`, `PLACE`; in `FILE`" above it. Its columns JSON and CSV hold
the names: `_y` stands for the name before it with that ending, `{a,b}_c` for `a_c` and `b_c`. The keys of `settings` are the
settings of docs/settings.md."""
import collections
import csv
import json
import pathlib
import re
import subprocess
import sys
import tempfile

import made_models
import schemas
import stl_shapes

dea, source = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve()
samples = source / "samples"
PAGE = "docs/results.md"
NEVER = "–"  # in the last column of a row
# Settings that say which files a run writes, and with which states
OUTPUTS = {"output", "json", "csv", "compartments-csv", "facets-csv", "report", "no-xplt", "vtu", "states"}

# Each setting in some JSON; where a model is then refused, settings are told all the same. And a run without a solution.
TABLES = {"loads.csv": "time,fx,fy,fz\n0,0,0,-10\n1,0,0,-20\n", "motion.csv": "time,tx,ty,tz,rx,ry,rz\n0,0,0,0,0,0,0\n1,0,0,-0.1,0,0,0\n",
          "thickness.csv": "node,thickness\n1,2\n",
          "matrices.csv": ",".join(["time"] + [f"T{i}{j}" for i in range(1, 5) for j in range(1, 5)]) + "\n"
                          + "".join(f"{time},1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1\n" for time in (0, 1))}
SETTINGS = (
    ("many.info.json", "info ligament.feb --contact joint --source tibia --layer-terms 1 --interface-stiffness 94 --facets flat --refine 2 "
     "--attach tibia_articular=tibia --keep-facets tibia_articular --thickness tibia_articular=2 --thickness-scale 0.8 --E 8 "
     "--nu tibia_articular=0.4 --frame f=1,0,0/0,1,0/0,0,1 --rotate femur=0,0,1,5 --rotate-about femur=com --move femur=frame:f,0,0,0.1 "
     "--free femur=x,y,z --force femur=frame:f,1,2,3 --load-at femur=sphere-center --skip-steps --units mm-N-s --set tethers.stiffness=30", (0,)),
    ("bone.info.json", "info ligament.feb --law linear --springs-at bone --load-at femur=0,0,20 --force femur=1,2,3 --instant --fibre-strain 0.03 "
     "--bone tibia_articular=tibia_articular --rotate femur=1,0,0,1 --rotate-about femur=1,2,3 --thickness-from femur_articular=thickness.csv "
     "--leave-out cartilage", (3,)),
    ("loads.info.json", "info ligament.feb --loads loads.csv --load-body femur --load-frame femur --load-units N-mm --body-weight 800 "
     "--load-columns fx,fy,fz --rigid cartilage", (3,)),
    ("motion.info.json", "info ligament.feb --motion motion.csv --motion-body femur --motion-units rad-mm --motion-rotation vector "
     "--motion-columns tx,ty,tz,rx,ry,rz", (0,)),
    ("matrices.info.json", "info ligament.feb --motion matrices.csv --motion-body femur --motion-columns T --motion-start 0 --motion-units mm", (0,)),
    ("part.info.json", "info disc.feb --part disc", (0,)),
    ("apart.run.json", "run hip_walking.feb -q --no-xplt --no-squash --states last --force femur=0,0,-500", (1,)))

# What joins and loads bodies besides what samples/ligament has: a cable, a joint, a force on nodes. And something that is
# passed over, and something that is left unsaid: which way the cable's force pulls.
EXTRAS = """<rigid_ic name="swing" type="initial_rigid_velocity"><rb>femur</rb><value>0,0,1</value></rigid_ic>
<rigid_load name="muscle" type="rigid_cable"><force>5</force><relative>0</relative>
<rigid_cable_point><rigid_body_id>femur</rigid_body_id><position>0,0,20</position></rigid_cable_point>
<rigid_cable_point><rigid_body_id>tibia</rigid_body_id><position>0,0,-20</position></rigid_cable_point></rigid_load>
<rigid_connector name="guide" type="rigid cylindrical joint"><body_a>tibia</body_a><body_b>femur</body_b>
<joint_origin>0,0,25</joint_origin><joint_axis>0,0,1</joint_axis><transverse_axis>1,0,0</transverse_axis></rigid_connector>
</Rigid>
<Loads><nodal_load name="push" type="nodal_force" node_set="pushed"><value>0,0,-1</value></nodal_load></Loads>"""


def each(name):
    """The names that `{a,b}_c` stands for."""
    braces = re.search(r"\{([^{}]+)\}", name)
    if not braces:
        return [name]
    return [whole for one in braces[1].split(",") for whole in each(name[:braces.start()] + one + name[braces.end():])]


def names(cell):
    """The code spans of a cell, `_y` and `{a,b}` written out."""
    full = []
    for name in re.findall(r"`([^`]+)`", cell):
        full += each(full[-1].rpartition("_")[0] + name if name.startswith("_") else name)
    return full


def places(line):
    """File -> where in it, of a line such as: In `run.json` at `states[]`; in `run.csv`."""
    found = {}
    for part in line.split(";"):
        file, *at = re.findall(r"`([^`]+)`", part)
        found[file] = [place for places in at for place in each(places)] or [""]
    return found


def read_page(text):
    """File -> key or column -> whether it may be null or empty."""
    said = collections.defaultdict(dict)
    lines = text.splitlines()
    above, heads = {}, None
    for number, line in enumerate(lines, 1):
        if re.match(r"In `", line):
            above = places(line)
        if not line.startswith("|"):
            heads = None
            continue
        cells = [c.strip() for c in line.strip("|").split("|")]
        if heads is None:
            heads = cells
            continue
        for file, at in above.items():
            kind = file.rpartition(".")[2].upper()
            for name in names(cells[heads.index(kind)]) if kind in heads else []:
                for place in at:
                    key = f"{place}.{name}" if place else name
                    if key in said[file]:
                        faults.append(f"{PAGE}:{number}: {file}: `{key}` is said twice")
                    said[file][key] = cells[-1] != NEVER
    return said


def walk(value, key, written):
    """Key -> whether it was null anywhere. Keys of objects by name are {}; settings are told one by one; values of findings not."""
    if key == "finding_values[].values":
        return  # each rule has its own
    if isinstance(value, dict):
        by_name = re.fullmatch(r"(states|steps)\[\]\.bodies", key)
        for name, inner in value.items():
            at = key + "{}" if by_name else f"{key}.{name}" if key else name
            if not by_name:
                written[at] = written.get(at, False) or inner is None
            if key != "settings":
                walk(inner, at, written)
    elif isinstance(value, list):
        for inner in value:
            written[key] = written.get(key, False) or inner is None
            walk(inner, key if isinstance(inner, list) else key + "[]", written)


def keys_of(file):
    written = {}
    if file.suffix == ".json":
        walk(json.loads(file.read_text()), "", written)
        return written
    rows = list(csv.reader(file.read_text().splitlines()))
    for i, column in enumerate(rows[0]):
        name = re.sub(r"_above_[0-9.e+-]+$", "_above_T", column)
        written[name] = written.get(name, False) or any(row[i] == "" for row in rows[1:])
    return written


def run(folder, line, exits=(0,)):
    done = subprocess.run([dea] + line.split(), cwd=folder, capture_output=True, text=True)
    if done.returncode not in exits:
        raise SystemExit(f"dea {line}: exit code {done.returncode}\n{done.stderr}")


def make_models(folder):
    for model in ("hip/hip_walking", "knee/knee", "plateaus/plateaus", "ligament/ligament", "chain/chain"):
        name = pathlib.Path(model).name
        (folder / f"{name}.feb").write_text((samples / f"{model}.feb").read_text())
    (folder / "shared.feb").write_text(made_models.with_one_trochlea((samples / "knee/knee.feb").read_text()))
    (folder / "disc.feb").write_text(made_models.disc())
    for name, text in TABLES.items():
        (folder / name).write_text(text)
    (folder / "febio.xplt").write_bytes((samples / "hip/hip_walking_febio.xplt").read_bytes())
    text = (samples / "ligament/ligament.feb").read_text()
    # on a node of the femur, after the mesh's last node
    femur = re.search(r'<Elements type="[^"]+" name="femur[^"]*">\s*<elem id="\d+">(\d+)', text).group(1)
    text = text.replace("<DiscreteSet", f'<NodeSet name="pushed">{femur}</NodeSet>\n<DiscreteSet', 1)
    text = text.replace("</Rigid>", EXTRAS, 1)
    (folder / "joined.feb").write_text(text)
    (folder / "refused.feb").write_text(text.replace("</Loads>", '<body_load type="non-const"/></Loads>', 1))


def run_all(folder):
    """File of the page -> the files of that kind that were written."""
    outputs = "--json {0}.run.json --csv {0}.run.csv --compartments-csv {0}.compartments.csv --facets-csv {0}.facets.csv"
    for model in ("hip_walking", "knee", "plateaus", "chain", "joined"):
        run(folder, f"run {model}.feb -q --states last --inside -o {model}.xplt " + outputs.format(model))
        run(folder, f"info {model}.feb --json {model}.info.json")
    run(folder, "run plateaus.feb -q --law linear -o all.xplt " + outputs.format("all"))  # from before the first touch
    run(folder, "run shared.feb -q --states last --no-xplt --json shared.run.json")
    run(folder, "run disc.feb -q --no-xplt --json disc.run.json")
    run(folder, "info disc.feb --json disc.info.json")
    run(folder, "info refused.feb --json refused.info.json", (3,))
    for file, line, exits in SETTINGS:
        run(folder, f"{line} --json {file}", exits)
    run(folder, "converge ligament.feb -q --target 0.05 --law linear --json a.converge.json")
    run(folder, "compare hip_walking.xplt febio.xplt -q --profile --dose-above 1 --up 0,0,1 --anterior 0,1,0 "
                "--regions anterior-superior-posterior --json hip.compare.json --csv hip.compare.csv")
    run(folder, "compare hip_walking.xplt hip_walking.xplt -q --json rows.compare.json --csv rows.compare.csv")
    run(folder, "compare all.xplt all.xplt -q --dose-above 1 --json all.compare.json --csv all.compare.csv")
    if has_build:
        for name, text in stl_shapes.SURFACES.items():
            (folder / name).write_text(text)
        run(folder, "build --bone pelvis=pelvis.stl --bone femur=femur.stl --half-gap max=2,min=0.5 --force femur=0,0,500 -q "
                    "-o a.feb --json half.build.json")
        run(folder, "build --bone pelvis=pelvis.stl --bone femur=femur.stl --uniform pelvis=2 --force femur=0,0,500 -q "
                    "-o a.feb --json bare.build.json")
        (folder / "loads.csv").write_text("fx,fy,fz\n0,0,500\n0,0,600\n")
        run(folder, "build --bone pelvis=pelvis.stl --bone femur=femur.stl --uniform pelvis=2 --loads femur=loads.csv --hold femur=x -q "
                    "-o a.feb --json rows.build.json")
        (folder / "ligaments.csv").write_text("name,body_a,x_a,y_a,z_a,body_b,x_b,y_b,z_b,stiffness,slack_length\nteres,femur,0,0,18,pelvis,0,0,25,100,6\n")
        run(folder, "build --bone pelvis=pelvis.stl --bone femur=femur.stl --uniform pelvis=2 --force femur=0,0,500 -q "
                    "--ligaments ligaments.csv -o a.feb --json joined.build.json")
        (folder / "few.csv").write_text("tx,ty,tz\n0,0,0.02\n")  # too little to touch: a warning
        run(folder, "build --bone pelvis=pelvis.stl --bone femur=femur.stl --uniform pelvis=2 --motion femur=few.csv -q "
                    "-o a.feb --json moved.build.json")
        (folder / "landmarks.csv").write_text(stl_shapes.LANDMARKS)
        run(folder, "build --bone pelvis=pelvis.stl --bone femur=femur.stl --uniform pelvis=2 --force femur=0,0,500 -q "
                    "--landmarks landmarks.csv -o a.feb --json framed.build.json")
        run(folder, "build --bone pelvis=pelvis.stl --bone femur=femur.stl --uniform pelvis=2 --force femur=0,0,-500 -q "
                    "-o a.feb --json pulled.build.json", (1,))
    files = collections.defaultdict(list)
    for file in sorted(folder.glob("*.*.*")):
        files[file.name.partition(".")[2]].append(file)
    return files


def compare(said, file, outputs):
    written = {}
    for output in outputs:
        for key, null in keys_of(output).items():
            written[key] = written.get(key, False) or null
    inside = {key[:end.start()] for key in said for end in re.finditer(r"(\[\]|\{\})?\.", key)}  # what holds others
    for key, null in written.items():
        if key not in said and key not in inside:
            faults.append(f"{file}: `{key}` is written, and {PAGE} lacks it")
        elif null and not said.get(key, True):
            faults.append(f"{file}: `{key}` is null or empty, and {PAGE} says never")
    for key in said:
        if key not in written:
            faults.append(f"{PAGE} names `{key}` of {file}, and no run writes it")
    return len(written)


faults = []
has_build = "\n  build " in subprocess.run([dea, "--help"], capture_output=True, text=True, check=True).stdout
said = read_page((source / PAGE).read_text())
settings = set(re.findall(r"</([\w-]+)>` \|", (source / "docs/settings.md").read_text()))
assert OUTPUTS < settings, f"found no settings {OUTPUTS - settings} in docs/settings.md"
for file in ("run.json", "info.json", "converge.json"):
    for name in settings - OUTPUTS - ({"refine"} if file == "converge.json" else set()):
        said[file]["settings." + name.replace("-", "_")] = True
with tempfile.TemporaryDirectory() as temporary:
    folder = pathlib.Path(temporary)
    make_models(folder)
    files = run_all(folder)
    faults += schemas.faults(dea, files)
    counts = [f"{file} {compare(said.get(file, {}), file, outputs)}" for file, outputs in sorted(files.items())]
faults += [f"{PAGE} has {file}, and no run writes it" for file in said
           if file not in files and (has_build or file != "build.json")]
print("\n".join(faults) or "names written, all on the page: " + ", ".join(counts))
sys.exit(bool(faults))
