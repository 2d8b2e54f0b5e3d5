#!/usr/bin/env python3
"""dea build from outside: shapes as scans have them are solved or refused in one line, and so is every kind of file.

build_command.py DEA [CHECK...]. Python's standard library only."""
import csv
import io
import json
import math
import os
import re
import shutil
import signal
import struct
import subprocess
import sys
import tempfile

HERE = os.path.dirname(os.path.abspath(__file__))
sys.dont_write_bytecode = True
sys.path[:0] = [HERE, os.path.join(HERE, "../samples/made_knee")]
import make_knee  # noqa: E402
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
    records = [struct.pack("<12fH", 0, 0, 0, *[c for p in t for c in p], 0) for t in triangles]
    return head.ljust(80, b" ") + struct.pack("<I", len(triangles)) + b"".join(records) + tail


def indexed(triangles):
    points = {}
    faces = [[points.setdefault(p, len(points)) for p in t] for t in triangles]
    return list(points), faces


def moved(triangles, change):
    return [tuple(change(p) for p in t) for t in triangles]


# ---- running ---------------------------------------------------------------------------------------------------------

# A slow machine sees what is being done, and for how long: a line each.
PROGRESS = re.compile(r"(reading surfaces|anatomy|cartilage|writing \S+|balance)( \(\d+ s\))?")


def lines_beside_progress(done):
    return [line for line in done.stderr.splitlines() if not PROGRESS.fullmatch(line)]


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
        true(not re.search(r"\b(nan|inf)\b", done.stdout), done.stdout)
        if done.returncode in (2, 3, 4):
            same(len(lines_beside_progress(done)), 1, f"lines of {done.stderr!r}")
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
    true(abs(forces[0] - forces[1]) > 50, f"forces: {forces}")


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
    "10 times coarser": (lambda: ball(2, 20), 0, "ball.stl: 48 triangles"),
    "10 times finer": (lambda: ball(80, 20), 0, "ball.stl: 76800 triangles"),
    "triangles that do not meet": (lambda: [tuple(tuple(c * (1 + 1e-4 * (i % 7)) for c in p) for p in t) for i, t in enumerate(ball(16, 20))], 3, "loose parts, none of them 1 % of the whole area"),
    "two balls in one file": (lambda: ball(16, 20) + ball(6, 5, (60, 0, 0)), 0, "triangles"),
    "slivers": (lambda: [t for a, b, c in ball(16, 20) for m in [tuple(0.998 * x + 0.001 * (y + z) for x, y, z in zip(a, b, c))] for t in ((a, b, m), (b, c, m), (c, a, m))], 0, "triangles"),
    "a fin": (lambda: ball(16, 20) + [((0.0, 0.0, -20.0), (0.0, 5.0, -30.0), (0.0, 0.0, -30.0))], 0, "triangles"),
}


@check
def shapes_are_solved_or_refused(folder):
    for what, (make, code, words) in SHAPES.items():
        folder.write("ball.stl", stl(make()))
        done = folder.build(*JOINT)
        same(done.returncode, code, f"{what}: {done.stderr}")
        true(words in done.stderr, f"{what}: not said: {words}: {done.stderr}")
        if code == 0:
            (row,) = folder.run("--states", "last")
            # the last digit is that of the search, which ends at a thousandth of the force
            close(math.hypot(*(float(row[f"force_{c}"]) for c in "xyz")), 500, 0.5, f"{what}: force")
    folder.write("ball.stl", stl(SHAPES["slivers"][0]()))
    slivers = folder.build(*JOINT)
    true("slivers merged with what lies around" in slivers.stdout, slivers.stdout)
    same(folder.build(*JOINT, "--edge", "2").returncode, 0, "slivers, with other triangles")
    fine = folder.build(*JOINT, "--edge", "1e-4")
    same(fine.returncode, 3, "edges far too short")
    true("expected one that makes no more than 1e+06" in fine.stderr, fine.stderr)


# ---- files -----------------------------------------------------------------------------------------------------------

def ply(triangles, quads=False, ends="\n"):
    points, faces = indexed(triangles)
    if quads:  # neighbours in the list are the two halves of a square
        faces = [join(faces[i], faces[i + 1]) for i in range(0, len(faces), 2)]
    head = ["ply", "format ascii 1.0", f"element vertex {len(points)}", "property float x", "property float y", "property float z",
            f"element face {len(faces)}", "property list uchar int vertex_indices", "end_header"]
    return ends.join(head + ["%.9g %.9g %.9g" % p for p in points] + [" ".join(map(str, [len(f), *f])) for f in faces]) + ends


def join(a, b):
    """Two triangles with a common edge as a quad."""
    (k,) = [k for k in range(3) if a[k] not in b]
    (new,) = [v for v in b if v not in a]
    return [a[k], a[(k + 1) % 3], new, a[(k + 2) % 3]]


def obj(triangles, negative=False, ends="\n"):
    points, faces = indexed(triangles)
    return ends.join(["# a ball", *("v %.9g %.9g %.9g" % p for p in points),
                      *("f " + " ".join(str(i - len(points) if negative else i + 1) + "//1" for i in f) for f in faces)]) + ends


def text_stl(triangles, ends="\n"):
    lines = ["solid ball"]
    for t in triangles:
        lines += ["facet normal 0 0 0", " outer loop", *("  vertex %.9g %.9g %.9g" % p for p in t), " endloop", "endfacet"]
    return ends.join(lines + ["endsolid ball", ""])


def vtk(triangles, ends="\n"):
    points, faces = indexed(triangles)
    return ends.join(["# vtk DataFile Version 3.0", "ball", "ASCII", "DATASET POLYDATA", f"POINTS {len(points)} float", *("%.9g %.9g %.9g" % p for p in points),
                      f"POLYGONS {len(faces)} {4 * len(faces)}", *("3 %d %d %d" % tuple(f) for f in faces)]) + ends


def vtp(form, head=""):
    return f"""<?xml version="1.0"?><VTKFile type="PolyData" version="1.0" byte_order="LittleEndian" header_type="UInt32"{head}><PolyData>
<Piece NumberOfPoints="3" NumberOfPolys="1"><Points><DataArray type="Float32" NumberOfComponents="3" format="{form}">AAAA</DataArray></Points>
<Polys><DataArray type="Int32" Name="connectivity" format="{form}">AAAA</DataArray><DataArray type="Int32" Name="offsets" format="{form}">AAAA</DataArray></Polys>
</Piece></PolyData>{'<AppendedData encoding="raw">_ab</AppendedData>' if form == "appended" else ""}</VTKFile>"""


B = ball(12, 20)
NAN = float("nan")
READ = {
    "b.stl": stl(B), "solid.stl": stl(B, b"solid ball"), "text.stl": text_stl(B), "crlf.stl": text_stl(B, "\r\n"), "upper.STL": text_stl(B).upper(),
    "marked.stl": b"\xef\xbb\xbf\n  " + text_stl(B).encode(), "name=1.stl": stl(B), "kost\u00fcm 1.stl": stl(B),
    "b.ply": ply(B), "crlf.ply": ply(B, ends="\r\n"), "quads.ply": ply(B, quads=True), "b.obj": obj(B), "negative.obj": obj(B, True), "crlf.obj": obj(B, ends="\r\n"),
    "b.vtk": vtk(B), "crlf.vtk": vtk(B, "\r\n"),
}
REFUSED = {
    "nan.stl": (stl([*B[:-1], ((0.0, 0.0, NAN), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0))]), "no number of use"),
    "infinite.stl": (stl([*B[:-1], ((0.0, 0.0, float("inf")), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0))]), "no number of use"),
    "nan_text.stl": (text_stl(B).replace("vertex", "vertex nan", 1), "expected a number"),
    "cut.stl": (stl(B)[:-30], "cut off or damaged"),
    "longer.stl": (stl(B, tail=b"more"), "cut off or damaged"),
    "cut_text.stl": (text_stl(B)[:4000], "the file is cut off"),
    "none.stl": (stl([]), "found no triangle"),
    "none_text.stl": ("solid x\nendsolid x\n", ""),
    "none.ply": (ply(B).split("element face")[0] + "element face 0\nproperty list uchar int vertex_indices\nend_header\n" + "0 0 0\n" * len(indexed(B)[0]), "found no triangle"),
    "none.obj": ("v 0 0 0\nv 1 0 0\nv 0 1 0\n", "found no triangle"),
    "beyond.obj": ("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n", "expected one of the 3 points"),
    "beyond_negative.obj": ("v 0 0 0\nv 1 0 0\nv 0 1 0\nf -1 -2 -9\n", "expected one of the 3 points"),
    "zero.obj": ("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 0 1 2\n", "expected \"f 1 2 3\""),
    "two.obj": ("v 0 0 0\nv 1 0 0\nf 1 2\n", "three or more"),
    "words.obj": ("v a b c\n", "with three numbers"),
    "binary.vtp": (vtp("binary"), "the file is cut off"),
    "appended.vtp": (vtp("appended"), "found an offset outside the appended data"),
    "compressed.vtp": (vtp("binary", ' compressor="vtkLZ4DataCompressor"'), "save the surface as STL or PLY"),
    "grid.vtk": ("# vtk DataFile Version 3.0\nx\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 0 float\n", "a surface, not a volume or grid"),
    "cut.ply": (ply(B)[:3000], "the file is cut off"),
    "empty.stl": ("", "found an empty file"),
    "words.stl": ("Dear reader,\nthis is no surface.\n", "no surface that is known"),
    "one.stl": (stl(B[:1]), "found 1 triangle with area"),
    "flat.stl": (stl([((0.0, 0.0, 0.0), (30.0, 0.0, 0.0), (60.0, 0.0, 0.0))] * 9), "found 0 triangles with area"),
    "page.html": ("<!doctype html><html><body>404</body></html>", "no surface that is known"),
    "model.feb": ('<?xml version="1.0"?><febio_spec version="4.0"></febio_spec>', "expected a VTP"),
    "there_is_none.stl": (None, "no file that can be read"),
}


