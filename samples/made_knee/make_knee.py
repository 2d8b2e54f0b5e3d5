#!/usr/bin/env python3
"""A made right knee for dea build: surfaces of two bones and their cartilage, ligaments, flexion.

make_knee.py [FOLDER] [--apart]    --apart: the femur's cartilage in two pieces, one on each condyle

x lateral, y forwards, z upwards; mm. The flexion axis is x, through the origin: the femur is a surface of revolution about it, with
condyles of 24 (medial) and 22 mm. The tibia's medial plateau is dished, the lateral one is convex from front to back.
"""
import math
import pathlib
import sys

MEDIAL, LATERAL = -23.0, 23.0  # x of both compartments
RADIUS = {MEDIAL: 24.0, LATERAL: 22.0}  # of the condyles' bone
FEMORAL, TIBIAL = 2.0, {MEDIAL: 2.5, LATERAL: 2.8}  # thickness of the cartilage
GAP = 0.1  # between both cartilages at time 0
RIM = 5.0  # over which cartilage thins out towards its edge


def mixed(x, medial, lateral):
    """From the medial value to the lateral one over the middle 16 mm."""
    t = min(1.0, max(0.0, (x + 8) / 16))
    return medial + (lateral - medial) * t * t * (3 - 2 * t)


def femur_radius(x):
    """Crests at both compartments, 6 mm less between them and beside them."""
    wave = (1 - math.cos(2 * math.pi * (x - MEDIAL) / (LATERAL - MEDIAL))) / 2
    return mixed(x, RADIUS[MEDIAL], RADIUS[LATERAL]) - 6 * wave


def femur_point(x, angle, outwards=0.0):
    """`angle`: from downwards, > 0 to the front. `outwards`: along the normal."""
    slope = (femur_radius(x + 1e-3) - femur_radius(x - 1e-3)) / 2e-3
    along = outwards / math.hypot(1, slope)
    r = femur_radius(x) + along
    return (x - slope * along, r * math.sin(angle), -r * math.cos(angle))


def plateau(x, y):
    """Height of the tibial cartilage's surface, without its rim."""
    medial = -(RADIUS[MEDIAL] + FEMORAL + GAP) + (x - MEDIAL) ** 2 / 160 + y * y / 80
    lateral = -(RADIUS[LATERAL] + FEMORAL + GAP) + (x - LATERAL) ** 2 / 400 - y * y / 240
    return mixed(x, medial, lateral) + 2 * math.exp(-(x / 6) ** 2)


def tibia_height(x, y):
    return plateau(x, y) - mixed(x, TIBIAL[MEDIAL], TIBIAL[LATERAL])


def tibia_point(x, y, outwards=0.0):
    """`outwards`: along the normal."""
    slope = [(tibia_height(x + dx, y + dy) - tibia_height(x - dx, y - dy)) / 2e-3 for dx, dy in ((1e-3, 0), (0, 1e-3))]
    along = outwards / math.hypot(1, *slope)
    return (x - slope[0] * along, y - slope[1] * along, tibia_height(x, y) + along)


def thinned(thickness, to_edge):
    """Cartilage thins out to a tenth at its edge."""
    t = min(1.0, max(0.0, to_edge / RIM))
    return thickness * (0.1 + 0.9 * t * (2 - t))


def shell(rows, inner, outer):
    """Closed, between two grids of points with the same rows; seen from outside `outer` the rows are counter-clockwise."""
    def sheet(grid):
        out = []
        for a, b in zip(grid, grid[1:]):
            for i in range(len(a) - 1):
                out += [(a[i], a[i + 1], b[i + 1]), (a[i], b[i + 1], b[i])]
        return out

    edge = [(0, i) for i in range(len(rows[0]))] + [(j, -1) for j in range(1, len(rows))]
    edge += [(-1, i) for i in range(len(rows[0]) - 2, -1, -1)] + [(j, 0) for j in range(len(rows) - 2, -1, -1)]
    out = sheet(outer) + [t[::-1] for t in sheet(inner)]
    for (j, i), (l, k) in zip(edge, edge[1:]):
        a, b, c, d = inner[j][i], inner[l][k], outer[l][k], outer[j][i]
        out += [(a, b, c), (a, c, d)]
    return out


def femur():
    around, along = 80, 41
    xs = [-40 + 80 * i / (along - 1) for i in range(along)]
    rings = [[femur_point(x, 2 * math.pi * k / around) for k in range(around)] for x in xs]
    out = []
    for a, b in zip(rings, rings[1:]):
        for k in range(around):
            n = (k + 1) % around
            out += [(a[k], b[n], b[k]), (a[k], a[n], b[n])]
    for ring, end in ((rings[0], -1), (rings[-1], 1)):
        middle = (ring[0][0], 0.0, 0.0)
        for k in range(around):
            t = (middle, ring[k], ring[(k + 1) % around])
            out.append(t if end > 0 else t[::-1])
    return out


