#!/usr/bin/env python3
"""The joint in the hand, in a headless Chromium, against the native program: in_hand.py DEA PAGE.html [CHECK...]

Exit code 77: there is no chromedriver. Python's standard library only."""
import csv
import io
import json
import math
import pathlib
import shlex
import shutil
import subprocess
import sys
import time

sys.dont_write_bytecode = True
from page import HIP, KNEE, drop, in_page, ready, recognised, run_all, same_numbers, setting, solve, workers  # noqa: E402
from browser import Browser  # noqa: E402
from report_test import no_faults, no_network, same, true  # noqa: E402

NEAR = 1e-9  # of the largest number of its kind
EXACT = "document.getElementById('hand') && document.getElementById('hand').dataset.exact === 'true' && Live.hand.settled"
CHECKS = []


def check(function):
    CHECKS.append(function)
    return function


# ---- what tests ask of the page ----

def take(b, pages, *files, **settings):
    b.log("performance")
    ready(b, pages)
    drop(b, *files)
    recognised(b)
    for name, value in settings.items():
        setting(b, "--" + name.replace("_", "-"), *((value,) if isinstance(value, str) else value))
    solve(b)
    b.wait("document.getElementById('take')", 20, "the button")
    b.click("#take")
    b.wait(EXACT, 120, "the first exact answer")


def put(b, key, value, nth=0):
    """Types a number, or chooses a word, in the nth row of this key."""
    b.run("""const [key, value, nth] = arguments, r = Live.rows.filter(r => r.about.key === key)[nth];
             const e = r.element.querySelector('input[type=number], input[type=text], select');
             e.value = value;
             e.dispatchEvent(new Event('change', { bubbles: true }))""", key, value, nth)
    b.wait(EXACT, 120, f"the exact answer of {key} {value}")


def line(b):
    """Words behind dea."""
    return shlex.split(b.run("return document.getElementById('hand-line').textContent"))[1:]


def state(b):
    return b.run("return Live.shown.answer.text.state")


def native(pages, words, code=None):
    """The last state that dea run gives of these words, in the folder of the pages."""
    done = subprocess.run([pages["dea"], *words, "--no-xplt", "--json", "-", "-q"], cwd=pages["folder"], capture_output=True, text=True)
    true(done.returncode in ((0, 1) if code is None else (code,)), f"dea {' '.join(words)}: exit {done.returncode}: {done.stderr}")
    return json.loads(done.stdout)["states"][-1]


def plain(state):
    """Without how the search went; a driver knows neither the order of keys nor whole numbers from others."""
    search = ("least_stiffness", "iterations", "unstable", "held_directions")

    def sorted_of(x):
        if isinstance(x, dict):
            return {k: sorted_of(x[k]) for k in sorted(x) if k not in search}
        if isinstance(x, list):
            return [sorted_of(v) for v in x]
        return float(x) if isinstance(x, int) and not isinstance(x, bool) else x
    return sorted_of(state)


def as_dea_run(b, pages, what, near=NEAR):
    """What is shown has the numbers of the line that stands there."""
    run = native(pages, line(b))
    shown = state(b)
    same(shown["outcome"], run["outcome"], what)
    same_solved = run["outcome"] == "Balanced"
    if same_solved:
        worst = same_numbers(plain(shown), plain(run), what, near)
        head = run["contacts"][0]["headline"]
        cells = b.run("return [...document.querySelectorAll('#hand-numbers tr')[1].querySelectorAll('td')].map(td => Number(td.textContent.replace('−', '-')))")
        for name, found in zip(("p99", "mean", "area", "peak"), cells):
            true(abs(found - head[name]) <= 1e-3 * abs(head[name]), f"{what}: {name} {found}, natively {head[name]}")
        return worst[0]
    no_map(b, what)
    return 0.0


def no_map(b, what):
    """Nothing of another place is left where there is no solution."""
    same(b.run("return document.querySelectorAll('#hand-numbers td').length"), 0, f"{what}: numbers of what has no solution")
    same(in_page(b, 0, lambda b: b.run("return [Page.panels[0].message, Page.panels[0].what.vertices, Page.panels[0].what.facets, Page.panels[0].marks.length]")),
         ["no solution here", None, None, 0], f"{what}: the map")
    true(b.run("return document.getElementById('hand-what').textContent.startsWith('No solution') && document.querySelectorAll('#hand-remarks li').length > 0"), f"{what}: why")