@check
def files_are_read(folder):
    """All are one ball: the same balance, but for the digits that text and single precision keep (9 and 7 of them)."""
    seats = {}
    for name, content in READ.items():
        folder.write(name, content)
        done = folder.build("--bone", "socket=socket.stl", "--bone", "ball=" + name, "--uniform", "socket=3", "--force", "ball=0,0,500", "--json", "j.json", "-q")
        same(done.returncode, 0, f"{name}: {done.stderr}")
        seats[name] = json.loads(folder.read("j.json"))["bones"][1]["seat"][2]
    for name, seat in seats.items():
        close(seat, seats["b.stl"], 1e-5, name)


@check
def files_are_refused(folder):
    for name, (content, words) in REFUSED.items():
        if content is not None:
            folder.write(name, content)
        done = folder.build("--bone", "socket=socket.stl", "--bone", "ball=" + name, "--uniform", "socket=3", "--force", "ball=0,0,500", "-q")
        same(done.returncode, 3, f"{name}: {done.stderr}")
        true(name in done.stderr and words in done.stderr, f"{name}: {words!r} is not in {done.stderr!r}")
    os.mkdir(os.path.join(folder.path, "folder.stl"))
    done = folder.build("--bone", "socket=socket.stl", "--bone", "ball=folder.stl", "--uniform", "socket=3", "--force", "ball=0,0,500", "-q")
    same(done.returncode, 3, done.stderr)


@check
def joints_that_are_none_are_refused(folder):
    folder.write("ball_m.stl", stl(ball(12, 0.02)))
    folder.write("socket_m.stl", stl(moved(socket(12, 24), lambda p: tuple(c / 1000 for c in p))))
    folder.write("far.stl", stl(ball(12, 20, (0, 0, 1000))))
    folder.write("in.stl", stl(ball(12, 20, (3, 0, 6))))
    folder.write("around.stl", stl(ball(12, 40)))
    for socket_file, ball_file, words in (
            ("socket_m.stl", "ball_m.stl", "these look like m; --units m says"), ("socket.stl", "far.stl", "are the bones in one frame and unit?"),
            ("socket.stl", "in.stl", "interpenetrate"), ("around.stl", "ball.stl", "are the bones in one frame and unit?"), ("ball.stl", "ball.stl", "are both given the same file?"),
            ("socket.stl", "ball_m.stl", "")):
        done = folder.build("--bone", f"socket={socket_file}", "--bone", f"ball={ball_file}", "--half-gap", "max=3,min=0.5", "--force", "ball=0,0,500", "-q")
        same(done.returncode, 3, f"{socket_file}, {ball_file}: {done.stderr}")
        true(words in done.stderr, done.stderr)


# ---- loads, planes of symmetry, rims ------------------------------------------------------------------------------------

@check
def a_table_of_loads_is_solved_row_by_row(folder):
    """Each row is what the same force gives alone, but for how exactly a balance is searched (a thousandth of the force,
    on a joint that gives way by some 0.1 mm)."""
    rows = [(50, -20, 300), (100, 0, 500), (0, 0, 200)]
    folder.write("walk.csv", "time,fx,fy,fz\n" + "".join(f"{0.1 * i},{x},{y},{z}\n" for i, (x, y, z) in enumerate(rows)))
    done = folder.build(*JOINT[:6], "--loads", "ball=walk.csv", "--json", "j.json")
    same(done.returncode, 0, done.stderr)
    true("walk.csv: 3 rows" in done.stderr, done.stderr)
    made = json.loads(folder.read("j.json"))["loads"]
    same([m["time"] for m in made], [2, 3, 4], "the model's times")
    same([m["table_time"] for m in made], [0, 0.1, 0.2], "the table's times")
    table = folder.run("--states", "2,3,4")
    for row, force, load in zip(table, rows, made):
        for c, f in zip("xyz", force):
            close(float(row[f"force_{c}"]), f, 0.5, "force")
        close(float(row["headline_p99"]), load["contacts"][0]["headline"]["p99"], 1e-3, "p99 of dea build and dea run")
    alone = json.loads(folder.read("j.json"))["loads"][1]["bones"][0]["displacement"]
    folder.build(*JOINT[:6], "--force", "ball=100,0,500", "--json", "j.json")
    for x, y in zip(alone, json.loads(folder.read("j.json"))["bones"][1]["seat"]):
        close(x, y, 1e-3, "displacement alone and after another load")
    folder.write("percent.csv", "fx,fy,fz\n10,0,50\n")
    folder.build(*JOINT[:6], "--loads", "ball=percent.csv", "--body-weight", "1000", "--json", "j.json")
    same(json.loads(folder.read("j.json"))["loads"][0]["bones"][0]["force"], [100, 0, 500], "per cent of the body weight")
    for words, code, said in ((["--loads", "ball=percent.csv", "--force", "ball=0,0,1"], 2, "found --force for this bone too"), (["--loads", "percent.csv"], 2, "expected BODY=FILE"),
                              (["--loads", "bal=percent.csv"], 2, "did you mean"), (["--loads", "ball=none.csv"], 3, "none.csv"), (["--force", "ball=0,0,1", "--body-weight", "800"], 2, "--loads"),
                              (["--loads", "ball=socket.stl"], 3, "socket.stl"), (["--loads", "ball=percent.csv", "--force", "socket=0,0,-1"], 2, "a load for every bone"),
                              (["--force", "ball=0,0,1", "--hold", "ball=x,y,z"], 2, "all three directions"), (["--force", "ball=0,0,1", "--hold", "ball=w"], 2, "expected some of x,y,z,Ru,Rv,Rw"),
                              (["--force", "ball=0,0,1", "--hold", "socket=x"], 2, "a bone without a force")):
        done = folder.build(*JOINT[:6], *words, "-q")
        same(done.returncode, code, done.stderr)
        true(said in done.stderr, done.stderr)


@check
def cartilage_that_lies_in_its_bone_is_a_warning(folder):
    """A lining of 2.1 mm whose middle is pressed 0.5 mm into the socket: a sound model all the same, with a line of how much
    changed, a warning (with -q too), and a map on the page."""
    lining = moved(socket(16, 21.9, 60), lambda p: tuple(c * (24.5 / 21.9 if math.hypot(p[0], p[1]) < 5 else 1) for c in p))
    folder.write("outer.stl", stl(lining))
    words = ("--bone", "socket=socket.stl", "--cartilage", "socket=outer.stl", "--bone", "ball=ball.stl", "--force", "ball=0,0,500", "--json", "j.json")
    done = folder.build(*words, "--report", "j.html")
    layer = json.loads(folder.read("j.json"))["layers"][0]
    true(layer["jacobian_least"] > 0, "least Jacobian")
    true(layer["thickness_changed_part"] > 0.01, layer)
    # no more than to the least thickness, a tenth of the mean
    true(0 < layer["thickness_change_mean"] < layer["thickness_change_most"] < 0.25, layer)
    same(layer["area_lost"], 0, "area lost")
    true("socket_cartilage: thickness changed by" in done.stdout, done.stdout)
    words_of_it = "found a thickness that had to change by more than a tenth over"
    true(words_of_it in done.stderr, done.stderr)
    true('"change":{' in folder.read("j.html"), "no map of the change")
    true(words_of_it in folder.build(*words, "-q").stderr, "quiet")


@check
def a_balance_that_ends_at_a_thin_place_names_it(folder):
    """A plate on 2 mm of cartilage, above a stump of the bone that leaves 0.25 mm. 2700 N on 400 mm^2 press by 15 % of 2 mm, which is
    more than is there."""
    def stump(p):
        return (p[0], p[1], 1.75) if math.hypot(p[0], p[1]) < 1.6 and abs(p[2]) < 1e-9 else p
    folder.write("stump.stl", stl(moved(block(20, 20, 10, 10, -10, True, lambda x, y: 0.0), stump)))
    folder.write("outer.stl", stl(sheet(20, 20, lambda u, v: (20 * u - 10, 20 * v - 10, 2))))
    folder.write("plate.stl", stl(block(20, 20, 12, 12, 12, False, lambda x, y: 2.01)))
    words = ("--bone", "tibia=stump.stl", "--cartilage", "tibia=outer.stl", "--bone", "femur=plate.stl", "--free", "femur=z", "-q")
    done = folder.build(*words, "--force", "femur=0,0,-2700", "--json", "j.json")
    same(done.returncode, 1, done.stderr)
    true("at a thin or rough place, " in done.stderr and "where tibia_cartilage is thin, 0." in done.stderr, done.stderr)
    true("or a greater least thickness (--least) may do" in done.stderr, done.stderr)
    close(json.loads(folder.read("j.json"))["layers"][0]["thickness_least"], 0.25, 1e-6, "least thickness")
    same(folder.build(*words, "--force", "femur=0,0,-100").returncode, 0, "a load that it bears")


