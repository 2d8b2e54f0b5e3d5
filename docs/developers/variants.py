#!/usr/bin/env python3
"""Writes the variants of the reference joints that docs/causes.md compares, and cuts FEBio's results up. Standard library only.

    docs/developers/variants.py write FOLDER_WITH_REFERENCE_MODELS OUT     OUT/RUN.feb, one per run of FEBio
    febio4 -i OUT/RUN.feb -p OUT/RUN.xplt                       each; needs a linear solver for unsymmetric matrices
    docs/developers/variants.py cut FOLDER_WITH_REFERENCE_MODELS OUT       OUT/RUN_CASE.feb and .xplt for every case of every run that is there

The cases of a run share a mesh and differ in the contact's penalty and the load: FEBio goes from one to the next with load curves, which
takes a few iterations each. Nothing in these models remembers (elastic, no friction), so the order does not matter. RUN_CASE.feb is the
model as it would be for that case alone.
"""
import itertools
import math
import os
import re
import struct
import sys

# run: model, change of the mesh, steps of the seating, cases: name, penalty, share of the load; no name: only on the way to the next.
# The penalty of FEBio's "auto penalty" is relative to an element's thickness: meshes with twice the elements have half of it, to be alike.
RUNS = {
    "hip_walking": ("hip_walking", {}, 10, [("penalty20", 20, 1), ("penalty50", 50, 1), ("load50", 50, 0.5), ("load20", 50, 0.2), ("", 50, 1),
                                            ("penalty100", 100, 1), ("penalty200", 200, 1), ("penalty400", 400, 1)]),
    "hip_walking_4deep": ("hip_walking", {"refine": "thickness"}, 10, [("penalty20", 10, 1), ("penalty50", 25, 1)]),
    "hip_walking_coarse": ("hip_walking", {"coarsen": (2, 1)}, 10, [("penalty20", 20, 1), ("penalty50", 50, 1)]),
    "hip_walking_coarse4deep": ("hip_walking", {"coarsen": (2, 1), "refine": "thickness"}, 10, [("penalty20", 10, 1), ("penalty50", 25, 1)]),
    "ball_tight": ("ball_tight", {}, 10, [("penalty30", 30, 1), ("penalty10", 10, 1), ("", 30, 1), ("penalty100", 100, 1), ("penalty300", 300, 1)]),
    "ball_loose": ("ball_loose", {}, 10, [("penalty30", 30, 1), ("penalty10", 10, 1), ("penalty100", 100, 1), ("penalty300", 300, 1)]),
    "ball_tight_13x2": ("ball_tight", {"coarsen": (2, 2)}, 5, [("penalty30", 60, 1)]),
    "ball_tight_13x4": ("ball_tight", {"coarsen": (2, 1)}, 8, [("penalty30", 30, 1)]),
    "ball_tight_26x2": ("ball_tight", {"coarsen": (1, 2)}, 5, [("penalty30", 60, 1)]),
    "ball_tight_52x2": ("ball_tight", {"coarsen": (1, 2), "refine": "plane"}, 5, [("penalty30", 60, 1)]),
    "ball_loose_15x2": ("ball_loose", {"coarsen": (2, 2)}, 5, [("penalty30", 60, 1)]),
    "ball_loose_15x4": ("ball_loose", {"coarsen": (2, 1)}, 5, [("penalty30", 30, 1)]),
    "ball_loose_15x4_nu0.3": ("ball_loose", {"coarsen": (2, 1), "nu": 0.3}, 5, [("penalty30", 30, 1)]),
    "ball_loose_15x4_nu0.49": ("ball_loose", {"coarsen": (2, 1), "nu": 0.49}, 5, [("penalty30", 30, 1)]),
    "ball_tight_small": ("ball_tight", {"gap": 0.1}, 5, [("penalty30", 30, 1), ("penalty10", 10, 1)]),
    "ball_tight_small_13x4": ("ball_tight", {"gap": 0.1, "coarsen": (2, 1)}, 10, [("penalty30", 30, 1)]),
    "ball_loose_small_15x4": ("ball_loose", {"gap": 0.1, "coarsen": (2, 1)}, 10, [("penalty30", 30, 1)]),
}
BALLS = {"ball_tight": 25.0, "ball_loose": 30.0}  # radius of the socket; the ball's is 24, 0.02 apart
SEATING = "ball_tight_13x2", "ball_tight_26x2", "ball_tight_52x2"  # their state at 0.8 of the seating is cut out, too: RUN_seating80.xplt
GRIDS = {"ball_tight": [(27, 27)] * 2, "ball_loose": [(31, 31)] * 2, "hip_walking": [(53, 53), (49, 19)]}  # nodes of each part's layers


