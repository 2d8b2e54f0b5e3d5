"""Lines that the tests ran: python3 tests/coverage.py BUILD [--refusals], after ctest in a build with --coverage (preset coverage).

Per folder and for files below 80 %: lines run of lines with code, as gcov counts them; a line counts as run if any object file that
has it (headers, sources compiled several at a time) ran it. --refusals: every throw and fail() that no test reached."""
import collections
import concurrent.futures
import json
import os
import pathlib
import re
import subprocess
import sys

FOLDERS = ("src", "io", "views", "app", "python")
LEAST = 80
build = pathlib.Path(sys.argv[1]).resolve()
source = pathlib.Path(__file__).resolve().parents[1]
links = {str(build / "include/febiodea" / link.name): str(link.resolve()) for link in (build / "include/febiodea").iterdir() if link.is_symlink()}


def place(name):
    """Within the source, through the links of the build's include folder; None: not ours."""
    path = os.path.normpath(os.path.join(build, name))
    for link, folder in links.items():
        if path.startswith(link + "/"):
            path = folder + path[len(link):]
    return os.path.relpath(path, source) if path.startswith(str(source) + "/") else None


def lines_of(notes):
    """(file, line) -> run, of one object file: it has been run if there are counts beside its notes."""
    done = subprocess.run(["gcov", "--json-format", "--stdout", str(notes)], capture_output=True, cwd=notes.parent, check=True)
    found = collections.defaultdict(int)
    for document in done.stdout.splitlines():
        for file in json.loads(document)["files"]:
            path = place(file["file"])
            if path is None or path.split("/")[0] not in FOLDERS:
                continue
            for line in file["lines"]:
                found[path, line["line_number"]] |= int(line["count"] > 0)
    return found


run = collections.defaultdict(int)
notes = sorted(build.rglob("*.gcno"))
if not notes:
    sys.exit(f"coverage.py: found no .gcno in {build}, expected a build of the preset coverage")
with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
    for found in pool.map(lines_of, notes):
        for where, count in found.items():
            run[where] |= count

folders, files = collections.Counter(), collections.defaultdict(lambda: [0, 0])
for (path, _), count in run.items():
    files[path][0] += count
    files[path][1] += 1
print(f"{'folder':24} {'run':>7} {'lines':>7}      %")
totals = collections.defaultdict(lambda: [0, 0])
for path, (hit, lines) in files.items():
    for name in (path.split("/")[0], "all"):
        totals[name][0] += hit
        totals[name][1] += lines
for name in (*FOLDERS, "all"):
    if name in totals:
        hit, lines = totals[name]
        print(f"{name:24} {hit:7} {lines:7} {100 * hit / lines:6.1f}")
print(f"\nfiles below {LEAST} %")
for path, (hit, lines) in sorted(files.items(), key=lambda f: f[1][0] / f[1][1]):
    if 100 * hit < LEAST * lines:
        print(f"{path:56} {hit:5} {lines:5} {100 * hit / lines:6.1f}")

if "--refusals" in sys.argv:
    print("\nrefusals that no test reached")
    for path in sorted(files):
        for number, text in enumerate((source / path).read_text().splitlines(), 1):
            refuses = re.search(r"\bthrow \w*(Error|Value|fault)|\bfail(_\w+)?\(|\brefuse(_\w+)?\(|\bthrow \w+\(", text)
            if refuses and run.get((path, number)) == 0:
                print(f"{path}:{number}: {text.strip()}")
