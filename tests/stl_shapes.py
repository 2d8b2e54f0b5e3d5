"""Bones as text STL for tests of pages and examples: a ball, and caps of spheres about the pole +z."""
import math


def cap(radius, polar, outwards, n=20):
    """From the pole to the angle `polar` [degrees], seen from outside or from the centre."""
    def point(i, j):
        angle, azimuth = math.radians(polar) * j / n, 2 * math.pi * i / (4 * n)
        return (radius * math.sin(angle) * math.cos(azimuth), radius * math.sin(angle) * math.sin(azimuth), radius * math.cos(angle))

    lines = ["solid cap"]
    for j in range(n):
        for i in range(4 * n):
            a, b, c, d = point(i, j), point(i, j + 1), point(i + 1, j + 1), point(i + 1, j)
            for triangle in ((a, b, c), (a, c, d)):
                lines += ["facet normal 0 0 0", "outer loop"]
                lines += ["vertex %.9g %.9g %.9g" % p for p in (triangle if outwards else reversed(triangle))]
                lines += ["endloop", "endfacet"]
    return "\n".join(lines + ["endsolid cap", ""])


# A hip as balls: bones, and the outer surfaces of 2 mm of cartilage on each that leave 0.1 mm between them.
SURFACES = {
    "pelvis.stl": cap(24, 75, False),
    "femur.stl": cap(19.9, 180, True),
    "acetabular_cartilage.stl": cap(22.05, 70, False),
    "femoral_cartilage.stl": cap(21.95, 80, True),
}
# Of the same as a right hip in LPS: x forwards is -y, y up is z, z to the right is -x.
LANDMARKS = ("name,x,y,z\nRASIS,-35,-60,80\nLASIS,205,-60,80\nRPSIS,40,90,82\nLPSIS,130,90,82\n"
             "RMFE,45,5,-400\nRLFE,-35,0,-402\n")