@check
def layers_in_one_place_are_refused(folder):
    """A tibia's sheet of cartilage that is twice in its file, once 0.01 mm lower."""
    def sheets(*heights):
        return stl([t for z in heights for t in sheet(20, 20, lambda u, v, z=z: (20 * u - 10, 20 * v - 10, z))])
    folder.write("tibia.stl", stl(block(12, 12, 12, 12, -10, True, lambda x, y: 0.0)))
    folder.write("femur.stl", stl(block(12, 12, 12, 12, 12, False, lambda x, y: 2.1)))
    folder.write("once.stl", sheets(2))
    folder.write("twice.stl", sheets(2, 1.99))
    words = ("--bone", "tibia=tibia.stl", "--bone", "femur=femur.stl", "--free", "femur=z", "--force", "femur=0,0,-100", "-q")
    same(folder.build(*words, "--cartilage", "tibia=once.stl").returncode, 0, "once")
    done = folder.build(*words, "--cartilage", "tibia=twice.stl")
    same(done.returncode, 3, done.stderr)
    true("tibia_cartilage_1 and tibia_cartilage_2: found 400 mm^2 of articular surface, 100 % of the smaller one's" in done.stderr, done.stderr)
    same(done.stderr.count("\n"), 1, done.stderr)


@check
def a_segmented_layer_thins_out_where_asked(folder):
    folder.write("outer.stl", stl(moved(socket(16, 21.9, 60), lambda p: p)))
    words = ("--bone", "socket=socket.stl", "--cartilage", "socket=outer.stl", "--bone", "ball=ball.stl", "--force", "ball=0,0,500", "--json", "j.json")
    thickness = []
    for fade in ([], ["--fade", "4"]):
        done = folder.build(*words, *fade)
        same(done.returncode, 0, done.stderr)
        layer = json.loads(folder.read("j.json"))["layers"][0]
        thickness.append((layer["rim_thickness"], layer["thickness_most"]))
        true(("thins out over 4" if fade else "ends at its rim") in done.stderr, done.stderr)
    # the cap's facets lie h^2 / 8R below the sphere: h = 24 * 75 degrees / 16
    close(thickness[0][0], 2.1, 0.03, "thickness of the rim that ends")
    close(thickness[1][0], 0.21, 0.005, "a tenth of the mean at the rim that thins out")
    close(thickness[0][1], thickness[1][1], 1e-9, "the thickest place")


def clipped(triangles, axis):
    """Those on the positive side; none is cut."""
    return [t for t in triangles if sum(p[axis] for p in t) > 0]


@check
def a_quarter_joint_is_completed(folder):
    """Planes of symmetry at x = 0 and y = 0. Without the other parts the contact's sideways force has no opposite, and there is
    no balance; with them the joint moves as the whole one does, but for diagonals that run the other way."""
    words = ("--uniform", "socket=3", "--reach", "8", "--force", "ball=0,0,800", "--json", "j.json", "-q")
    same(folder.build("--bone", "socket=socket.stl", "--bone", "ball=ball.stl", *words).returncode, 0, "the whole joint")
    whole = json.loads(folder.read("j.json"))
    folder.write("ball.stl", stl(clipped(clipped(ball(16, 20), 0), 1)))
    folder.write("socket.stl", stl(clipped(clipped(socket(16, 24), 0), 1)))
    quarter = ("--bone", "socket=socket.stl", "--bone", "ball=ball.stl", *words)
    same(folder.build(*quarter).returncode, 1, "a quarter by itself")
    same(folder.build(*quarter, "--mirror", "x=0,y=0").returncode, 0, "completed")
    found = json.loads(folder.read("j.json"))
    for what, get, part in (("motion", lambda j: j["bones"][1]["seat"][2], 0.005), ("area", lambda j: j["layers"][0]["area"], 0.005), ("p99", lambda j: j["headline"]["p99"], 0.02)):
        print(f"        {what}: {get(found):.6g}, of the whole joint {get(whole):.6g}")
        close(get(found), get(whole), part * abs(get(whole)), what)
    for mirror, code, said in (("x=5", 3, "found points on both sides of x=5"), ("w=0", 2, "expected x, y or z"), ("x", 2, "expected x=0"), ("x=a", 2, "--mirror")):
        done = folder.build(*quarter, "--mirror", mirror)
        same(done.returncode, code, done.stderr)
        true(said in done.stderr, done.stderr)


@check
def points_and_regions_are_mirrored_too(folder):
    """Thickness at points of one half, mirrored, is that of both halves: the ball's layer is as thick, and it moves straight."""
    def points(half):
        rows = [(20 * math.sin(a) * math.cos(b), 20 * math.sin(a) * math.sin(b), 20 * math.cos(a), 1 + 0.5 * math.cos(b) ** 2 * math.sin(a))
                for a in (math.radians(7.5 * i) for i in range(1, 12)) for b in (math.radians(7.5 + 15 * k) for k in range(24))]
        return "x,y,z,thickness\n" + "".join("%r,%r,%r,%r\n" % r for r in rows if not half or r[0] > 0)
    words = ("--bone", "socket=socket.stl", "--bone", "ball=ball.stl", "--reach", "8", "--force", "ball=0,0,800", "--json", "j.json", "-q")
    means = []
    for half in (False, True):
        if half:
            folder.write("ball.stl", stl(clipped(ball(16, 20), 0)))
            folder.write("socket.stl", stl(clipped(socket(16, 24), 0)))
        folder.write("points.csv", points(half))
        same(folder.build(*words, "--thickness-at", "ball=points.csv", *(("--mirror", "x=0") if half else ())).returncode, 0, "solved")
        made = json.loads(folder.read("j.json"))
        means.append([layer["thickness_mean"] for layer in made["layers"] if layer["bone"] == "ball"][0])
        # the points are the two halves' own images; what is left is how the triangles lie
        close(made["bones"][1]["seat"][0], 0, 0.01, "motion to the side")
    close(means[1], means[0], 0.01 * means[0], "thickness")
    done = folder.build(*words, "--uniform", "ball=1", "--mirror", "x=0", "--region", "ball=sphere:12,0,16,8")
    same(done.returncode, 2, done.stderr)
    true("its own mirror image" in done.stderr, done.stderr)


# ---- how it stands -----------------------------------------------------------------------------------------------------

TURN = math.radians(20)
ROTATION = ((1, 0, 0), (0, math.cos(TURN), -math.sin(TURN)), (0, math.sin(TURN), math.cos(TURN)))  # about x
SHIFT = (3.0, -40.0, 7.0)


def times(m, x):
    return tuple(sum(row[k] * x[k] for k in range(3)) for row in m)


def transposed(m):
    return tuple(zip(*m))


def placed(x):
    return tuple(c + d for c, d in zip(times(ROTATION, x), SHIFT))


def itk(rotation, shift):
    return ("#Insight Transform File V1.0\n#Transform 0\nTransform: AffineTransform_double_3_3\nParameters: "
            + " ".join(repr(v) for v in (*(v for row in rotation for v in row), *shift)) + "\nFixedParameters: 0 0 0\n")


@check
def a_bone_stands_where_it_is_placed(folder):
    """A ball and its layer in axes of their own, brought back by every kind of pose, balance as where they were scanned. The surfaces
    are in single precision: a few 1e-6 mm, of which the search makes some 1e-4."""
    outer = ball(16, 21.5)
    folder.write("outer.stl", stl(outer))
    words = ("--bone", "socket=socket.stl", "--bone", "ball=ball.stl", "--cartilage", "ball=outer.stl", "--uniform", "socket=1.5", "--reach", "6",
             "--force", "ball=100,50,500", "--json", "j.json")
    same(folder.build(*words).returncode, 0, "as scanned")
    direct = json.loads(folder.read("j.json"))
    own = lambda x: times(transposed(ROTATION), tuple(c - d for c, d in zip(x, SHIFT)))  # noqa: E731
    folder.write("ball.stl", stl(moved(ball(16, 20), own)))
    folder.write("outer.stl", stl(moved(outer, own)))
    rows = [[*row, c] for row, c in zip(ROTATION, SHIFT)] + [[0, 0, 0, 1]]
    folder.write("pose.txt", "\n".join(" ".join(repr(float(v)) for v in row) for row in rows))
    back = transposed(ROTATION), times(transposed(ROTATION), tuple(-c for c in SHIFT))  # ITK: where points come from
    folder.write("T.tfm", itk(*back))
    folder.write("forwards.tfm", itk(ROTATION, SHIFT))
    over = lambda m: tuple(tuple(v * (-1 if i < 2 else 1) * (-1 if k < 2 else 1) for k, v in enumerate(row)) for i, row in enumerate(m))  # noqa: E731
    folder.write("ras.tfm", itk(over(back[0]), tuple(v * (-1 if i < 2 else 1) for i, v in enumerate(back[1]))))
    folder.write("poses.csv", "tx,ty,tz,rx,ry,rz\n9,9,9,0,0,0\n3,-40,7,20,0,0\n")
    table = ("--place-rotation", "ball=xyz", "--place-units", "ball=deg-mm")
    names = ",".join(f"ball_T{i}{k}" for i in range(1, 5) for k in range(1, 5))
    folder.write("matrices.csv", f"{names}\n" + ",".join(repr(float(v)) for row in rows for v in row) + "\n")
    for place, more, said in (("pose.txt", (), "turned by 20 degrees about (1, 0, 0)"), ("inverse:back.txt", (), "the other way round"),
                              (",".join(repr(float(v)) for row in rows for v in row), (), "as given"),
                              ("T.tfm", (), "turned round; the bones' axes taken as LPS"), ("inverse:forwards.tfm", (), "inverse:"),
                              ("ras.tfm", ("--scan-axes", "RAS"), "taken as RAS"), ("poses.csv:2", table, "row 2 of poses.csv"), ("matrices.csv:1", ("--place-columns", "ball=ball_T"), "row 1 of matrices.csv")):
        folder.write("back.txt", "\n".join(" ".join(repr(float(v)) for v in (*row, c)) for row, c in zip(*back)) + "\n0 0 0 1")
        done = folder.build(*words, "--place", f"ball={place}", *more)
        same(done.returncode, 0, f"{place}: {done.stderr}")
        true(said in done.stderr, f"{place}: {done.stderr}")
        for x, y in zip(json.loads(folder.read("j.json"))["bones"][1]["seat"], direct["bones"][1]["seat"]):
            close(x, y, 1e-3, f"{place}: seat")
    # in m, as OpenSim has bodies: the matrix is in the unit of the surfaces, a transform of Slicer in mm
    for name, radius in (("ball", 20), ("outer", 21.5)):
        folder.write(f"{name}.stl", stl(moved(moved(ball(16, radius), own), lambda x: tuple(c / 1000 for c in x))))
    folder.write("socket.stl", stl(moved(socket(16, 24), lambda x: tuple(c / 1000 for c in x))))
    folder.write("metres.txt", "\n".join(" ".join(repr(float(v) / (1000 if i < 3 and k == 3 else 1)) for k, v in enumerate(row)) for i, row in enumerate(rows)))
    for place in ("metres.txt", "T.tfm"):
        same(folder.build(*words, "--units", "m", "--place", f"ball={place}", "-q").returncode, 0, place)
        for x, y in zip(json.loads(folder.read("j.json"))["bones"][1]["seat"], direct["bones"][1]["seat"]):
            close(x, y, 1e-3, f"{place}, metres: seat")


