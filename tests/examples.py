"""Every example as a user would type it: python3 examples.py DEA SOURCE [-v].

Collects the commands of the pages on top, of docs, of every folder's README.md and the "Examples" of each --help: lines of indented or fenced
blocks that begin with `dea`, and code in a sentence that names a file. Runs each in a folder of its own with the files it names, and fails
where the exit code is not 0, where a file that the line or the words beside it name is not there afterwards, and where a
"note: ..." shown below it is not printed. A new example with a new file name needs a line in FILES."""
import concurrent.futures
import math
import os
import pathlib
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
import time

import stl_shapes

dea, source = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve()
sys.dont_write_bytecode = True
sys.path.insert(0, str(source / "samples/made_knee"))
import make_knee  # noqa: E402
COMMANDS = ("run", "info", "converge", "convert", "compare", "plot", "study", "build", "plugin-build", "cite", "findings", "schema", "man", "completion")

# Commands that are not run: what they hold, and why.
SKIPPED = {"plugin-build": "needs an installed FEBio"}
if not (dea.parent / "dea-build").exists():
    SKIPPED["build"] = "no dea-build was built"



def poses(*flexions):
    """As OpenSim-JAM writes it: a femur flexed about x on a tibia that leans by 10 degrees, 0.4 m up; nRows too small."""
    def turn(degrees, axis):
        c, s, (i, j) = math.cos(math.radians(degrees)), math.sin(math.radians(degrees)), ((1, 2), (2, 0), (0, 1))[axis]
        m = [[float(a == b) for b in range(4)] for a in range(4)]
        m[i][i], m[i][j], m[j][i], m[j][j] = c, -s, s, c
        return m
    lean = turn(10, 1)
    lean[2][3] = 0.4
    names = [f"{body}_T{i}{j}" for body in ("femur_r", "tibia_r") for i in range(1, 5) for j in range(1, 5)]
    rows = []
    for time, flexion in enumerate(flexions, 1):
        femur = [[sum(lean[i][k] * turn(flexion, 0)[k][j] for k in range(4)) for j in range(4)] for i in range(4)]
        rows.append("\t".join(map(repr, [time, *sum(femur, []), *sum(lean, [])])))
    return "nColumns=33\nnRows=1\nDataType=double\nversion=3\nendheader\n" + "\n".join(["\t".join(["time", *names]), *rows, ""])


HIP, FEBIO = "samples/hip/hip_walking.feb", "samples/hip/hip_walking_febio.xplt"
# The same hip in 7 states instead of 23: a user's own, of which no example names the states.
FEW = HIP + "".join(f" <{word}>{was}</{word}>-><{word}>{now}</{word}>" for word, was, now in
                    (("time_steps", "20", "4"), ("step_size", "0.05", "0.25"), ("dtmax", "0.05", "0.25")))
