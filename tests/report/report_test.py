#!/usr/bin/env python3
"""The report's page in a headless Chromium.

report_test.py DEA MAKE_PAGES SAMPLES. Exit code 77: there is no chromedriver. Python's standard library only.
"""
import csv
import json
import os
import re
import struct
import subprocess
import sys
import xml.etree.ElementTree
import zlib

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from browser import WINDOW, Browser, run_checks  # noqa: E402

CHECKS = []


def check(function):
    CHECKS.append(function)
    return function


def same(found, expected, what):
    if found != expected:
        raise AssertionError(f"{what}: found {found!r}, expected {expected!r}")


def true(condition, what):
    if not condition:
        raise AssertionError(what)


# ---- what tests ask of a page ----

HASH = """
const hash = (canvas) => {
  const d = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height).data;
  let h = 0; const seen = new Set();
  for (let i = 0; i < d.length; i += 4) {
    const c = d[i] << 16 | d[i + 1] << 8 | d[i + 2];
    h = (Math.imul(h, 31) + c) | 0;
    if (i % 64 === 0) seen.add(c);
  }
  return [h, seen.size];
};
"""


# Words of the pictures that are saved from here on, and where they stand: window.written.
KEEP_WORDS = """
window.written = [];
const was = CanvasRenderingContext2D.prototype.fillText;
CanvasRenderingContext2D.prototype.fillText = function (text, ...rest) {
  if (this.canvas.width > 1500) window.written.push([text, ...rest]);
  return was.call(this, text, ...rest);
};
"""


def ready(b, page):
    b.open("file://" + page)
    b.wait("document.documentElement.dataset.ready", 120, "the page to be ready")
    if not b.run("return Page.maps.fault"):
        b.wait("Page.maps.drawn > 0 && Page.maps.settled", 60, "the first drawing")


def settle(b):
    b.wait("Page.maps.settled", 30, "the drawing to be done")


def pictures(b):
    """Per map: a hash of its pixels, and how many colours it has."""
    settle(b)
    return b.run(HASH + "return Page.panels.map(p => hash(p.canvas))")


def place(b, index, fx=0.5, fy=0.5):
    """A point of a map in the window, scrolled to."""
    box = b.run("const c = Page.panels[arguments[0]].canvas; c.scrollIntoView({block: 'center'});"
                "const r = c.getBoundingClientRect(); return [r.left, r.top, r.width, r.height]", index)
    return box[0] + fx * box[2], box[1] + fy * box[3]


def no_faults(b, what):
    faults = [e for e in b.log("browser") if e["level"] in ("SEVERE", "WARNING")
              # the driver reads pixels back, which software drawing finds slow
              and not re.search(r"GPU stall|willReadFrequently|Automatic fallback to software WebGL", e["message"])]
    same(faults, [], f"{what}: messages of the console")


def no_network(b, what):
    """Everything that was asked for was the page itself."""
    asked = []
    for entry in b.log("performance"):
        message = json.loads(entry["message"])["message"]
        if message["method"] in ("Network.requestWillBeSent", "Network.webSocketCreated"):
            p = message["params"]
            asked.append(p["request"]["url"] if "request" in p else p["url"])
    true(any(u.startswith("file://") for u in asked), f"{what}: the log of requests is empty, it proves nothing")
    same([u[:200] for u in asked if not u.startswith(("file://", "data:", "blob:", "about:"))], [],
         f"{what}: requests")
    same(len([u for u in asked if u.startswith("file://") and not u.endswith(".html")]), 0, f"{what}: other files")


def png_size(data):
    """Of a sound PNG, with all its checksums; its pixels must not all be alike."""
    same(data[:8], b"\x89PNG\r\n\x1a\n", "signature")
    at, size, pixels, end = 8, None, b"", False
    while at < len(data):
        n, kind = struct.unpack(">I4s", data[at:at + 8])
        body = data[at + 8:at + 8 + n]
        same(struct.unpack(">I", data[at + 8 + n:at + 12 + n])[0], zlib.crc32(kind + body), f"checksum of {kind}")
        if kind == b"IHDR":
            size = struct.unpack(">II", body[:8])
        elif kind == b"IDAT":
            pixels += body
        end = kind == b"IEND"
        at += 12 + n
    true(end, "no end of the PNG")
    raw = zlib.decompress(pixels)
    true(len(set(raw)) > 3, "the PNG is blank")
    return size