@check
def what_cannot_be_placed_is_refused(folder):
    folder.write("scaled.txt", "2 0 0 0 0 2 0 0 0 0 2 0 0 0 0 1")
    folder.write("poses.csv", "tx,ty,tz,rx,ry,rz\n0,0,0,20,0,0\n")
    for words, code, said in ((("--place", "ball=1,2"), 2, "found 2 numbers, expected a translation"), (("--place", "bal=1,2,3"), 2, "did you mean"),
                              (("--place", "ball=none.txt"), 3, "none.txt: found no file"), (("--place", "ball=scaled.txt"), 3, "a pose does not scale"),
                              (("--place", "ball=0,0,0", "--place", "ball=0,0,1"), 2, "found a second one"), (("--place", "ball=0,0,0", "--mirror", "x=0"), 2, "--place and --mirror"),
                              (("--place", "ball=poses.csv:1"), 2, "--place ball=poses.csv:1: its rows have rotations, and nobody says what their three numbers are; say --place-rotation \"ball=vector\""),
                              (("--place", "ball=poses.csv:1", "--place-rotation", "ball=vector"), 2, "whether in degrees or radians; say --place-units \"ball=deg-mm\""),
                              (("--place", "ball=poses.csv:2", "--place-rotation", "ball=vector", "--place-units", "ball=deg-mm"), 2, "row 2 of a table with 1"),
                              (("--place", "ball=poses.csv:1", "--place-rotation", "ball=xxy"), 2, "--place-rotation ball=xxy: found"),
                              (("--place", "ball=poses.csv:1", "--place-columns", "ball=up_T"), 2, "--place-columns ball=up_T: poses.csv has no columns up_T11 to up_T44"),
                              (("--place", "ball=poses.csv:1", "--place-units", "socket=m"), 2, "--place-units socket=m: found no table for this bone, expected --place socket=FILE:ROW too"),
                              (("--place", "ball=poses.csv:1", "--place-units", "ball=m", "--place-units", "ball=mm"), 2, "--place-units ball=mm: found a second one for this bone"),
                              (("--place", "ball=poses.csv:1", "--motion-units", "deg-mm"), 2, "--motion-units deg-mm: found no table, expected --motion BODY=FILE too"),
                              (("--place", "ball=poses.csv"), 3, "is named FILE:ROW"), (("--motion-units", "deg-mm"), 2, "found no table"),
                              (("--place", "ball=2,0,0,0,0,2,0,0,0,0,2,0,0,0,0,1"), 2, "a pose does not scale")):
        done = folder.build(*JOINT, *words, "-q")
        same(done.returncode, code, f"{words}: {done.stderr}")
        true(said in done.stderr, f"{words}: {done.stderr}")


@check
def landmarks_go_with_the_bone_they_are_given_for(folder):
    for name, text in stl_shapes.SURFACES.items():
        folder.write(name, text)
    folder.write("landmarks.csv", stl_shapes.LANDMARKS)
    words = ("--bone", "pelvis=pelvis.stl", "--bone", "femur=femur.stl", "--uniform", "pelvis=2", "--force", "femur=432,-262,1834", "--json", "j.json", "-q")
    turned = ",".join(repr(float(v)) for row in (*([*row, c] for row, c in zip(ROTATION, SHIFT)), (0, 0, 0, 1)) for v in row)
    folder.build(*words, "--landmarks", "landmarks.csv")
    as_is = json.loads(folder.read("j.json"))["frames"]
    folder.build(*words, "--landmarks", "pelvis=landmarks.csv", "--place", f"pelvis={turned}", "--place", f"femur={turned}")
    frames = json.loads(folder.read("j.json"))["frames"]
    same([f["name"] for f in frames], ["pelvis", "femur"], "frames")
    for frame, before in zip(frames, as_is):
        for x, y in zip(frame["x"], times(ROTATION, before["x"])):
            close(x, y, 1e-6, "an axis turned with its bone")
        for x, y in zip(frame["origin"], placed(before["origin"])):
            close(x, y, 1e-3, "an origin moved with its bone")


@check
def two_compartments_share_an_eccentric_load_by_the_lever(folder):
    """The tibia of two compartments, its femur free along z and in varus-valgus: a load 5 mm beside the middle, between contacts that
    lie x1 and x2 aside, is shared by the lever, F1 x1 + F2 x2 = 5 F. If it does not turn each bears half."""
    aside = lambda x, y: (abs(x) - 22) ** 2 + y * y  # noqa: E731
    folder.write("tibia.stl", stl(block(72, 44, 36, 22, -25, True, lambda x, y: aside(x, y) / 120 + 6 * math.exp(-x * x / 25))))
    folder.write("femur.stl", stl(block(72, 44, 36, 22, 40, False, lambda x, y: 3.5 + aside(x, y) / 50 + 18 * math.exp(-x * x / 36))))
    words = ("--bone", "tibia=tibia.stl", "--bone", "femur=femur.stl", "--half-gap", "max=2.5,min=0.5", "--force", "femur=0,0,-1500", "--center", "femur=5,0,20", "--json", "j.json")
    done = folder.build(*words)
    true("two compartments and no ligaments" in done.stderr and "--free femur=z,Rv" in done.stderr, done.stderr)
    done = folder.build(*words, "--free", "femur=z,Rv")
    same(done.returncode, 0, done.stderr)
    (bone,) = [b for b in json.loads(folder.read("j.json"))["bones"] if b["name"] == "femur"]
    same((bone["free"], bone["seat"][:2]), (["z", "Rv"], [0, 0]), "free, and held where nothing is free")
    rows = folder.run("--states", "last")
    forces = [-float(r["force_z"]) for r in rows]
    close(sum(forces), 1500, 0.1, "the load")
    middles = [float(r["center_of_pressure_x"]) for r in rows]
    # the centre of pressure is the pressures' middle; a force that leans there by up to a tenth has its lever from z = 0 to 5 mm, too
    close(sum(f * x for f, x in zip(forces, middles)) / 1500, 5, 0.3, "the lever")
    close(max(forces), 750 * (1 + 5 / 22), 40, "the nearer compartment")


