"""large_model.py: seconds and peak memory of dea info and dea run on a ball in its socket, with millions of hexahedra, or with thousands of states.
What is printed and how to read it: README.md."""
import argparse
import math
import os
import pathlib
import subprocess
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parents[1]
INTERFACE, CARTILAGE, BONE = 22.0, 2.0, 10.0  # [mm]: radius at which the layers meet, thickness of each layer and bone


def hemisphere(n):
    """Points and quads of the unit sphere's upper half, as the upper half of a cube whose lines are spread evenly in angle: 3 n n quads, outwards."""
    points, quads, index = [], [], {}

    def coordinate(i):
        return math.copysign(1.0 if abs(i) == n else math.tan(math.pi / 4 * abs(i) / n), i) if i else 0.0

    def point(i, j, k):
        if (i, j, k) not in index:
            index[i, j, k] = len(points)
            x, y, z = coordinate(i), coordinate(j), coordinate(k)
            length = math.sqrt(x * x + y * y + z * z)
            points.append((x / length, y / length, z / length))
        return index[i, j, k]

    for j in range(-n, n, 2):
        for i in range(-n, n, 2):
            quads.append((point(i, j, n), point(i + 2, j, n), point(i + 2, j + 2, n), point(i, j + 2, n)))
    sides = [lambda a, k: point(n, a, k), lambda a, k: point(-a, n, k), lambda a, k: point(-n, -a, k), lambda a, k: point(a, -n, k)]
    for k in range(n, 0, -2):
        for side in sides:
            for a in range(-n, n, 2):
                quads.append((side(a, k - 2), side(a + 2, k - 2), side(a + 2, k), side(a, k)))
    return points, quads


def write_model(path, n, cartilage, bone, states=1):
    """Both layers `cartilage` hexahedra deep on bones `bone` hexahedra deep, 3 n n in each sheet. Returns how many hexahedra and nodes there are."""
    points, quads = hemisphere(n)
    count, elements = len(points), 0

    def sheet(out, radius):
        nonlocal node
        for x, y, z in points:
            node += 1
            out.write(f'<node id="{node}">{radius * x:.9g},{radius * y:.9g},{radius * z:.9g}</node>\n')

    # radii of the sheets of nodes, from the inside outwards; bone and cartilage share one
    ball = [INTERFACE - CARTILAGE - BONE + BONE * k / bone for k in range(bone)] + [INTERFACE - CARTILAGE + CARTILAGE * k / cartilage for k in range(cartilage + 1)]
    socket = [INTERFACE + CARTILAGE * k / cartilage for k in range(cartilage + 1)] + [INTERFACE + CARTILAGE + BONE * k / bone for k in range(1, bone + 1)]
    first_of_socket = len(ball) * count
    parts = [("ball_bone", "ball", 0, bone), ("ball_layer", "ball cartilage", bone * count, cartilage),
             ("socket_layer", "socket cartilage", first_of_socket, cartilage), ("socket_bone", "socket", first_of_socket + cartilage * count, bone)]
    with open(path, "w") as out:
        out.write('<?xml version="1.0" encoding="ISO-8859-1"?>\n<febio_spec version="4.0">\n<Module type="solid">\n<units>mm-N-s</units>\n</Module>\n<Material>\n')
        for i, name in enumerate(("ball cartilage", "socket cartilage"), 1):
            out.write(f'<material id="{i}" name="{name}" type="neo-Hookean">\n<density>1</density>\n<E>11.85</E>\n<v>0.45</v>\n</material>\n')
        for i, name in enumerate(("ball", "socket"), 3):
            out.write(f'<material id="{i}" name="{name}" type="rigid body">\n<density>1</density>\n<center_of_mass>0,0,0</center_of_mass>\n</material>\n')
        out.write('</Material>\n<Mesh>\n<Nodes name="all">\n')
        node = 0
        for radius in ball + socket:
            sheet(out, radius)
        out.write("</Nodes>\n")
        for name, _, begin, sheets in parts:
            out.write(f'<Elements type="hex8" name="{name}">\n')
            for s in range(sheets):
                low, high = begin + s * count + 1, begin + (s + 1) * count + 1
                for a, b, c, d in quads:
                    elements += 1
                    out.write(f'<elem id="{elements}">{low + a},{low + b},{low + c},{low + d},{high + a},{high + b},{high + c},{high + d}</elem>\n')
            out.write("</Elements>\n")
        for name, begin, turned in (("ball_articular", (bone + cartilage) * count + 1, False), ("socket_articular", first_of_socket + 1, True)):
            out.write(f'<Surface name="{name}">\n')
            for i, (a, b, c, d) in enumerate(quads, 1):
                out.write(f'<quad4 id="{i}">{",".join(str(begin + v) for v in ((a, d, c, b) if turned else (a, b, c, d)))}</quad4>\n')
            out.write("</Surface>\n")
        out.write('<SurfacePair name="joint">\n<primary>socket_articular</primary>\n<secondary>ball_articular</secondary>\n</SurfacePair>\n</Mesh>\n<MeshDomains>\n')
        for name, material, _, _ in parts:
            out.write(f'<SolidDomain name="{name}" mat="{material}"/>\n')
        out.write('</MeshDomains>\n<Rigid>\n')
        for body, held in (("socket", "111111"), ("ball", "000111")):
            dofs = "".join(f"<R{axis}_dof>{on}</R{axis}_dof>\n" for axis, on in zip("xyzuvw", held))
            out.write(f'<rigid_bc name="{body} held" type="rigid_fixed">\n<rb>{body}</rb>\n{dofs}</rigid_bc>\n')
        out.write('</Rigid>\n<Contact>\n<contact name="joint" type="sliding-elastic" surface_pair="joint"/>\n</Contact>\n<Step>\n<step id="1" name="load">\n'
                  f'<Control>\n<analysis>STATIC</analysis>\n<time_steps>{states}</time_steps>\n<step_size>{1 / states:.15g}</step_size>\n</Control>\n<Rigid>\n'
                  '<rigid_load name="load" type="rigid_force">\n<rb>ball</rb>\n<dof>Rz</dof>\n<value lc="1">2000</value>\n<load_type>LOAD</load_type>\n'
                  '<relative>0</relative>\n</rigid_load>\n</Rigid>\n</step>\n</Step>\n<LoadData>\n<load_controller id="1" type="loadcurve">\n'
                  '<interpolate>LINEAR</interpolate>\n<points>\n<pt>0,0</pt>\n<pt>1,1</pt>\n</points>\n</load_controller>\n</LoadData>\n</febio_spec>\n')
    return elements, node


