"""Who includes whom: python3 includes.py SOURCE. Fails on an include that goes up the house, and on circles. Who words
settings: src has no text with an option of the command line. Who reads what a model holds and moves: of src, facts
alone. And who knows the operating system: two files, their twins, and the plugin.

Floors, lowest first. A file includes its own floor and those below; plugin and python never include app, nor each other."""
import pathlib
import re
import sys

FLOORS = ["base", "model", "geometry", "build", "facts", "joint", "springs", "equilibrium", "results", "rules", "run", "study", "io", "views", "app"]
ASIDE = ["plugin", "python"]  # beside the program, on the same floors
SYSTEM = {f"{file}{twin}.cpp" for file in ("io/files/system", "app/process") for twin in ("", "_windows")}  # who may ask the operating system
LIBRARIES = {"cairo.h", "cholmod.h", "gif_lib.h", "hdf5.h", "hdf5_hl.h", "muParser.h", "sqlite3.h", "tinyxml2.h", "zlib.h"}  # other headers of such names are the system's
source = pathlib.Path(sys.argv[1])


def floor(path):
    part = path.split("/")[0]
    return len(FLOORS) if part in ASIDE else FLOORS.index(part)


def name(file):
    path = file.relative_to(source).as_posix()
    return path[4:] if path.startswith("src/") else path


files = [f for folder in ("src", "io", "views", "app", *ASIDE) for f in sorted((source / folder).rglob("*")) if f.suffix in (".h", ".cpp")]
faults, graph = [], {}
for file in files:
    text = file.read_text()
    for other in re.findall(r'^#include "([^"]+)"', text, re.M):
        if not (source / other).is_file():
            faults.append(f"{name(file)} includes {other}: no file of the tree, seen from its root")
    if re.search(r"^#include <hdf5", text, re.M) and name(file) != "io/study/hdf5_file.cpp":
        faults.append(f"{name(file)} includes hdf5.h: only io/study/hdf5_file.cpp does")
    if re.search(r"^#include <sqlite3\.h>", text, re.M) and not name(file).startswith("io/study/"):
        faults.append(f"{name(file)} includes sqlite3.h: only io/study does, which is a library by itself")
    if re.search(r"^ *# *include *<(oneapi/)?tbb/", text, re.M) and name(file) != "base/parallel.cpp":
        faults.append(f"{name(file)} includes the thread library: only src/base/parallel.cpp does")
    if name(file) not in SYSTEM and not name(file).startswith("plugin/"):
        headers = re.findall(r"^ *# *include *<(csignal|(?:sys|net|netinet|arpa|linux)/[^>]+|\w+\.h)>", text, re.M)
        calls = re.findall(r"(?<![\w:>])::[a-z]\w* ?\(", re.sub(r"//.*", "", text))  # ::open(
        for found in [h for h in headers if h not in LIBRARIES] + calls:
            faults.append(f"{name(file)} has {found}: only {', '.join(sorted(SYSTEM))} know the operating system")
    for other in re.findall(r'^#include "(?:src/(?!version\.h))?(?!src/)([^"]+)"', text, re.M):
        if floor(other) > floor(name(file)):
            faults.append(f"{name(file)} includes {other}, which is a floor higher")
        own = name(file).split("/")[0]
        if own in ASIDE and other.split("/")[0] in {"app", *ASIDE} - {own}:
            faults.append(f"{name(file)} includes {other}: {own} knows nothing of it")
        # a .cpp file stands for its header: what one of the two includes, both depend on
        graph.setdefault(re.sub(r"\.(h|cpp)$", "", name(file)), set()).add(re.sub(r"\.h$", "", other))
for file in sorted((source / "src").rglob("*.[hc]*")):
    for text in re.findall(r'"(?:[^"\\\n]|\\.)*"', file.read_text()):
        if re.search(r"--[a-z]", text, re.I):
            faults.append(f"{name(file)} says {text}: name the setting (base/sentence.h), each front end words it")
    if name(file).split("/")[0] not in ("model", "facts"):
        for found in re.findall(r"\b(?:rigid_fixed|rigid_prescribed|fixed_nodes|prescribed_nodes)\b(?!\.h)", re.sub(r"//.*", "", file.read_text())):
            faults.append(f"{name(file)} reads {found}: ask src/facts (conditions.h, node_holds.h)")
seen, stack = {}, []


def visit(node):
    seen[node] = 1
    stack.append(node)
    for other in sorted(graph.get(node, ())):
        if other == node:
            continue
        if seen.get(other) == 1:
            faults.append("a circle: " + " -> ".join(stack[stack.index(other):] + [other]))
        elif other not in seen:
            visit(other)
    stack.pop()
    seen[node] = 2


for node in sorted(graph):
    if node not in seen:
        visit(node)
print("\n".join(faults) or f"{len(files)} files, no include goes up, no circle")
sys.exit(bool(faults))