@check
def a_table_of_poses_presses_as_the_load_that_leads_there(folder):
    """Where a load leads the ball to, a table of poses takes it: the contact bears that load there, in dea build and in dea run."""
    folder.build(*JOINT[:-1], "ball=100,0,500", "--json", "j.json")
    seat = json.loads(folder.read("j.json"))["bones"][1]["seat"]
    folder.write("poses.csv", "time,tx,ty,tz\n0,0,0,%r\n5,%r,%r,%r\n" % (seat[2] / 2, *seat))
    done = folder.build(*JOINT[:6], "--motion", "ball=poses.csv", "--json", "j.json")
    same(done.returncode, 0, done.stderr)
    made = json.loads(folder.read("j.json"))
    same([load["table_time"] for load in made["loads"]], [0, 5], "times of the table")
    # the rows alone, as the note says: what they are with the 21 states that seat the ball before them, to the springs' tolerance
    true("dea run --states 2:3 has these alone, without the step that seats the bones" in done.stderr, done.stderr)
    alone, all_states = folder.run("--states", "2:3"), folder.run()
    same([float(row["time"]) for row in alone], [2, 3], "times")
    same(len(all_states), 23, "states")
    for a, b in zip(alone, all_states[-2:]):
        close(float(a["headline_p99"]), float(b["headline_p99"]), 1e-6, "p99 with and without the seating's states")
    same(made["bones"][1]["moved"], ["x", "y", "z"], "moved")
    (row,) = folder.run("--states", "last")
    # the force at a pose that is known to 1e-3 of the force (the search's end)
    for c, f in zip("xyz", (100, 0, 500)):
        close(float(row[f"force_{c}"]), f, 1, "force at the pose")
    # matrices turn about the origin, not about the ball's centre; the ball is put aside so that both differ
    aside = (2.0, -3.0, 1.0)
    for name, triangles in (("ball", ball(16, 20)), ("socket", socket(16, 24))):
        folder.write(f"{name}.stl", stl(moved(triangles, lambda x: tuple(c + d for c, d in zip(x, aside)))))
    quarter = ((0, -1, 0), (1, 0, 0), (0, 0, 1))  # about z: the ball's mesh is its own image
    shift = [c + d - e for c, d, e in zip(aside, seat, times(quarter, aside))]
    names = ",".join(f"ball_T{i}{k}" for i in range(1, 5) for k in range(1, 5))
    folder.write("matrices.csv", f"{names}\n" + ",".join(repr(float(v)) for v in (*(v for row, d in zip(quarter, shift) for v in (*row, d)), 0, 0, 0, 1)) + "\n")
    done = folder.build(*JOINT[:4], "--half-gap", "max=3,min=0.5", "--motion", "ball=matrices.csv", "--motion-columns", "ball_T", "--json", "j.json")
    same(done.returncode, 0, done.stderr)
    (bone,) = json.loads(folder.read("j.json"))["loads"][0]["bones"]
    for x, y in zip(bone["displacement"], seat):
        close(x, y, 1e-3, "displacement of the centre by a matrix")
    close(bone["turn"][2], 90, 1e-6, "turn by a matrix")
    for name, triangles in (("ball", ball(16, 20)), ("socket", socket(16, 24))):
        folder.write(f"{name}.stl", stl(triangles))
    # --free takes dofs out of the table: balance there, poses elsewhere
    done = folder.build(*JOINT[:6], "--motion", "ball=poses.csv", "--free", "ball=x,y", "--json", "j.json")
    same(done.returncode, 0, done.stderr)
    true("its x, y not used, which --free leaves free" in done.stderr, done.stderr)
    bone = json.loads(folder.read("j.json"))["loads"][1]["bones"][0]["displacement"]
    close(bone[0], 0, 1e-3, "free, without a force along it")
    close(bone[2], seat[2], 1e-9, "moved")


@check
def a_ligament_pulls_with_its_formula(folder):
    """A ball hung up in its socket by a bundle along z: the contact bears the force and the bundle's tension at the length that the
    displacement leaves."""
    head = "name,body_a,x_a,y_a,z_a,body_b,x_b,y_b,z_b,stiffness,slack_length,reference_strain,curve\n"
    for row, slack, force_of in (("5000,38,,", 38, lambda e: 5000 * (e - 0.03 if e > 0.06 else e * e / 0.12)), ("5000,,0.02,", 40 / 1.02, lambda e: 5000 * (e - 0.03 if e > 0.06 else e * e / 0.12)),
                                 ("5000,38,,linear", 38, lambda e: 5000 * e)):
        folder.write("l.csv", head + f"tether,ball,0,0,0,socket,0,0,40,{row}\n")
        done = folder.build(*JOINT, "--ligaments", "l.csv", "--json", "j.json")
        same(done.returncode, 0, done.stderr)
        made = json.loads(folder.read("j.json"))
        length = math.dist(made["bones"][1]["seat"], (0, 0, 40))
        close(made["ligaments"][0]["slack_length"], slack, 1e-9, "slack length")
        close(made["ligaments"][0]["force"], force_of(40 / slack - 1), 1e-6, "force as built")
        (row,) = folder.run("--states", "last")
        # the displacement is that of a search which ends at a thousandth of the force
        close(float(row["force_z"]), 500 + force_of(length / slack - 1), 0.5, "force and tension")
    for row, code, said in (("tether,bal,0,0,0,socket,0,0,40,5000,38,,", 3, "l.csv:2: tether: body_a: no bone has the name \"bal\" (did you mean \"ball\"?)"),
                            ("tether,ball,0,0,0,ball,0,0,40,5000,38,,", 3, "found one bone at both ends"),
                            ("tether,ball,0,0,40,socket,0,0,40,5000,38,,", 3, "found both ends at one place")):
        folder.write("l.csv", head + row + "\n")
        done = folder.build(*JOINT, "--ligaments", "l.csv", "-q")
        same(done.returncode, code, done.stderr)
        true(said in done.stderr, done.stderr)


def turned(w, x):
    """By the rotation vector w [degrees]."""
    angle = math.sqrt(sum(c * c for c in w))
    if angle == 0:
        return x
    k, a = [c / angle for c in w], math.radians(angle)
    across = (k[1] * x[2] - k[2] * x[1], k[2] * x[0] - k[0] * x[2], k[0] * x[1] - k[1] * x[0])
    along = sum(p * q for p, q in zip(k, x))
    return tuple(c * math.cos(a) + d * math.sin(a) + e * along * (1 - math.cos(a)) for c, d, e in zip(x, across, k))


@check
def a_knee_balances_on_its_ligaments(folder):
    """A made knee, flexed: where dea build says that the bones come to, the tensions of Blankevoort's formula and the load on the tibia
    add up to what the contacts of dea run bear, in all three components."""
    for name, text in make_knee.files(apart=True).items():
        folder.write(name, text)
    done = folder.build("--bone", "femur=knee_femur.stl", "--cartilage", "femur=knee_femoral_cartilage.stl", "--bone", "tibia=knee_tibia.stl",
                        "--cartilage", "tibia=knee_tibial_cartilage.stl", "--center", "femur=0,0,0", "--motion", "femur=knee_flexion.csv", "--motion-rotation", "zxy",
                        "--motion-units", "deg-mm", "--ligaments", "knee_ligaments.csv", "--force", "tibia=0,0,700", "--json", "j.json")
    same(done.returncode, 0, done.stderr)
    made = json.loads(folder.read("j.json"))
    true("flexion, about x, is held" in done.stderr, done.stderr)
    same([b["free"] for b in made["bones"]], [[], ["x", "y", "z", "Rv", "Rw"]], "free")
    bundles = list(csv.DictReader(io.StringIO(folder.read("knee_ligaments.csv"))))
    rows = folder.run("--states", "2,3,4")
    for i, load in enumerate(made["loads"]):
        def place(bone, point):
            b, at = made["bones"][bone], load["bones"][bone]
            arm = turned(at["turn"], tuple(p - c for p, c in zip(point, b["center"])))
            return tuple(c + d + a for c, d, a in zip(b["center"], at["displacement"], arm))

        close(load["bones"][0]["turn"][0], (0, 15, 30)[i], 1e-9, "flexion")
        pull = [0.0, 0.0, 700.0]
        for bundle in bundles:
            a, b = (tuple(float(bundle[f"{c}_{end}"]) for c in "xyz") for end in "ab")
            slack = math.dist(a, b) / (1 + float(bundle["reference_strain"]))
            now_a, now_b = place(0, a), place(1, b)
            length = math.dist(now_a, now_b)
            e, k = length / slack - 1, float(bundle["stiffness [N]"])
            tension = 0 if e < 0 else k * e * e / 0.12 if e < 0.06 else k * (e - 0.03)
            pull = [f + tension * (p - q) / length for f, p, q in zip(pull, now_a, now_b)]
        contact = [sum(float(r[f"force_{c}"]) for r in rows if float(r["time"]) == load["time"]) for c in "xyz"]
        # both searches end at a thousandth of the load
        for c, f, g in zip("xyz", contact, pull):
            close(f, g, 1, f"force along {c} at {load['time']}")


@check
def what_moves_nothing_or_twice_is_refused(folder):
    folder.write("poses.csv", "tx,ty,tz,rx,ry,rz\n0,0,0.5,0,0,0\n")
    folder.write("walk.csv", "fx,fy,fz\n0,0,500\n0,0,600\n")
    turns = ("--motion-rotation", "vector", "--motion-units", "deg-mm")
    for words, code, said in ((("--free", "ball=z"), 2, "no force is given"), (("--force", "ball=0,0,1", "--free", "ball=none"), 2, "--free ball: found a force"),
                              (("--force", "ball=0,0,1", "--free", "ball=Rx"), 2, "x is the way along x, Ru the turn about it"),
                              (("--force", "ball=0,0,1", "--free", "ball=x", "--free", "ball=y"), 2, "found a second one"),
                              (("--force", "ball=0,0,1", "--free", "ball=z", "--hold", "ball=x"), 2, "--hold ball=x: found --free for this bone too, which says what is held"),
                              (("--motion", "ball=poses.csv", *turns, "--hold", "ball=x"), 2, "--hold ball=x: found --motion for this bone too, which says what is held"),
                              (("--motion", "ball=poses.csv", *turns, "--free", "ball=x", "--hold", "ball=y"), 2, "found --free and --motion for this bone too, which say what is held"),
                              (("--motion", "ball=poses.csv", *turns, "--motion", "socket=poses.csv"), 2, "--motion socket=poses.csv: found a second table of poses beside ball=poses.csv, expected one, for one bone; give its poses"),
                              (("--force", "ball=0,0,0"), 2, "--force ball=0,0,0: found a force of zero"),
                              (("--ligaments", "tether.csv", "--free", "ball=none"), 2, "no force is given"),
                              (("--motion", "ball=poses.csv", *turns, "--free", "ball=Rv"), 2, "which FEBio cannot say of one body"),
                              (("--motion", "ball=poses.csv"), 2, "--motion-rotation"), (("--motion", "ball=poses.csv", "--motion-rotation", "xxy"), 2, "--motion-rotation xxy: found"),
                              (("--motion", "ball=poses.csv", *turns, "--loads", "ball=walk.csv"), 2, "both tables with the same times"),
                              (("--motion", "ball=poses.csv", *turns, "--force", "ball=0,0,1"), 2, "--motion ball: found a force"),
                              (("--force", "ball=0,0,1", "--free", "socket=x"), 2, "a load for every bone")):
        done = folder.build(*JOINT[:6], *words, "-q")
        same(done.returncode, code, f"{words}: {done.stderr}")
        true(said in done.stderr, f"{words}: {done.stderr}")