# ---- checks: each gets a browser and the pages ----

@check
def maps_are_drawn(b, pages):
    for name in ("compare", "run", "awkward"):
        ready(b, pages[name])
        found = pictures(b)
        true(len(found) >= 3, f"{name}: {len(found)} maps")
        for i, (_, colours) in enumerate(found):
            true(colours > 20, f"{name}: map {i} is blank, {colours} colours")
        true(b.run("return document.querySelectorAll('figure svg').length") >= 5, f"{name}: figures are missing")
        true(not re.search(r"NaN|undefined|Infinity", b.run("return document.body.innerText")), f"{name}: NaN in the text")
        svg = b.run("return [...document.querySelectorAll('figure svg')].map(s => s.outerHTML).join()")
        true(not re.search(r'="[^"]*(NaN|Infinity)', svg), f"{name}: NaN in a figure")
        no_faults(b, name)


@check
def nothing_comes_from_the_network(b, pages):
    b.log("performance")
    for name in ("compare", "awkward"):
        ready(b, pages[name])
        b.click("#save-maps")
        b.downloaded()
    no_network(b, "pages")


@check
def names_are_text(b, pages):
    ready(b, pages["awkward"])
    same(b.run("return document.querySelectorAll('b, i, img, h1 *').length"), 0, "elements made of names")
    true(b.run("return document.querySelector('h1').textContent").startswith("</script><b>&\"'é\ufffd"), "the title")
    true(b.run("return document.title").startswith("</script><b>&\"'é\ufffd"), "the window's title")


@check
def slider_moves_the_state(b, pages):
    ready(b, pages["compare"])
    before = pictures(b)
    now = b.run("return document.getElementById('now').textContent")
    b.run("const s = document.getElementById('slider'); s.value = '4'; s.dispatchEvent(new Event('input'))")
    after = pictures(b)
    same(b.run("return Page.state.frame"), 4, "state")
    true(now != b.run("return document.getElementById('now').textContent"), "the time stands still")
    for i, (x, y) in enumerate(zip(before, after)):
        true(x[0] != y[0], f"map {i} did not change")
    b.key("\ue014")  # right
    same(b.run("return Page.state.frame"), 5, "state after the right arrow")
    true(pictures(b)[0][0] != after[0][0], "the right arrow changed nothing")
    b.key("\ue012")
    same(pictures(b), after, "maps after going back")
    report = b.run("return Report.surfaces[0].measures[0][4][0].headline.peak")
    shown = b.run("return document.getElementById('readout0').textContent")
    same(float(re.search(r"peak ([0-9.]+)", shown).group(1)), float(f"{report:.4g}"), "peak below the map")


@check
def captions_are_the_headline_numbers(b, pages):
    ready(b, pages["compare"])
    for kind in ("facets", "nodes"):
        b.click("#facets" if kind == "facets" else "#smooth")
        for i in (0, 1):
            known = b.run("return Page.state.surface.about.measures[arguments[0]].at(-1)[0].headline", i)
            b.run("Page.setFrame(Report.frames.length - 1)")
            text = b.run("return document.getElementById('readout' + arguments[0]).innerText", i)
            true(text.startswith("p99"), f"{kind}: below the map stands {text}")
            for word in ("p99", "mean", "area", "peak"):
                found = float(re.search(word + r" ([0-9.]+)", text).group(1))
                same(found, float(f"{known[word]:.4g}"), f"{kind}, {word} below the map")


COLOURED = """
  Page.maps.draw();
  return Page.panels.slice(0, arguments[0]).map((p) => {
    const d = p.canvas.getContext("2d").getImageData(0, 0, p.canvas.width, p.canvas.height).data;
    let n = 0;
    for (let i = 0; i < d.length; i += 4) {
      const most = Math.max(d[i], d[i + 1], d[i + 2]), least = Math.min(d[i], d[i + 1], d[i + 2]);
      if (most - least > 0.3 * most) ++n;
    }
    return n;
  })"""


@check
def smooth_contact_is_no_larger_than_the_facets(b, pages):
    for name, count in (("knee", 1), ("three", 3)):
        ready(b, pages[name])
        for toggle in ("contours", "marks", "veil"):
            b.click("#" + toggle)
        smooth = b.run(COLOURED, count)
        b.click("#facets")
        facets = b.run(COLOURED, count)
        for i, (p, q) in enumerate(zip(smooth, facets)):
            true(q > 500, f"{name}, map {i}: {q} pixels with colour")
            true(abs(p / q - 1) < 0.04, f"{name}, map {i}: {p} pixels with colour when smooth, {q} of facets")


