#!/usr/bin/env python3
"""How far the laws of docs/layer_law.md follow the exact response of a bonded layer (L1). Standard library only.

    docs/developers/kernel.py                 prints the table of section 2, and the weights behind it
    docs/developers/kernel.py -o kernel.svg   draws the figure
"""
import math
import sys


def solve(rows, values):
    """Gauss with pivots."""
    a = [list(r) + [v] for r, v in zip(rows, values)]
    n = len(a)
    for k in range(n):
        pivot = max(range(k, n), key=lambda i: abs(a[i][k]))
        a[k], a[pivot] = a[pivot], a[k]
        for i in range(n):
            if i != k:
                f = a[i][k] / a[k][k]
                a[i] = [x - f * y for x, y in zip(a[i], a[k])]
    return [a[k][n] / a[k][k] for k in range(n)]


# All compliances times E: functions of nu and s alone.
def exact(nu, s):
    """(L1), for s >= 0.01."""
    n = 3 - 4 * nu
    d = math.exp(-2 * s)  # numerator and denominator times 2 exp(-2s)
    return (2 * (1 - nu * nu) / s * (n * (1 - d * d) - 4 * s * d)
            / (n * (1 + d * d) + 2 * d * (2 * s * s + 5 - 12 * nu + 8 * nu * nu)))


def spring(nu): return (1 + nu) * (1 - 2 * nu) / (1 - nu)
def first(nu): return nu * (4 * nu - 1) * (1 + nu) / (3 * (1 - nu) ** 2)


def one_term(nu):
    beta = 1.0
    if nu >= 0.3:
        beta -= (3 - 4 * nu) * (4 * nu * nu + 2 * nu - 1) / (20 * nu * (4 * nu - 1))
    beta /= 1 - nu
    weight = -first(nu) / beta
    return lambda s: spring(nu) - weight + weight / (1 + beta * s * s)


BETA, MATCHED = (2.0, 0.155), (2.0, 9.0)


def weights(nu):
    """local, weight_0, weight_1, square (L2b)"""
    rows, values = [[1, 1, 1, 1], [0, -BETA[0], -BETA[1], -2 * BETA[1]]], [spring(nu), first(nu)]
    for s in MATCHED:
        f = 1 / (1 + BETA[1] * s * s)
        rows.append([1, 1 / (1 + BETA[0] * s * s), f, f * f])
        values.append(exact(nu, s))
    return solve(rows, values)


def two_terms(nu):
    local, w0, w1, square = weights(nu)

    def law(s):
        f = 1 / (1 + BETA[1] * s * s)
        return local + w0 / (1 + BETA[0] * s * s) + w1 * f + square * f * f
    return law


def table():
    ends = (1, 2, 3, 5, 10, 20)
    print("| nu | law | " + " | ".join("s <= %g" % e for e in ends) + " |\n" + "|---" * (len(ends) + 2) + "|")
    for nu in (-0.5, 0.0, 0.2, 0.3, 0.4, 0.45, 0.49, 0.5):
        for name, law in (("one term", one_term(nu)), ("two terms", two_terms(nu))):
            cells = []
            for end in ends:
                worst = max(abs(law(k / 100) / exact(nu, k / 100) - 1) for k in range(1, 100 * end + 1))
                cells.append("%.*f %%" % (0 if worst > 0.1 else 1 if worst > 0.01 else 2, 100 * worst))
            print("| %s | %s | %s |" % ("%g" % nu if name == "one term" else "", name, " | ".join(cells)))
    print("\n| nu | E/M | E local | E weight_0 | E weight_1 | E square | greatest / local |\n" + "|---" * 7 + "|")
    for nu in (-0.5, 0.0, 0.2, 0.3, 0.4, 0.45, 0.49, 0.5):
        law, w = two_terms(nu), weights(nu)
        top = max(law(k / 100) for k in range(0, 2000))
        print("| %g | %s | %.1f |" % (nu, " | ".join("%.4f" % x for x in [spring(nu)] + w), top / w[0]))