# What a user has: a file of the sources, or the command that makes it. "WORD->OTHER": the same with another word.
FILES = {
    "hip.feb": FEW, "own.feb": FEW, "hip_walking.feb": HIP,
    "hip.xplt": FEBIO, "own.xplt": FEBIO, "fea.xplt": FEBIO, "hip_walking_febio.xplt": FEBIO,
    "knee.feb": "samples/knee/knee.feb",
    "chain.feb": "samples/chain/chain.feb",
    "menisci.feb": "samples/menisci/menisci.feb",
    "plateaus.feb": "samples/plateaus/plateaus.feb",
    "ligament.feb": "samples/ligament/ligament.feb",
    "sphere_on_flat.feb": "samples/sphere_on_flat/sphere_on_flat.feb",
    "one_layer.feb": "samples/spheres/one_layer.feb",
    "hip_dea.xplt": "dea run hip.feb",
    "own_dea.xplt": "dea run own.feb --times-from own.xplt",
    "own_series.xplt": "dea run own.feb -o own_series.xplt --times-from own.xplt --interface-stiffness 92",
    "hip_walking_dea.xplt": "dea run hip_walking.feb",
    "hip_walking_check.xplt": "dea info hip_walking.feb -o hip_walking_check.xplt",
    "knee_dea.xplt": "dea run knee.feb --states last",
    "hip_inside.xplt": "dea run hip_walking.feb --inside -o hip_inside.xplt",
    # FEBio's with `stress` is not in the sources
    "hip_stress.xplt": "dea run hip_walking.feb --inside --E 12 -o hip_stress.xplt",
    "hip_dea.feb": "dea convert hip.feb",
    "hip_springs.xplt": "dea run hip.feb -o hip_springs.xplt",  # in its text FEBio with the plugin makes it
    "task.xplt": "dea run hip.feb -o task.xplt", "run.xplt": "dea run hip.feb -o run.xplt",  # the first by febio4 with the plugin
    "articular.xplt": "dea run hip.feb -o articular.xplt --states last",
    "layer.xplt": "dea run hip.feb -o layer.xplt --states last",
    "bone.xplt": "dea run hip.feb -o bone.xplt --springs-at bone --states last",
    "linear.xplt": "dea run hip.feb -o linear.xplt --law linear --states last",
    # two results of a ball: FEBio's is not in the sources
    "ball_dea.xplt": "dea run one_layer.feb -o ball_dea.xplt --states last",
    "ball.xplt": "dea run one_layer.feb -o ball.xplt --law linear --states last",
    # results in which a surface has different names
    "a.feb": FEW + " acetabular_articulating->socket", "b.feb": FEW + " acetabular_articulating->acetabulum",
    "a.xplt": "dea run a.feb -o a.xplt", "b.xplt": "dea run b.feb -o b.xplt --law linear",
    "gait.csv": "samples/osteotomy/gait.csv",
    "osteotomy.db": "dea study hip_walking.feb --vary 'tilt: rotate pelvis=0,1,0,{0|10}' --states last -o osteotomy.db",
    **stl_shapes.SURFACES,
    **make_knee.files(),
    "made_knee.feb": "dea build --bone femur=knee_femur.stl --cartilage femur=knee_femoral_cartilage.stl --bone tibia=knee_tibia.stl "
                     "--cartilage tibia=knee_tibial_cartilage.stl --ligaments knee_ligaments.csv --force tibia=0,0,700 -o made_knee.feb",
    # where both bones lie as they are: in m, and the femur moved by angles
    "bones.csv": ",".join(f"pelvis_T{i}{k}" for i in range(1, 5) for k in range(1, 5)) + "\n1,0,0,0,0,1,0,0,0,0,1,0.00005,0,0,0,1\n",
    "moves.csv": "tx,ty,tz,rx,ry,rz\n0,0,2.25,0,0,0\n0,0,2.35,3,0,5\n",
    "femur_pose.txt": "1 0 0 0\n0 1 0 0\n0 0 1 0.05\n0 0 0 1\n",
    "landmarks.csv": stl_shapes.LANDMARKS,
    "hip_frames.xml": "dea build --bone pelvis=pelvis.stl --bone femur=femur.stl --uniform pelvis=2 --landmarks landmarks.csv "
                      "--force femur=432,-262,1834 --frames hip_frames.xml -o j.feb -q",
    "mri_thickness.csv": "x,y,z,thickness\n0,0,19.9,2\n19.9,0,0,1.5\n",
    "cases.csv": "stiffness,poisson\n8,0.4\n12,0.45\n",
    "plan.db": "dea study hip.feb --vary 'E: E={8|12}' --states last -o plan.db",
    "hips.db": "dea study a.feb b.feb --states last -o hips.db",
    "subjects.csv": "model,subject,stage\na,S01,before\nb,S01,after\n",
    "turned.db": "dea study hip.feb --vary 'tilt: rotate pelvis=0,1,0,{0|5}' --keep fields -o turned.db",
    **{f"plan.{i}-of-4.db": f"dea study hip.feb --vary 'E: E={{8:14:2}}' --states last --shard {i}/4 -o plan.db" for i in range(1, 5)},
    "walk.csv": "time,fx,fy,fz\n0,30,-20,150\n1,54,-33,229\n",  # % of body weight
    "pelvis_forces.csv": "time,fx,fy,fz\n0,20,150,-30\n1,33,229,-54\n",  # the same, forwards, up, to the right
    "poses.sto": poses(0, 6),
    "gait.sto": "gait\nversion=1\nnRows=2\nnColumns=4\ninDegrees=no\nendheader\n"
                "time\thip_fx\thip_fy\thip_fz\n0\t240\t-160\t1200\n1\t432\t-262\t1834\n",
}
# What stands for a number.
NUMBERS = {"ball=0,0,F": "ball=0,0,2000", "--interface-stiffness X": "--interface-stiffness 92",
           "{-20:20:5}": "{0|10}"}  # samples/osteotomy has 81 positions of 13 instants