@check
def scales_are_the_programs(b, pages):
    """Ends and lines, for all states and for one; joint space ends below its largest value."""
    ready(b, pages["compare"])
    b.run("Page.panels.forEach(p => { Page.maps.observer.unobserve(p.canvas); p.visible = false; })")  # scales alone: no map needs drawing
    wanted = """
      const [q, kind, every] = arguments, s = Page.state.surface.about.scales.find(x => x.field === q)[kind];
      return every ? s.all : s.frames[Page.state.frame]"""
    seen = set()
    for q in ("pressure", "space", "thickness"):
        b.run("const s = document.getElementById('quantity'); s.value = arguments[0]; s.dispatchEvent(new Event('change'))", q)
        b.wait(f"Page.panels[0].quantity === '{q}'", 20, q)
        for kind in ("nodes", "facets"):
            b.click("#smooth" if kind == "nodes" else "#facets")
            for every in (True, False):
                b.run("const s = document.getElementById('range'); s.value = arguments[0]; s.dispatchEvent(new Event('change'))",
                      "all" if every else "state")
                scale = b.run("return Page.panels[0].what.scale")
                low, high, step, least, most = b.run(wanted, q, kind, every)
                same([scale["least"], scale["most"], scale["level"]], [low, high, step], f"{q}, {kind}: scale and lines")
                same(scale["beyondMost"], most > high * (1 + 1e-6), f"{q}, {kind}: arrow at the bar's end")
                seen.add((q, kind, high))
                if q == "space":
                    true(most > 1.2 * high > 0, f"joint space to {high}, largest {most}")
    true(len(seen) >= 9, f"scales that differ: {seen}")
    # what the user says ends there, with lines by the same rule
    b.run("const s = document.getElementById('quantity'); s.value = 'pressure'; s.dispatchEvent(new Event('change'))")
    for most, step in ((3, 0.5), (6, 1), (7.19, 2), (0.05, 0.01), (120, 20), (31, 10)):
        b.run("const s = document.getElementById('most'); s.value = arguments[0]; s.dispatchEvent(new Event('change'))", most)
        scale = b.run("return Page.panels[0].what.scale")
        true(scale["most"] == most and abs(scale["level"] / step - 1) < 1e-9, f"up to {most}: {scale}")


def lines(b):
    """Pixels of the first map that differ with lines and without."""
    return b.run("""
      const pixels = (on) => {
        Page.maps.options.contours = on;
        Page.maps.draw();
        const c = Page.panels[0].canvas;
        return new Uint32Array(c.getContext("2d").getImageData(0, 0, c.width, c.height).data.buffer);
      };
      const without = pixels(false), lined = pixels(true);
      return lined.reduce((n, x, i) => n + (x !== without[i]), 0)""")


@check
def facets_have_the_lines_of_their_averages(b, pages):
    ready(b, pages["compare"])
    for toggle in ("marks", "veil"):
        b.click("#" + toggle)
    smooth = lines(b)
    b.click("#facets")
    facets = lines(b)
    true(smooth > 300, f"{smooth} pixels of lines when smooth")
    true(abs(facets / smooth - 1) < 0.1, f"{facets} pixels of lines over facets, {smooth} when smooth")
    # none beyond the end that the user sets
    b.run("const s = document.getElementById('most'); s.value = 1e6; s.dispatchEvent(new Event('change'))")
    same(lines(b), 0, "pixels of lines where none is between the ends")


@check
def profile_begins_and_ends_with_facets(b, pages):
    ready(b, pages["three"])
    found = b.run("""
      const s = Page.state.surface.about, all = s.profiles[Page.state.frame];
      return [s.bins.length - 1, all.map(p => p.filter(x => x !== null).length).reduce((a, c) => a + c, 0),
        document.querySelectorAll('#figure-profile svg circle').length]""")
    true(found[2] > 5, "points of the profile")
    same(found[2], found[1], "points of the profile, bins with facets")