def two_wells(path):
    """A ball that its load presses into one of two hollows of a bed of cartilage, at x = 8 and -8."""
    nx, ny, nodes, beds, bones = 48, 8, [], [], []
    height = lambda x, y: 2.5 * ((x / 8) ** 2 - 1) ** 2 + y * y / 60  # noqa: E731
    for z in (-1, 0):
        nodes += [(x, y, height(x, y) + z) for y in (-6 + 12 * j / ny for j in range(ny + 1)) for x in (-12 + 24 * i / nx for i in range(nx + 1))]
    layer, row = (nx + 1) * (ny + 1), nx + 1
    for j in range(ny):
        for i in range(nx):
            a = j * row + i + 1
            bottom = (a, a + 1, a + row + 1, a + row)
            beds.append(bottom + tuple(n + layer for n in bottom))
            bones.append(bottom)
    tops, balls, first, n, radius = [b[4:] for b in beds], [], len(nodes), 16, 4.0
    for j in range(n + 1):
        for i in range(n + 1):
            x, y = -2.4 + 4.8 * i / n, -2.4 + 4.8 * j / n
            nodes.append((8 + x, y, radius - (radius ** 2 - x * x - y * y) ** 0.5 + 0.02))
    for j in range(n):
        for i in range(n):
            a = first + j * (n + 1) + i + 1
            balls.append((a, a + n + 1, a + n + 2, a + 1))
    rows = lambda name, kind, list, start: f'<Elements type="{kind}" name="{name}">' + "".join(f'<elem id="{start + k}">{",".join(map(str, e))}</elem>' for k, e in enumerate(list)) + "</Elements>"  # noqa: E731
    faces = lambda name, list: f'<Surface name="{name}">' + "".join(f'<quad4 id="{k + 1}">{",".join(map(str, e))}</quad4>' for k, e in enumerate(list)) + "</Surface>"  # noqa: E731
    held = lambda body, dofs: f'<rigid_bc name="{body} held" type="rigid_fixed"><rb>{body}</rb>' + "".join(f"<{d}_dof>{int(d in dofs)}</{d}_dof>" for d in ("Rx", "Ry", "Rz", "Ru", "Rv", "Rw")) + "</rigid_bc>"  # noqa: E731
    load = lambda dof, x: f'<rigid_load name="load {dof}" type="rigid_force"><rb>ball</rb><dof>{dof}</dof><value lc="1">{x}</value></rigid_load>'  # noqa: E731
    path.write_text(f"""<?xml version="1.0"?>
<febio_spec version="4.0"><Module type="solid"/>
<Material><material id="1" name="cartilage" type="neo-Hookean"><density>1</density><E>5</E><v>0.4</v></material>
<material id="2" name="base" type="rigid body"><density>1</density><center_of_mass>0,0,0</center_of_mass></material>
<material id="3" name="ball" type="rigid body"><density>1</density><center_of_mass>8,0,4</center_of_mass></material></Material>
<Mesh><Nodes>{"".join(f'<node id="{k + 1}">{x:.9g},{y:.9g},{z:.9g}</node>' for k, (x, y, z) in enumerate(nodes))}</Nodes>
{rows("bed", "hex8", beds, 1)}{rows("base_bone", "quad4", bones, 1001)}{rows("ball_bone", "quad4", balls, 2001)}
{faces("bed_top", tops)}{faces("ball_face", balls)}
<SurfacePair name="joint"><primary>bed_top</primary><secondary>ball_face</secondary></SurfacePair></Mesh>
<MeshDomains><SolidDomain name="bed" mat="cartilage"/><ShellDomain name="base_bone" mat="base"><shell_thickness>0</shell_thickness></ShellDomain>
<ShellDomain name="ball_bone" mat="ball"><shell_thickness>0</shell_thickness></ShellDomain></MeshDomains>
<Rigid>{held("base", ("Rx", "Ry", "Rz", "Ru", "Rv", "Rw"))}{held("ball", ("Ry", "Ru", "Rv", "Rw"))}{load("Rx", 1)}{load("Rz", -20)}</Rigid>
<Contact><contact name="joint" type="sliding-elastic" surface_pair="joint"/></Contact>
<Control><analysis>STATIC</analysis><time_steps>1</time_steps><step_size>1</step_size></Control>
<LoadData><load_controller id="1" type="loadcurve"><interpolate>LINEAR</interpolate><points><pt>0,0</pt><pt>1,1</pt></points></load_controller></LoadData>
</febio_spec>
""")