def measured(words, folder):
    """Exit code, wall seconds, the processors' seconds, peak [GB], and what stood on standard error."""
    start = time.perf_counter()
    process = subprocess.Popen(words, cwd=folder, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
    told = process.stderr.read()
    _, status, used = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    return process.returncode, time.perf_counter() - start, used.ru_utime + used.ru_stime, used.ru_maxrss * 1024 / 1e9, told


def line(dea, folder, words, title):
    code, seconds, processors, peak, told = measured([str(dea), *words], folder)
    print(f"{title:<42}{code:>6}{seconds:>8.1f}{processors:>8.1f}{1000 * peak:>10.0f}", flush=True)
    if code != 0:
        print(told, end="")


def heading(first):
    print(f"{first:<42}{'code':>6}{'s':>8}{'CPU s':>8}{'peak MB':>10}")


def many_elements(a, folder):
    heading("command")
    for words in (["info"], ["run", "--law", "linear"], ["run", "--law", "layer"]):
        line(a.dea, folder, [words[0], "ball.feb", *words[1:], *(["--overwrite"] if words[0] == "run" else [])], "dea " + " ".join(words))


def many_states(a, folder):
    heading("files")
    for states in a.states:
        write_model(os.path.join(folder, "ball.feb"), a.edge, a.cartilage, a.bone, states)
        for title, files in ((".xplt", ""), (".xplt, JSON, both CSV, VTU", "--csv a.csv --json a.json --facets-csv facets.csv --vtu vtu"),
                             (".xplt, page", "--report page.html")):
            with tempfile.TemporaryDirectory() as own:
                model = os.path.join(folder, "ball.feb")
                words = ["run", model, "--law", "linear", "--threads", "1", "-q", "-o", "plot.xplt", *files.split()]
                line(a.dea, own, words, f"{states} states: {title}")


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--edge", type=int, help="quads along an edge of the cube, even: 3 N N in each sheet")
    parser.add_argument("--cartilage", type=int, default=4, help="hexahedra through each layer")
    parser.add_argument("--bone", type=int, default=12, help="hexahedra through each bone")
    parser.add_argument("--states", type=int, nargs="+", help="runs of so many states instead, with each kind of file")
    parser.add_argument("--dea", type=pathlib.Path, default=ROOT / "build/release/app/dea")
    a = parser.parse_args()
    a.edge = a.edge or (10 if a.states else 146)
    with tempfile.TemporaryDirectory() as folder:
        model = os.path.join(folder, "ball.feb")
        elements, nodes = write_model(model, a.edge, a.cartilage, a.bone)
        print(f"{elements} hexahedra, {nodes} nodes, {3 * a.edge ** 2} facets on each side, {os.path.getsize(model) / 1e6:.1f} MB")
        (many_states if a.states else many_elements)(a, folder)


if __name__ == "__main__":
    main()
