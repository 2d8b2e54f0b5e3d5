#!/usr/bin/env python3
"""dea build from outside: shapes as scans have them are solved or refused in one line, and so is every kind of file.

build_command.py DEA [CHECK...]. Python's standard library only."""
import csv
import io
import json
import math
import os
import re
import struct
import subprocess
import sys
import tempfile

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import stl_shapes  # noqa: E402

CHECKS = []
DEA = os.path.abspath(sys.argv[1])


def check(function):
    CHECKS.append(function)
    return function


def true(condition, what):
    if not condition:
        raise AssertionError(what)


def same(found, expected, what):
    true(found == expected, f"{what}: found {found!r}, expected {expected!r}")


def close(found, expected, tolerance, what):
    true(abs(found - expected) <= tolerance, f"{what}: found {found}, expected {expected} within {tolerance}")


# ---- surfaces: triangles as three points each ----------------------------------------------------------------------

def sheet(nu, nv, point):
    p = [[point(i / nu, j / nv) for i in range(nu + 1)] for j in range(nv + 1)]
    out = []
    for j in range(nv):
        for i in range(nu):
            a, b, c, d = p[j][i], p[j][i + 1], p[j + 1][i + 1], p[j + 1][i]
            out += [(a, b, c), (a, c, d)] if (i + j) % 2 == 0 else [(a, b, d), (b, c, d)]
    return out


def block(nx, ny, half_x, half_y, end, up, height):
    """Closed, between z = end and the surface height(x, y), which is above it (up) or below."""
    def at(u, v, face):
        x, y = half_x * (2 * u - 1), half_y * (2 * v - 1)
        return (x, y, height(x, y) if face else end)

    out = sheet(nx, ny, lambda u, v: at(u, v, True)) + [t[::-1] for t in sheet(nx, ny, lambda u, v: at(u, v, False))]
    rim = [(i / nx, 0) for i in range(nx)] + [(1, j / ny) for j in range(ny)]
    rim += [(i / nx, 1) for i in range(nx, 0, -1)] + [(0, j / ny) for j in range(ny, 0, -1)]
    for p, q in zip(rim, rim[1:] + rim[:1]):
        a, b, c, d = at(*p, True), at(*q, True), at(*q, False), at(*p, False)
        out += [(a, d, c), (a, c, b)]
    return out if up else [t[::-1] for t in out]


def ball(n, radius, middle=(0, 0, 0)):
    """n x n squares on each face of a cube, spread evenly in angle."""
    def face(axis, sign):
        def point(u, v):
            x = [math.tan(math.pi / 4 * (2 * u - 1)), math.tan(math.pi / 4 * (2 * v - 1)) * sign, sign]
            x = x[-axis:] + x[:-axis] if axis else x
            size = math.sqrt(sum(c * c for c in x))
            return tuple(m + radius * c / size for m, c in zip(middle, x))
        return sheet(n, n, point)
    return [t for axis in range(3) for sign in (1, -1) for t in face(axis, sign)]


def socket(n, radius, polar=75):
    return [tuple(tuple(float(c) for c in v.split()) for v in re.findall(r"vertex (.*)", f)) for f in stl_shapes.cap(radius, polar, False, n).split("endfacet")[:-1]]


def stl(triangles, head=b"", tail=b""):
    """Bytes of a binary STL."""
    out = head.ljust(80, b" ") + struct.pack("<I", len(triangles))
    for t in triangles:
        out += struct.pack("<12fH", 0, 0, 0, *[c for p in t for c in p], 0)
    return out + tail


def indexed(triangles):
    points = {}
    faces = [[points.setdefault(p, len(points)) for p in t] for t in triangles]
    return list(points), faces


def moved(triangles, change):
    return [tuple(change(p) for p in t) for t in triangles]


# ---- running ---------------------------------------------------------------------------------------------------------

class Folder:
    def __init__(self):
        self.temporary = tempfile.TemporaryDirectory(prefix="dea_build_")
        self.path = self.temporary.name
        self.write("socket.stl", stl(socket(16, 24)))
        self.write("ball.stl", stl(ball(16, 20)))

    def write(self, name, content):
        with open(os.path.join(self.path, name), "wb") as file:
            file.write(content if isinstance(content, bytes) else content.encode())

    def read(self, name):
        with open(os.path.join(self.path, name)) as file:
            return file.read()

    def dea(self, *words):
        return subprocess.run([DEA, *words], cwd=self.path, capture_output=True, text=True, timeout=600)

    def build(self, *words):
        path = os.path.join(self.path, "j.feb")
        if os.path.exists(path):
            os.remove(path)
        done = self.dea("build", "-o", "j.feb", *words)
        true("nan" not in (done.stdout + done.stderr).lower().replace("nan.", ""), done.stdout + done.stderr)
        if done.returncode in (2, 3, 4):
            same(done.stderr.count("\n"), 1, f"lines of {done.stderr!r}")
            true(not os.path.exists(path), "a model is there all the same")
        else:
            true(done.returncode in (0, 1) and os.path.exists(path), f"{done.returncode}: {done.stderr}")
        return done

    def run(self, *words):
        """Rows of dea run's table."""
        done = self.dea("run", "j.feb", "--no-xplt", "--csv", "-", "-q", *words)
        same(done.returncode, 0, done.stderr)
        return list(csv.DictReader(io.StringIO(done.stdout)))