def drag(b, move):
    """A slider goes over five places and rests; which one, `move` says: (key, nth, share of its range per place)."""
    b.run("""const [key, nth, share] = arguments, r = Live.rows.filter(r => r.about.key === key)[nth], range = r.element.querySelector('input[type=range]'), a = r.about;
             window.moves = 0;
             const steps = Number(range.max) - Number(range.min), at = Number(range.value);
             for (let k = 1; k <= 5; ++k) setTimeout(() => {
               range.value = at + Math.round(k * share * steps);
               range.dispatchEvent(new Event('input', { bubbles: true }));
               if (k === 5) range.dispatchEvent(new Event('change', { bubbles: true }));
               ++window.moves;
             }, 25 * k);""", *move)
    b.wait("window.moves === 5 && " + EXACT, 120, f"the exact answer after {move}")


def handle_at(b, key):
    """Where a handle can be grabbed, in the window; its panel is scrolled to."""
    inside = in_page(b, 0, lambda b: b.run("""
        const p = Page.panels[0], c = p.canvas, m = Page.maps;
        c.scrollIntoView({ block: 'center' });
        const w = c.clientWidth, h = c.clientHeight, x = m.placedHandles(p, w, h, 1, m.aim(w, h, p.offset)).find(x => x.handle.key === arguments[0]);
        return [x.handle.kind === 'turn' ? x.line[20] : x.line[1]][0]""", key))
    return b.run("""const f = document.querySelector('#result iframe'), r = f.getBoundingClientRect(), c = f.contentDocument.querySelector('.panel canvas').getBoundingClientRect();
                    return [r.left + f.clientLeft + c.left + arguments[0], r.top + f.clientTop + c.top + arguments[1]]""", *inside)


# ---- checks ----

@check
def twenty_places_give_what_dea_run_gives(b, pages):
    take(b, pages, HIP)
    times, worst = [], 0.0
    moves = [(k, n, s) for k, count in (("turn", 3), ("move", 3), ("force", 3)) for n in range(count) for s in (0.02, -0.012)]
    moves += [("E", 0, 0.03), ("E", 1, -0.02), ("thickness-scale", 1, 0.04), ("size", 0, 0.05)]
    for i, move in enumerate(moves):
        drag(b, move)
        worst = max(worst, as_dea_run(b, pages, f"step {i}, {move}"))
        times.append(b.run("return 1000 * Live.shown.answer.seconds"))
        if i == 3:
            b.click("#hand-undo")
            b.wait(EXACT, 60, "the answer before")
    put(b, "law", "linear")
    as_dea_run(b, pages, "law linear")
    put(b, "nu", 0.4)
    as_dea_run(b, pages, "nu")
    put(b, "time", 21)
    worst = max(worst, as_dea_run(b, pages, "an earlier time"))
    same(line(b)[-2:], ["--states", "1.5"], "the time in the line")
    print(f"        {len(moves)} places: numbers within {worst:.1e}; exact answers: median {sorted(times)[len(times) // 2]:.0f} ms, largest {max(times):.0f} ms")
    same(in_page(b, 0, lambda b: b.run("return document.getElementById('now').textContent")), "in the hand", "what the map says it is")
    same(len(workers(b)), 2, "workers of the hand")
    b.click("#hand-reset")
    b.wait(EXACT, 60, "the model's own place")
    same(line(b)[2:], ["--states", "last"], "the line of the model's own place")
    b.click("#hand-down")
    same(in_page(b, 0, lambda b: b.run("return [Page.state.held, document.getElementById('now').textContent.includes('hand'), Page.panels.length > 1]")), [None, False, True], "the run's own states")
    b.click("#take")
    b.wait(EXACT, 60, "the first exact answer, again")
    drop(b, KNEE)
    recognised(b)
    same(b.run("return document.getElementById('hand')"), None, "the hand of another model")
    same(len(workers(b)), 0, "workers that are left")
    no_network(b, "the page")
    no_faults(b, "the page")


