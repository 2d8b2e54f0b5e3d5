#!/usr/bin/env python3
"""Greatest shear in two plot files of one mesh, by the distance from the surface's free rim: the last table of
docs/layer_law.md, section 8. Standard library only; hexes, uncompressed files, last states.

    docs/developers/inside_rims.py DEA.xplt FEA.xplt SURFACE      DEA's with --inside, FEA's with `stress`
"""
import math
import sys

from xplt_reader import PlotFile, cross, dot, sub

# Opposite faces of a hex.
FACES = (((0, 1, 5, 4), (3, 2, 6, 7)), ((1, 2, 6, 5), (0, 3, 7, 4)), ((0, 3, 2, 1), (4, 7, 6, 5)))


def hexes(plot):
    """(domain, place in it) -> nodes."""
    found = {}
    for domain, (_, span) in enumerate(plot.chunks(plot.child(plot.mesh, 0x01042000)), 1):
        if plot.ints(plot.child(plot.child(span, 0x01042101), 0x01042102)) != (0,):
            continue
        for place, (_, element) in enumerate(plot.chunks(plot.child(span, 0x01042200))):
            found[domain, place] = plot.ints(element)[1:]
    return found


def columns(elements, facets):
    """Per facet the elements under it, the first one first."""
    at_face = {}
    for element, nodes in elements.items():
        for face in (f for pair in FACES for f in pair):
            at_face.setdefault(frozenset(nodes[i] for i in face), []).append(element)
    for facet in facets:
        column, key = [], frozenset(facet)
        while next_one := [e for e in at_face.get(key, []) if e not in column]:
            column.append(next_one[0])
            both = [[frozenset(elements[column[-1]][i] for i in face) for face in pair] for pair in FACES]
            key = next(b if a == key else a for a, b in both if key in (a, b))
        yield column


def max_shear(t):
    """Half the difference of the outer eigenvalues of xx yy zz xy yz xz, in closed form."""
    mean = sum(t[:3]) / 3
    a, b, c, d, e, f = [x - mean for x in t[:3]] + list(t[3:])
    size = math.sqrt((a * a + b * b + c * c + 2 * (d * d + e * e + f * f)) / 6)
    if size == 0:
        return 0.0
    det = (a * (b * c - e * e) - d * (d * c - e * f) + f * (d * e - b * f)) / size ** 3
    angle = math.acos(max(-1.0, min(1.0, det / 2))) / 3
    return size * (math.cos(angle) - math.cos(angle + 2 * math.pi / 3))


def volume(x):
    total = 0.0
    for pair in FACES:
        for sign, face in zip((1, -1), pair):
            p, q, r, s = (sub(x[i], x[0]) for i in face)
            total += sign * (dot(p, cross(q, r)) + dot(p, cross(r, s))) / 6
    return abs(total)


def p99(values, weights):
    """As percentile.h: each value in the middle of its share, linear between."""
    order, total, done, before = sorted(zip(values, weights)), sum(weights), 0.0, None
    for value, weight in order:
        place = (done + weight / 2) / total
        if place >= 0.99 and before:
            return before[1] + (value - before[1]) * (0.99 - before[0]) / (place - before[0])
        before, done = (place, value), done + weight
    return before[1]


def numbers(a, b, w):
    mean = [sum(x * y for x, y in zip(v, w)) / sum(w) for v in (a, b)]
    product = lambda u, v, m, n: sum(z * (x - m) * (y - n) for x, y, z in zip(u, v, w))
    r = product(a, b, *mean) / math.sqrt(product(a, a, mean[0], mean[0]) * product(b, b, mean[1], mean[1]))
    return "%.3f, %+.0f %%, %+.0f %%" % (r, 100 * (p99(a, w) / p99(b, w) - 1), 100 * (mean[0] / mean[1] - 1))


def main():
    dea, fea, name = PlotFile(sys.argv[1]), PlotFile(sys.argv[2]), sys.argv[3]
    facets, pressure = dea.surface(name)
    _, thickness = dea.surface(name, "cartilage thickness")
    elements = hexes(dea)
    stress = [{d: p.values(0x01024000, 0x02020400, "stress", d) for d in {d for d, _ in elements}} for p in (dea, fea)]
    edges = {}
    for facet in facets:
        for i, node in enumerate(facet):
            edges.setdefault(frozenset((node, facet[i - 1])), []).append(facet)
    middle = lambda nodes: tuple(sum(dea.reference[n][k] for n in nodes) / len(nodes) for k in range(3))
    rim = [middle(edge) for edge, of in edges.items() if len(of) == 1]
    above = 0.05 * sum(p * p for p in pressure) / sum(pressure)
    places = []
    for facet, p, column, i in zip(facets, pressure, columns(elements, facets), range(len(facets))):
        if p > above and column:
            t = sum(thickness[4 * i:4 * i + 4]) / 4
            places.append((min(math.dist(middle(facet), x) for x in rim) / t, column))
    print("| further from the rim than | elements | row at the bone | row at the surface |\n|---|---|---|---|")
    for least in (0, 1, 2, 3):
        cells, chosen = [], [column for distance, column in places if distance >= least]
        for row in (-1, 0):
            of = [column[row] for column in chosen]
            a, b = ([max_shear(s[d][6 * e:6 * e + 6]) for d, e in of] for s in stress)
            cells.append(numbers(a, b, [volume([dea.reference[n] for n in elements[e]]) for e in of]))
        print("| %s | %d | %s |" % ("%d t" % least if least else "everywhere", len(chosen), " | ".join(cells)))


if __name__ == "__main__":
    main()