def replace(pattern, text, new):
    text, count = re.subn(pattern, new, text, flags=re.S)
    assert count, pattern
    return text


def rows(body): return [(int(i), v.split(",")) for i, v in re.findall(r'<\w+ id="(\d+)">([^<]*)<', body)]
def parts(text): return re.findall(r'<Nodes name="(\w+)"', text)
def section(text, tag, name): return re.search(r'<%s [^>]*name="%s">(.*?)</%s>' % (tag, name, tag), text, re.S).group(1)
def nodes_of(text, part): return {i: tuple(map(float, v)) for i, v in rows(section(text, "Nodes", part))}


def rebuild(text, place, new_nodes, hexes, quads):
    """The mesh with other nodes. `place`: the old nodes that a new one lies between -> its number; `hexes`, `quads`: an old element's new ones."""
    for part, nodes in new_nodes.items():
        lines = "".join('\t\t\t<node id="%d">%.10g,%.10g,%.10g</node>\n' % (i, *x) for i, x in sorted(nodes.items()))
        text = replace(r'(<Nodes name="%s">).*?(</Nodes>)' % part, text, lambda m: m.group(1) + "\n" + lines + "\t\t" + m.group(2))

    def written(body, tag, numbers):
        lines = ""
        for _, old in rows(body):
            old = tuple(map(int, old))
            for new in (hexes if len(old) == 8 else quads)(old):
                lines += '\t\t\t<%s id="%d">%s</%s>\n' % (tag, next(numbers), ",".join(map(str, new)), tag)
        return "\n" + lines + "\t\t"
    numbers = itertools.count(1)
    text = replace(r'(<Elements type="\w+" name="\w+">)(.*?)(</Elements>)', text, lambda m: m.group(1) + written(m.group(2), "elem", numbers) + m.group(3))
    text = replace(r'(<Surface name="\w+">)(.*?)(</Surface>)', text, lambda m: m.group(1) + written(m.group(2), "quad4", itertools.count(1)) + m.group(3))

    def node_set(m):
        old = set(map(int, m.group(2).split(",")))
        return m.group(1) + ",".join(str(i) for p, i in sorted(place.items(), key=lambda x: x[1]) if old.issuperset(p)) + m.group(3)
    return re.sub(r'(<NodeSet name="\w+">)([^<]*)(</NodeSet>)', node_set, text)


def centres(model):
    return {"ball_cartilage": 0.0, "socket_cartilage": 24.02 - BALLS[model]} if model in BALLS else {}


