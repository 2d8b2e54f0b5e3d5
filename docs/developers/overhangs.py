#!/usr/bin/env python3
"""A layer with a free edge under one that goes on over it: slices in plane strain that febio4 and dea solve at given depths.
The table of docs/layer_law.md, section 3, "Over the edge". Standard library only; some minutes.

    docs/developers/overhangs.py FEBIO4 DEA FOLDER [CONFIG.xml]

x = 0 is the edge, z = 0 the lower layer's surface there, both layers 2.5 thick, E = 10, nu = 0.45 (mm, N, MPa). The upper
surface is a cylinder's of radius 20 about an axis over x = `axis`, or flat. Elements: hexes, one across the slice."""
import math
import os
import subprocess
import sys

T, E, NU, WIDTH, INSIDE, BEYOND = 2.5, 10.0, 0.45, 0.5, 12.5, 10.0


def graded(length, first, most=0.8):
    """Places from 0 to `length`, whose steps grow from `first` on."""
    xs, step = [0.0], first
    while xs[-1] < length - 1e-9:
        xs.append(xs[-1] + step)
        step = min(1.25 * step, most)
    return [x * length / xs[-1] for x in xs]


class Model:
    def __init__(self):
        self.nodes, self.elements = [], []

    def block(self, xs, through, place):
        """Nodes by column, row, side, and the block's elements; place(x, s): s from 0 to 1 through the thickness."""
        ids = {}
        for i, x in enumerate(xs):
            for j in range(through + 1):
                for k in (0, 1):
                    px, pz = place(x, j / through)
                    self.nodes.append((px, WIDTH * k, pz))
                    ids[i, j, k] = len(self.nodes)
        hexes = [[ids[i + a, j + c, k] for c in (0, 1) for a, k in ((0, 0), (1, 0), (1, 1), (0, 1))]
                 for i in range(len(xs) - 1) for j in range(through)]
        return ids, hexes


def row(ids, columns, j, up):
    """Facets along row j, facing up or down."""
    order = ((0, 0), (1, 0), (1, 1), (0, 1)) if up else ((0, 0), (0, 1), (1, 1), (1, 0))
    return [[ids[i + a, j, k] for a, k in order] for i in range(columns)]


def lists(tag, items, first=1):
    return "".join('<%s id="%d">%s</%s>' % (tag, first + i, ",".join(map(str, item)), tag)
                   for i, item in enumerate(items))