@check
def what_a_bone_has_once_is_refused_twice(folder):
    for words, said in ((("--force", "ball=0,0,900"), "--force ball=0,0,900: found a second one"),
                        (("--center", "ball=0,0,0", "--center", "ball=0,0,1"), "--center ball=0,0,1: found a second one"),
                        (("--region", "ball=sphere:0,0,20,12", "--region", "ball=plane:0,0,0,0,0,1"), "found a second one"),
                        (("--hold", "ball=z"), "held altogether")):
        done = folder.build(*JOINT, *words, "-q")
        same(done.returncode, 2, f"{words}: {done.stderr}")
        true(said in done.stderr, done.stderr)
    done = folder.build(*JOINT[:-1], "ball=0,100,500", "--hold", "ball=y")
    true("(0, 100, 0) of the force (0, 100, 500) goes into what holds the bone" in done.stderr, done.stderr)


def matrix_table(name, shift, rotation=((1, 0, 0), (0, 1, 0), (0, 0, 1))):
    names = ",".join(f"{name}{i}{k}" for i in range(1, 5) for k in range(1, 5))
    return f"{names}\n" + ",".join(repr(float(v)) for v in (*(v for row, d in zip(rotation, shift) for v in (*row, d)), 0, 0, 0, 1)) + "\n"


@check
def a_row_places_one_bone_and_another_table_moves_the_other(folder):
    """The socket's files lie 0.3 m aside and turned; a matrix in m brings it back. The ball is moved by angles in degrees and mm. What is
    read of both is the answer on paper, and the contact is as without a placement. The surfaces are in single precision."""
    folder.write("poses.csv", "time,tx,ty,tz,rx,ry,rz\n0,0,0,0.3,0,0,0\n1,0.05,-0.1,0.4,3,5,30\n")
    moves = ("--motion", "ball=poses.csv", "--motion-rotation", "zxy", "--motion-units", "deg-mm")
    words = (*JOINT[:4], "--uniform", "ball=1.9", "--uniform", "socket=1.9", "--reach", "6", *moves, "--json", "j.json")
    same(folder.build(*words).returncode, 0, "as scanned")
    direct = json.loads(folder.read("j.json"))
    shift = (300, -40, 7)
    folder.write("socket.stl", stl(moved(socket(16, 24), lambda x: times(transposed(ROTATION), tuple(c - d for c, d in zip(x, shift))))))
    folder.write("bones.csv", matrix_table("socket_T", tuple(c / 1000 for c in shift), ROTATION))
    done = folder.build(*words, "--place", "socket=bones.csv:1", "--place-columns", "socket=socket_T", "--place-units", "socket=m")
    same(done.returncode, 0, done.stderr)
    true("in m, the model in mm-N-s" in done.stderr and "then moved by (300, -40, 7) mm" in done.stderr, done.stderr)
    true("in deg-mm, the model in mm-N-s" in done.stderr and "matrix-units" not in done.stderr, done.stderr)
    made = json.loads(folder.read("j.json"))
    (ball,) = made["loads"][1]["bones"]
    c, s = [math.cos(math.radians(a)) for a in (3, 5, 30)], [math.sin(math.radians(a)) for a in (3, 5, 30)]
    # cos of the whole turn by the trace of Rz Rx Ry
    trace = c[2] * c[1] - s[2] * s[0] * s[1] + c[2] * c[0] + c[0] * c[1]
    close(math.sqrt(sum(v * v for v in ball["turn"])), math.degrees(math.acos((trace - 1) / 2)), 1e-9, "turn")
    for found, given in zip(ball["displacement"], (0.05, -0.1, 0.4)):
        close(found, given, 1e-12, "displacement")
    for a, b in zip(made["loads"], direct["loads"]):
        close(a["contacts"][0]["headline"]["p99"], b["contacts"][0]["headline"]["p99"], 1e-3 * b["contacts"][0]["headline"]["p99"], "p99")


@check
def matrices_in_metres_are_questioned(folder):
    """A joint of 48 mm: translations below a hundredth of that are questioned where nobody says their unit, by build and by run."""
    ask = (*JOINT[:4], "--uniform", "ball=1.9", "--uniform", "socket=1.9", "--reach", "6", "--motion", "ball=m.csv")
    folder.write("m.csv", matrix_table("ball_T", (0, 0, 0.4)))
    done = folder.build(*ask, "--json", "j.json", "-q")
    same(done.returncode, 0, done.stderr)
    said = 'm.csv: its matrices of body "ball" have translations of at most 0.4 mm beside surfaces that are 46.4 mm large: if they are in m, say --motion-units m; if they are in mm, --motion-units mm [matrix-units]'
    true(f"warning: {said}\n" in done.stderr, done.stderr)
    made = json.loads(folder.read("j.json"))
    true(said in made["warnings"] and made["finding_values"][0]["code"] == "matrix-units", made["warnings"])
    ran = folder.dea("run", "j.feb", "--no-xplt", "--motion", "m.csv", "--motion-body", "ball", "--skip-steps")
    true("at most 0.4 mm beside surfaces that are" in ran.stderr and "--motion-units m; if they are in mm, --motion-units mm [matrix-units]" in ran.stderr, ran.stderr)
    for more in (("--motion-units", "mm"),):
        true("matrix-units" not in folder.build(*ask, *more).stderr, f"{more}")
        true("matrix-units" not in folder.dea("run", "j.feb", "--no-xplt", "--motion", "m.csv", "--motion-body", "ball", "--skip-steps", *more).stderr, f"run {more}")
    for name, shift in (("m.csv", (0, 0, 0.6)), ("m.csv", (0, 0, 0))):  # a small motion of some tenths, and none
        folder.write(name, matrix_table("ball_T", shift))
        true("matrix-units" not in folder.build(*ask).stderr, f"{shift}")
    done = folder.build(*JOINT, "--place", "ball=m.csv:1")
    true("matrix-units" not in done.stderr, done.stderr)
    folder.write("m.csv", matrix_table("ball_T", (0, 0, 0.1)))
    done = folder.build(*JOINT, "--place", "ball=m.csv:1")
    true('if they are in m, say --place-units "ball=m"; if they are in mm, --place-units "ball=mm" [matrix-units]' in done.stderr, done.stderr)


@check
def what_dea_run_warns_of_dea_build_tells_too(folder):
    """The warnings of dea run of the model, word by word, but those that dea build tells in its own words; none twice."""
    folder.write("few.csv", "tx,ty,tz\n0,0,0.02\n")
    wide = (*JOINT[:4], "--uniform", "ball=1.9", "--uniform", "socket=1.9", "--reach", "6")
    any_warned = False
    for words in ((*JOINT[:6], "--motion", "ball=few.csv"), (*wide, "--motion", "ball=few.csv"), (*JOINT[:-1], "ball=0,0,5")):
        done = folder.build(*words, "--json", "j.json", "--report", "j.html", "--overwrite")
        same(done.returncode, 0, done.stderr)
        ran = folder.dea("run", "j.feb", "--no-xplt", "--states", "last")
        expected = [line for line in ran.stderr.splitlines() if line.startswith("warning: ")]
        told = [line for line in done.stderr.splitlines() if line.startswith("warning: ")]
        any_warned = any_warned or bool(expected)
        same([line for line in told if line.endswith("]")], expected, f"{words}")
        same(len(told), len(set(told)), "told once")
        made = json.loads(folder.read("j.json"))
        for line in expected:
            true(line.removeprefix("warning: ") in made["warnings"], line)
        same([f"[{f['code']}]" for f in made["finding_values"]], [line[line.rindex("["):] for line in expected], "codes")
        true(all(json.dumps(f["code"])[1:-1] in folder.read("j.html") for f in made["finding_values"]), "the page")
        same(folder.build(*words, "-q").stderr.count("["), 0, "-q, as dea run -q")
    true(any_warned, "dea run warns of none of them")
    # a ball's own turn, which nothing resists: a note of dea run; and one on top of another, which stands on the brink
    done = folder.build(*JOINT, "--free", "ball=x,y,z,Rw")
    (held,) = [line for line in done.stderr.splitlines() if line.endswith("[motion-held]")]
    true(held in folder.dea("run", "j.feb", "--no-xplt", "--states", "last").stderr.splitlines(), held)
    folder.write("low.stl", stl(ball(16, 20)))
    folder.write("high.stl", stl(ball(16, 20, (0, 0, 43.5))))
    done = folder.build("--bone", "low=low.stl", "--bone", "high=high.stl", "--uniform", "low=1.5", "--uniform", "high=1.5", "--reach", "6", "--force", "high=0,0,-500")
    ran = folder.dea("run", "j.feb", "--no-xplt", "--states", "last")
    told, expected = ([line for line in text.splitlines() if "unstable" in line] for text in (done.stderr, ran.stderr))
    true(len(expected) == 1 and told == expected, f"{expected} {told}")


