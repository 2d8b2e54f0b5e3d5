#!/usr/bin/env python3
"""How far the fractions of docs/layer_law.md, section 8, follow the exact inside of a bonded layer. Standard library
only.

    docs/developers/inside.py          prints the tables of section 8: weights at the bone, errors per depth, errors under spheres
"""
import math

from kernel import BETA, solve

POWERS, SAMPLES, SHORTEST = 6, 64, 20.0
NAMES = ("normal", "s shear", "s^2 spread", "sinking")
ORDER = (0, 1, 2, 0)


def waves(nu, s, z):
    """What each of the four solutions adds to U, W, sigma_zz, sigma_xz; t = mu = 1."""
    k, a, b = 3 - 4 * nu, math.exp(s * (z - 1)), math.exp(-s * z)
    U = [-a, -(z + k / s) * a, b, (z - k / s) * b]
    W = [a, z * a, b, z * b]
    dU = [-s * a, -(1 + s * z + k) * a, -s * b, (1 - s * z + k) * b]
    dW = [s * a, (1 + s * z) * a, -s * b, (1 - s * z) * b]
    normal = [2 * w for w in dW]
    normal[1] -= 4 * nu * a
    normal[3] -= 4 * nu * b
    return U, W, normal, [u - s * w for u, w in zip(dU, W)]


def dot(a, b): return sum(x * y for x, y in zip(a, b))


def amplitudes(nu, s):
    base, top = waves(nu, s, 0), waves(nu, s, 1)
    return solve([base[0], base[1], top[2], top[3]], [0, 0, -1, 0])


def exact(nu, s, z, x=None):
    """normal, shear, spread, sinking (N1)"""
    x = x or amplitudes(nu, s)
    U, W, normal, shear = waves(nu, s, z)
    return -dot(normal, x), dot(shear, x) / s, dot(U, x) / s, -dot(W, x)


def limits(nu, z):
    g, m = nu / (1 - nu), (1 - 2 * nu) / (2 * (1 - nu))
    return 1, (1 - z) * g, g * (z - z * z / 2) - m * z * z / 2, z * m


def fractions(s):
    f = 1 / (1 + BETA[1] * s * s)
    return [1 / (1 + BETA[0] * s * s)] + [f ** k for k in range(1, POWERS + 1)]


def fit(nu, z):
    """Per function: local, weight of the first fraction, weights of the powers of the second (N2)."""
    if z == 1:
        fixed = {0: [1.0] + [0.0] * (POWERS + 1), 1: [0.0] * (POWERS + 2)}
    else:
        fixed = {2: [0.0] * (POWERS + 2), 3: [0.0] * (POWERS + 2)} if z == 0 else {}
    samples = [SHORTEST * ((i + 0.5) / SAMPLES) ** 2 for i in range(SAMPLES)]
    values = [exact(nu, s, z) for s in samples]
    out = []
    for j, order in enumerate(ORDER):
        if j in fixed:
            out.append(fixed[j])
            continue
        local = z > 0 and order == 0
        rows, right = [], []
        for s, value in zip(samples, values):
            w = math.sqrt(2 * math.sqrt(s * SHORTEST) / SAMPLES / (1 + s * s)) * s ** order
            f = fractions(s)
            rows.append([w * (x - f[0]) for x in f[1:]] + ([w * (1 - f[0])] if local else []))
            right.append(w * (value[j] - limits(nu, z)[j] * f[0]))
        n = len(rows[0])
        x = solve([[sum(r[a] * r[b] for r in rows) for b in range(n)] for a in range(n)],
                  [sum(r[a] * v for r, v in zip(rows, right)) for a in range(n)])
        out.append([x[POWERS] if local else 0.0, limits(nu, z)[j] - sum(x)] + x[:POWERS])
    return out


def law(weights, s): return weights[0] + dot(weights[1:], fractions(s))


def weights_table():
    print("| nu | of | q_0 | " + " | ".join("q_%d" % k for k in range(1, POWERS + 1)) + " |\n" + "|---" * (POWERS + 3) + "|")
    for nu in (0.0, 0.2, 0.3, 0.45, 0.49, 0.5):
        for name, w in zip(("normal", "shear"), fit(nu, 0.0)):
            print("| %s | %s | %s |" % ("%g" % nu if name == "normal" else "", name, " | ".join("%.3f" % x for x in w[1:])))