@check
def play_plays(b, pages):
    ready(b, pages["compare"])
    b.run("document.getElementById('slider').focus(); Page.setFrame(0)")
    b.key(" ")
    b.wait("Page.state.frame >= 3", 20, "three states of the film")
    b.key(" ")
    at = b.run("return Page.state.frame")
    b.run("return new Promise(done => setTimeout(done, 900))")
    same(b.run("return Page.state.frame"), at, "state after pause")
    settle(b)
    drawn = b.run("return Page.maps.drawn")
    b.run("return new Promise(done => setTimeout(done, 600))")
    same(b.run("return Page.maps.drawn"), drawn, "drawings while nothing changes")


@check
def picking_tells_the_files_numbers(b, pages):
    ready(b, pages["compare"])
    b.click("#facets")
    last = b.run("return Report.frames.length - 1")
    b.run("Page.setFrame(arguments[0])", last)
    settle(b)
    rows, surface = {}, "acetabular_articulating"
    b.run("""const i = Report.surfaces.findIndex(s => s.title === arguments[0]), s = document.getElementById('surface');
             s.value = String(i); s.dispatchEvent(new Event('change'))""", surface)
    b.wait(f"Page.state.surface.about.title === '{surface}'", 20, "the socket")
    settle(b)
    for i, name in enumerate(("layer", "linear")):
        with open(pages[name + "_facets"], newline="") as file:
            for row in csv.DictReader(file):
                if row["surface"] == surface and float(row["time"]) == 2:
                    rows[i, int(row["facet"])] = row
    true(len(rows) > 1000, "facets of the CSV")
    # facets that the viewer sees, from all over the surface: the pointer goes where the file says they are
    seen = pressed = 0
    for facet in range(7, 860, 37):
        row = rows[0, facet]
        centre = [float(row["reference_" + x]) for x in "xyz"]
        left, top = place(b, 0, 0, 0)
        x, y = b.run("const c = Page.panels[0].canvas; Page.maps.aim(c.clientWidth, c.clientHeight);"
                     "return Page.maps.toScreen(arguments[0], c.clientWidth, c.clientHeight)", centre)
        b.pointer(("move", left + x, top + y))
        facets = b.run("return Page.panels.slice(0, 2).map(p => p.readout.dataset.facet)")
        if facets[0] is None:
            continue  # a facet on edge
        same(facets[0], facets[1], "facet in both maps")
        if facets[0] != str(facet):
            continue  # something is in front
        seen += 1
        for i in (0, 1):
            text = b.run("return document.getElementById('readout' + arguments[0]).innerText", i)
            row = rows[i, facet]
            value = float(re.search(r"facet \d+ · ([0-9.]+)", text).group(1))
            expected = float(row["pressure"])
            true(abs(value - expected) <= 0.0006 * abs(expected), f"facet {facet}: shown {value}, in the file {expected}")
            thickness = float(re.search(r"thickness ([0-9.]+)", text).group(1))
            true(abs(thickness - float(row["thickness"])) < 0.02, f"thickness {thickness}, in the file {row['thickness']}")
            pressed += expected > 0
    true(seen >= 12 and pressed >= 12, f"{seen} of 24 facets were found under the pointer, {pressed} pressures")
    # away from the surface the readout is the surface's own again
    b.pointer(("move", *place(b, 0, 0.01, 0.01)))
    true(b.run("return Page.panels[0].readout.dataset.facet") is None, "a facet where none is")


@check
def cameras_are_linked(b, pages):
    ready(b, pages["compare"])
    before = pictures(b)
    x, y = place(b, 1)
    b.pointer(("move", x, y), ("down",), ("move", x + 60, y + 25), ("up",))
    b.pointer(("move", 5, 5))
    after = pictures(b)
    for i, (p, q) in enumerate(zip(before, after)):
        true(p[0] != q[0], f"map {i} did not turn")
        true(q[1] > 20, f"map {i} is blank")
    b.click("#reset")
    same(pictures(b), before, "maps after the view was reset")


@check
def slow_drawing_ends_whole(b, pages):
    """Where drawing is slow the rest of the model is left out while maps turn, and comes back."""
    ready(b, pages["compare"])
    # as on a slow machine, whatever this one is
    b.run("Page.maps.slow = true; Page.maps.measured = 9; Page.maps.hurry = function () { this.rest = performance.now() + 3000; }")
    before = pictures(b)
    b.run("Page.maps.turn(0.4, 0)")
    b.wait("!Page.maps.pending", 30, "the drawing on the way")
    true(b.run("return Page.maps.plain"), "drawn whole while it moves")
    settle(b)
    same(b.run("return Page.maps.plain"), False, "left out at rest")
    b.run("Page.maps.turn(0.4, 0)")
    b.click("#reset")
    b.wait("!Page.maps.pending", 30, "the drawing after the view was reset")
    same(b.run("return Page.maps.plain"), False, "left out after the view was reset")
    same(pictures(b), before, "maps after the view was reset")