@check
def a_place_without_a_solution_has_no_map(b, pages):
    take(b, pages, HIP)
    put(b, "law", "linear")
    put(b, "size", 62000)
    same(state(b)["outcome"], "BeyondStrainLimit", "outcome")
    as_dea_run(b, pages, "beyond the strain limit")
    b.click("#hand-undo")
    b.wait(EXACT, 60, "the answer before")
    as_dea_run(b, pages, "back")
    for n, x in enumerate((0, 0, -200)):
        put(b, "force", x, n)
    same(state(b)["outcome"], "SurfacesApart", "outcome")
    as_dea_run(b, pages, "apart")
    put(b, "E", -3)
    why = b.run("return document.getElementById('hand-remarks').textContent")
    true("found \"-3\", expected a number > 0" in why, f"the refusal of dea run: {why}")
    same(b.run("return document.getElementById('hand-what').textContent"), "No answer", "a line that is refused")
    same(in_page(b, 0, lambda b: b.run("return Page.panels[0].message")), "no solution here", "its map")


@check
def the_knee_follows_the_hand(b, pages):
    take(b, pages, KNEE)
    worst = as_dea_run(b, pages, "knee", 1e-7)
    coarse = []
    for move in (("E", 0, 0.02), ("size", 0, 0.03), ("turn", 1, 0.01)):
        drag(b, move)
        worst = max(worst, as_dea_run(b, pages, f"knee, {move}", 1e-6))
    b.run("window.seen = []; const show = Live.hand.show; Live.hand.show = (a, q) => { if (q.quick) window.seen.push(a.seconds); show(a, q); }")
    for _ in range(4):
        drag(b, ("size", 0, -0.004))
    coarse = sorted(b.run("return window.seen"))
    print(f"        numbers within {worst:.1e}; {len(coarse)} coarse answers: median {1000 * coarse[len(coarse) // 2]:.0f} ms, largest {1000 * coarse[-1]:.0f} ms")
    put(b, "force", -4000, 2)  # nothing holds the shank on that side
    if state(b)["outcome"] != "Balanced":
        no_map(b, "no balance")


@check
def what_the_line_had_is_where_the_hand_begins(b, pages):
    more = "--rotate-about femur=com --thickness-scale 1.2 --states 0.5:1.5 --layer-terms 1 --frame 'left hip=0,1,0/0,0,1/1,0,0'"
    ready(b, pages)
    drop(b, HIP)
    recognised(b)
    b.run("const e = document.getElementById('more'); e.value = arguments[0]; e.dispatchEvent(new Event('input', { bubbles: true }))", more)
    recognised(b)
    solve(b)
    b.wait("document.getElementById('take')", 20, "the button")
    b.click("#take")
    b.wait(EXACT, 120, "the first exact answer")
    same(b.run("return ['about', 'thickness-scale', 'time'].map(k => Live.rows.find(r => r.about.key === k).value)"), ["com", 1.2, 11], "where the rows begin")
    same(line(b)[-2:], ["--states", "1.5"], "the last state of the run, not of the model")
    as_dea_run(b, pages, "the line's own place")
    put(b, "axes", "left hip")
    put(b, "turn", 3)
    same([w for w in line(b) if w.startswith("femur=frame")], ["femur=frame:left hip,1,0,0,3"], "a turn about an axis of a frame")
    as_dea_run(b, pages, "about an axis of a frame")
    put(b, "about", "sphere-center")
    same(line(b).count("--rotate-about"), 1, "points to turn about")
    as_dea_run(b, pages, "about another point")
    put(b, "thickness-scale", 1.25)
    as_dea_run(b, pages, "another thickness")
    # a grid of other axes is another one
    b.run("document.getElementById('plan').open = true; document.getElementById('plan-count').value = '6'; document.getElementById('plan-go').click()")
    b.wait("Plan.grid && Plan.grid.done === 36", 120, "the grid")
    b.wait("document.getElementById('plan-map').style.opacity === '1'", 10, "the grid of this place")
    put(b, "axes", "")
    b.wait("document.getElementById('plan-map').style.opacity === '0.45'", 10, "the grid of other axes")


