#!/usr/bin/env python3
"""What `dea run` makes of a folder of FEBio models, by reason and version of the format, as a table in Markdown.

    docs/developers/outcomes.py build/release/app/dea FOLDER

Every .feb file in FOLDER and its subfolders is run; results go to a temporary folder. A refused model is counted under its
first reason, the most basic one: `dea info MODEL` lists all. Models whose line fits none of the reasons below are listed
after the table, with their line.
"""
import collections
import os
import re
import subprocess
import sys
import tempfile

REASONS = [  # (row of the table, what the line of the refusal says)
    ("no sliding contact", r"no sliding contact"),
    ("no rigid body", r"no rigid body in the model"),
    ("nodes that move, but not as a bone", r"so it is no bone|prescribed displacement of nodes"),
    ("module of another kind", r"module \""),
    ("other loads and conditions that DEA does not have", r"is not supported and would change the result"),
    ("contact on deformable shells", r"lies on deformable shells"),
    ("a part that no bone holds", r"held by no rigid body|held by \d+ bodies"),
    ("a part without a bone surface to measure its thickness to", r"no bone surface"),
    ("a material without E and nu", r"gives no (E|nu)\b"),
]
SOLVED = "solved"
NO_SOLUTION = "an answer that is no solution (exit code 1)"


def version_of(path):
    with open(path, "rb") as file:
        found = re.search(rb"<febio_spec\s+version=\"([^\"]*)\"", file.read(10000))
    return found.group(1).decode(errors="replace") if found else "?"


def outcome(dea, path, folder):
    words = [dea, "run", path, "-q", "--no-xplt"]
    try:
        done = subprocess.run(words, capture_output=True, text=True, errors="replace", timeout=600)
    except subprocess.TimeoutExpired:
        return None, "no answer after 600 s"
    if done.returncode in (0, 1):
        return (SOLVED, NO_SOLUTION)[done.returncode], ""
    line = done.stderr.strip()
    for row, pattern in REASONS:
        if done.returncode == 3 and re.search(pattern, line):
            return row, line
    return None, f"exit code {done.returncode}: {line}"


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    dea, top = sys.argv[1:]
    paths = sorted(os.path.join(folder, name) for folder, _, names in os.walk(top) for name in names
                   if name.endswith(".feb"))
    if not paths:
        sys.exit(f"{top}: no .feb file in this folder")
    counts, others = collections.Counter(), []
    with tempfile.TemporaryDirectory() as folder:
        for path in paths:
            row, line = outcome(dea, path, folder)
            if row is None:
                others.append(f"{path}: {line}")
                row = "something else"
            counts[row, version_of(path)] += 1
    versions = sorted({version for _, version in counts})
    rows = [SOLVED, NO_SOLUTION] + [row for row, _ in REASONS] + ["something else"]
    print("| outcome | " + " | ".join(versions) + " | all |")
    print("|---|" + "---|" * (len(versions) + 1))
    for row in rows:
        cells = [counts[row, version] for version in versions]
        if sum(cells):
            print(f"| {row} | " + " | ".join(str(n) if n else "" for n in cells) + f" | {sum(cells)} |")
    cells = [sum(counts[row, version] for row in rows) for version in versions]
    print("| models | " + " | ".join(map(str, cells)) + f" | {sum(cells)} |")
    for line in others:
        print(line)


if __name__ == "__main__":
    main()
