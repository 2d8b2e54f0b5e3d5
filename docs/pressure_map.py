#!/usr/bin/env python3
"""Draws pressure maps of plot files side by side as one SVG, seen along an axis. Standard library only.

    docs/pressure_map.py --surface NAME [--up x,y,z] [--max MPA] -o map.svg TITLE=FILE.xplt [TITLE=FILE.xplt ...]

Shows the last state's `contact pressure` on one surface of each file, on the deformed mesh, seen against the surface's
mean normal, with one colour scale (viridis) for all, and the centre of pressure.
"""
import argparse
import math
import os
import sys

sys.path.insert(0, os.path.dirname(__file__))
from xplt_reader import PlotFile, cross, dot, sub  # noqa: E402

VIRIDIS = [(68, 1, 84), (72, 40, 120), (62, 74, 137), (49, 104, 142), (38, 130, 142), (31, 158, 137), (53, 183, 121),
           (109, 205, 89), (180, 222, 44), (253, 231, 37)]


def unit(a): return tuple(x / math.sqrt(dot(a, a)) for x in a)


def colour(fraction):
    f = min(max(fraction, 0.0), 1.0) * (len(VIRIDIS) - 1)
    i = min(int(f), len(VIRIDIS) - 2)
    return "#%02x%02x%02x" % tuple(round(a + (b - a) * (f - i)) for a, b in zip(VIRIDIS[i], VIRIDIS[i + 1]))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--surface", required=True)
    parser.add_argument("--up", default="0,1,0")
    parser.add_argument("--max", type=float, default=0.0, help="upper end of the colour scale; default: the largest value")
    parser.add_argument("-o", required=True)
    parser.add_argument("files", nargs="+", metavar="TITLE=FILE")
    args = parser.parse_args()
    panels = []
    for entry in args.files:
        title, path = entry.split("=", 1)
        file = PlotFile(path)
        panels.append((title, file.nodes, *file.surface(args.surface)))
    top = args.max or max(max(p) for _, _, _, p in panels)
    out, width, height = [], 340, 330
    for k, (title, nodes, facets, pressure) in enumerate(panels):
        areas = [cross(sub(nodes[f[1]], nodes[f[0]]), sub(nodes[f[2]], nodes[f[0]])) for f in facets]
        view = unit([sum(a[i] for a in areas) for i in range(3)])
        right = unit(cross([float(x) for x in args.up.split(",")], view))
        up = cross(view, right)
        flat = {n: (dot(nodes[n], right), dot(nodes[n], up), dot(nodes[n], view)) for f in facets for n in f}
        lo = [min(p[i] for p in flat.values()) for i in range(2)]
        hi = [max(p[i] for p in flat.values()) for i in range(2)]
        scale = 280 / max(hi[0] - lo[0], hi[1] - lo[1])
        x0, y0 = k * width + 25, 40

        def place(p): return (x0 + (p[0] - lo[0]) * scale, y0 + (hi[1] - p[1]) * scale)
        out.append('<text x="%g" y="24" font-weight="bold">%s</text>' % (x0, title))
        for f, p in sorted(zip(facets, pressure), key=lambda fp: min(flat[n][2] for n in fp[0])):
            points = " ".join("%.1f,%.1f" % place(flat[n]) for n in f)
            fill = colour(p / top) if p > 0 else "#e8e8ec"
            out.append('<polygon points="%s" fill="%s" stroke="%s" stroke-width="0.4"/>' % (points, fill, fill if p > 0 else "#ffffff"))
        weights = [math.sqrt(dot(a, a)) * p for a, p in zip(areas, pressure)]
        if sum(weights) > 0:
            middles = [[sum(nodes[n][i] for n in f) / len(f) for i in range(3)] for f in facets]
            cop = [sum(w * m[i] for w, m in zip(weights, middles)) / sum(weights) for i in range(3)]
            x, y = place((dot(cop, right), dot(cop, up)))
            out.append('<path d="M%.1f %.1fh12m-6 -6v12" stroke="#fff" stroke-width="3"/><path d="M%.1f %.1fh12m-6 -6v12" stroke="#000" stroke-width="1.2"/>'
                       % (x - 6, y, x - 6, y))
        out.append('<text x="%g" y="%g" fill="#444">largest %.2f MPa</text>' % (x0, height + 12, max(pressure)))
    total = len(panels) * width + 90
    for i in range(100):
        out.append('<rect x="%d" y="%g" width="16" height="2.6" fill="%s" shape-rendering="crispEdges"/>' % (total - 80, 300 - 2.5 * i, colour(i / 99)))
    for i in range(5):
        out.append('<text x="%d" y="%g">%.1f</text>' % (total - 58, 306 - 62 * i, top * i / 4))
    out.append('<text x="%d" y="36">MPa</text>' % (total - 80))
    with open(args.o, "w") as f:
        f.write('<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 %d %d" font-family="sans-serif" font-size="13">'
                '<rect width="100%%" height="100%%" fill="#fff"/>%s</svg>\n' % (total, height + 30, "".join(out)))


main()