@check
def nothing_of_a_moment_ago_is_taken_for_now(b, pages):
    take(b, pages, HIP)
    told = b.run("""const r = Live.rows.find(r => r.about.key === 'turn'), e = r.element.querySelector('input[type=range]');
        e.value = 80; e.dispatchEvent(new Event('input', { bubbles: true }));
        document.getElementById('hand-keep').click();
        return [document.getElementById('hand-what').textContent, document.getElementById('hand').dataset.exact, document.getElementById('hand-keep').disabled, document.getElementById('hand-kept').textContent,
                document.querySelector('#result iframe').contentDocument.getElementById('now').textContent]""")
    same(told, ["Of a moment ago", "false", True, "", "in the hand, a moment ago"], "what is shown before there is an answer")
    b.run("Live.rows.find(r => r.about.key === 'turn').element.querySelector('input[type=range]').dispatchEvent(new Event('change', { bubbles: true }))")
    b.wait(EXACT, 60, "the exact answer")
    same(in_page(b, 0, lambda b: b.run("Page.setFrame(3); const drawn = []; const save = Figures.saveCanvas; Figures.saveCanvas = (c, name) => drawn.push(name); document.getElementById('save-maps').click(); Figures.saveCanvas = save; return drawn")),
         ["hip_walking_acetabular_articulating_in_the_hand"], "the name of a picture")
    # thirty small moves of the load's arrow, however many answers there are between them, are one long one
    x, y = handle_at(b, "load")
    b.cdp("Input.dispatchMouseEvent", type="mousePressed", x=x, y=y, button="left", buttons=1, clickCount=1)
    for k in range(1, 31):
        b.cdp("Input.dispatchMouseEvent", type="mouseMoved", x=x + 2 * k, y=y, button="left", buttons=1)
    b.cdp("Input.dispatchMouseEvent", type="mouseReleased", x=x + 60, y=y, button="left", buttons=0, clickCount=1)
    b.wait(EXACT, 60, "the exact answer")
    turned = b.run("const f = Live.rows.filter(r => r.about.key === 'force').map(r => r.value), m = [432, -262, 1834], l = Math.hypot(...m); return Math.acos(f.reduce((s, v, i) => s + v * m[i] / l / l, 0)) * 180 / Math.PI")
    true(turned > 15, f"sixty pixels turn the load by {turned:.1f} degrees")
    # with the joint changed in the form it cannot be taken; back again, it can
    b.click("#hand-down")
    setting(b, "--E", "20")
    b.wait("document.getElementById('take').hidden", 10, "no button on an old result")
    setting(b, "--E", "")
    b.wait("!document.getElementById('take').hidden", 10, "the button, once it is of now again")
    b.click("#take")
    b.wait(EXACT, 60, "the first exact answer")
    # a worker that has ended
    b.run("Live.fail('The worker has ended.')")
    same(b.run("return [document.getElementById('hand-what').textContent, document.querySelectorAll('#hand-numbers td').length, document.getElementById('hand-keep').disabled]"), ["No answer", 0, True], "after a worker has ended")
    b.click("#hand-down")
    b.click("#take")
    b.wait(EXACT, 60, "the first exact answer, again")


@check
def two_balances_are_told(b, pages):
    model = pathlib.Path(pages["folder"]) / "two_wells.feb"
    two_wells(model)
    take(b, pages, model)
    b.wait("document.getElementById('hand').dataset.again", 20, "the second search")
    same(b.run("return document.getElementById('hand-other').textContent"), "", "a word on two balances where there is one")
    # put above the other hollow, dea run finds that one; the hand comes from the first
    put(b, "move", -16, 3)
    b.wait("document.getElementById('hand-other').textContent", 20, "that there are two balances")
    told = b.run("return document.getElementById('hand-other').textContent")
    true(told.startswith("Two balances: coming from where the hand was, ball would rest 15."), told)
    as_dea_run(b, pages, "the balance that is shown")
    print(f"        {told}")
    b.click("#hand-undo")
    b.wait(EXACT, 60, "the answer before")