def refine(text, model, how):
    """Every hexahedron into 1x1x2 ("thickness") or 2x2x1 ("plane"); on balls new nodes lie on the old spheres."""
    old = {p: nodes_of(text, p) for p in parts(text)}
    part_of = {i: p for p, n in old.items() for i in n}
    centre, place, new_nodes = centres(model), {}, {p: {} for p in old}

    def node(*between):
        key = tuple(sorted(between))
        if key not in place:
            part = part_of[key[0]]
            points = [old[part][i] for i in key]
            x = [sum(p[k] for p in points) / len(key) for k in range(3)]
            if part in centre and len(key) > 1:
                c = (0, 0, centre[part])
                out = sum(math.dist(p, c) for p in points) / len(key) / math.dist(x, c)
                x = [c[k] + (x[k] - c[k]) * out for k in range(3)]
            place[key] = len(place) + 1
            new_nodes[part][place[key]] = x
        return place[key]

    def quads(q):
        if how == "thickness":
            return [[node(i) for i in q]]
        a, b, c, d = q
        g = [[node(a), node(a, b), node(b)], [node(a, d), node(*q), node(b, c)], [node(d), node(c, d), node(c)]]
        return [[g[r][k], g[r][k + 1], g[r + 1][k + 1], g[r + 1][k]] for r in (0, 1) for k in (0, 1)]

    def hexes(e):
        if how == "plane":
            return [low + high for low, high in zip(quads(e[:4]), quads(e[4:]))]
        middle = [node(a, b) for a, b in zip(e[:4], e[4:])]
        return [[node(i) for i in e[:4]] + middle, middle + [node(i) for i in e[4:]]]

    for part in old:  # numbered part by part
        for i in old[part]:
            node(i)
        for _, e in rows(section(text, "Elements", part)):
            hexes(tuple(map(int, e)))
    return rebuild(text, place, new_nodes, hexes, quads)


def coarsen(text, model, plane, thickness):
    """Every second node of the grids, in plane or through the thickness, as far as these are 2."""
    place, new_nodes, first = {}, {}, 1
    for part, (m, n) in zip(parts(text), GRIDS[model]):
        old = nodes_of(text, part)
        new_nodes[part] = {}
        for i, x in old.items():
            layer, row, column = (i - first) // (m * n), (i - first) // n % m, (i - first) % n
            if layer % thickness == 0 and row % plane == 0 and column % plane == 0:
                place[(i,)] = len(place) + 1
                new_nodes[part][place[(i,)]] = x
        first += len(old)

    def grown(start, corners): return [start + plane * (i - start) for i in corners]

    def kept(e): return [[place[(i,)] for i in e]] if all((i,) in place for i in e) else []
    def quads(q): return kept(grown(min(q), q)) if (min(q),) in place else []

    def hexes(e):
        low = grown(e[0], e[:4])
        return kept(low + [i + thickness * (e[4] - e[0]) for i in low])
    return rebuild(text, place, new_nodes, hexes, quads)


def shrink_gap(text, model, share):
    """Small strain, the same contact: the gap before loading times `share`, the moduli over it."""
    radius = BALLS[model]
    c, new_radius = centres(model)["socket_cartilage"], 24 + (radius - 24) * share
    c_new = 24 + 0.02 * share - new_radius
    nodes = {}
    for i, x in nodes_of(text, "socket_cartilage").items():
        r = math.dist(x, (0, 0, c))
        f = (r - radius + new_radius) / r
        nodes[i] = (x[0] * f, x[1] * f, c_new + (x[2] - c) * f)
    lines = "".join('\t\t\t<node id="%d">%.10g,%.10g,%.10g</node>\n' % (i, *x) for i, x in nodes.items())
    text = replace(r'(<Nodes name="socket_cartilage">).*?(</Nodes>)', text, lambda m: m.group(1) + "\n" + lines + "\t\t" + m.group(2))
    text = replace(r"<E>([^<]*)<", text, lambda m: "<E>%.8g<" % (float(m.group(1)) / share))
    return replace(r'(type="rigid_displacement">.*?<value lc="1">)([^<]*)<', text, lambda m: "%s%.8g<" % (m.group(1), float(m.group(2)) * share))


def changed(text, model, mesh):
    if "nu" in mesh:
        text = replace(r"<v>[^<]*<", text, "<v>%g<" % mesh["nu"])
    if "gap" in mesh:
        text = shrink_gap(text, model, mesh["gap"])
    if "coarsen" in mesh:
        text = coarsen(text, model, *mesh["coarsen"])
    if "refine" in mesh:
        text = refine(text, model, mesh["refine"])
    return text