def error_table():
    grid = [0.02 * 1.03 ** i for i in range(234)]
    print("| zeta | nu | " + " | ".join(NAMES) + " |\n" + "|---" * 6 + "|")
    for z in (0.0, 0.25, 0.5, 0.75, 0.9, 1.0):
        for nu in (0.0, 0.2, 0.3, 0.45, 0.499):
            law_z, worst, most = fit(nu, z), [0.0] * 4, [0.0] * 4
            for s in grid:
                x = amplitudes(nu, s)
                here, base, top = exact(nu, s, z, x), exact(nu, s, 0, x), exact(nu, s, 1, x)
                for j, size in enumerate((1, base[1], top[2], top[3])):
                    worst[j] = max(worst[j], s ** ORDER[j] * abs(law(law_z[j], s) - here[j]))
                    most[j] = max(most[j], s ** ORDER[j] * abs(size))
            print("| %s | %g | %s |" % ("%g" % z if nu == 0 else "", nu,
                                        " | ".join("%.1f %%" % (100 * a / b) for a, b in zip(worst, most))))


# ---- under a pressure sqrt(1 - r^2/a^2)
def bessel(x):
    """J_0, J_1 by the trapezoidal rule, which converges like a power series."""
    n = int(x) + 24
    zero = one = 0.0
    for i in range(n):
        angle = math.pi * (i + 0.5) / n
        zero += math.cos(x * math.sin(angle))
        one += math.cos(angle - x * math.sin(angle))
    return zero / n, one / n


def measures(nu, normal, shear, across, hoop):
    """Greatest shear, first and third principal strain; mu = 1."""
    g, trace = nu / (1 - nu), across + hoop
    up = -normal * (1 - 2 * nu) / (2 * (1 - nu)) - g * trace
    sx, sy = (-g * normal + 2 * (e + g * trace) for e in (across, hoop))
    middle, half = (sx - normal) / 2, math.hypot((sx + normal) / 2, shear)
    e_middle, e_half = (across + up) / 2, math.hypot((across - up) / 2, shear / 2)
    return ((max(middle + half, sy) - min(middle - half, sy)) / 2, max(e_middle + e_half, hoop),
            min(e_middle - e_half, hoop))


def sphere_errors(nu, z, a):
    law_z, n, top = fit(nu, z), 240, 30.0
    ks = [top * ((i + 0.5) / n) ** 2 for i in range(n)]
    radii = [(max(a, 0.7) * 2.4) * i / 24 for i in range(25)]
    sums = [[[0.0] * 4 for _ in radii] for _ in range(2)]
    for i, s in enumerate(ks):
        x = s * a
        share = a * a * (math.sin(x) - x * math.cos(x)) / x ** 3 * s * top * 2 * (i + 0.5) / n / n
        both = exact(nu, s, z), [law(w, s) for w in law_z]
        for r, *rows in zip(radii, *sums):
            zero, one = bessel(s * r)
            for row, f in zip(rows, both):
                row[0] += share * f[0] * zero
                row[1] += share * s * f[1] * one
                row[2] += share * s * s * f[2] * zero
                row[3] += share * s * s * f[2] * (one / (s * r) if r > 0 else 0.5)
    found = [[(v[0], v[1]) + measures(nu, v[0], v[1], v[2] - v[3], v[3]) for v in rows] for rows in sums]
    errors = []
    for k in range(5):
        most = max(abs(row[k]) for row in found[0])
        errors.append(max(abs(x[k] - y[k]) for x, y in zip(*found)) / most if most > 1e-9 else 0.0)
    return errors


def sphere_table():
    widths = (0.5, 1, 2, 4)
    print("| zeta | nu | " + " | ".join("a/t = %g" % a for a in widths) + " |\n" + "|---" * (2 + len(widths)) + "|")
    for z in (0.0, 0.25, 0.5, 0.75, 1.0):
        for nu in (0.0, 0.3, 0.45, 0.499):
            cells = [", ".join("%.1f" % (100 * e) for e in sphere_errors(nu, z, a)) for a in widths]
            print("| %s | %g | %s |" % ("%g" % z if nu == 0 else "", nu, " | ".join(cells)))


if __name__ == "__main__":
    for table in (weights_table, error_table, sphere_table):
        table()
        print()
