#!/usr/bin/env python3
"""Joints made from seeds, as people model them: two bodies, cartilage of hexahedra on rigid bone, one contact or two.

    joints.py list                               what there is
    joints.py make NAME|all FOLDER [--finer]     FEBio models; --finer: a finer mesh and a higher penalty
    joints.py load DEA                           works out loads and seats anew, into loads.json beside this file

A joint's load has the size at which dea's largest pressure is a share of the cartilage's confined modulus that the seed draws; loads.json keeps
it with where dea seats the body, so that a model is the same whatever dea finds later. Numpy alone. mm, N, MPa."""
import json
import math
import pathlib
import subprocess
import sys
import tempfile

import numpy as np

HERE = pathlib.Path(__file__).resolve().parent
LOADS = HERE / "loads.json"
COUNTS = {"hip": 12, "knee": 6, "ankle": 6, "shoulder": 5, "finger": 3, "elbow": 2, "ball": 6}
NAMES = [f"{kind}_{k:02d}" for kind, count in COUNTS.items() for k in range(1, count + 1)]
# Drawn once, before any result was seen; never looked at while dea is changed.
UNTOUCHED = sorted(NAMES[k] for k in np.random.default_rng(54).choice(len(NAMES), 10, replace=False))
# With a finer mesh and a higher penalty, too: six chosen before, then five that dea was far from (shoulder_05 does not converge).
FINER = [next(n for n in NAMES if n.startswith(kind) and n not in UNTOUCHED) for kind in ("hip", "knee", "ankle", "shoulder", "finger", "ball")]
FINER += ["hip_05", "ankle_03", "shoulder_05", "elbow_02", "ball_03"]


# ---- patches: grids of points on an articular surface, directions into the bone, thickness ----

def unit(v):
    return v / np.linalg.norm(v, axis=-1, keepdims=True)


def frame(axis):
    """Three orthonormal directions, the last along `axis`."""
    c = unit(np.asarray(axis, float))
    a = unit(np.cross([0.0, 1.0, 0.0] if abs(c[1]) < 0.9 else [1.0, 0.0, 0.0], c))
    return np.array([a, np.cross(c, a), c])


def waves(rng, amplitude, length):
    """A smooth random field of points, about `amplitude` high, of waves about `length` long."""
    k, phase = rng.normal(size=(6, 3)), rng.uniform(0, 2 * math.pi, 6)
    k *= (2 * math.pi / length) * rng.uniform(0.6, 1.0, (6, 1)) / np.linalg.norm(k, axis=1, keepdims=True)
    return lambda x: amplitude * np.sqrt(2 / 6) * np.cos(x @ k.T + phase).sum(axis=-1)


def rim_distance(points):
    """Of each point of a grid from its nearest edge, along the grid's lines."""
    d = np.full(points.shape[:2], np.inf)
    for axis in (0, 1):
        steps = np.linalg.norm(np.diff(points, axis=axis), axis=-1)
        along = np.concatenate([np.zeros_like(np.take(steps, [0], axis)), np.cumsum(steps, axis)], axis)
        d = np.minimum(d, np.minimum(along, np.take(along, [-1], axis) - along))
    return d


def cap(axis, half, n, longer=1.0):
    """Directions of a square patch of a sphere about `axis`; `half`: its half angle; n points a side."""
    a, b = np.meshgrid(np.linspace(-half * longer, half * longer, round(1 + (n - 1) * longer)), np.linspace(-half, half, n), indexing="ij")
    return unit(np.stack([np.tan(a), np.tan(b), np.ones_like(a)], -1)) @ frame(axis)


def lunate(axis, inner, outer, around, open_to, n):
    """Directions of a horseshoe about `axis`, between two polar angles, open towards the azimuth `open_to`."""
    rows = max(5, round(n * 0.42))
    t, p = np.meshgrid(np.linspace(inner, outer, rows), open_to + math.pi + np.linspace(-around / 2, around / 2, round(n * 1.5)), indexing="ij")
    return np.stack([np.sin(t) * np.cos(p), np.sin(t) * np.sin(p), np.cos(t)], -1) @ frame(axis)