def write_model(path, wall, radius, axis, depth, size, through):
    slope = 0.0 if wall == 90 else 1 / math.tan(math.radians(wall))
    top = lambda x: radius - math.sqrt(radius ** 2 - (x - axis) ** 2) if radius else 0.0
    under = [-x for x in graded(INSIDE, size)][::-1]
    over = [-x for x in graded(INSIDE, 0.93 * size)][::-1] + graded(BEYOND, 0.93 * size)[1:]
    m = Model()
    low, low_hexes = m.block(under, through, lambda x, s: (
        x + (1 - s) * T * slope * max(0.0, 1 + x / (3 * T)) ** 2, -(1 - s) * T))
    upp, upp_hexes = m.block(over, through, lambda x, s: (x, top(x) + s * T))
    a, b = len(under) - 1, len(over) - 1
    bone_l, bone_u = row(low, a, 0, False), row(upp, b, through, True)
    held = {n for facet in bone_l + bone_u for n in facet}
    sets = {"sides": [n for n in range(1, len(m.nodes) + 1) if n not in held],
            "middle": [ids[0, j, k] for ids in (low, upp) for j in range(through + 1) for k in (0, 1)
                       if ids[0, j, k] not in held]}
    count = len(low_hexes) + len(upp_hexes)
    text = ['<?xml version="1.0"?><febio_spec version="4.0"><Module type="solid"/><Control><analysis>STATIC</analysis>'
            '<time_steps>10</time_steps><step_size>0.1</step_size><time_stepper type="default"><max_retries>12'
            '</max_retries><opt_iter>15</opt_iter><dtmin>1e-5</dtmin><dtmax>0.1</dtmax></time_stepper><solver '
            'type="solid"><symmetric_stiffness>non-symmetric</symmetric_stiffness><max_refs>40</max_refs>'
            '<qn_method type="BFGS"><max_ups>0</max_ups></qn_method></solver></Control><Material>']
    for i, name in enumerate(("lower", "upper"), 1):
        text.append('<material id="%d" name="%s" type="neo-Hookean"><density>1</density><E>%g</E><v>%g</v></material>'
                    % (i, name, E, NU))
    for i, name in enumerate(("base", "head"), 3):
        text.append('<material id="%d" name="%s" type="rigid body"><density>1</density><center_of_mass>0,0,0'
                    '</center_of_mass></material>' % (i, name))
    text.append('</Material><Mesh><Nodes name="all">%s</Nodes>' % lists("node", m.nodes))
    for name, kind, items, first in (("lower", "hex8", low_hexes, 1), ("upper", "hex8", upp_hexes, 1 + len(low_hexes)),
                                     ("base", "quad4", bone_l, 1 + count), ("head", "quad4", bone_u, 1 + count + a)):
        text.append('<Elements type="%s" name="%s">%s</Elements>' % (kind, name, lists("elem", items, first)))
    for name, items in (("low", row(low, a, through, True)), ("upp", row(upp, b, 0, False))):
        text.append('<Surface name="%s">%s</Surface>' % (name, lists("quad4", items)))
    for name, nodes in sets.items():
        text.append('<NodeSet name="%s">%s</NodeSet>' % (name, ",".join(map(str, nodes))))
    text.append('<SurfacePair name="pair"><primary>low</primary><secondary>upp</secondary></SurfacePair></Mesh>'
                '<MeshDomains><SolidDomain name="lower" mat="lower"/><SolidDomain name="upper" mat="upper"/>'
                '<ShellDomain name="base" mat="base"/><ShellDomain name="head" mat="head"/></MeshDomains><Boundary>')
    for name, of in (("sides", "y"), ("middle", "x")):
        text.append('<bc name="%s" node_set="%s" type="zero displacement"><%s_dof>1</%s_dof></bc>' % (name, name, of, of))
    every = "".join("<%s_dof>1</%s_dof>" % (d, d) for d in ("Rx", "Ry", "Rz", "Ru", "Rv", "Rw"))
    text.append('</Boundary><Rigid><rigid_bc name="hold" type="rigid_fixed"><rb>base</rb>%s</rigid_bc><rigid_bc '
                'name="guide" type="rigid_fixed"><rb>head</rb>%s</rigid_bc><rigid_bc name="push" '
                'type="rigid_displacement"><rb>head</rb><dof>z</dof><value lc="1">%g</value><relative>0</relative>'
                '</rigid_bc></Rigid>' % (every, every.replace("<Rz_dof>1</Rz_dof>", ""), -depth))
    text.append('<Contact><contact name="c" surface_pair="pair" type="sliding-elastic"><penalty>100</penalty>'
                '<auto_penalty>1</auto_penalty><two_pass>0</two_pass><symmetric_stiffness>0</symmetric_stiffness>'
                '<search_radius>2</search_radius><laugon>PENALTY</laugon></contact></Contact><LoadData>'
                '<load_controller id="1" name="ramp" type="loadcurve"><interpolate>LINEAR</interpolate><points>'
                '<pt>0,0</pt><pt>1,1</pt></points></load_controller></LoadData><Output><plotfile type="febio">'
                '<var type="displacement"/><var type="contact pressure"/></plotfile><logfile><rigid_body_data '
                'data="Fz" delim=" " file="%s"></rigid_body_data></logfile></Output></febio_spec>'
                % os.path.basename(path).replace(".feb", ".force"))
    with open(path, "w") as f:
        f.write("\n".join(text))


def forces(febio4, dea, folder, config, name, case):
    """FEBio's force on the base and dea's at the last depth; None: FEBio did not get there."""
    path = os.path.join(folder, name + ".feb")
    write_model(path, *case)
    run = subprocess.run([febio4, "-i", name + ".feb"] + (["-config", config] if config else []), cwd=folder,
                         capture_output=True, text=True)
    with open(os.path.join(folder, name + ".force")) as f:
        last = [line.split() for line in f if line.startswith("3 ")][-1]
    lines = subprocess.run([dea, "run", name + ".feb", "-o", name + "_dea.xplt", "--overwrite", "--csv", "-"], cwd=folder,
                           capture_output=True, text=True).stdout.splitlines()
    head, values = lines[0].split(","), lines[-1].split(",")
    return abs(float(last[1])) if "N O R M A L" in run.stdout else None, abs(float(values[head.index("force_z")]))


def main():
    febio4, dea = (os.path.abspath(p) for p in sys.argv[1:3])
    folder, config = sys.argv[3], os.path.abspath(sys.argv[4]) if len(sys.argv) > 4 else None
    cases = [(wall, 20.0, 0.0, depth, 0.15, 12) for wall in (60, 90, 110) for depth in (0.1, 0.4, 0.8)]
    cases += [(90, 20.0, axis, 0.5, 0.15, 12) for axis in (-2.0, -1.0, 2.0)]
    cases += [(90, 0.0, 0.0, depth, 0.3, 10) for depth in (0.02, 0.25, 0.8, 1.6)]
    print("| wall | surface above | depth | finite elements [N] | dea [N] | |\n|---|---|---|---|---|---|")
    for number, case in enumerate(cases):
        exact, found = forces(febio4, dea, folder, config, "overhang_%d" % number, case)
        above = "cylinder over x = %g" % case[2] if case[1] else "flat"
        error = "" if exact is None else "%+.1f %%" % (100 * (found / exact - 1))
        print("| %g | %s | %g | %s | %.4g | %s |" % (case[0], above, case[3], "-" if exact is None else "%.4g" % exact,
                                                  found, error), flush=True)


if __name__ == "__main__":
    main()
