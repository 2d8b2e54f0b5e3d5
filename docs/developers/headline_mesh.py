#!/usr/bin/env python3
"""How p99, mean, area and peak of `dea run` follow the mesh: the table of docs/theory.md, 6.1. Standard library only.

    docs/developers/headline_mesh.py DEA [--facets 12,16,24,32,48,96] [--turned DEGREES] [dea's options ...]

DEA: the built program. The model: a condyle (radii 20 and 26, 2.5 of cartilage) on a flat plateau of 36 x 36 (2.5 of cartilage), E = 10,
nu = 0.45, pressed by 800; the plateau has N x N facets, the condyle as many on 25 x 25. --turned: the condyle's mesh about its axis.
Errors are those from the last N.
"""
import argparse
import json
import math
import os
import subprocess
import tempfile


def write_model(path, n, turned):
    nodes, elements, surfaces = [], [], []
    c, s = math.cos(math.radians(turned)), math.sin(math.radians(turned))

    def layer(name, width, heights, c, s, upward):
        """Grids of nodes from the bone to the face, hexahedra between them, shells at the bone."""
        first = len(nodes)
        for height in heights:
            for j in range(n + 1):
                for i in range(n + 1):
                    x, y = width * (i / n - 0.5), width * (j / n - 0.5)
                    x, y = c * x - s * y, s * x + c * y
                    nodes.append((x, y, height(x, y)))
        grid = (n + 1) ** 2
        cells = [first + j * (n + 1) + i + 1 for j in range(n) for i in range(n)]
        up = lambda a: [a, a + 1, a + n + 2, a + n + 1]
        round_ = up if upward else lambda a: up(a)[::-1]
        elements.append((name + "_cartilage", "hex8", [up(a + k * grid) + up(a + (k + 1) * grid) if upward else up(a + (k + 1) * grid) + up(a + k * grid)
                                                       for k in range(len(heights) - 1) for a in cells]))
        elements.append((name, "quad4", [round_(a) for a in cells]))
        surfaces.append((name + "_face", [round_(a + (len(heights) - 1) * grid) for a in cells]))

    condyle = lambda x, y: 26 - 26 * math.sqrt(1 - (x / math.sqrt(20 * 26)) ** 2 - (y / 26) ** 2)
    layer("tibia", 36, [lambda x, y: -2.5, lambda x, y: -1.25, lambda x, y: 0.0], 1.0, 0.0, True)
    layer("femur", 25, [lambda x, y: condyle(x, y) + 2.5, lambda x, y: condyle(x, y) + 1.25, condyle], c, s, False)

    text = ['<?xml version="1.0"?>\n<febio_spec version="4.0"><Module type="solid"/><Control><analysis>STATIC</analysis><time_steps>1</time_steps>'
            '<step_size>1</step_size></Control><Material>']
    for k, (name, kind) in enumerate([("tibia_cartilage", "c"), ("femur_cartilage", "c"), ("tibia", "r"), ("femur", "r")], 1):
        text.append('<material id="%d" name="%s" type="%s">%s</material>' % (
            k, name, *(("neo-Hookean", "<density>1</density><E>10</E><v>0.45</v>") if kind == "c" else
                       ("rigid body", "<density>1</density><center_of_mass>0,0,%d</center_of_mass>" % (20 if name == "femur" else -10)))))
    text.append('</Material><Mesh><Nodes name="all">')
    text += ['<node id="%d">%.9g,%.9g,%.9g</node>' % (k, *x) for k, x in enumerate(nodes, 1)]
    text.append("</Nodes>")
    number = 0
    for name, kind, cells in elements:
        text.append('<Elements type="%s" name="%s">' % (kind, name))
        for cell in cells:
            number += 1
            text.append('<elem id="%d">%s</elem>' % (number, ",".join(map(str, cell))))
        text.append("</Elements>")
    for name, facets in surfaces:
        text.append('<Surface name="%s">' % name)
        text += ['<quad4 id="%d">%s</quad4>' % (k, ",".join(map(str, f))) for k, f in enumerate(facets, 1)]
        text.append("</Surface>")
    held = lambda body, dofs: '<rigid_bc type="rigid_fixed"><rb>%s</rb>%s</rigid_bc>' % (body, "".join("<%s_dof>1</%s_dof>" % (d, d) for d in dofs))
    text.append('<SurfacePair name="pair"><primary>tibia_face</primary><secondary>femur_face</secondary></SurfacePair></Mesh><MeshDomains>')
    text += ['<%sDomain name="%s" mat="%s"/>' % ("Solid" if kind == "hex8" else "Shell", name, name) for name, kind, _ in elements]
    text.append("</MeshDomains><Rigid>" + held("tibia", ["Rx", "Ry", "Rz", "Ru", "Rv", "Rw"]) + held("femur", ["Rx", "Ry", "Ru", "Rv", "Rw"]) +
                '<rigid_load type="rigid_force"><rb>femur</rb><dof>Rz</dof><value lc="1">-800</value></rigid_load></Rigid>'
                '<Contact><contact type="sliding-elastic" surface_pair="pair"/></Contact><LoadData><load_controller id="1" type="loadcurve"><points>'
                "<pt>0,0</pt><pt>1,1</pt></points></load_controller></LoadData></febio_spec>")
    with open(path, "w") as f:
        f.write("\n".join(text))


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("dea")
    parser.add_argument("--facets", default="12,16,24,32,48,96")
    parser.add_argument("--turned", type=float, default=0.0)
    given, options = parser.parse_known_args()
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        for n in map(int, given.facets.split(",")):
            model = os.path.join(folder, "condyle.feb")
            write_model(model, n, given.turned)
            out = subprocess.run([given.dea, "run", model, "--no-xplt", "--states", "last", "-q", "--json", "-", *options], check=True,
                                 capture_output=True, text=True).stdout
            contact = json.loads(out)["states"][-1]["contacts"][0]
            h = contact["headline"]
            rows.append((n, [h["p99"], h["mean"], h["area"], h["peak"], contact["mean_pressure"], contact["contact_area"]]))
    last = rows[-1][1]
    print("| facets | p99 | mean | area | peak | springs' mean | springs' area |\n|---|---|---|---|---|---|---|")
    for n, row in rows:
        print("| %d x %d | %s |" % (n, n, " | ".join("%.4g (%+.1f %%)" % (x, 100 * (x / y - 1)) for x, y in zip(row, last))))


if __name__ == "__main__":
    main()