@check
def difference_of_any_two(b, pages):
    ready(b, pages["three"])
    b.click("#facets")
    options = b.run("return [...document.querySelectorAll('#pair option')].map(o => o.value)")
    same(options, ["0,2", "1,2", "0,1"], "differences")
    seen = set()
    for pair in options:
        b.run("const s = document.getElementById('pair'); s.value = arguments[0]; s.dispatchEvent(new Event('change'))", pair)
        seen.add(pictures(b)[-1][0])
        i, j = map(int, pair.split(","))
        worst = b.run("""
          const [i, j] = arguments, s = Page.state.surface, f = Report.frames[Page.state.frame].states;
          const a = s.fields.pressure[i].state(f[i]), c = s.fields.pressure[j].state(f[j]), d = Page.panels.at(-1).what.facets;
          let worst = 0; for (let k = 0; k < d.length; ++k) worst = Math.max(worst, Math.abs(d[k] - (a[k] - c[k])));
          return worst""", i, j)
        true(worst < 1e-6, f"difference {pair} is off by {worst}")
        scale = b.run("return Page.panels.at(-1).what.scale")
        same(scale["least"], -scale["most"], "the difference's scale about 0")
        same(scale["map"], "diverging", "the difference's colours")
    same(len(seen), 3, "different pictures of differences")


@check
def one_scale_for_all(b, pages):
    ready(b, pages["three"])
    scales = b.run("return Page.panels.slice(0, 3).map(p => JSON.stringify(p.what.scale))")
    same(len(set(scales)), 1, "scales of the three results")
    peak = b.run("return Math.max(...Report.surfaces[0].measures.flat().map(m => m[0].nodes.peak))")
    most = json.loads(scales[0])["most"]
    true(peak <= most * (1 + 1e-9) <= 1.05 * peak + 1e-9, f"scale to {most}, peak {peak}")


@check
def other_fields_and_surfaces(b, pages):
    ready(b, pages["compare"])
    pressure = pictures(b)
    for quantity in ("space", "thickness"):
        b.run("const s = document.getElementById('quantity'); s.value = arguments[0]; s.dispatchEvent(new Event('change'))", quantity)
        settle(b)
        found = pictures(b)
        true(found[0][0] != pressure[0][0] and found[0][1] > 20, f"map of {quantity}")
    count = b.run("return Report.surfaces.length")
    true(count >= 2, "surfaces")
    b.run("const s = document.getElementById('surface'); s.value = '1'; s.dispatchEvent(new Event('change'))")
    b.wait("Page.state.surface.index === 1", 20, "the other surface")
    true(pictures(b)[0][1] > 20, "map of the other surface")
    # a result that lacks the field says so
    ready(b, pages["awkward"])
    b.run("const s = document.getElementById('quantity'); s.value = 'space'; s.dispatchEvent(new Event('change'))")
    settle(b)
    same(b.run("return Page.panels.map(p => p.message)")[1], "no joint space in this file", "message of the map")
    no_faults(b, "fields and surfaces")


@check
def undefined_is_a_gap(b, pages):
    ready(b, pages["awkward"])
    b.run("const s = document.getElementById('quantity'); s.value = 'space'; s.dispatchEvent(new Event('change'))")
    b.click("#facets")
    settle(b)
    shown = b.run("""
      const p = Page.panels[0], m = p.mesh, out = [0, 0, 0];
      for (let k = 0; k < m.map.triangles.length; ++k) {
        const x = p.what.facets[m.map.facet[(k / 3) | 0]], s = p.object.geometry.getAttribute("shown").array[k];
        if (Number.isNaN(x)) ++out[s < -1.5 ? 0 : 1]; else ++out[2];
      }
      return out""")
    true(shown[0] > 100 and shown[1] == 0 and shown[2] > 100, f"undefined facets as gaps, as values, defined: {shown}")