@check
def a_pose_that_leaves_force_over_is_no_balance(folder):
    """A ball on a flat plate slides away under a force that leans: whatever a search ends at, it is not told as a balance unless the
    contact bears the force."""
    folder.write("plate.stl", stl(block(12, 12, 30, 30, -10, True, lambda x, y: 0.0)))
    folder.write("ball.stl", stl(ball(16, 20, (0, 0, 23))))
    done = folder.build("--bone", "plate=plate.stl", "--bone", "ball=ball.stl", "--uniform", "plate=2", "--reach", "6", "--force", "ball=150,0,-500", "--json", "j.json", "-q")
    same(done.returncode, 1, done.stderr)
    true("no balance" in done.stderr, done.stderr)
    same(json.loads(folder.read("j.json"))["balanced"], False, "balanced")


# ---- anatomy, units, names ---------------------------------------------------------------------------------------------

def landmarks(forwards, scale=1.0, move=(0, 0, 0), side=1):
    """Spines of a pelvis in which the made socket, which opens along -z, opens forwards by `forwards` (a sine), 0.6 downwards and else to
    the right, with a `side` of -1 to the left; the hip's centre is the origin, on the right of the pelvis."""
    down = 0.6
    right = side * math.sqrt(1 - forwards ** 2 - down ** 2)
    # columns x, y, z of the body: each has z = -(its share of the opening); any such rotation does
    z_row = [-forwards, down, -right]
    first = [1 - z_row[0] * z_row[0], -z_row[0] * z_row[1], -z_row[0] * z_row[2]]
    size = math.sqrt(sum(c * c for c in first))
    x_row = [c / size for c in first]
    y_row = [z_row[1] * x_row[2] - z_row[2] * x_row[1], z_row[2] * x_row[0] - z_row[0] * x_row[2], z_row[0] * x_row[1] - z_row[1] * x_row[0]]
    rows = ["name,x,y,z"]
    for name, p in {"RASIS": (50, 80, 35), "LASIS": (50, 80, -205), "RPSIS": (-100, 80, -40), "LPSIS": (-100, 80, -130)}.items():
        rows.append(name + "," + ",".join("%.9g" % (scale * (sum(r[k] * p[k] for k in range(3)) + m)) for r, m in zip((x_row, y_row, z_row), move)))
    return "\n".join(rows) + "\n"


@check
def a_hip_against_its_axes_is_a_warning_that_is_not_quiet(folder):
    """On paper: the socket opens forwards by 0.3, or backwards: asin(0.3) = 17.5 degrees."""
    for forwards in (0.3, -0.3):
        folder.write("l.csv", landmarks(forwards))
        done = folder.build(*JOINT, "--landmarks", "l.csv", "-q", "--json", "j.json")
        same(done.returncode, 0, done.stderr)
        made = json.loads(folder.read("j.json"))
        close(made["hip"]["anteversion_radiographic"], math.degrees(math.asin(forwards)), 0.01, "anteversion")
        same(made["side"], "right", "side")
        said = [line for line in done.stderr.splitlines() if line.startswith("warning: hip: found a socket that opens backwards by 17.5 degrees")]
        same(len(said), 1 if forwards < 0 else 0, done.stderr)
        same(len(made["warnings"]), len(said), "warnings of JSON")


@check
def landmarks_in_another_unit_are_refused(folder):
    folder.write("metres.csv", landmarks(0.3, scale=1e-3, move=(0, 0, 500)))
    for name, shape in (("socket.stl", socket(16, 24)), ("ball.stl", ball(16, 20))):
        folder.write(name, stl(moved(shape, lambda p: (p[0], p[1], p[2] + 500))))
    # a landmark on the bone, so that it is known where they lie
    folder.write("metres.csv", folder.read("metres.csv") + "HJC,0,0,0.5\n")
    done = folder.build(*JOINT, "--landmarks", "metres.csv", "-q")
    same(done.returncode, 3, done.stderr)
    for words in ("metres.csv: found landmarks 0.", "from the bones, which are 4", "multiplied by 1000", "the landmarks look like m (--landmark-units m)"):
        true(words.replace("from", "away from") in done.stderr, f"{words}: {done.stderr}")
    done = folder.build(*JOINT, "--landmarks", "metres.csv", "--landmark-units", "m", "-q")
    same(done.returncode, 0, done.stderr)
    for words, code, said in ((["--landmark-units", "m"], 2, "found no landmarks"), (["--landmarks", "metres.csv", "--landmark-units", "inch"], 2, "mm, cm or m"),
                              (["--units", "m"], 3, "found bones 4.64e+04 mm large"), (["--scale", "0.001"], 3, "found bones 0.0464 mm large")):
        done = folder.build(*JOINT, *words, "-q")
        same(done.returncode, code, done.stderr)
        true(said in done.stderr, f"{said}: {done.stderr}")


@check
def a_modulus_in_pascals_is_questioned_before_the_work(folder):
    said = "cartilage: E = 1.2e+07 is 1.2e+07 MPa in the model's units, mm-N-s; cartilage has 0.1 to 100 MPa: check the modulus and the units"
    done = folder.build(*JOINT, "--E", "12e6", "--json", "j.json", "-q")
    same([line for line in done.stderr.splitlines() if "modulus" in line], ["warning: " + said], done.stderr)
    same(done.stderr.splitlines()[0], "warning: " + said, "what is said first")
    same([w for w in json.loads(folder.read("j.json"))["warnings"] if "modulus" in w], [said], "warnings of JSON")
    same("modulus" in folder.build(*JOINT, "--E", "12", "-q").stderr, False, "a modulus of cartilage")


@check
def loads_that_no_joint_bears_are_questioned(folder):
    folder.write("walk.csv", "time,fx,fy,fz\n0,0,0,500\n1,0,0,0\n")
    for words, said in (((), ""), (("--load-units", "mN-m"), "ball: found a table whose largest force is 0.5 N on "), (("--body-weight", "80"), "")):
        done = folder.build(*JOINT[:6], "--loads", "ball=walk.csv", *words, "--json", "j.json")
        warnings = [w for w in json.loads(folder.read("j.json"))["warnings"] if "joint surface" in w]
        same([w.startswith(said) and "(--load-units, --body-weight)" in w for w in warnings], [True] if said else [], done.stderr)
        true(("80 kg would be 784.8 N" in done.stderr) == ("80" in words), done.stderr)
    done = folder.build(*JOINT[:-1], "ball=0,0,0.5", "-q")
    true("ball: found a force of 0.5 N on " in done.stderr, done.stderr)
    done = folder.build(*JOINT[:-1], "ball=0,0,-500", "-q")  # out of the socket
    same(done.returncode, 1, done.stderr)
    true("moves the surfaces apart" in done.stderr and "(the opposite load would press them together: look at its sign)" in done.stderr, done.stderr)


@check
def what_is_no_cartilage_name_region_or_edge_is_refused(folder):
    folder.write("in.stl", stl(ball(12, 18)))
    folder.write("far.csv", "x,y,z,thickness\n0,0,20000,2\n")
    plain = ("--bone", "socket=socket.stl", "--bone", "ball=ball.stl", "--force", "ball=0,0,500", "-q")
    for words, code, said in (((*plain, "--cartilage", "ball=in.stl"), 3, "inside the bone, expected the cartilage's outer surface; are the files of bone and cartilage exchanged?"),
                              ((*plain, "--cartilage", "ball=ball.stl"), 3, "is the file the bone's own?"),
                              ((*plain, "--thickness-at", "ball=far.csv"), 3, "found its nearest point 1.998e+04 away from the bone, expected points on the bone"),
                              ((*JOINT, "--region", "ball=sphere:500,0,0,5", "-q"), 3, "found no part of it in the region that was given"),
                              ((*JOINT, "--edge", "0.01", "-q"), 3, "expected one that makes no more than 1e+06"),
                              (("--bone", " =socket.stl", *JOINT[2:], "-q"), 2, "expected NAME=FILE"),
                              (("--bone", "ball_cartilage=socket.stl", *JOINT[2:], "-q"), 2, "a part of \"ball\" has in the model"),
                              (("--bone", "cartilage=socket.stl", *JOINT[2:], "-q"), 2, "the cartilage's material")):
        done = folder.build(*words)
        same(done.returncode, code, f"{words}: {done.stderr}")
        true(said in done.stderr, f"{said}: {done.stderr}")


@check
def landmarks_as_slicer_5_writes_them(folder):
    """Two values more in each row than there are names."""
    rows = [r.split(",") for r in landmarks(0.3).split()[1:]]
    folder.write("l.fcsv", "# Markups fiducial file version = 5.2\n# CoordinateSystem = LPS\n"
                 "# columns = id,x,y,z,ow,ox,oy,oz,vis,sel,lock,label,desc,associatedNodeID\n"
                 + "".join(f"{i},{x},{y},{z},0,0,0,1,1,1,0,{name},,,2,0\n" for i, (name, x, y, z) in enumerate(rows)))
    done = folder.build(*JOINT, "--landmarks", "l.fcsv", "-q", "--json", "j.json")
    same(done.returncode, 0, done.stderr)
    close(json.loads(folder.read("j.json"))["hip"]["anteversion_radiographic"], math.degrees(math.asin(0.3)), 0.01, "anteversion")
    folder.write("l.csv", landmarks(0.3).encode("utf-16"))
    done = folder.build(*JOINT, "--landmarks", "l.csv", "-q")
    same(done.returncode, 3, done.stderr)
    true("l.csv: found text as UTF-16, expected UTF-8" in done.stderr, done.stderr)