@check
def handles_on_the_map_move_a_body(b, pages):
    take(b, pages, HIP)
    before = in_page(b, 0, lambda b: b.run("return Page.maps.orientation.toArray()"))
    for touch in (False, True):
        for key, option in (("turn 0", "--rotate"), ("move 1", "--move"), ("load", "--force")):
            x, y = handle_at(b, key)
            send = (lambda kind, x, y: b.cdp("Input.dispatchTouchEvent", type={"pressed": "touchStart", "moved": "touchMove", "released": "touchEnd"}[f"{kind}"],
                                             touchPoints=[] if kind == "released" else [{"x": x, "y": y}])) if touch else \
                   (lambda kind, x, y: b.cdp("Input.dispatchMouseEvent", type={"pressed": "mousePressed", "moved": "mouseMoved", "released": "mouseReleased"}[kind], x=x, y=y,
                                             button="left", buttons=0 if kind == "released" else 1, clickCount=1))
            send("pressed", x, y)
            for k in range(1, 6):
                send("moved", x + 3 * k, y + 2 * k)
            send("released", x + 15, y + 10)
            b.wait(EXACT, 60, f"the exact answer after {key}")
            true(option in line(b), f"{'touch' if touch else 'mouse'} on {key}: {line(b)}")
            as_dea_run(b, pages, key)
            b.click("#hand-undo")
            b.wait(EXACT, 60, "the answer before")
            same(line(b)[2:], ["--states", "last"], f"one drag of {key} is one step back")
    same(in_page(b, 0, lambda b: b.run("return Page.maps.orientation.toArray()")), before, "the view, while a handle is dragged")
    put(b, "size", 951.16)
    force = [float(x) for x in line(b)[line(b).index("--force") + 1].split("=")[1].split(",")]
    for found, whole in zip(force, (432, -262, 1834)):
        true(abs(found - whole / 2) < 0.01, f"half the force: {force}")


@check
def keys_do_all_of_it(b, pages):
    take(b, pages, HIP)
    b.run("Live.rows.find(r => r.about.key === 'turn').element.querySelector('input').focus()")
    for _ in range(3):
        b.key("\ue014")  # arrow right
    b.wait("document.getElementById('hand-line').textContent.includes('--rotate') && " + EXACT, 60, "the exact answer")
    same(line(b)[2:4], ["--rotate", "femur=1,0,0,0.3"], "three steps of a slider")
    true(b.run("return document.getElementById('hand-said').getAttribute('role') === 'status' && /p99 [\\d.]+, mean [\\d.]+/.test(document.getElementById('hand-said').textContent)"), "what a screen reader is told")
    nameless = b.run("""return [...document.querySelectorAll('#hand input, #hand select, #hand button, #hand canvas')].filter((e) => !e.hidden && !(e.getAttribute('aria-label') || e.textContent && e.tagName === 'BUTTON'
                        || document.querySelector(`label[for="${e.id}"]`) || e.closest('label'))).map((e) => e.outerHTML)""")
    same(nameless, [], "controls without a name")


@check
def a_grid_is_that_of_dea_study(b, pages):
    take(b, pages, HIP)
    b.run("document.getElementById('plan').open = true; document.getElementById('plan-count').value = '6'")
    for name, value in (("a", "0"), ("b", "2")):
        b.run("const e = document.getElementById('plan-' + arguments[0]); e.value = arguments[1]; e.dispatchEvent(new Event('change'))", name, value)
    b.click("#plan-go")
    b.wait("Plan.grid && Plan.grid.done === 36 && document.getElementById('plan-go').textContent === 'Work it out'", 120, "the grid")
    same(len(workers(b)), 2, "workers that are left")
    words = shlex.split(b.run("return Plan.studyLine()"))
    done = subprocess.run([pages["dea"], *words[1:], "--overwrite", "-q", "--csv", "-"], cwd=pages["folder"], capture_output=True, text=True)
    same(done.returncode, 0, done.stderr)
    rows = [r for r in csv.DictReader(io.StringIO(done.stdout))]
    cells = b.run("return Plan.grid.cells.map((c, k) => [Plan.grid.a.at(k % 6, 6), Plan.grid.b.at(Math.floor(k / 6), 6), c.values[0].p99, c.values[0].area])")
    same(len(rows), 36, "cases of the study")
    worst = 0.0
    for row in rows:
        at = [float(row[k]) for k in ("across", "up")]
        cell = min(cells, key=lambda c: math.hypot(c[0] - at[0], c[1] - at[1]))
        true(math.hypot(cell[0] - at[0], cell[1] - at[1]) < 1e-9, f"no place {at}")
        for found, column in zip(cell[2:], ("headline_p99", "headline_area")):
            worst = max(worst, abs(found / float(row[column]) - 1))
    print(f"        36 places within {worst:.1e} of dea study")
    true(worst < 1e-6, f"apart from dea study by {worst:.1e}")
    least = min(cells, key=lambda c: c[2])
    true(f"at femur: turn about x {least[0]:g}".replace("-", "−") in b.run("return document.getElementById('plan-text').textContent"), "the least")
    # the dot takes the hand along, and another load makes it another grid
    b.run("document.getElementById('plan-map').focus()")
    b.key("\ue013")  # arrow up
    b.wait("document.getElementById('hand-line').textContent.includes('--rotate') && " + EXACT, 60, "the exact answer")
    as_dea_run(b, pages, "a place of the grid")
    put(b, "size", 1000)
    b.wait("document.getElementById('plan-text').textContent.includes('something else')", 10, "that the grid is another place's")
    same(b.run("return document.getElementById('plan-map').style.opacity"), "0.45", "the grid of another load")