def with_case(text, penalty, load):
    text = replace(r"<penalty>[^<]*<", text, "<penalty>%g<" % penalty)
    return replace(r'(<rigid_load.*?<value lc="1">)([^<]*)<', text, lambda m: "%s%.10g<" % (m.group(1), float(m.group(2)) * load))


def with_cases(text, steps, cases):
    """One run through all cases: the first at time 2, the next at 3, ..."""
    def curve(number, name, points, shape="LINEAR"):
        return ('\t\t<load_controller id="%d" name="%s" type="loadcurve"><interpolate>%s</interpolate><extend>CONSTANT</extend>'
                '<points>%s</points></load_controller>\n'
                % (number, name, shape, "".join("<pt>%g,%g</pt>" % p for p in points)))
    text = replace(r"<time_steps>20<", text, "<time_steps>%d<" % steps)
    text = replace(r"<(step_size|dtmax)>0.05<", text, lambda m: "<%s>%.10g<" % (m.group(1), 1 / steps))
    text = replace(r"<time_steps>2<", text, "<time_steps>%d<" % len(cases))
    text = replace(r"<step_size>0.5<", text, "<step_size>1<")
    text = replace(r"<dtmax>0.5<", text, '<dtmax lc="3">1<')
    text = replace(r"<penalty>[^<]*<", text, '<penalty lc="2">1<')
    text = replace(r'(<rigid_load.*?<value lc=")1"', text, r'\g<1>4"')
    times = range(2, 2 + len(cases))
    curves = (curve(2, "penalty", [(0, cases[0][1])] + [(t, c[1]) for t, c in zip(times, cases)])
              + curve(3, "times to meet", [(t - 1, 1) for t in times] + [(times[-1], 1)], "STEP")
              + curve(4, "force", [(0, cases[0][2])] + [(t, c[2]) for t, c in zip(times, cases)]))
    return text.replace("\t</LoadData>", curves + "\t</LoadData>")


def states(data):
    """Time and place of every state of a plot file, and the end of what comes before them."""
    found, at, head = [], 4, None
    while at < len(data):
        ident, size = struct.unpack_from("<II", data, at)
        if ident == 0x02000000:
            head = head or at
            found.append((struct.unpack_from("<f", data, data.index(struct.pack("<II", 0x02010002, 4), at) + 8)[0], at, at + 8 + size))
        at += 8 + size
    return head, found


def main(what, reference, out):
    for run, (model, mesh, steps, cases) in RUNS.items():
        path = os.path.join(reference, model + ".feb")
        if not os.path.exists(path):
            continue
        plot = os.path.join(out, run + ".xplt")
        if what == "cut" and not os.path.exists(plot):
            continue
        with open(path) as f:
            text = changed(f.read(), model, mesh)
        if what == "write":
            with open(os.path.join(out, run + ".feb"), "w") as f:
                f.write(with_cases(text, steps, cases))
            continue
        with open(plot, "rb") as f:
            data = f.read()
        head, found = states(data)
        for time, (name, penalty, load) in [(0.8, ("seating80" if run in SEATING else "", 0, 0))] + list(enumerate(cases, 2)):
            span = next((s[1:] for s in found if abs(s[0] - time) < 1e-4), None)
            if not name or not span:
                continue
            with open(os.path.join(out, "%s_%s.xplt" % (run, name)), "wb") as f:
                f.write(data[:head] + data[span[0]:span[1]])
            if name == "seating80":
                continue
            with open(os.path.join(out, "%s_%s.feb" % (run, name)), "w") as f:
                f.write(with_case(text, penalty, load))


if __name__ == "__main__":
    if len(sys.argv) != 4 or sys.argv[1] not in ("write", "cut"):
        sys.exit(__doc__)
    main(*sys.argv[1:])