# ---- the figure
LEFT, TOP, WIDE, HIGH, STEP = 62, 44, 252, 250, 278
S_LOW, S_HIGH, W_HIGH = 0.1, 30.0, 1.0
STYLES = [("exact (L1)", 'stroke="#b9c6d6" stroke-width="7"'), ("two terms", 'stroke="#0b3c6f" stroke-width="1.8"'),
          ("one term", 'stroke="#c2410c" stroke-width="1.8" stroke-dasharray="7 4"'),
          ("spring", 'stroke="#555" stroke-width="1.6" stroke-dasharray="2 3"')]


def draw(path):
    out = []

    def text(x, y, words, more=""): out.append('<text x="%.1f" y="%.1f" %s>%s</text>' % (x, y, more, words))
    middle = 'text-anchor="middle"'
    for panel, nu in enumerate((0.3, 0.45, 0.49)):
        x0 = LEFT + panel * STEP

        def place(s, w): return (x0 + WIDE * math.log(s / S_LOW) / math.log(S_HIGH / S_LOW), TOP + HIGH * (1 - w / W_HIGH))
        for w in (0, 0.2, 0.4, 0.6, 0.8, 1.0):
            y = place(1, w)[1]
            out.append('<path d="M%d %.1fh%d" stroke="#e3e3e8"/>' % (x0, y, WIDE))
            if panel == 0:
                text(x0 - 8, y + 4.5, "%.1f" % w, 'text-anchor="end"')
        for s in (0.1, 0.2, 0.5, 1, 2, 5, 10, 20):
            x = place(s, 0)[0]
            out.append('<path d="M%.1f %dv%d" stroke="#e3e3e8"/><path d="M%.1f %dv5" stroke="#444"/>' % (x, TOP, HIGH, x, TOP + HIGH))
            text(x, TOP + HIGH + 20, "%g" % s, middle)
        grid = [S_LOW * (S_HIGH / S_LOW) ** (k / 200) for k in range(201)]
        laws = [lambda s: exact(nu, s), two_terms(nu), one_term(nu), lambda s: spring(nu)]
        for law, (_, style) in zip(laws, STYLES):
            points = " ".join("%.1f,%.1f" % place(s, law(s)) for s in grid)
            out.append('<polyline points="%s" fill="none" stroke-linejoin="round" %s/>' % (points, style))
        for s in MATCHED:
            out.append('<circle cx="%.1f" cy="%.1f" r="3.6" fill="#fff" stroke="#0b3c6f" stroke-width="1.6"/>' % place(s, exact(nu, s)))
        out.append('<rect x="%d" y="%d" width="%d" height="%d" fill="none" stroke="#444"/>' % (x0, TOP, WIDE, HIGH))
        text(x0 + WIDE / 2, TOP - 12, "&#957; = %g" % nu, middle + ' font-weight="bold"')
    total = LEFT + 2 * STEP + WIDE + 18
    text(LEFT + STEP + WIDE / 2, TOP + HIGH + 44, "s = 2&#960; &#215; thickness / wavelength of the pressure", middle)
    text(0, 0, "compliance  E w / (p t)", 'transform="translate(20 %d) rotate(-90)" %s' % (TOP + HIGH / 2, middle))
    x = LEFT + 74
    y = TOP + HIGH + 72
    for name, style in STYLES:
        out.append('<path d="M%d %dh38" fill="none" %s/>' % (x, y - 5, style))
        if name == "two terms":
            out.append('<circle cx="%d" cy="%d" r="3.6" fill="#fff" stroke="#0b3c6f" stroke-width="1.6"/>' % (x + 19, y - 5))
            name += " (circles: matched)"
        text(x + 46, y, name)
        x += 78 + 7.6 * len(name)
    with open(path, "w") as f:
        f.write('<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 %d %d" font-family="sans-serif" font-size="14">'
                '<rect width="100%%" height="100%%" fill="#fff"/>%s</svg>\n' % (total, y + 16, "".join(out)))


if __name__ == "__main__":
    if len(sys.argv) == 3 and sys.argv[1] == "-o":
        draw(sys.argv[2])
    elif len(sys.argv) == 1:
        table()
    else:
        sys.exit(__doc__)