JOINT = ("--bone", "socket=socket.stl", "--bone", "ball=ball.stl", "--half-gap", "max=3,min=0.5", "--force", "ball=0,0,500")


# ---- shapes ----------------------------------------------------------------------------------------------------------

@check
def a_two_compartment_tibia_shares_the_load(folder):
    """Two condyles over two dishes with an eminence between, mirror images about x = 0: on paper each compartment bears
    half of a central load, whatever the law. The meshes are mirror images, too: what is left is what points move by where
    single precision rounds them."""
    aside = lambda x, y: (abs(x) - 22) ** 2 + y * y  # noqa: E731
    folder.write("tibia.stl", stl(block(72, 44, 36, 22, -25, True, lambda x, y: aside(x, y) / 120 + 6 * math.exp(-x * x / 25))))
    folder.write("femur.stl", stl(block(72, 44, 36, 22, 40, False, lambda x, y: 3.5 + aside(x, y) / 50 + 18 * math.exp(-x * x / 36))))
    built = folder.build("--bone", "tibia=tibia.stl", "--bone", "femur=femur.stl", "--half-gap", "max=2.5,min=0.5", "--force", "femur=0,0,-1500",
                         "--json", "j.json")
    same(built.returncode, 0, built.stderr)
    made = json.loads(folder.read("j.json"))
    same(len(made["contacts"]), 2, "contacts")
    forces = [-float(r["force_z"]) for r in folder.run("--states", "last")]
    for force in forces:
        close(force, 750, 1e-3, "force of a compartment")
    # a load that leans to one side is shared otherwise: the numbers above are no accident
    folder.build("--bone", "tibia=tibia.stl", "--bone", "femur=femur.stl", "--half-gap", "max=2.5,min=0.5", "--force", "femur=150,0,-1500")
    forces = [-float(r["force_z"]) for r in folder.run("--states", "last")]
    true(abs(forces[0] - forces[1]) > 100, f"forces: {forces}")


def spiked(triangles, every, out):
    points, _ = indexed(triangles)
    spikes = set(points[::every])
    return moved(triangles, lambda p: tuple(c * out for c in p) if p in spikes else p)


SHAPES = {  # what, the ball's triangles, what happens: 0 solved with these words in the notes, 3 refused with these
    "a hole where it bears": (lambda: [t for t in ball(16, 20) if not (t[0][2] > 19 and abs(t[0][0]) < 4 and abs(t[0][1]) < 4)], 0, "1 open rim"),
    "holes elsewhere": (lambda: [t for i, t in enumerate(ball(16, 20)) if t[0][2] > 0 or i % 37], 0, "open rims"),
    "spikes that touch nothing": (lambda: spiked(ball(16, 20), 150, 1.1), 0, "triangles"),
    "spikes into the socket": (lambda: spiked(ball(16, 20), 40, 1.5), 3, "interpenetrate"),
    "flipped patches": (lambda: [t[::-1] if t[0][0] > 5 or i % 50 == 0 else t for i, t in enumerate(ball(16, 20))], 0, "triangles turned"),
    "10 times coarser": (lambda: ball(2, 20), 0, "24 triangles" if False else "48 triangles"),
    "10 times finer": (lambda: ball(80, 20), 0, "76800 triangles"),
    "slivers": (lambda: [t for a, b, c in ball(16, 20) for t in ((a, b, tuple((x + 1e-4 * y) / 1.0001 for x, y in zip(b, c))), (a, tuple((x + 1e-4 * y) / 1.0001 for x, y in zip(b, c)), c))], 0, "triangles"),
    "two balls in one file": (lambda: ball(16, 20) + ball(6, 5, (60, 0, 0)), 0, "triangles"),
    "a fin": (lambda: ball(16, 20) + [((0.0, 0.0, -20.0), (0.0, 5.0, -30.0), (0.0, 0.0, -30.0))], 0, "triangles"),
}


@check
def shapes_are_solved_or_refused(folder):
    for what, (make, code, words) in SHAPES.items():
        folder.write("ball.stl", stl(make()))
        done = folder.build(*JOINT)
        print(what, done.returncode, [l for l in done.stderr.split("\n") if "ball" in l][:6])
        print(done.stdout)


def main():
    wanted, failed = sys.argv[2:], 0
    for function in CHECKS:
        if wanted and function.__name__ not in wanted:
            continue
        try:
            function(Folder())
            print(f"ok      {function.__name__}", flush=True)
        except Exception as error:  # whatever it is, the other checks go on
            failed += 1
            print(f"FAILED  {function.__name__}: {type(error).__name__}: {error}", flush=True)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