# Dividing the hip's springs takes a minute: for dea converge its names are those of a smaller model.
CONVERGE = {name: "samples/sphere_on_flat/sphere_on_flat.feb" for name in ("hip.feb", "own.feb")}
# Programs that show what dea has written: here they only look whether it is there.
VIEWERS = ("xdg-open", "paraview")


def split_comment(text):
    """A command, and what is said beside it after two spaces or more."""
    command, _, beside = re.sub(r"\s{2,}", "\0", text.strip(), count=1).partition("\0")
    return command, beside


def in_text(path):
    """(where, command, what is said beside it, lines of output shown below) of a page."""
    lines, fenced = path.read_text().splitlines(), False
    for number, line in enumerate(lines, 1):
        where = f"{path.relative_to(source)}:{number}"
        if line.startswith("```"):
            fenced = not fenced
        elif fenced or line.startswith("    "):
            if re.match(rf"(\S*/)?dea ({'|'.join(COMMANDS)}|--\w+)\b", line.strip()):
                shown = []
                for below in lines[number:]:
                    if not below.strip().startswith(("note: ", "warning: ")):
                        break
                    shown.append(below.strip())
                yield (where, *split_comment(line), shown)
        else:
            for code in re.findall(r"`((?:[^`\s]*/)?dea [^`]+)`", line):
                if re.search(r"\.(feb|xplt|db)\b", code):
                    yield where, code, "", []


def in_help(command):
    text = subprocess.run([dea, *command, "--help"], capture_output=True, text=True, check=True).stdout
    where = " ".join(["dea", *command, "--help"])
    examples = text.partition("\nExamples:\n")[2].splitlines()
    if not examples:
        faults.append(f"{where}: no examples")
    for line in examples:
        yield (where, *split_comment(line), [])


def outputs_of(command):
    names = re.findall(r"(?:-o|--json|--csv|--compartments-csv|--facets-csv|--report|--live|--vtu|--frames|--hip-figure|--animate|>) ([^\s-]\S*)", command)
    shard = re.search(r"--shard (\d+)/(\d+)", command)
    return [re.sub(r"\.db$", ".{}-of-{}.db".format(*shard.groups()), name) for name in names] if shard else names


def inputs_of(command):
    words = shlex.split(command.partition(">")[0].partition("&&")[0])
    found = [name for word in words for name in re.findall(r"[^\s=]+\.(?:feb|xplt|csv|sto|mot|xml|db|stl|txt|tfm)(?=$|:\d+$)", word)]  # FILE:ROW
    return sorted(set(found) - set(outputs_of(command)))


def beside_a_page(folder):
    """The program beside a dea.html of its own, which portable/build makes: for --live."""
    place = folder / "program"
    if not place.exists():
        place.mkdir()
        shutil.copy(dea, place / "dea")
        (place / "dea.html").write_text('<script type="text/plain" id="sample-model" data-gives-way="1">x</script>\n')
    return place / "dea"


def bash(folder, command):
    program = f"shopt -s expand_aliases\nalias dea={shlex.quote(str(beside_a_page(folder) if ' --live ' in command else dea))}\n"
    program += "".join(f"{viewer}() {{ test -s \"$1\"; }}\n" for viewer in VIEWERS) + "man() { grep -q '^.TH'; }\n"
    return subprocess.run(["bash", "-c", program + re.sub(r"^\S*/dea ", "dea ", command)], cwd=folder,
                          capture_output=True, text=True, timeout=300)


def made(kit, name, command):
    """The bytes of a file that a command needs; made once."""
    needed.add(name)
    recipe = CONVERGE.get(name) if command.startswith("dea converge") else None
    recipe = recipe or FILES.get(name)
    if name == "mri.csv":  # a thickness at every node of the hip
        nodes = re.findall(r'<node id="(\d+)">', (source / HIP).read_text())
        return "".join(["node,thickness\n"] + [f"{n},1.5\n" for n in nodes]).encode()
    if recipe is None:
        raise LookupError(f"needs {name}: say in FILES of tests/examples.py what that is")
    if "\n" in recipe:
        return recipe.encode()
    if not recipe.startswith("dea "):
        path, *changes = recipe.split(" ")
        content = (source / path).read_bytes()
        for was, now in (change.encode().split(b"->") for change in changes):
            if was not in content:
                raise LookupError(f"needs {name}: {path} has no {was.decode()}")
            content = content.replace(was, now)
        return content
    if recipe not in kit:
        with tempfile.TemporaryDirectory() as folder:
            done = execute(kit, pathlib.Path(folder), recipe)
            if done.returncode != 0:
                raise LookupError(f"needs {name}: {recipe}: exit code {done.returncode}\n{done.stderr}")
            kit[recipe] = (pathlib.Path(folder) / name).read_bytes()
    return kit[recipe]