@check
def a_grid_of_21_by_21_takes_less_than_a_minute(b, pages):
    take(b, pages, HIP)
    b.run("document.getElementById('plan').open = true")
    start = time.monotonic()
    b.click("#plan-go")
    b.wait("Plan.grid && Plan.grid.done === 441", 240, "the grid")
    seconds = time.monotonic() - start
    print(f"        441 places in {seconds:.0f} s")
    true(seconds < 60, f"{seconds:.0f} s")


@check
def another_place_is_kept_beside(b, pages):
    take(b, pages, HIP)
    first = state(b)["contacts"][0]["headline"]["p99"]
    b.click("#hand-keep")
    drag(b, ("turn", 0, 0.05))
    second = state(b)["contacts"][0]["headline"]["p99"]
    rows = b.run("return [...document.querySelectorAll('#hand-numbers tr')].map(r => [r.cells[0].textContent, r.cells[1].textContent])")
    same([r[0] for r in rows], ["contact", "hip_contact", "kept", "change"], "rows")
    true(abs(float(rows[2][1]) - first) < 1e-3 * first, f"kept {rows[2]}, was {first}")
    true(abs(float(rows[3][1].replace("−", "-").rstrip(" %")) - 100 * (second / first - 1)) < 0.06, f"change {rows[3]}")
    maps = in_page(b, 0, lambda b: b.run("""return [Page.panels.map(p => p.title()), Page.panels[0].what.scale.most === Page.panels[1].what.scale.most, Page.panels.map(p => p.message),
        Math.max(...Page.panels[2].what.vertices.map((x, k) => Math.abs(x - (Page.panels[0].what.vertices[k] - Page.panels[1].what.vertices[k]))))]"""))
    same(maps[:3], [["In the hand", "Kept", "In the hand − kept"], True, ["", "", ""]], "maps")
    true(maps[3] < 1e-6, f"the difference: {maps[3]}")
    put(b, "size", 62000)
    if state(b)["outcome"] != "Balanced":
        same(in_page(b, 0, lambda b: b.run("return Page.panels.map(p => p.message)"))[0], "no solution here", "a place without a solution beside one that has")
    b.click("#hand-keep")
    same(in_page(b, 0, lambda b: b.run("return Page.panels.map(p => p.title())")), ["In the hand"], "maps, once it is put away")