@check
def a_model_of_somebody_elses_stays(folder):
    """One that dea build made gives way."""
    folder.write("mine.feb", "<febio_spec/>\n")
    done = folder.dea("build", "-o", "mine.feb", *JOINT, "-q")
    same((done.returncode, done.stdout), (4, ""), done.stderr)
    true("mine.feb: it is there already, not made by dea build; --overwrite replaces it" in done.stderr, done.stderr)
    same(folder.read("mine.feb"), "<febio_spec/>\n", "the model")
    for more in (("--overwrite",), ()):
        same(folder.dea("build", "-o", "mine.feb", *JOINT, "-q", *more).returncode, 0, more)
    true("Made by dea build" in folder.read("mine.feb"), "the mark")


@check
def files_beside_the_model_that_are_somebody_elses_stay(folder):
    """What dea build made gives way; frames with a user's settings are the user's."""
    folder.write("l.csv", landmarks(0.3))
    words = ("build", "-o", "own.feb", *JOINT, "--landmarks", "l.csv", "-q")
    for option, name in (("--json", "b.json"), ("--report", "b.html"), ("--frames", "b.xml")):
        folder.write(name, "mine\n")
        done = folder.dea(*words, option, name)
        same((done.returncode, folder.read(name)), (4, "mine\n"), done.stderr)
        true(f"{name}: it is there already, not made by dea; --overwrite replaces it, {option} writes another" in done.stderr, done.stderr)
        for more in (("--overwrite",), ()):
            same(folder.dea(*words, option, name, *more).returncode, 0, (option, more))
    frames = folder.read("b.xml")
    folder.write("b.xml", frames.replace("</febiodea_settings>", "<law>linear</law></febiodea_settings>"))
    same(folder.dea(*words, "--frames", "b.xml").returncode, 4, "frames with a setting")


@check
def options_that_no_joint_has_are_refused(folder):
    """Each by its own line, before a surface is read."""
    folder.write("points.csv", "x,y,z,thickness\n0,0,20,2\n")
    bones = ("--bone", "socket=socket.stl", "--bone", "ball=ball.stl")
    force = ("--force", "ball=0,0,500")
    for words, said in (
            ((*JOINT[:2], "--bone", "ba\tll=ball.stl", *JOINT[4:]), "--bone: found a control character in the name, expected letters, digits, spaces"),
            ((*JOINT, "--bone", "ball=socket.stl"), '--bone ball=socket.stl: found the name "ball" twice, expected another'),
            ((*JOINT[:2], *JOINT[4:]), "--bone: found fewer than two, expected --bone NAME=FILE for each bone of the joint"),
            ((*bones, *force, "--uniform", "ball=2", "--thickness-at", "ball=points.csv"), "--thickness-at ball: found a second cartilage of this bone, expected one"),
            ((*bones, *force, "--half-gap", "most=3,min=0.5"), '--half-gap most=3,min=0.5: found "most", expected max=A,min=B'),
            ((*JOINT, "--uniform", "ball=2", "--uniform", "socket=2"), "--half-gap max=3,min=0.5: every bone has its cartilage already, expected one without"),
            ((*JOINT, "--region", "ball=sphere:0,0,20,0"), "--region ball=sphere:0,0,20,0: found a radius of 0, expected one above 0"),
            ((*JOINT, "--region", "ball=plane:0,0,0,0,0,0"), "--region ball=plane:0,0,0,0,0,0: found a normal of no length, expected a direction"),
            ((*bones, *force, "--cartilage", "ball=in.stl", "--uniform", "socket=2", "--region", "ball=sphere:0,0,20,12"),
             "--region ball=sphere:0,0,20,12: the bone has no cartilage that is made here, expected --uniform, --half-gap or --thickness-at for it"),
            ((*JOINT, "--hip", "ball,ball"), "--hip ball,ball: found one bone twice, expected two bones, SOCKET,HEAD"),
            ((*JOINT, "--nu", "0.5"), '--nu 0.5: found "0.5", expected a number below 0.5')):
        done = folder.build(*words, "-q")
        same(done.returncode, 2, f"{words}: {done.stderr}")
        true(said in done.stderr, f"{said!r}: {done.stderr!r}")


@check
def files_beside_the_bones_are_refused(folder):
    plain = ("--bone", "socket=socket.stl", "--bone", "ball=ball.stl", "--force", "ball=0,0,500")
    folder.write("no_thickness.csv", "x,y,z,t\n0,0,20,2\n")
    folder.write("zero.csv", "x,y,z,thickness\n0,0,20,2\n0,0,20,0\n")
    markups = "# Markups fiducial file version = 4.11\n# CoordinateSystem = %s\n# columns = id,x,y,z,ow,ox,oy,oz,vis,sel,lock,label,desc,associatedNodeID\n1,%s,0,0,0,0,0,1,1,1,0,%s,,\n"
    folder.write("lps.fcsv", markups % ("LPS", 1, "RASIS"))
    folder.write("ras.fcsv", markups % ("RAS", 2, "LASIS"))
    folder.write("far.stl", stl(ball(12, 19, (100, 0, 0))))
    folder.write("left.csv", landmarks(0.3, side=-1))
    folder.write("plate.stl", stl(block(12, 12, 30, 30, -10, True, lambda x, y: 0.0)))
    folder.write("top.stl", stl(sheet(12, 12, lambda u, v: (40 * u - 20, 40 * v - 20, 1.0))))
    folder.write("beside.stl", stl(ball(12, 20, (53, 0, -5))))
    folder.write("in.stl", stl(ball(12, 23)))
    for words, said in (
            ((*plain, "--thickness-at", "ball=no_thickness.csv"), 'no_thickness.csv: found no column "thickness", expected x, y, z, thickness'),
            ((*plain, "--thickness-at", "ball=zero.csv"), "zero.csv:3: found a thickness of 0, expected one above 0"),
            ((*JOINT, "--landmarks", "lps.fcsv", "--landmarks", "ras.fcsv"), "ras.fcsv: found landmarks in RAS, and in LPS before, expected one of them"),
            ((*JOINT, "--landmarks", "left.csv"),
             "hip: found the socket open towards the middle of the body, for the landmarks, expected it to open to the right; are they in the bones' axes?"),
            ((*plain, "--cartilage", "ball=far.stl"), 'cartilage of "ball": found it 61.19 away from the bone where it is nearest, expected it on the bone'),
            ((*plain, "--cartilage", "socket=in.stl"), 'cartilage of "socket": found a closed surface with no side away from the bone, expected one'),
            (("--bone", "plate=plate.stl", "--bone", "ball=beside.stl", "--cartilage", "plate=top.stl", "--force", "ball=0,0,-500"),
             "found no two articular surfaces that face each other, expected a contact")):
        done = folder.build(*words, "-q")
        same(done.returncode, 3, f"{words}: {done.stderr}")
        true(said in done.stderr, f"{said!r}: {done.stderr!r}")


# ---- two programs ----------------------------------------------------------------------------------------------------

@check
def dea_build_is_found_beside_dea_or_on_the_path(folder):
    """Wherever it is found it writes the same model; where it is not, one line says what to install, and --help helps."""
    own = os.path.join(os.path.dirname(DEA), "dea-build")
    for path in ("a.feb", "b.feb", "c.feb"):
        program = {"a.feb": (DEA, "build"), "b.feb": (own,), "c.feb": ("alone/dea", "build")}[path]
        os.makedirs(os.path.join(folder.path, "alone"), exist_ok=True)
        shutil.copy(DEA, os.path.join(folder.path, "alone/dea"))
        called = {"env": {**os.environ, "PATH": os.path.dirname(DEA)}, "cwd": folder.path, "capture_output": True, "text": True}
        done = subprocess.run([*program, *JOINT, "-q", "-o", path], **called)
        same((done.returncode, folder.read(path)), (0, folder.read("a.feb")), done.stderr)
    called["env"]["PATH"] = folder.path
    done = subprocess.run(["alone/dea", "build", *JOINT, "-o", "d.feb"], **called)
    same((done.returncode, done.stdout, os.path.exists(os.path.join(folder.path, "d.feb"))), (2, "", False), done.stderr)
    same(done.stderr.count("\n"), 1, done.stderr)
    true("install the package febiodea-build" in done.stderr, done.stderr)
    same(subprocess.run(["alone/dea", "build", "--help"], **called).stdout, folder.dea("build", "--help").stdout, "the help")


@check
def a_signal_ends_dea_build_as_any_command(folder):
    folder.write("big.stl", stl(ball(160, 20)))
    building = subprocess.Popen([DEA, "build", "--bone", "socket=socket.stl", "--bone", "ball=big.stl", *JOINT[4:], "-o", "e.feb"], cwd=folder.path,
                                stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
    building.stderr.readline()  # its first word: the handlers are there
    building.send_signal(signal.SIGINT)
    rest = building.stderr.read()
    same(building.wait(), 130, rest)
    true("dea: stopped" in rest, rest)
    true(not os.path.exists(os.path.join(folder.path, "e.feb")), "a model is there all the same")


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
