#!/usr/bin/env python3
"""The page of dea build in a headless Chromium: maps, what is under the pointer, switches, saving, hostile names, widths.

build_page_test.py DEA [CHECK...]. Exit code 77: there is no chromedriver. Python's standard library only."""
import csv
import io
import json
import math
import os
import re
import subprocess
import sys
import time
import xml.etree.ElementTree

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
sys.path.insert(0, os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
import stl_shapes  # noqa: E402
from browser import WINDOW, Browser, run_checks  # noqa: E402
from report_test import HASH, no_faults, no_network, png_size, same, true  # noqa: E402

CHECKS = []
HOSTILE = "</script><b>&\"'é"
TABLES = 9  # cartilage, rims, contacts, balance, pressure, frames, spheres and angles of the hip, options


def check(function):
    CHECKS.append(function)
    return function


def make(dea, folder):
    for name, text in stl_shapes.SURFACES.items():
        with open(os.path.join(folder, name), "w") as file:
            file.write(text)
    with open(os.path.join(folder, "landmarks.csv"), "w") as file:
        file.write(stl_shapes.LANDMARKS)
    pages = {}
    for name, pelvis, options in (("hip", "pelvis", ["--json", "hip.json", "--landmarks", "landmarks.csv"]), ("hostile", HOSTILE, []), ("bare", "pelvis", ["--bones", "none"])):
        cartilage = ["--uniform", "femur=2"] if name == "bare" else ["--half-gap", "max=2,min=0.5"]
        subprocess.run([dea, "build", "--bone", f"{pelvis}=pelvis.stl", "--bone", "femur=femur.stl", *cartilage, "--force", "femur=432,-262,1834",
                        "-o", name + ".feb", "--report", name + ".html", "-q", *options], cwd=folder, check=True, stdout=subprocess.DEVNULL)
        pages[name] = os.path.join(folder, name + ".html")
    # a lining of which the middle is pressed half a millimetre into the bone: its thickness cannot be what it was
    with open(os.path.join(folder, "dented.stl"), "w") as file:
        file.write(re.sub(r"vertex (\S+) (\S+) (\S+)", lambda m: "vertex %.9g %.9g %.9g" % dented(*map(float, m.groups())), stl_shapes.SURFACES["acetabular_cartilage.stl"]))
    subprocess.run([dea, "build", "--bone", "pelvis=pelvis.stl", "--cartilage", "pelvis=dented.stl", "--bone", "femur=femur.stl", "--force", "femur=432,-262,1834",
                    "-o", "dented.feb", "--report", "dented.html", "--json", "dented.json", "-q"], cwd=folder, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    pages["dented"] = os.path.join(folder, "dented.html")
    for key, name in (("json", "hip.json"), ("dented json", "dented.json")):
        with open(os.path.join(folder, name)) as file:
            pages[key] = json.load(file)
    return pages


def dented(*point):
    return tuple(c * (24.5 / 22.05 if math.hypot(point[0], point[1]) < 5 else 1) for c in point)


def ready(b, page):
    b.open("file://" + page)
    b.wait("document.documentElement.dataset.ready", 60, "the page to be ready")


def settled(b, maps):
    b.run(f"Page.{maps}.panels[0].canvas.scrollIntoView()")
    b.run(f"Page.{maps}.request()")
    time.sleep(0.2)
    b.wait(f"Page.{maps}.drawn > 0 && Page.{maps}.settled", 30, "the maps")


def hashes(b, maps):
    settled(b, maps)
    return b.run(HASH + f"return Page.{maps}.panels.map(p => hash(p.canvas))")


@check
def all_maps_are_drawn(b, pages):
    ready(b, pages["hip"])
    for maps, count in (("whole", 1), ("parts", 3)):
        drawn = hashes(b, maps)
        same(len(drawn), count, f"maps of {maps}")
        true(all(colours > 10 for _, colours in drawn), f"blank maps: {drawn}")
    no_faults(b, "the page")


@check
def a_change_of_thickness_is_a_map_and_a_warning(b, pages):
    ready(b, pages["dented"])
    drawn = hashes(b, "parts")
    same(len(drawn), 4, "thickness, gap, Jacobian, change")
    true(all(colours > 10 for _, colours in drawn), f"blank maps: {drawn}")
    words = b.run("return document.querySelector('#readout3').textContent")
    value, exact = float(re.search(r"most: ([0-9.e-]+)", words).group(1)), pages["dented json"]["layers"][0]["thickness_change_most"]
    true(abs(value - exact) <= 5e-3 * exact, f"most: {words}, expected {exact}")
    true("had to change by more than a tenth" in b.run("return document.getElementById('warnings').textContent"), "no warning")
    no_faults(b, "the page")


@check
def switches_change_the_joint(b, pages):
    ready(b, pages["hip"])
    seen = [hashes(b, "whole")[0][0]]
    for button in ("#solid", "#cartilage0", "#bone0", "#joint-mesh"):
        b.click(button)
        time.sleep(0.3)
        seen.append(hashes(b, "whole")[0][0])
    same(len(set(seen)), len(seen), "different pictures")
    b.run("['#bone1', '#cartilage1'].forEach(s => document.querySelector(s).click())")  # nothing is left
    time.sleep(0.3)
    hashes(b, "whole")
    no_faults(b, "an empty joint")


@check
def what_is_shown_is_what_was_computed(b, pages):
    ready(b, pages["hip"])
    for number, layer in enumerate(pages["json"]["layers"]):
        b.run("const s = document.getElementById('layer'); s.value = arguments[0]; s.dispatchEvent(new Event('change'))", str(number))
        b.wait(f"document.querySelector('#map0').getAttribute('aria-label').includes('{layer['name']}')", 10, "the layer")
        words = b.run("return [...document.querySelectorAll('#panels .readout')].map(e => e.textContent)")
        value = [float(re.search(r": ([−0-9.e-]+)", w).group(1).replace("−", "-")) for w in words]
        for name, shown, exact in (("thickness", value[0], layer["thickness_most"]), ("Jacobian", value[2], layer["jacobian_least"])):
            true(abs(shown - exact) <= 5e-4 * exact, f"{name} of {layer['name']}: {shown}, expected {exact}")
        if layer["name"] == pages["json"]["contacts"][0]["primary"]:
            gap = pages["json"]["contacts"][0]["least_gap"]
            true(abs(value[1] - gap) <= 5e-4 * gap, f"gap: {value[1]}, expected {gap}")
    text = b.run("return document.getElementById('told').textContent")
    for finding in pages["json"]["findings"]:
        true(finding in text, f"not on the page: {finding}")


@check
def the_pointer_tells_the_place(b, pages):
    ready(b, pages["hip"])
    settled(b, "parts")
    box = b.run("const c = document.getElementById('map0'); c.scrollIntoView({block: 'center'});"
                "const r = c.getBoundingClientRect(); return [r.left, r.top, r.width, r.height]")
    b.pointer(("move", box[0] + 0.4 * box[2], box[1] + 0.5 * box[3]))
    b.wait("Page.parts.hover && Page.panels.every(p => p.hit)", 10, "the same place in all maps")
    words = b.run("return [...document.querySelectorAll('#panels .readout')].map(e => e.textContent)")
    point = int(re.search(r"point (\d+) at", words[0]).group(1))
    same(point, int(re.search(r"point (\d+) at", words[1]).group(1)), "the point in both maps")
    value = b.run("const p = Page.panels[0]; return p.numbers[[...p.sheet.nodes].indexOf(arguments[0])]", point)
    same(words[0].split(" ")[0], "%.3f" % value, "its thickness")


@check
def everything_is_saved(b, pages):
    ready(b, pages["hip"])
    for selector, kind in (("#joint-png", "png"), ("#save-maps", "png"), ("#figure-jacobians [data-save=png]", "png"),
                           ("#figure-jacobians [data-save=svg]", "svg"), ("#figure-hip [data-save=svg]", "svg"), ("#figure-jacobians [data-save=csv]", "csv")):
        b.click(selector)
        name, content = b.downloaded()
        true(name.startswith("hip_") and name.endswith("." + kind), name)
        if kind == "png":
            true(png_size(content)[0] > 800, f"{selector}: the PNG is small")
        elif kind == "svg":
            true(len(list(xml.etree.ElementTree.fromstring(content).iter())) > 20, "the SVG is empty")
            true(not re.search(rb'="[^"]*(NaN|Infinity|undefined)', content), "NaN in the SVG")
        else:
            rows = list(csv.DictReader(io.StringIO(content.decode())))
            for layer in pages["json"]["layers"]:
                same(sum(int(r["elements"]) for r in rows if r["layer"] == layer["name"]), 2 * layer["triangles"], "elements of a layer")
    tables = b.run("return document.querySelectorAll('#numbers [data-save=csv]').length")
    same(tables, TABLES, "tables")
    for i in range(tables):
        b.run("document.querySelectorAll('#numbers [data-save=csv]')[arguments[0]].click()", i)
        true(len(list(csv.reader(io.StringIO(b.downloaded()[1].decode())))) > 1, "a table's CSV is empty")


@check
def the_hip_is_drawn(b, pages):
    """The picture, and its angles among the tables."""
    ready(b, pages["hip"])
    b.wait("document.getElementById('hip-figure').complete", 10, "the picture")
    true(b.run("return document.getElementById('hip-figure').naturalWidth") > 200, "the picture is not there")
    words = b.run("return document.getElementById('numbers').textContent")
    true("%.1f" % pages["json"]["hip"]["lateral_center_edge"] in words, "the lateral centre-edge angle")
    b.size(390, 800)  # one panel below the other, as wide as the page
    panels = b.run("return [...document.querySelectorAll('#figure-hip img')].map(p => [p.clientWidth, p.complete && p.naturalHeight > p.naturalWidth])")
    same(panels[0][0], 0, "width of the whole picture")
    true(len(panels) == 4 and all(width > 330 and tall for width, tall in panels[1:]), f"panels on a narrow page: {panels}")
    b.size(*WINDOW)


@check
def names_are_text(b, pages):
    ready(b, pages["hostile"])
    same(b.run("return document.querySelectorAll('b').length"), 3, "bold words: the readouts alone")
    true(HOSTILE in b.run("return document.getElementById('bone0').textContent"), "the bone's name")
    no_faults(b, "hostile names")


@check
def a_bare_bone_and_no_shells(b, pages):
    ready(b, pages["bare"])
    hashes(b, "whole")
    names = b.run("return [...document.querySelectorAll('#layer option')].map(o => o.textContent)")
    same(names, ["pelvis_bone", "femur_cartilage"], "layers")
    b.run("const s = document.getElementById('layer'); s.value = '0'; s.dispatchEvent(new Event('change'))")
    b.wait("Page.panels.length === 1", 10, "the gap alone")
    no_faults(b, "a bare bone")


@check
def it_fits_narrow_and_dark(b, pages):
    try:
        for width in (1400, 390):
            for scheme in ("light", "dark"):
                b.size(width, 900)
                b.scheme(scheme)
                ready(b, pages["hip"])
                same(b.run("return document.documentElement.dataset.theme"), scheme, "the theme")
                true(b.run("return document.documentElement.scrollWidth") <= width, f"wider than {width}")
        no_faults(b, "widths")
    finally:
        b.size(*WINDOW)
        b.scheme("light")


@check
def nothing_comes_from_the_network(b, pages):
    b.log("performance")
    ready(b, pages["hip"])
    no_network(b, "the page")


def without_webgl(pages):
    with Browser(webgl=False) as b:
        ready(b, pages["hip"])
        true(b.run("return !!document.getElementById('nowebgl')"), "it says that there is no WebGL")
        same(b.run("return document.querySelectorAll('#numbers table').length"), TABLES, "tables")
        true(b.run("return document.querySelectorAll('#figure-jacobians svg').length") > 0, "the figure")


def main():
    if len(sys.argv) < 2:
        print("usage: build_page_test.py DEA [CHECK...]", file=sys.stderr)
        return 2
    dea, *wanted = sys.argv[1:]
    return run_checks(CHECKS, wanted, lambda folder: make(os.path.abspath(dea), folder), without_webgl)


if __name__ == "__main__":
    sys.exit(main())
