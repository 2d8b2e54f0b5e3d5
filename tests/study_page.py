"""docs/studies.md and the file of a study: python3 study_page.py DEA MAKE_SAMPLES SOURCE.

Fails on a table, view or column that the page lacks, and on one that it names and no file has. A section "### Table `NAME`" or
"### View `NAME`" holds a table whose first column has the names: `_y` stands for the name before it with that ending."""
import pathlib
import re
import sqlite3
import subprocess
import sys
import tempfile

dea, make_samples, source = (pathlib.Path(a).resolve() for a in sys.argv[1:4])
FACTOR = "stiffness"


def read_page(text):
    said = {}
    for section in re.split(r"^##+ ", text, flags=re.M)[1:]:
        head = re.match(r"(?:Table|View) `(\w+)`", section)
        if not head:
            continue
        names = said.setdefault(head.group(1), [])
        for line in section.splitlines():
            for name in re.findall(r"`([^`]+)`", line.split("|")[1]) if line.startswith("| ") else []:
                names.append(names[-1].rpartition("_")[0] + name if name.startswith("_") else name)
    return said


def read_file(path):
    with sqlite3.connect(path) as d:
        tables = [t for t, in d.execute("SELECT name FROM sqlite_master WHERE type IN ('table', 'view')")]
        columns = {t: [c[1] for c in d.execute(f"PRAGMA table_info({t})")] for t in tables}
        empty = [t for t in tables if not d.execute(f"SELECT 1 FROM {t} LIMIT 1").fetchone()]
    return columns, empty


faults = []
with tempfile.TemporaryDirectory() as folder:
    subprocess.run([make_samples, "--plateaus", "6", f"{folder}/knee.feb"], check=True)
    subprocess.run([dea, "study", "knee.feb", "--vary", FACTOR + ": E={8|9}", "--inside", "--states", "last", "--keep",
                    "fields", "-q", "-o", "plan.db"], cwd=folder, check=True)
    columns, empty = read_file(f"{folder}/plan.db")
said = read_page((source / "docs/studies.md").read_text())
for table, there in columns.items():
    if table not in said:
        faults.append(f"the page lacks table {table}")
        continue
    there = [c for c in there if c != FACTOR]
    faults += [f"{table}: the page lacks column {c}" for c in there if c not in said[table]]
    faults += [f"{table}: the page names {c}, and the file has no such column" for c in said[table] if c not in there]
    faults += [f"{table}: the page names {c} twice" for c in set(said[table]) if said[table].count(c) > 1]
faults += [f"the page names table {t}, and the file has none" for t in said if t not in columns]
TRIED_ELSEWHERE = ("warnings", "layers", "layer_results", "soft_parts", "soft_part_results")  # study.py has joints with them
faults += [f"nothing is in table {t}: the test does not try it" for t in empty if t not in TRIED_ELSEWHERE]
print("\n".join(faults) or f"{len(columns)} tables and views, {sum(map(len, columns.values()))} columns, all on the page")
sys.exit(bool(faults))