@check
def figures_are_saved(b, pages):
    ready(b, pages["three"])
    names = b.run("return [...document.querySelectorAll('figure')].filter(f => !f.hidden).map(f => f.id)")
    true(len(names) >= 6, f"figures: {names}")
    for name in names:
        b.click(f"#{name} [data-save=svg]")
        file, data = b.downloaded()
        true(file.endswith(".svg"), file)
        root = xml.etree.ElementTree.fromstring(data)
        same(root.tag, "{http://www.w3.org/2000/svg}svg", name)
        true(float(root.get("width")) > 300, f"{name}: width")
        marks = sum(1 for e in root.iter() if e.tag.rsplit("}", 1)[-1] in ("path", "rect", "circle", "line"))
        true(marks > 5, f"{name}: {marks} marks")
        true(b"NaN" not in data, f"{name}: NaN")
        true(b"http" not in data.replace(b"http://www.w3.org/", b""), f"{name}: refers to elsewhere")
        b.click(f"#{name} [data-save=png]")
        file, data = b.downloaded()
        true(file.endswith(".png"), file)
        width, _ = png_size(data)
        true(width > 1200, f"{name}: {width} pixels wide")
    b.click("#save-maps")
    file, data = b.downloaded()
    true(file.endswith(".png"), file)
    true(png_size(data)[0] > 2000, "width of the maps' picture")
    no_faults(b, "saving")


@check
def saved_maps_say_what_they_are(b, pages):
    """The words in the picture: whose it is, which surface and time, the numbers of each map, the colours' title, what marks are."""
    for name in ("run", "three"):
        ready(b, pages[name])
        b.run(KEEP_WORDS)
        b.click("#save-maps")
        b.downloaded()
        words = b.run("return window.written.map(w => w[0])")
        title, surface, now = b.run("return [document.querySelector('h1').textContent, Page.state.surface.about.title, document.getElementById('now').textContent]")
        same(words[0], title, f"{name}: first line")
        true(words[1].startswith(surface + ", "), f"{name}: {words[1]}")
        when = re.match(r"time \S+", now)
        true(when and when[0] in words[1], f"{name}: {words[1]!r} has no {now!r}")
        numbers = b.run("return Page.panels.map(p => p.readout.textContent.trim()).filter(t => t)")
        true(numbers, f"{name}: no numbers below the maps")
        said = " ".join(words)
        for line in numbers:
            for part in line.split(" · "):
                true(part.strip() in said, f"{name}: {part!r} is not in the picture")
        for scale in b.run("return Page.state.bars.map(s => s.title)"):
            true(scale in words, f"{name}: {scale!r} is not in the picture")
        true("cross: centre of pressure" in said, f"{name}: {words[-3:]}")
        no_faults(b, name)


@check
def two_surfaces_stand_side_by_side(b, pages):
    """Both plateaus of a knee: each with the numbers that it has alone, in one scale, that of the one with more."""
    b.size(1400, 1000)  # beside each other, not below
    def choose(id, title):
        b.run("""
          const s = document.getElementById(arguments[0]), o = [...s.options].find(o => o.textContent === arguments[1]);
          s.value = o.value;
          s.dispatchEvent(new Event('change'))""", id, title)

    def alone(title):
        choose("surface", title)
        b.wait(f"Page.state.surface.about.title === '{title}'", 20, title)
        settle(b)
        p = "Page.panels.find(p => p.quantity === 'pressure')"
        return b.run(f"return [{p}.readout.textContent, {p}.what.scale.most]")
    ready(b, pages["knee"])
    lateral, medial = alone("lateral_plateau"), alone("medial_plateau")
    choose("beside", "lateral_plateau")
    b.wait("Page.state.beside", 20, "the second surface")
    pair = b.run("""
      return Page.panels.filter(p => p.quantity === 'pressure').map(p => [p.readout.textContent, p.what.scale.most, p.title(), p.offset && p.offset.x])""")
    same([p[0] for p in pair], [medial[0], lateral[0]], "numbers")
    same([p[1] for p in pair], [max(medial[1], lateral[1])] * 2, "end of the scale")
    same([p[2] for p in pair], ["Pressure, medial_plateau", "Pressure, lateral_plateau"], "titles")
    true(pair[0][3] is None and abs(pair[1][3] - 44) < 1, f"the second stands 44 mm beside the first: {pair[1][3]}")
    true(all(colours > 20 for _, colours in pictures(b)), "a map is empty")
    # what lies under the pointer in the second is a facet of its own
    index = b.run("return Page.panels.findIndex(p => p.surface === Page.state.beside)")
    x, y = place(b, index)
    b.pointer(("move", x, y))
    b.wait(f"Page.panels[{index}].readout.dataset.facet", 10, "what lies under the pointer")
    # the second begins a row of its own, on the page and in the picture, though the first has fewer maps
    b.run("Report.surfaces[Page.state.surface.index].fields.space[0] = null")
    choose("beside", "none")
    b.wait("!Page.state.beside", 20, "one surface again")
    choose("beside", "lateral_plateau")
    b.wait("Page.state.beside", 20, "the second surface")
    settle(b)
    first, second = b.run("""
      const of = (s) => Page.panels.filter(p => p.surface === s).map(p => p.canvas.getBoundingClientRect()).map(r => [r.left, r.top]);
      return [of(Page.state.surface), of(Page.state.beside)]""")
    true(len(first) < len(second), f"{len(first)} and {len(second)} maps")
    same(second[0][0], first[0][0], "where the second row begins")
    true(len({y for _, y in first}) == len({y for _, y in second}) == 1 and second[0][1] > first[0][1], f"rows: {first}, {second}")
    b.run(KEEP_WORDS)
    b.click("#save-maps")
    b.downloaded()
    places = b.run("return window.written.filter(w => w[0].startsWith('Pressure, ')).map(w => [w[1], w[2]])")
    true(len(places) == 2 and places[0][0] == places[1][0] and places[0][1] < places[1][1], f"in the picture: {places}")
    # the same surface twice is one
    choose("beside", "medial_plateau")
    b.wait("!Page.state.beside", 20, "one surface again")
    same(b.run("return document.getElementById('beside').value"), "-1", "what is said to stand beside it")
    ready(b, pages["knee"])
    same(alone("medial_plateau"), medial, "alone again")
    no_faults(b, "two surfaces")
    b.size(*WINDOW)


