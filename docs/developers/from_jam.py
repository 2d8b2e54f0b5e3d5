#!/usr/bin/env python3
"""Prints the table of docs/from_jam.md: PYTHONPATH=build/release/python docs/developers/from_jam.py [--write].

Each joint is solved with independent springs under its own load; at the pose found both laws are asked for the forces. --write
puts the table into the page, between the lines <!-- from_jam.py poses --> and <!-- end poses -->."""
import pathlib
import re
import sys

import numpy

import febiodea

HERE = pathlib.Path(__file__).resolve().parent
JOINTS = [  # title, model, force
    ("hip, walking (1902 N)", "hip/hip_walking.feb", {}),
    ("hip, a third of it", "hip/hip_walking.feb", {"force": {"femur": (144, -87, 611)}}),
    ("knee, flexed by 60 degrees", "knee/knee.feb", {}),
    ("plateaus of a tibia, 500 N", "plateaus/plateaus.feb", {}),
    ("ball on a flat layer, 400 N", "sphere_on_flat/sphere_on_flat.feb", {}),
    ("ball in a socket of its own radius, 2000 N", "spheres/two_layers.feb", {"force": {"ball": (0, 0, 2000)}}),
    ("ball in a socket of its own radius, 100 N", "spheres/two_layers.feb", {"force": {"ball": (0, 0, 100)}}),
]


def recognised(model, law, settings):
    return febiodea.recognise(str(HERE.parents[1] / "samples" / model), law=law, **settings)


lines = ["| joint | force, linear | force, layer | less | area, linear | area, layer | E of layer for the same force |", "|---" * 7 + "|"]
for title, model, settings in JOINTS:
    solved = febiodea.analyse(recognised(model, "linear", settings)).states[-1]
    assert solved.solved, title
    force, area = {}, {}
    for law in ("linear", "layer"):
        pressed = febiodea.prepare(recognised(model, law, settings)).press(solved)
        force[law] = sum(numpy.linalg.norm(c.force) for c in pressed.contacts)
        area[law] = sum(c.springs.area[c.springs.pressure > 0].sum() for c in pressed.contacts)
    found = sum(numpy.linalg.norm(c.force) for c in solved.contacts)
    assert abs(force["linear"] / found - 1) < 1e-6, (title, force, found)  # the pose is the one that was found
    lines.append("| %s | %.4g | %.4g | %.0f %% | %.4g | %.4g | times %.2f |" % (
        title, force["linear"], force["layer"], 100 * (1 - force["layer"] / force["linear"]), area["linear"], area["layer"], force["linear"] / force["layer"]))
print("\n".join(lines))
if "--write" in sys.argv:
    page = HERE.parent / "from_jam.md"
    place = re.compile(r"(<!-- from_jam\.py poses -->\n).*?(<!-- end poses -->)", re.S)
    assert len(place.findall(page.read_text())) == 1
    page.write_text(place.sub(lambda m: m.group(1) + "\n".join(["", *lines, "", ""]) + m.group(2), page.read_text()))