def femoral_cartilage(first=-37.0, last=37.0):
    along, around = max(2, round((last - first) / 1.6)), 84
    low, high = math.radians(-100), math.radians(80)
    xs = [first + (last - first) * i / along for i in range(along + 1)]
    angles = [low + (high - low) * k / around for k in range(around + 1)]

    def thickness(x, angle):
        return thinned(FEMORAL, min(x - first, last - x, (angle - low) * 20, (high - angle) * 20))

    rows = [[(x, angle) for angle in angles] for x in xs]
    inner = [[femur_point(*p) for p in row] for row in rows]
    outer = [[femur_point(*p, thickness(*p)) for p in row] for row in rows]
    return shell(rows, inner, outer)


def tibia():
    rings, around, end = 22, 96, -75.0
    outline = [(38 * math.cos(2 * math.pi * k / around), 25 * math.sin(2 * math.pi * k / around)) for k in range(around)]
    grid = [[(x * i / rings, y * i / rings) for x, y in outline] for i in range(1, rings + 1)]

    def disc(height):
        out = []
        for k in range(around):
            n = (k + 1) % around
            out.append(((0.0, 0.0, height(0, 0)), (*grid[0][k], height(*grid[0][k])), (*grid[0][n], height(*grid[0][n]))))
            for a, b in zip(grid, grid[1:]):
                p = [(*q, height(*q)) for q in (a[k], b[k], b[n], a[n])]
                out += [(p[0], p[1], p[2]), (p[0], p[2], p[3])]
        return out

    out = disc(tibia_height) + [t[::-1] for t in disc(lambda x, y: end)]
    for k in range(around):
        a, b = grid[-1][k], grid[-1][(k + 1) % around]
        top_a, top_b = (*a, tibia_height(*a)), (*b, tibia_height(*b))
        out += [((*a, end), (*b, end), top_b), ((*a, end), top_b, top_a)]
    return out


def plateau_cartilage(middle):
    """Half axes of 12.5 and 19 mm; its grid is a square that is bent to an ellipse."""
    n = 28

    def place(i, j):
        u, v = 2 * i / n - 1, 2 * j / n - 1
        return (middle + 12.5 * u * math.sqrt(1 - v * v / 2), 19 * v * math.sqrt(1 - u * u / 2))

    rows = [[place(i, j) for i in range(n + 1)] for j in range(n + 1)]

    def thickness(x, y):
        return thinned(TIBIAL[middle], (1 - math.hypot((x - middle) / 12.5, y / 19)) * 12.5)

    inner = [[tibia_point(x, y) for x, y in row] for row in rows]
    outer = [[tibia_point(x, y, thickness(x, y)) for x, y in row] for row in rows]
    return shell(rows, inner, outer)


# Stiffness [N per strain] and strain with the knee straight, as knee models take them from Blankevoort et al. (1991), J Biomech 24:1019-1031.
# Where they are fastened is made up to fit these bones.
LIGAMENTS = """name,body_a,x_a,y_a,z_a,body_b,x_b,y_b,z_b,stiffness [N],reference_strain
ACL_anterior,femur,8,-3,4,tibia,-2,12,-25,5000,0.06
ACL_posterior,femur,8,-8,3,tibia,1,6,-25,5000,0.1
PCL_anterior,femur,-6,6,-8,tibia,-2,-22,-34,9000,-0.24
PCL_posterior,femur,-7,1,-5,tibia,2,-22,-36,9000,-0.03
LCL_anterior,femur,42,2,3,tibia,40,-10,-50,2000,-0.25
LCL_superior,femur,42,0,4,tibia,40,-13,-50,2000,-0.05
LCL_posterior,femur,42,-2,3,tibia,40,-16,-50,2000,0.08
MCL_anterior,femur,-42,3,0,tibia,-36,10,-72,2750,0.04
MCL_inferior,femur,-42,0,-2,tibia,-36,5,-72,2750,0.04
MCL_posterior,femur,-42,-3,0,tibia,-36,0,-70,2750,0.03
capsule_medial,femur,-24,-25,4,tibia,-22,-22,-40,1000,0.08
capsule_lateral,femur,24,-23,4,tibia,22,-22,-40,1000,0.06
"""
FLEXION = "time,tx,ty,tz,rx,ry,rz\n0,0,0,0,0,0,0\n15,0,0,0,15,0,0\n30,0,0,0,30,0,0\n"


def stl(triangles):
    lines = ["solid knee"]
    for t in triangles:
        lines += ["facet normal 0 0 0", "outer loop", *("vertex %.7g %.7g %.7g" % p for p in t), "endloop", "endfacet"]
    return "\n".join([*lines, "endsolid knee", ""])


def files(apart=False):
    """Names and texts."""
    cartilage = femoral_cartilage(-37, -9) + femoral_cartilage(9, 37) if apart else femoral_cartilage()
    return {
        "knee_femur.stl": stl(femur()),
        "knee_tibia.stl": stl(tibia()),
        "knee_femoral_cartilage.stl": stl(cartilage),
        "knee_tibial_cartilage.stl": stl(plateau_cartilage(MEDIAL) + plateau_cartilage(LATERAL)),
        "knee_ligaments.csv": LIGAMENTS,
        "knee_flexion.csv": FLEXION,
    }


if __name__ == "__main__":
    words = [word for word in sys.argv[1:] if word != "--apart"]
    folder = pathlib.Path(words[0] if words else ".")
    for name, text in files("--apart" in sys.argv).items():
        (folder / name).write_text(text)