@check
def the_rest_of_the_model_stands_in_its_pose(b, pages):
    """Thickness is the same in all states: its map changes with the time only by what stands around it."""
    ready(b, pages["knee"])
    true(b.run("return Report.context.parts_move.length === Report.results[0].times.length"), "a motion for each state")
    b.click("#marks")
    index = b.run("return Page.panels.findIndex(p => p.quantity === 'thickness')")
    last = b.run("return Report.frames.length - 1")
    seen = {}
    for poses in (True, False):
        for frame in (0, last):
            b.run("const s = document.getElementById('slider'); s.value = arguments[0]; s.dispatchEvent(new Event('input'))", frame)
            seen[poses, frame] = pictures(b)[index]
        b.click("#poses")
    true(seen[True, 0] != seen[True, last], "the bones do not move with the time")
    same(seen[False, 0], seen[False, last], "the bones move though they shall not")
    no_faults(b, "poses")


@check
def light_and_dark(b, pages):
    def paper():
        return b.run("return getComputedStyle(document.body).backgroundColor")
    b.scheme("light")
    ready(b, pages["compare"])
    same(paper(), "rgb(255, 255, 255)", "light paper")
    light = pictures(b)
    b.click("#theme")
    dark_paper = paper()
    true(sum(map(int, re.findall(r"\d+", dark_paper)[:3])) < 150, f"dark paper {dark_paper}")
    dark = pictures(b)
    true(dark[0][0] != light[0][0], "the maps did not follow")
    # figures out of sight follow a little later
    b.wait("[...document.querySelectorAll('figure:not([hidden]) svg[role=img]')].every(s => parseInt(s.getAttribute('fill').slice(1, 3), 16) > 180)", 20,
           "figures in light ink")
    b.scheme("dark")
    ready(b, pages["compare"])
    same(paper(), dark_paper, "the system's choice")
    b.scheme("light")


@check
def narrow_window(b, pages):
    for name in ("three", "run", "awkward", "compare"):
        for width in (600, 390):  # opened narrow, then made narrower
            b.size(width, 900)
            if width == 600:
                ready(b, pages[name])
            settle(b)
            widths = b.run("return [document.documentElement.scrollWidth, document.documentElement.clientWidth]")
            true(widths[0] <= widths[1], f"{name}: {widths[0]} pixels in a window of {widths[1]}")
            out = b.run("""
              return [...document.querySelectorAll('h1, h3, button, select, canvas, figure svg, p')].filter(e => {
                const r = e.getBoundingClientRect();
                return r.width > 0 && r.right > document.documentElement.clientWidth + 1;
              }).map(e => e.outerHTML.slice(0, 80))""")
            same(out, [], f"{name}: what sticks out at {width}")
    b.size(*WINDOW)


