"""A portable program against the native one of the same commit: models.py web|windows|linux PROGRAM DEA SOURCE

Every model of samples, and of ../shared/reference where it is: plot files, words and exit codes are the same, and JSON to 1e-12 of the largest
number of its kind. Windows and WebAssembly have mathematical functions of their own: there JSON and the numbers of plot files are compared by tolerance(), below,
and those in words by their last digit; the hip's are to 1e-12 there too. Refusals are the same. linux: in an empty root as well, where this may be had. Python's standard library only."""
import array
import difflib
import json
import os
import pathlib
import re
import shutil
import struct
import subprocess
import sys
import tempfile
import time

product = sys.argv[1]
program, native, source = (pathlib.Path(a).resolve() for a in sys.argv[2:5])

exact = product == "linux"


# In WebAssembly sums are made in another order too. How the solver came to its answer, and the bones of a chain, which its tolerance
# leaves free to a millionth of their way, show it most.
def tolerance(name, path):
    if exact or (name.startswith("hip/") and "residual" not in path):
        return 1e-12
    if product == "web" and name.startswith("chain/"):
        return 1e-3
    return 1e-6 if re.search(r"residual|complementarity", path) else 1e-8


NUMBER = re.compile(r"(?<![\w.])-?\d+(?:\.(\d+))?(?:e([+-]?\d+))?")
top = tempfile.TemporaryDirectory(prefix="dea_models_")
os.environ.update(LC_ALL="C.UTF-8", WINEDEBUG="-all", WINEPREFIX=top.name + "/prefix")
start = [program]
if product == "web":
    start = ["node", source / "portable/tests/node.js", program]
