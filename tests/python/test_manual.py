"""What the pages say of the module runs, taken from the pages: python/README.md, docs/python.md, docs/coming_from.md."""
import csv
import importlib.util
import json
import os
import pathlib
import re
import shlex
import subprocess
import sys

import pytest

import febiodea

ROOT = pathlib.Path(__file__).parents[2]


def blocks(page):
    return re.findall(r"```python\n(.*?)```", (ROOT / page).read_text(), re.S)


def run(code, folder):
    finished = subprocess.run([sys.executable, "-c", code], cwd=folder, capture_output=True, text=True,
                              env={**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)})
    assert finished.returncode == 0, finished.stderr
    return finished.stdout


@pytest.fixture
def root(tmp_path, samples):
    """Like the clone's root: what the code writes comes here."""
    (tmp_path / "samples").symlink_to(samples)
    return tmp_path


@pytest.fixture
def in_hip(tmp_path, samples):
    for name in ("hip_walking.feb", "hip_walking_febio.xplt"):
        (tmp_path / name).symlink_to(samples / "hip" / name)
    return tmp_path


def numbers(line, name):
    return float(re.search(rf"{name} ([\d.]+)", line).group(1))


def test_first_lines(root, hip, dea):
    code = blocks("docs/python.md")[0]
    assert len([line for line in code.splitlines() if line]) <= 10
    ours, nodes, theirs = run(code, root).splitlines()
    result = febiodea.analyse(hip)
    contact = result.states[-1].contact()
    assert [numbers(ours, n) for n in ("p99", "mean", "area", "peak")] == [float(f"{x:.4g}") for x in contact.headline[:4]]
    assert nodes.split() == ["nodes", str(contact.nodes.pressure.max()), f"({len(contact.nodes)},)"]
    assert abs(numbers(ours, "p99") / numbers(theirs, "p99") - 1) < 0.1  # README.md, "Accuracy"
    # the picture is that of the program, of the same two files
    result.write_xplt(root / "dea.xplt")
    dea("plot", "dea.xplt", "samples/hip/hip_walking_febio.xplt", "--label", "dea", "--label", "FEBio", "--smooth", "-o",
        "expected.png", cwd=root)
    assert (root / "hip.png").read_bytes() == (root / "expected.png").read_bytes()


def test_readme_of_the_module(root, hip_result):
    (code,) = blocks("python/README.md")
    out = run(code, root)
    assert out.startswith(str(hip_result)) and numbers(out.splitlines()[-1], "p99") > 5


def test_a_turned_socket_from_start_to_end(in_hip, hip_result):
    (code,) = [block for block in blocks("docs/python.md") if "abduction.csv" in block]
    run(code, in_hip)
    with open(in_hip / "abduction.csv", newline="") as file:
        rows = {float(row["degrees"]): row for row in csv.DictReader(file)}
    assert list(rows) == [-10, -5, 0, 5, 10, 15] and all(row["p99"] for row in rows.values())
    assert float(rows[0]["p99"]) == pytest.approx(hip_result.states[-1].contact().headline.p99, rel=1e-6)
    assert float(rows[-10]["p99"]) > float(rows[0]["p99"])  # less of the socket is above the head
    with open(in_hip / "nodes.csv", newline="") as file:
        nodes = list(csv.DictReader(file))
    model = hip_result.recognition.model
    place = {number: point for number, point in zip(model.node_ids, model.points)}
    assert len(nodes) == len(hip_result.states[-1].contact().nodes)
    for row in nodes[::50]:
        assert [float(row[k]) for k in "xyz"] == list(place[int(row["node"])]) and float(row["pressure"]) >= 0


def test_the_optimiser_finds_the_least(in_hip):
    (code,) = [block for block in blocks("docs/python.md") if "minimize" in block]
    if importlib.util.find_spec("scipy") is None:
        pytest.skip("no SciPy")
    found = re.match(r"(\S+) degrees: p99 (\S+), as the file has it (\S+)$", run(code, in_hip))
    best, least, now = map(float, found.groups())
    joint = febiodea.prepare(febiodea.recognise(in_hip / "hip_walking.feb", law="linear"))
    plain = {degrees: joint.solve(rotate=[("pelvis", (0, 1, 0), degrees)]).contact().headline.p99
             for degrees in range(-10, 26, 2)}
    # maps of facets are not quite smooth in the angle
    assert -9 < best < 24 and least < now and least <= min(plain.values()) * 1.005
    assert abs(best - min(plain, key=plain.get)) <= 2.2


def test_a_study(in_hip):
    pytest.importorskip("pandas")
    (code,) = [block for block in blocks("docs/python.md") if "febiodea.Study(" in block]
    out = run(code, in_hip).splitlines()
    assert out[:6] == [f"{k} of 6" for k in range(1, 7)] and len(out) == 13
    assert febiodea.read_study(in_hip / "plan.db").counts["solved"] == 6


def test_files_of_dea_without_the_module(in_hip, dea):
    pytest.importorskip("pandas")
    (code,) = blocks("docs/coming_from.md")
    commands = [line.strip() for line in (ROOT / "docs/coming_from.md").read_text().splitlines() if line.startswith("    dea ")]
    for command in commands:
        dea(*shlex.split(command)[1:], cwd=in_hip)
    out = run(code, in_hip)
    p99 = json.loads((in_hip / "run.json").read_text())["states"][-1]["contacts"][0]["headline"]["p99"]
    assert out.startswith(f"{p99}\n") and f"{p99:.6f}" in out.partition("\n")[2]


def test_febios_result_beside(in_hip, hip_result):
    """docs/python.md, "Read plot files of dea and FEBio": what FEBio found, at the points of dea's surface."""
    hip_result.write_xplt(in_hip / "hip_dea.xplt")
    surface = febiodea.read_xplt(in_hip / "hip_walking_febio.xplt").states[-1].surface("acetabular_articulating")
    ours = febiodea.read_xplt(in_hip / "hip_dea.xplt").states[-1].surface("acetabular_articulating")
    theirs = ours.carry_from(surface, surface.nodal("contact pressure"))
    assert theirs == pytest.approx(surface.nodal("contact pressure"), abs=1e-9)  # the same points in the same order
    pattern = febiodea.pattern_difference(ours.nodal("contact pressure"), theirs, ours.nodal_areas)
    assert pattern["correlation"] > 0.98