def overlapping_words(b):
    """Texts of figures that lie on each other."""
    return b.run("""
        const out = [];
        for (const svg of document.querySelectorAll('figure svg[role=img]')) {
          const texts = [...svg.querySelectorAll('text')].filter(t => t.textContent.trim()).map(t => [t.textContent, t.getBoundingClientRect()]);
          for (let i = 0; i < texts.length; ++i) for (let j = 0; j < i; ++j) {
            const a = texts[i][1], c = texts[j][1];
            const w = Math.min(a.right, c.right) - Math.max(a.left, c.left), h = Math.min(a.bottom, c.bottom) - Math.max(a.top, c.top);
            if (w > 1.5 && h > 3) out.push(svg.closest('figure').id + ': ' + texts[i][0] + ' / ' + texts[j][0]);
          }
        }
        return out""")


@check
def words_do_not_overlap(b, pages):
    """Axis labels, ticks, legends."""
    for name in ("three", "run", "knee"):
        for width in (1400, 600):  # opened wide, then made narrow
            b.size(width, 1000)
            if width == 1400:
                ready(b, pages[name])
            b.run("return new Promise(done => setTimeout(done, 400))")
            same(overlapping_words(b), [], f"{name} at {width}: words on words")
            near = b.run("""
              const out = [];
              for (const svg of document.querySelectorAll('figure svg svg')) {
                const title = svg.querySelector('[aria-label="y-axis label"] text');
                if (!title) continue;
                for (const t of svg.querySelectorAll('[aria-label="y-axis tick label"] text')) {
                  const d = t.getBoundingClientRect().left - title.getBoundingClientRect().right;
                  if (d < 4) out.push(svg.closest('figure').id + ': ' + title.textContent + ' / ' + t.textContent + ', ' + d);
                }
                out.titles = (out.titles || 0) + 1;
              }
              return [out, out.titles || 0]""")
            same(near[0], [], f"{name} at {width}: titles of axes at ticks")
            true(near[1] > 2, f"{name} at {width}: titles of axes")
    b.size(*WINDOW)


@check
def printing_shows_everything(b, pages):
    ready(b, pages["three"])
    pdf = b.cdp("Page.printToPDF", printBackground=True)["data"]
    true(len(pdf) > 100000, "the print is empty")
    no_faults(b, "printing")


def without_webgl(pages):
    with Browser(webgl=False) as b:
        ready(b, pages["three"])
        true("WebGL" in b.run("return (document.getElementById('nowebgl') || {}).textContent || ''"), "no word on WebGL")
        true(b.run("return document.querySelectorAll('figure svg').length") >= 5, "figures without WebGL")
        b.run("Page.setFrame(2)")
        same(b.run("return Page.state.frame"), 2, "state without WebGL")


def make(folder, dea, make_pages, samples):
    pages = {}

    def run(*words):
        subprocess.run(words, cwd=folder, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    hip = os.path.join(samples, "hip", "hip_walking.feb")
    for law in ("layer", "linear"):
        run(dea, "run", hip, "-o", f"{law}.xplt", "--law", law, "-q", "--facets-csv", f"{law}.csv")
        pages[law + "_facets"] = os.path.join(folder, f"{law}.csv")
    run(dea, "run", hip, "-o", "bone.xplt", "--springs-at", "bone", "-q", "--report", "run.html")
    run(dea, "run", os.path.join(samples, "knee", "knee.feb"), "-o", "knee.xplt", "-q", "--report", "knee.html")
    run(dea, "compare", "layer.xplt", "linear.xplt", "--report", "compare.html")
    run(dea, "compare", "layer.xplt", "linear.xplt", "bone.xplt", "--report", "three.html", "--profile",
        "--regions", "anterior-superior-posterior", "--up", "0,0,1", "--anterior", "0,1,0")
    run(make_pages, "awkward", "awkward.html")
    for name in ("run", "knee", "compare", "three", "awkward"):
        pages[name] = os.path.join(folder, name + ".html")
    return pages


def main():
    if len(sys.argv) < 4:
        print("usage: report_test.py DEA MAKE_PAGES SAMPLES [CHECK...]", file=sys.stderr)
        return 2
    programs = [os.path.abspath(a) for a in sys.argv[1:4]]
    return run_checks(CHECKS, sys.argv[4:], lambda folder: make(folder, *programs), without_webgl)


if __name__ == "__main__":
    sys.exit(main())