@check
def five_hundred_moves_leave_memory_flat(b, pages):
    take(b, pages, HIP)
    b.run("""window.memory = []; window.drawn = []; window.late = [];
             const show = Live.hand.show;
             Live.hand.show = (a, q) => { window.memory.push(a.memory); window.drawn.push([q.place, q.quick]); if (q.quick) window.late.push(performance.now() - window.asked[q.place]); show(a, q); };
             window.asked = {}; window.moves = 0;
             const row = Live.rows.find(r => r.about.key === 'turn'), range = row.element.querySelector('input[type=range]');
             const step = () => { ++window.moves; range.value = 80 * Math.sin(window.moves / 20); range.dispatchEvent(new Event('input', { bubbles: true })); window.asked[Live.hand.place] = performance.now();
               if (window.moves < 500) setTimeout(step, 30); else range.dispatchEvent(new Event('change', { bubbles: true })); };
             window.heap = performance.memory.usedJSHeapSize; step();""")
    b.wait("window.moves === 500 && " + EXACT, 180, "the end of the drag")
    memory, drawn, late = b.run("return [window.memory, window.drawn, window.late]")
    true(all(2 * p + (not q) > 2 * p0 + (not q0) for (p0, q0), (p, q) in zip(drawn, drawn[1:])), "an older answer over a newer one")
    late.sort()
    print(f"        {len(drawn)} answers drawn of 500 moves; coarse: median {late[len(late) // 2]:.0f} ms after the move, 95 of 100 within {late[len(late) * 95 // 100]:.0f} ms; "
          f"memory of a worker {memory[len(memory) // 10] / 1e6:.0f} MB at first, {memory[-2] / 1e6:.0f} MB at the end")
    quick = memory[:-1]
    true(quick[-1] <= 1.02 * quick[len(quick) // 10], f"memory grows: {quick[len(quick) // 10]} to {quick[-1]} bytes")
    heap = b.run("return performance.memory.usedJSHeapSize - window.heap")
    true(heap < 60e6, f"the page's own memory grew by {heap / 1e6:.0f} MB")
    as_dea_run(b, pages, "after 500 moves")


@check
def rows_of_a_table_are_times(b, pages):
    folder = pathlib.Path(pages["folder"])
    table = folder / "gait.csv"
    table.write_text("time,Fx,Fy,Fz\n" + "".join(f"{k},{200 + 50 * k},{-100 - 30 * k},{900 + 200 * k}\n" for k in range(5)))
    take(b, pages, HIP, table, loads="gait.csv", load_body="femur")
    same(b.run("return Live.rows.find(r => r.about.key === 'time').about.times"), [0, 1, 2, 3, 4], "times")
    put(b, "time", 2)
    same(line(b)[-2:], ["--states", "2"], "the row in the line")
    same(state(b)["time"], 2, "the row")
    as_dea_run(b, pages, "a row")
    drag(b, ("turn", 0, 0.03))
    as_dea_run(b, pages, "a row, turned")


@check
def a_page_of_its_own_begins_in_the_hand(b, pages):
    folder = pathlib.Path(pages["folder"])
    program, sub = folder / "program", folder / "sub dir"
    program.mkdir()
    sub.mkdir()
    shutil.copy(pages["dea"], program / "dea")
    table = sub / "gait <b>.csv"
    table.write_text("time,Fx,Fy,Fz\n0,432,-262,1834\n1,300,-200,1500\n")
    words = ["run", str(HIP), "--loads", str(table), "--load-body", "femur", "--E", "acetabular_articulating=9", "--no-squash", "--no-xplt", "-q", "--live", "hip_live.html"]
    done = subprocess.run([program / "dea", *words], cwd=folder, capture_output=True, text=True)
    same([done.returncode, done.stderr.count("\n"), "found no dea.html" in done.stderr], [2, 1, True], done.stderr)
    shutil.copy(pages["page"], program / "dea.html")
    done = subprocess.run([program / "dea", *words], cwd=folder, capture_output=True, text=True)
    same([done.returncode, done.stderr], [0, ""], "dea run --live")
    b.log("performance")
    b.open((folder / "hip_live.html").as_uri())
    b.wait(EXACT, 120, "the joint in the hand, without a click")
    same(b.run("return [document.title, document.getElementById('sample')]"), ["hip_walking in the hand", None], "the page")
    same(line(b), ["run", HIP.name, "--loads", table.name, "--load-body", "femur", "--E", "acetabular_articulating=9", "--no-squash", "--states", "last"], "its line")
    shutil.copy(table, folder / table.name)
    as_dea_run(b, pages, "the joint of the page")
    drag(b, ("turn", 0, 0.03))
    as_dea_run(b, pages, "the joint of the page, turned")
    no_network(b, "the page")
    no_faults(b, "the page")


@check
def a_case_is_saved_for_febio(b, pages):
    take(b, pages, HIP)
    drag(b, ("turn", 0, 0.03))
    b.click("#hand-save")
    name, content = b.downloaded()
    same(name, "hip_walking_hand.feb", "name")
    mine = pathlib.Path(pages["folder"]) / name
    mine.write_bytes(content if isinstance(content, bytes) else content.encode())
    moved = native(pages, ["run", name, "--states", "last"])
    same(round(moved["contacts"][0]["headline"]["p99"] / state(b)["contacts"][0]["headline"]["p99"], 6), 1.0, "p99 of the saved case")
    put(b, "size", 1000)
    b.click("#hand-save")
    b.wait("document.getElementById('hand-other').textContent.includes('--force')", 30, "that a converted model cannot hold this force")


def without_webgl(pages):
    with Browser(webgl=False) as b:
        take(b, pages, HIP)
        drag(b, ("turn", 0, 0.03))
        as_dea_run(b, pages, "without WebGL")


if __name__ == "__main__":
    sys.exit(run_all(CHECKS, without_webgl, __doc__))