def execute(kit, folder, command):
    for name in inputs_of(command):
        if (folder / name).exists():  # an example before it has written it
            continue
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_bytes(made(kit, name, command))
    return bash(folder, command)


def with_numbers(command):
    """With a number for each of the words that stand for one."""
    for word, number in NUMBERS.items():
        command = command.replace(word, number)
    return command


def fault_of(kit, folder, command, places):
    """What is wrong with an example, wherever it stands; empty: nothing."""
    beside, shown = " ".join(place[1] for place in places), [line for place in places for line in place[2]]
    command = with_numbers(command)
    try:
        done = execute(kit, folder, command)
    except (LookupError, subprocess.TimeoutExpired) as fault:
        return str(fault)
    if done.returncode != 0:
        return f"exit code {done.returncode}\n{done.stderr}"
    said = re.findall(r"[\w./]+\.(?:xplt|feb|png|svg|pdf|html|json|csv)\b", re.sub(r"dea \w+ \S+", "", beside))
    for name in outputs_of(command) + said:
        file = folder / name.rstrip(",;")
        if not (any(file.iterdir()) if file.is_dir() else file.is_file() and file.stat().st_size > 0):
            return f"{name} is not there afterwards"
    printed = (done.stdout + done.stderr).splitlines()
    missing = [line for line in shown if line not in [p.strip() for p in printed]]
    return f"shown, but not printed: {missing[0]}" if missing else ""


def results(kit, commands):
    """(command, what is wrong with it, seconds) of each, pasted one after the other into one folder: none is refused for what those
    before have written."""
    with tempfile.TemporaryDirectory() as folder:
        for command in commands:
            start = time.monotonic()
            yield command, fault_of(kit, pathlib.Path(folder), command, examples[command]), time.monotonic() - start


def collect():
    pages = [*sorted(source.glob("*.md")), *sorted((source / "docs").rglob("*.md")), *sorted((source / "samples").rglob("README.md")),
             *sorted(source.glob("*/README.md"))]
    found = [example for page in pages for example in in_text(page)]
    for command in ((), *((c,) for c in COMMANDS)):
        found += in_help(command)
    examples = {}  # the same command in several places is run once
    for where, command, beside, shown in found:
        examples.setdefault(re.sub(r"^\S*/dea ", "dea ", command), []).append((where, beside, shown))
    return examples


faults, kit, needed = [], {}, set()
examples = collect()
skipped = {command: why for command in examples for word, why in SKIPPED.items() if word in command.split()[:2]}
to_run = [command for command in examples if command not in skipped]
for name in sorted({name for command in to_run for name in inputs_of(command)} & FILES.keys()):  # what examples share
    try:
        made(kit, name, "")
    except LookupError:
        pass  # told by each example that needs it

# Each in a folder of its own; those of dea study --help in one, in their order (each writes other files).
in_turn = [command for _, command, _, _ in in_help(("study",))]
alone = [[command] for command in to_run if command not in in_turn]
with concurrent.futures.ThreadPoolExecutor(min(4, os.cpu_count() or 1)) as pool:
    for command, fault, seconds in (result for some in pool.map(lambda c: list(results(kit, c)), [in_turn, *alone]) for result in some):
        if fault:
            faults.append(f"{', '.join(place[0] for place in examples[command])}: {command}\n  {fault.strip()}")
        if "-v" in sys.argv:
            print(f"{seconds:6.1f} s  {command}")
if len(in_turn) < 5:
    faults.append(f"dea study --help: found {len(in_turn)} examples, expected more")
faults += [f"FILES of tests/examples.py has {name}, and no example needs it" for name in FILES if name not in needed
           and not ("build" in SKIPPED and (name.endswith(".stl") or name.startswith(("knee_", "made_knee")) or name in ("mri_thickness.csv", "femur_pose.txt")))]
for command, why in skipped.items():
    print(f"skipped, {why}: {command}")
print("\n".join(faults) or f"{len(to_run)} examples, each does what is said of it")
sys.exit(bool(faults) or len(to_run) < 40)  # fewer: they were not found