if product == "windows":
    wine = shutil.which(os.environ.get("WINE", "wine64"), path=os.environ["PATH"] + ":/usr/lib/wine")
    if wine is None:
        print("no wine64")
        sys.exit(77)
    start = [wine, program]
    subprocess.run([wine, "wineboot", "-i"], check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
faults, seconds, worst, count = [], {"native": 0.0, product: 0.0}, {}, 0
same_bytes = 0  # plot files


def run(who, words, folder):
    begin = time.monotonic()
    done = subprocess.run([*(start if who != "native" else [native]), *words], cwd=folder, capture_output=True, stdin=subprocess.DEVNULL, timeout=1200)
    seconds[who] += time.monotonic() - begin
    # how long it took or will take is said only where it took long
    said = [re.sub(r"\d+ states? in .*|state \d+ of \d+.*\n|springs and layers\n", "", text.decode()) for text in (done.stdout, done.stderr)]
    return done.returncode, *said


def leaves(value, path=""):
    if isinstance(value, dict):
        for key, item in value.items():
            if key != "timings":
                yield from leaves(item, f"{path}.{key}")
    elif isinstance(value, list):
        for i, item in enumerate(value):
            yield from leaves(item, f"{path}[{i}]")
    else:
        yield path, value


def kind(path):
    return re.sub(r"\[\d+\]", "[]", path)


def compare_numbers(name, here, there):
    """To a tolerance of the largest number of the same kind in the native file, or of 1."""
    ours, theirs = list(leaves(here)), list(leaves(there))
    if [p for p, _ in ours] != [p for p, _ in theirs]:
        faults.append(f"{name}: JSON has other keys")
        return
    scale = {}
    for path, value in theirs:
        if isinstance(value, float):
            scale[kind(path)] = max(scale.get(kind(path), 1.0), abs(value))
    for (path, a), (_, b) in zip(ours, theirs):
        if isinstance(b, float) and isinstance(a, (float, int)):
            off = 0.0 if a == b else abs(a - b) / scale[kind(path)]
            worst[name] = max(worst.get(name, (0.0, "")), (off, f"{path}: {a!r}, native {b!r}"))
            if not off <= tolerance(name, path):
                faults.append(f"{name}{path}: found {a!r}, expected {b!r}")
        elif a != b and not (isinstance(a, str) and isinstance(b, str) and same_words(name, a, b)):
            faults.append(f"{name}{path}: found {a!r}, expected {b!r}")


def same_words(name, here, there):
    """Numbers by one of their last digit or tolerance(), of the largest of their line that differs."""
    if exact:
        return here == there
    ours, theirs = NUMBER.sub("#", here), NUMBER.sub("#", there)
    if re.sub(" +", " ", ours) != re.sub(" +", " ", theirs):
        return False
    for line, expected in zip(here.splitlines(), there.splitlines()):
        numbers = list(zip(NUMBER.finditer(line), NUMBER.finditer(expected)))
        largest = max([1.0, *(abs(float(b[0])) for a, b in numbers if a[0] != b[0])])  # a vector's, say
        for a, b in numbers:
            last = max(10.0 ** max(-9, int(n[2] or 0) - len(n[1] or "")) for n in (a, b)) if a[0] != b[0] else 0.0
            count = "." not in a[0] and abs(float(b[0])) < 100
            if not (a[0] == b[0] or abs(float(a[0]) - float(b[0])) <= max(0.0 if count else 1.001 * last, max(1e-6, tolerance(name, "")) * largest)):
                return False
    return True


# Chunks of a plot file that hold others, and those that hold numbers of single precision, as those of a region or of an object do.
BRANCHES = {0x01000000, 0x01020000, 0x01021000, 0x01023000, 0x01024000, 0x01025000, 0x01026000, 0x01020001, 0x01040000, 0x01050000, 0x01051000, 0x01052000, 0x01050006,
            0x02000000, 0x02010000, 0x02020000, 0x02020100, 0x02020300, 0x02020400, 0x02020500, 0x02020600, 0x02020001, 0x02020003, 0x02040000}
FLOATS = {0x02010002, 0x01050004, 0x01050005, 0x01051001, 0x01052001}
ITEM_NAME, VARIABLE_ID, OBJECT_DATA = 0x01020004, 0x02020002, 0x01050006


def plot_leaves(data):
    """What a plot file holds, in its order: (name of the variable or number of the chunk, bytes, are they numbers?)."""
    names, leaves = {}, []

    def walk(begin, end, group, variable):
        while begin < end:
            chunk, size = struct.unpack_from("<II", data, begin)
            begin, last = begin + 8, begin + 8 + size
            if chunk in BRANCHES:
                walk(begin, last, chunk if chunk & 0xFFF != 1 and chunk & 0xFFF != 3 else group, variable)
            else:
                leaf = data[begin:last]
                if chunk == ITEM_NAME:
                    names.setdefault(group >> 12 & 15, []).append(leaf.rstrip(b"\0").decode())
                if chunk == VARIABLE_ID:
                    variable = names[group >> 8 & 15][struct.unpack("<I", leaf)[0] - 1]
                what = names[0][chunk] if group == OBJECT_DATA and chunk < 0x10000 else variable if chunk < 0x10000 else f"{chunk:x}"
                leaves.append((what, leaf, chunk in FLOATS or chunk < 0x10000))
            begin = last

    walk(4, len(data), 0, "")
    return leaves


def compare_plot_files(name, here, there):
    """Numbers to a tolerance of the largest of their variable, all else by bytes."""
    ours, theirs = plot_leaves(here), plot_leaves(there)
    if [(what, len(leaf)) for what, leaf, _ in ours] != [(what, len(leaf)) for what, leaf, _ in theirs]:
        faults.append(f"{name}: the plot file holds other things")
        return
    scale = {}
    for what, leaf, numbers in theirs:
        if numbers:
            least = 1.0 if re.search("force|torque|moment|angle", what, re.I) else 0.0  # balance leaves a little
            scale[what] = max([least, scale.get(what, 0.0), *map(abs, array.array("f", leaf))])
    for (what, a, numbers), (_, b, _) in zip(ours, theirs):
        if a == b:
            continue
        apart = [abs(x - y) if x == x and y == y else float("inf") for x, y in zip(array.array("f", a), array.array("f", b))] if numbers else [float("inf")]
        off = max(apart) / (scale[what] or 1.0)
        # of whole facets with pressure, as FEBio has it: rounding decides of one at the border of contact
        allowed = 0.02 if what == "contact area" else max(1e-6, tolerance(name, what))
        if not off <= allowed:
            faults.append(f"{name}: {what} of the plot file is {off:.1e} off")


def compare(name, model, words):
    """Both run the same words beside the model: codes, words and files."""
    global count, same_bytes
    count += 1
    folders = {}
    results = {}
    for who in ("native", product):
        folders[who] = pathlib.Path(tempfile.mkdtemp(dir=top.name))
        if model is not None:
            (folders[who] / "model.feb").write_bytes(model)
        results[who] = run(who, words, folders[who])
    (code, *said), (expected_code, *expected) = results[product], results["native"]
    if code != expected_code or not all(same_words(name, a, b) for a, b in zip(said, expected)):
        faults.append(f"{name}: " + "\n".join(difflib.unified_diff(f"{expected_code}\n{''.join(expected)}".split("\n"), f"{code}\n{''.join(said)}".split("\n"), "native", product, "", "", 0, "")))
    if name.startswith("refused") and (code < 2 or said[1].count("\n") != 1):
        faults.append(f"{name}: found {code} and {said[1]!r}, expected one line and a refusal's code")
    files = {who: {p.name: p.read_bytes() for p in folders[who].iterdir()} for who in folders}
    if files[product].keys() != files["native"].keys():
        faults.append(f"{name}: wrote {sorted(files[product])}, expected {sorted(files['native'])}")
    for file in files[product].keys() & files["native"].keys():
        here, there = files[product][file], files["native"][file]
        if file.endswith(".json"):
            compare_numbers(name, json.loads(here), json.loads(there))
        elif not exact and here != there and file.endswith(".xplt"):
            compare_plot_files(name, here, there)
        elif here != there and not (file.endswith(".csv") and same_words(name, here.decode(), there.decode())):
            faults.append(f"{name}: {file} has other bytes")
        elif file.endswith(".xplt"):
            same_bytes += 1
    for folder in folders.values():
        shutil.rmtree(folder)


models = sorted((source / "samples").rglob("*.feb")) + sorted((source.parent / "shared/reference").glob("*.feb"))
for path in models:
    name = "/".join(path.parts[-2:])
    compare(name, path.read_bytes(), ["run", "model.feb", "-o", "model.xplt", "--json", "model.json"])
    compare(name + " info", path.read_bytes(), ["info", "model.feb"])
hip = (source / "samples/hip/hip_walking.feb").read_bytes()
compare("study", hip, ["study", "model.feb", "--vary", "E: E={8|12}", "--states", "last", "--csv", "cases.csv", "-q"])
broken = {
    "nothing": b"",
    "no XML": b"PK\3\4 a zip",
    "cut off": hip[:len(hip) // 2],
    "no number": hip.replace(b"<v>0.", b"<v>zero.", 1),
    "too large a number": re.sub(rb"<E>[^<]*", b"<E>1e400", hip, count=1),
    "too small a number": re.sub(rb"<E>[^<]*", b"<E>1e-400", hip, count=1),
    "hexadecimal": re.sub(rb"<E>[^<]*", b"<E>0x10", hip, count=1),
    "a comma": re.sub(rb"<E>[^<]*", b"<E>1,5", hip, count=1),
    "not finite": re.sub(rb"<E>[^<]*", b"<E>inf", hip, count=1),
    "another word": hip.replace(b"<Material>", b"<Materials>", 1),
}
for what, model in broken.items():
    assert model != hip, what
    compare(f"refused: {what}", model, ["run", "model.feb", "--no-xplt"])
for words in (["run", "nowhere.feb"], ["run"], ["run", "model.feb", "--facets", "round"], ["run", "model.feb", "--refine", "1e9"], ["plot", "model.feb"], ["compare", "model.feb", "model.feb"]):
    compare("refused: " + " ".join(words), hip, words)
# Pictures: SVG alone.
folder = pathlib.Path(tempfile.mkdtemp(dir=top.name))
(folder / "hip.feb").write_bytes(hip)
run("native", ["run", "hip.feb", "-q", "-o", "hip.xplt"], folder)
code, _, err = run(product, ["plot", "hip.xplt", "--at", "0.5,1", "-q"], folder)
svg = (folder / "hip.svg").read_text() if code == 0 else ""
if code != 0 or svg.count("<path") < 100 or not svg.endswith("</svg>\n"):
    faults.append(f"plot: {code} {err}")
code, _, err = run(product, ["plot", "hip.xplt", "-o", "hip.png"], folder)
if code != 2 or "draws SVG alone" not in err or err.count("\n") != 1:
    faults.append(f"plot to PNG: {code} {err}")
count += 2
if product == "linux" and os.geteuid() == 0:
    root = pathlib.Path(tempfile.mkdtemp(dir=top.name))
    shutil.copy(program, root / "dea")
    (root / "hip.feb").write_bytes(hip)
    done = subprocess.run(["chroot", root, "/dea", "run", "/hip.feb", "-q", "-o", "/hip.xplt"], capture_output=True)
    if done.returncode or (root / "hip.xplt").read_bytes() != (folder / "hip.xplt").read_bytes():
        faults.append(f"in an empty root: {done.returncode} {done.stderr}")
    count += 1
for fault in faults[:20]:
    print("FAILED " + fault[:600])
if product == "windows":
    subprocess.run([shutil.which("wineserver", path="/usr/lib/wine:" + os.environ["PATH"]), "-k"])
for name, (off, where) in worst.items():
    if off > 0:
        print(f"{name}: {off:.1e} {where}")
print(f"{product}: {count} comparisons, {len(faults)} differences; {same_bytes} of {len(models)} plot files the same bytes; seconds {seconds['native']:.1f} native, {seconds[product]:.1f} {product}; "
      f"furthest number {max(w[0] for w in worst.values()):.1e}")
sys.exit(bool(faults))