def graph(f, x, y):
    """Points of the surface z = f(x, y), and its normals up."""
    x, y = np.meshgrid(x, y, indexing="ij")
    e = 1e-4
    normal = unit(np.stack([-(f(x + e, y) - f(x - e, y)) / (2 * e), -(f(x, y + e) - f(x, y - e)) / (2 * e), np.ones_like(x)], -1))
    return np.stack([x, y, f(x, y)], -1), normal


class Patch:
    """Its margin is rounded: within 1.5 thicknesses of the rim the surface goes back, by a third of the thickness at the rim; the bone stays."""

    def __init__(self, name, body, points, into, thickness, material):
        self.name, self.body, self.into, self.material = name, body, into, material
        thickness = np.broadcast_to(thickness, points.shape[:2])
        back = 0.35 * thickness * np.clip(1 - rim_distance(points) / (1.5 * thickness), 0, 1) ** 2
        self.points, self.thickness = points + into * back[..., None], thickness - back


def round_patch(name, body, center, radius, directions, side, thickness, material, rough, uneven):
    """`side`: 1 for a socket, whose bone is outside, -1 for a ball."""
    points = center + directions * (radius + rough(directions * radius))[..., None]
    return Patch(name, body, points, side * directions, thickness * (1 + uneven(directions * radius)), material)


# ---- kinds ----

