"""The tutorial of docs/python.md runs, and finds what a plain search finds."""
import os
import pathlib
import re
import subprocess
import sys

import febiodea

MANUAL = pathlib.Path(__file__).parents[2] / "docs" / "python.md"


def test_the_tutorial_finds_the_least(samples):
    (code,) = re.findall(r"```python\n(.*?)```", MANUAL.read_text(), re.S)
    finished = subprocess.run([sys.executable, "-c", code], cwd=samples / "hip", capture_output=True, text=True,
                              env={**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)})
    assert finished.returncode == 0, finished.stderr
    best, least, now = map(float, re.match(r"(\S+) degrees: p99 (\S+), as the file has it (\S+)$", finished.stdout).groups())
    joint = febiodea.prepare(febiodea.recognise(samples / "hip" / "hip_walking.feb", law="linear"))
    plain = {degrees: joint.solve(rotate=[("pelvis", (0, 1, 0), degrees)]).contact().headline.p99
             for degrees in range(-10, 26, 2)}
    assert -9 < best < 24 and least < now and least <= min(plain.values()) * 1.005  # maps of facets are not quite smooth in the angle
    assert abs(best - min(plain, key=plain.get)) <= 2.2
