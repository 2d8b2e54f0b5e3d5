"""samples/osteotomy: the commands of its page with fewer positions and law linear; the table is what the study's CSV has."""
import csv
import importlib.util
import os
import shlex
import subprocess
import sys

import pytest


@pytest.fixture
def page(samples, tmp_path):
    """The commands, and a folder with what they need."""
    for path in ("hip/hip_walking.feb", "osteotomy/gait.csv", "osteotomy/table.py"):
        (tmp_path / os.path.basename(path)).symlink_to(samples / path)
    text = (samples / "osteotomy/README.md").read_text()
    return text, [shlex.split(line) for line in text.splitlines() if line.startswith("    ")], tmp_path


def table(words, folder):
    return subprocess.run([sys.executable, *words[1:]], cwd=folder, capture_output=True, text=True,
                          env={**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)})


def rows_of(text):
    return [[cell.strip() for cell in line.strip("|").split("|")] for line in text.splitlines() if line.startswith("| ")]


def test_the_table_is_that_of_the_study(page, dea):
    text, (study, show, write), folder = page
    small = [word.replace("{-20:20:5}", "{0|10}") for word in study]
    assert small != study
    dea(*small[1:], "--law", "linear", "-q", cwd=folder)
    dea(*write[1:], "-q", cwd=folder)
    with open(folder / "results.csv") as file:
        results = list(csv.DictReader(file))
    assert len(results) == 4 * 13
    if importlib.util.find_spec("matplotlib") is None:
        show = show[:-1]
    shown = table(show, folder)
    assert shown.returncode == 0, shown.stderr
    p99, area = (rows_of(part) for part in shown.stdout.split("area [mm^2]"))
    assert p99[0] == area[0] == ["", "+0", "+10"] and [row[0] for row in p99[1:]] == ["+0", "+10"]
    for i, tilt in enumerate(("0", "10")):
        for j, version in enumerate(("0", "10")):
            case = [r for r in results if (r["tilt"], r["version"]) == (tilt, version)]
            worst = max(case, key=lambda r: float(r["headline_p99"]))
            assert p99[1 + i][1 + j] == f"{float(worst['headline_p99']):.2f}"
            assert area[1 + i][1 + j] == f"{float(worst['headline_area']):.0f}"
    if len(show) == 4:
        picture = (folder / show[3]).read_text()
        assert "<svg" in picture and picture.count("<path") > 20
        table(show, folder)
        assert (folder / show[3]).read_text() == picture


def test_the_page_shows_a_table_of_all_positions(page):
    text, (study, *_), _ = page
    rows = rows_of(text)
    angles = [f"{a:+d}" for a in range(-20, 21, 5)]
    assert study.count("tilt: rotate pelvis=0,1,0,{-20:20:5}") == 1
    assert len(rows) == 20 and all(rows[k] == ["", *angles] for k in (0, 10))
    assert [row[0] for row in rows[1:10]] == angles and all(float(cell) > 0 for row in rows[1:10] for cell in row[1:])


def test_positions_without_a_solution_and_files_that_are_no_such_study(page, dea):
    _, (_, show, _), folder = page
    done = subprocess.run([os.environ["DEA_PROGRAM"], "study", "hip_walking.feb", "--vary", "tilt: rotate pelvis=0,1,0,{0|90}", "--vary",
                           "version: rotate pelvis=0,0,1,{0|5}", "--law", "linear", "--states", "last", "-q", "-o", show[2]],
                          cwd=folder, capture_output=True, text=True)
    assert done.returncode == 1, done.stderr  # a socket turned by 90 degrees
    shown = table(show, folder)
    assert shown.returncode == 0, shown.stderr
    assert [row[1:] for row in rows_of(shown.stdout) if row[0] == "+90"] == [["-", "-"]] * 2
    dea("study", "hip_walking.feb", "--vary", "E: E={8|9}", "--law", "linear", "--states", "last", "-q", "-o", "one.db", cwd=folder)
    for name, words in [("one.db", "found 1 factors, expected two"), ("none.db", "none.db: found no readable file")]:
        refused = table(["python3", "table.py", name], folder)
        assert refused.returncode == 1 and words in refused.stderr and refused.stderr.count("\n") == 1, refused.stderr