class Joint:
    """What is drawn: patches, pairs of them (primary, secondary), dofs of the body that moves, the direction of its load, the share of the confined
    modulus that its largest pressure is to reach."""

    def __init__(self, name, finer=False):
        self.name, self.kind = name, name.split("_")[0]
        self.rng = np.random.default_rng([54, NAMES.index(name)])
        self.finer = finer
        self.patches, self.pairs, self.free = [], [], "xyz"
        self.about = {}
        self.nu = self.draw("nu", 0.3, 0.49)
        self.moduli = [self.draw("E", 5, 15)]
        self.share = self.draw("share", 0.06, 0.16)
        getattr(self, self.kind)()

    def draw(self, what, least, most):
        x = round(float(self.rng.uniform(least, most)), 4)
        self.about[what] = x
        return x

    def size(self, n):
        return round(1 + (n - 1) * (1.75 if self.finer else 1.25))

    @property
    def layers(self):
        return 3 + (self.nu > 0.46) + self.finer

    def towards(self, axis, most):
        """A direction within an angle of `axis`."""
        tilt, around = self.draw("load off axis", 0, most), self.rng.uniform(0, 2 * math.pi)
        return np.array([math.sin(tilt) * math.cos(around), math.sin(tilt) * math.sin(around), math.cos(tilt)]) @ frame(axis)

    def ball_in_socket(self, head, clearance, t, half_socket, half_ball, axis, points, roughness=0.0, unevenness=0.0, socket=None, moduli=(0, 0), longer=1.0):
        """Layers (socket, ball) of thickness t; the moving ball's centre is where the surfaces just touch along `axis`."""
        rough = [waves(self.rng, roughness, head * 0.8) for _ in range(2)]
        uneven = [waves(self.rng, unevenness, head * 1.5) for _ in range(2)]
        pole = unit(np.asarray(axis, float))
        ns, nb = self.size(points), self.size(round(points * 1.35))
        directions = cap(axis, half_socket, ns, longer) if socket is None else socket(ns)
        center = np.zeros(3)
        self.patches = [
            round_patch("socket", "base", center, head + clearance, directions, 1, t[0], moduli[0], rough[0], uneven[0]),
            round_patch("ball", "mover", center + pole * (clearance - 2 * roughness), head, cap(axis, half_ball, nb, longer), -1, t[1], moduli[1], rough[1], uneven[1])]
        self.pairs = [(0, 1)]

    def hip(self):
        edge = math.radians(self.draw("center-edge angle", 10, 45))
        outer = math.radians(76)
        lateral = outer - edge  # of the socket's pole from the vertical, to the middle
        pole = np.array([-math.sin(lateral), 0.18, math.cos(lateral)])
        t = self.draw("thickness", 0.8, 2.5)
        uneven = self.draw("uneven", 0, 0.2)
        self.load = unit(np.array([self.rng.uniform(-0.35, 0.0), self.rng.uniform(-0.2, 0.15), 1.0]))
        notch = frame(pole) @ np.array([0.35, 0.0, -1.0])  # below
        open_to = math.atan2(notch[1], notch[0])
        self.ball_in_socket(self.draw("head", 22, 27), self.draw("clearance", 0.1, 0.9), (t, t * self.draw("head to socket", 0.7, 1.1)), 0, math.radians(64), unit(pole + np.array([0.45, 0, 0.6])), 30,
                            self.draw("rough", 0, 0.06), uneven, lambda n: lunate(pole, math.radians(26), outer, math.radians(250), open_to, round(n * 1.15)))

    def shoulder(self):
        t = self.draw("thickness", 1.2, 2.4)
        self.load = self.towards([0, 0, 1], 0.25)
        self.ball_in_socket(self.draw("head", 22, 27), self.draw("clearance", 1.0, 4.0), (t, 0.8 * t), math.radians(self.draw("half angle", 24, 32)), math.radians(42), [0, 0, 1], 23,
                            self.draw("rough", 0, 0.04), self.draw("uneven", 0, 0.15), longer=1.25)

    def ball(self):
        head = self.draw("head", 15, 30)
        self.moduli = [self.moduli[0], round(self.moduli[0] * math.exp(self.draw("log of moduli's ratio", -1.1, 1.1)), 4)]
        t = self.draw("thickness", 1.0, 3.0)
        self.load = self.towards([0, 0, 1], 0.2)
        self.ball_in_socket(head, head * self.draw("clearance to radius", 0.01, 0.2), (t, t * self.draw("ball to socket", 0.5, 2.0)), math.radians(self.draw("half angle", 38, 52)), math.radians(56), [0, 0, 1], 24,
                            moduli=(0, 1))

    def finger(self):
        head = self.draw("head", 3.5, 6)
        t = 0.5 * head * self.draw("thickness of both to radius", 0.2, 0.5)
        self.load = self.towards([0, 0, 1], 0.15)
        self.ball_in_socket(head, head * self.draw("clearance to radius", 0.03, 0.15), (t, t), math.radians(38), math.radians(52), [0, 0, 1], 22, 0.0, self.draw("uneven", 0, 0.1), longer=1.2)

    def elbow(self):
        head = self.draw("head", 8, 11)
        t = 0.5 * head * self.draw("thickness of both to radius", 0.2, 0.45)
        self.load = self.towards([0, 0, 1], 0.15)
        self.ball_in_socket(head, head * self.draw("clearance to radius", 0.02, 0.12), (t, t), math.radians(40), math.radians(54), [0, 0, 1], 22, 0.0, self.draw("uneven", 0, 0.12))

    def two_graphs(self, title, lower, upper, x, y, t, points, margin=1.12):
        """The lower surface is the base's, its bone below; the upper one the moving body's."""
        nx = self.size(points)
        ny = round(1 + (nx - 1) * (y[1] - y[0]) / (x[1] - x[0]))
        mx, my = (sum(x) / 2, (x[1] - x[0]) / 2 * margin), (sum(y) / 2, (y[1] - y[0]) / 2 * margin)
        more = 1.35
        p, up = graph(lower, np.linspace(*x, nx), np.linspace(*y, ny))
        q, down = graph(upper, np.linspace(mx[0] - mx[1], mx[0] + mx[1], round(nx * more)), np.linspace(my[0] - my[1], my[0] + my[1], round(ny * more)))
        uneven = [waves(self.rng, self.draw("uneven", 0, 0.15), 25) for _ in range(2)]
        self.patches += [Patch(f"{title}lower", "base", p, -up, t[0] * (1 + uneven[0](p)), 0), Patch(f"{title}upper", "mover", q, down, t[1] * (1 + uneven[1](q)), 0)]
        self.pairs.append((len(self.patches) - 2, len(self.patches) - 1))

    def knee(self):
        self.free = "z"
        t = (self.draw("plateau thickness", 1.8, 3.2), self.draw("condyle thickness", 1.4, 2.4))
        for title, sign in (("medial ", 1), ("lateral ", -1)):
            across, along = self.draw("radius across", 18, 26), self.draw("radius along", 24, 36)
            dish = self.draw("dish", -0.3, 0.75) if sign < 0 else self.draw("dish", 0.3, 0.75)  # the plateau's curvature to the condyle's
            x0 = 22.0 * sign
            condyle = lambda x, y, x0=x0, a=across, b=along: (x - x0) ** 2 / (2 * a) + y ** 2 / (2 * b) + 0.05  # noqa: E731
            plateau = lambda x, y, x0=x0, a=across, b=along, d=dish: 0.6 * abs(d) * (x - x0) ** 2 / (2 * a) + d * y ** 2 / (2 * b)  # noqa: E731
            self.two_graphs(title, plateau, condyle, (x0 - 11, x0 + 11), (-14, 14), t, 18)
        self.load = np.array([0, 0, -1.0])

    def ankle(self):
        r = self.draw("radius", 18, 24)
        saddle = self.draw("saddle", 0.0, 0.006)
        clearance = self.draw("clearance to radius", 0.01, 0.08)
        self.free = "yz" if saddle < 0.002 else "xyz"
        t = (self.draw("lower thickness", 0.9, 1.7), self.draw("upper thickness", 0.9, 1.7))
        # upside down: the tibia's roof as a saddle's trough below, the talus' dome above
        roof = lambda x, y: r * (1 + clearance) - np.sqrt((r * (1 + clearance)) ** 2 - y * y) - saddle * x * x  # noqa: E731
        dome = lambda x, y: r - np.sqrt(r * r - y * y) - saddle * (1 - clearance) * x * x + 0.05  # noqa: E731
        self.two_graphs("", roof, dome, (-12, 12), (-0.62 * r, 0.62 * r), t, 25)
        self.load = np.array([0, 0, -1.0]) if self.free == "yz" else unit(np.array([0.02, 0.08, -1.0]))

    # ---- as a FEBio model ----

    @property
    def confined(self):
        nu = self.nu
        return min(self.moduli) * (1 - nu) / ((1 + nu) * (1 - 2 * nu))

    def model(self, force, seat=None):
        """The text of the model. `force`: of the load on the moving body; `seat`: its translation at the end of the first step (none: there is
        no such step)."""
        nodes, solids, shells, surfaces, count = [], {}, {}, [], 0
        for patch in self.patches:
            rows, columns = patch.points.shape[:2]
            first, k = len(nodes), self.layers
            for level in range(k + 1):
                x = patch.points + (1 - level / k) * (patch.thickness[..., None] * patch.into)
                nodes += x.reshape(-1, 3).tolist()
            at = np.arange(rows * columns).reshape(rows, columns)
            quads = np.stack([at[:-1, :-1], at[1:, :-1], at[1:, 1:], at[:-1, 1:]], -1).reshape(-1, 4)
            p = patch.points.reshape(-1, 3)
            normal = np.cross(p[quads[:, 2]] - p[quads[:, 0]], p[quads[:, 3]] - p[quads[:, 1]])
            if (normal * patch.into.reshape(-1, 3)[quads[:, 0]]).sum() > 0:
                quads = quads[:, ::-1]
            level = lambda n: quads + 1 + first + n * rows * columns  # noqa: E731
            solids[patch] = np.concatenate([np.hstack([level(n), level(n + 1)]) for n in range(k)])
            shells[patch] = level(0)[:, ::-1]
            surfaces.append(level(k))
        out = ['<?xml version="1.0" encoding="ISO-8859-1"?>', '<febio_spec version="4.0">', '<Module type="solid"><units>mm-N-s</units></Module>', "<Material>"]
        for m, modulus in enumerate(self.moduli):
            out.append(f'<material id="{m + 1}" name="cartilage {m + 1}" type="neo-Hookean"><density>1</density><E>{modulus}</E><v>{self.nu}</v></material>')
        for b, body in enumerate(("base", "mover")):
            out.append(f'<material id="{len(self.moduli) + 1 + b}" name="{body}" type="rigid body"><density>1</density><center_of_mass>0,0,0</center_of_mass></material>')
        out += ["</Material>", "<Mesh>", "<Nodes>"]
        out += [f'<node id="{i + 1}">{x:.7g},{y:.7g},{z:.7g}</node>' for i, (x, y, z) in enumerate(nodes)] + ["</Nodes>"]

        def elements(kind, name, list):
            nonlocal count
            out.append(f'<Elements type="{kind}" name="{name}">')
            for e in list:
                count += 1
                out.append(f'<elem id="{count}">{",".join(map(str, e))}</elem>')
            out.append("</Elements>")
        for patch in self.patches:
            elements("hex8", f"{patch.name} cartilage", solids[patch])
        for patch in self.patches:
            elements("quad4", f"{patch.name} bone", shells[patch])
        for patch, facets in zip(self.patches, surfaces):
            out.append(f'<Surface name="{patch.name}">' + "".join(f'<quad4 id="{i + 1}">{",".join(map(str, f))}</quad4>' for i, f in enumerate(facets)) + "</Surface>")
        pair_names = [self.patches[a].name.replace("lower", "").replace("socket", "").strip() or "joint" for a, _ in self.pairs]
        for name, (a, b) in zip(pair_names, self.pairs):
            out.append(f'<SurfacePair name="{name}"><primary>{self.patches[a].name}</primary><secondary>{self.patches[b].name}</secondary></SurfacePair>')
        out += ["</Mesh>", "<MeshDomains>"]
        out += [f'<SolidDomain name="{p.name} cartilage" mat="cartilage {p.material + 1}"/>' for p in self.patches]
        out += [f'<ShellDomain name="{p.name} bone" mat="{p.body}"><shell_thickness>0</shell_thickness></ShellDomain>' for p in self.patches]
        held = lambda body, free: f'<rigid_bc name="{body} held" type="rigid_fixed"><rb>{body}</rb>' + "".join(f"<R{d}_dof>{int(d not in free)}</R{d}_dof>" for d in "xyzuvw") + "</rigid_bc>"  # noqa: E731
        out += ["</MeshDomains>", "<Rigid>", held("base", ""), held("mover", self.free), "</Rigid>", "<Contact>"]
        penalty = 10 if self.finer else 4
        out += [f'<contact name="{name}" type="sliding-elastic" surface_pair="{name}"><laugon>PENALTY</laugon><penalty>{penalty}</penalty><auto_penalty>1</auto_penalty><two_pass>0</two_pass>'
                f'<symmetric_stiffness>0</symmetric_stiffness><search_radius>1</search_radius><search_tol>0.01</search_tol><fric_coeff>0</fric_coeff></contact>' for name in pair_names]
        out += ["</Contact>", "<Step>"]

        def control(steps, plot):
            return (f"<Control><analysis>STATIC</analysis><time_steps>{steps}</time_steps><step_size>{1 / steps}</step_size><plot_level>{plot}</plot_level>"
                    f'<time_stepper type="default"><max_retries>10</max_retries><opt_iter>12</opt_iter><dtmin>0.0001</dtmin><dtmax>{1 / steps}</dtmax></time_stepper>'
                    '<solver type="solid"><symmetric_stiffness>non-symmetric</symmetric_stiffness><max_refs>30</max_refs><dtol>0.001</dtol><etol>0.01</etol><rtol>0</rtol><lstol>0.9</lstol>'
                    '<lsmin>0.01</lsmin><lsiter>5</lsiter><qn_method type="BFGS"><max_ups>0</max_ups></qn_method></solver></Control>')
        if seat is not None:
            out += ['<step id="1" name="seat">', control(16, "PLOT_NEVER"), "<Rigid>"]
            out += [f'<rigid_bc name="seat {d}" type="rigid_displacement"><rb>mover</rb><dof>{d}</dof><value lc="1">{x}</value><relative>0</relative></rigid_bc>' for d, x in zip("xyz", seat) if d in self.free]
            out += ["</Rigid>", "</step>"]
        out += [f'<step id="{1 if seat is None else 2}" name="load">', control(2, "PLOT_FINAL"), "<Rigid>"]
        out += [f'<rigid_load name="load {d}" type="rigid_force"><rb>mover</rb><dof>R{d}</dof><value>{x:.6g}</value><load_type>LOAD</load_type><relative>0</relative></rigid_load>' for d, x in zip("xyz", force) if d in self.free]
        out += ["</Rigid>", "</step>", "</Step>", '<LoadData><load_controller id="1" name="seat" type="loadcurve"><interpolate>LINEAR</interpolate><extend>CONSTANT</extend><points><pt>0,0</pt><pt>0.2,0.6</pt><pt>1,1</pt></points></load_controller></LoadData>']
        out += ['<Output><plotfile type="febio"><compression>1</compression>' + "".join(f'<var type="{v}"/>' for v in ("displacement", "stress", "contact pressure", "contact gap", "contact force", "contact area", "rigid force", "rigid position")) + "</plotfile></Output>", "</febio_spec>", ""]
        return "\n".join(out)


