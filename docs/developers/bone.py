#!/usr/bin/env python3
"""How far the surface of a bonded layer feels a step of the bone: the tables of docs/layer_law.md, section 3, and 7.

    docs/developers/bone.py

A layer of thickness 1 under an even pressure p sinks by p/M. Where its bone (or its face) is moved by eps cos(s x), the surface sinks by f(s) eps p/M more, to
first order. Bone: f is what moves the top of a layer without load whose base is moved by cos(s x). Face: p/M of strain there acts as a shear of the top.
Chebyshev collocation through the thickness. Standard library only.
"""
import math

from kernel import BETA, solve


def chebyshev(n):
    """Points from 1 to -1, and the matrix that differentiates values at them."""
    x = [math.cos(math.pi * i / n) for i in range(n + 1)]
    c = [(2 if i in (0, n) else 1) * (-1) ** i for i in range(n + 1)]
    d = [[0.0 if i == j else c[i] / c[j] / (x[i] - x[j]) for j in range(n + 1)] for i in range(n + 1)]
    for i in range(n + 1):
        d[i][i] = -sum(d[i])
    return d


def top(nu, s, base, shear, n=24):
    """w at the top of a layer, u = U sin(s x), w = W cos(s x): w at the base, u' - s w at the top given, G = 1."""
    m = n + 1
    lame = 2 * nu / (1 - 2 * nu)
    d = [[2 * v for v in row] for row in chebyshev(n)]  # thickness 1
    d2 = [[sum(d[i][k] * d[k][j] for k in range(m)) for j in range(m)] for i in range(m)]
    rows, values = [], []
    for i in range(m):
        if i == 0:
            rows.append([d[0][j] for j in range(m)] + [-s if j == 0 else 0.0 for j in range(m)])
            values.append(shear)
        elif i == n:
            rows.append([1.0 if j == n else 0.0 for j in range(2 * m)])
            values.append(0.0)
        else:
            rows.append([d2[i][j] - (lame + 2) * s * s * (i == j) for j in range(m)]
                        + [-(lame + 1) * s * d[i][j] for j in range(m)])
            values.append(0.0)
    for i in range(m):
        if i == 0:
            rows.append([lame * s if j == 0 else 0.0 for j in range(m)] + [(lame + 2) * d[0][j] for j in range(m)])
            values.append(0.0)
        elif i == n:
            rows.append([1.0 if j == m + n else 0.0 for j in range(2 * m)])
            values.append(base)
        else:
            rows.append([(lame + 1) * s * d[i][j] for j in range(m)]
                        + [(lame + 2) * d2[i][j] - s * s * (i == j) for j in range(m)])
            values.append(0.0)
    return solve(rows, values)[m]


def main():
    waves = (0.25, 0.5, 1, 1.5, 2, 3, 5)
    print('| f at s = | ' + ' | '.join('%g' % s for s in waves) + ' |')
    print('|---' * (len(waves) + 1) + '|')
    for name, f in (('bone', lambda nu, s: top(nu, s, 1.0, 0.0)), ('face', lambda nu, s: 1 - top(nu, s, 0.0, -2 * s))):
        for nu in (0.0, 0.3, 0.45, 0.49):
            print('| %s, nu = %g | ' % (name, nu) + ' | '.join('%.2f' % f(nu, s) for s in waves) + ' |')
    print('| 1/(1 + %g s^2) | ' % BETA[1] + ' | '.join('%.2f' % (1 / (1 + BETA[1] * s * s)) for s in waves) + ' |')


if __name__ == '__main__':
    main()