def solved(dea, joint, force):
    """dea's last state: its largest p99 of a contact, and the translation of the moving body."""
    with tempfile.TemporaryDirectory() as folder:
        path = pathlib.Path(folder) / "joint.feb"
        path.write_text(joint.model(force))
        done = subprocess.run([dea, "run", path, "--no-xplt", "--states", "last", "-q", "--json", "-"], capture_output=True, text=True)
        if done.returncode != 0:
            raise SystemExit(f"{joint.name}: {done.stderr}")
        state = json.loads(done.stdout)["states"][-1]
    heads = [c["headline"]["p99"] or 0 for c in state["contacts"]]
    return max(heads), state["bodies"]["mover"]["translation"]


def load(dea):
    found = {}
    for name in NAMES:
        joint = Joint(name)
        size = 0.3 * joint.share * joint.confined * {"finger": 20, "elbow": 100}.get(joint.kind, 300)
        for _ in range(6):
            p99, seat = solved(dea, joint, size * joint.load)
            wanted = joint.share * joint.confined
            if abs(p99 / wanted - 1) < 0.03:
                break
            size *= min(4.0, max(0.25, (wanted / p99) ** 1.7))
        size = float(f"{size:.4g}")
        _, seat = solved(dea, joint, size * joint.load)
        found[name] = {"size": size, "seat": [float(f"{x:.5g}") for x in seat]}
        print(name, found[name], f"p99 {p99:.3g} of {joint.confined:.3g}", flush=True)
        LOADS.write_text(json.dumps(found, indent=1) + "\n")


def make(name, folder, finer=False):
    joint, about = Joint(name, finer), json.loads(LOADS.read_text())[name]
    path = pathlib.Path(folder) / f"{name}{'_finer' if finer else ''}.feb"
    path.write_text(joint.model(about["size"] * joint.load, about["seat"]))
    return path


def main():
    words = [w for w in sys.argv[1:] if w != "--finer"]
    finer = len(words) < len(sys.argv) - 1
    if words == ["list"]:
        for name in NAMES:
            print(name, *("untouched",) * (name in UNTOUCHED), *("finer",) * (name in FINER), Joint(name).about)
    elif len(words) == 2 and words[0] == "load":
        load(words[1])
    elif len(words) == 3 and words[0] == "make" and (words[1] == "all" or words[1] in NAMES):
        for name in NAMES if words[1] == "all" else [words[1]]:
            print(make(name, words[2], finer))
    else:
        sys.exit(__doc__)


if __name__ == "__main__":
    main()
