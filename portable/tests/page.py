#!/usr/bin/env python3
"""The page that solves, in a headless Chromium, against the native program: page.py DEA PAGE.html [CHECK...]

Files are dropped as from a desktop. Numbers are those of the native program to 1e-8 of the largest of their kind, of the knee to 1e-7. Exit code 77: there is no
chromedriver. Python's standard library only."""
import csv
import json
import math
import os
import pathlib
import re
import shlex
import subprocess
import sys
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.dont_write_bytecode = True
sys.path.insert(0, str(ROOT / "tests/report"))
from browser import WINDOW, Browser, run_checks  # noqa: E402
from report_test import HASH, no_faults, no_network, same, true  # noqa: E402

HIP, HIP_FEBIO, KNEE = (ROOT / "samples" / name for name in ("hip/hip_walking.feb", "hip/hip_walking_febio.xplt", "knee/knee.feb"))
HOSTILE = "<script>document.title='broken into'<\\script> \"it's\" $HOME & 50%.feb"
MOST_BYTES, MOST_RATIO, STOP_SECONDS = 4_200_000, 2.5, 1.0
WORKER_SECONDS = 6.0  # Chromium gives a worker that computes two seconds before it ends it
CHECKS = []


def check(function):
    CHECKS.append(function)
    return function


# ---- what tests ask of the page ----

def ready(b, pages):
    b.log("browser")
    b.open("file://" + pages["page"])
    b.wait("document.documentElement.dataset.ready", 60, "the page to be ready")


def drop(b, *files):
    b.run("window.scrollTo(0, 0)")
    box = b.run("const r = document.getElementById('drop').getBoundingClientRect(); return [r.left + r.width / 2, r.top + 10]")
    data = {"items": [], "files": [str(f) for f in files], "dragOperationsMask": 1}
    for kind in ("dragEnter", "dragOver", "drop"):
        b.cdp("Input.dispatchDragEvent", type=kind, x=box[0], y=box[1], data=data)


def text(b, selector):
    return b.run("const e = document.querySelector(arguments[0]); return e ? e.textContent : null", selector)


def recognised(b, seconds=60):
    """Waits until dea info has answered; what it printed and the faults."""
    b.wait("!recognising && document.getElementById('activity').textContent === '' && Files.list.length && document.getElementById('files').children.length && settled()"
           .replace("settled()", "(document.getElementById('info').textContent || document.getElementById('faults').textContent)"), seconds, "what is recognised")
    return text(b, "#info"), b.run("return [...document.querySelectorAll('#faults .fault')].map(p => p.textContent)")


def solve(b, seconds=180):
    """Presses the button; when the result is there, its parts' titles."""
    b.run("window.before = solved")
    b.wait("!document.getElementById('solve').disabled", 60, "the button")
    b.click("#solve")
    return solved(b, seconds)


def solved(b, seconds=180):
    b.wait("!solving && solved && solved !== window.before && document.querySelectorAll('#result iframe').length === solved.parts.length", seconds, "the result")
    b.wait("[...document.querySelectorAll('#result iframe')].every(f => f.contentDocument && f.contentDocument.documentElement.dataset.ready)", 120, "its page")
    return b.run("return solved.parts.map(p => p.title)")


def saved(b, ending, part=0):
    b.run("const all = [...document.querySelectorAll('#result > section')][arguments[0]]; [...all.querySelectorAll('.controls button')].find(x => (x.title || '').endsWith(arguments[1])).click()",
          part, ending)
    return b.downloaded()


def words_of_line(b, part=0):
    return shlex.split(b.run("return document.querySelectorAll('#result pre.line')[arguments[0]].textContent", part))


def setting(b, name, value, key=""):
    b.run("""const [name, key, value] = arguments, box = [...document.querySelectorAll('#form .field')].find(f => f.firstChild.textContent === name);
             const parts = box.querySelectorAll('input, select');
             if (parts.length > 1) parts[0].value = key;
             const e = parts[parts.length - 1];
             e.value = value;
             if (e.value !== value) throw new Error(name + ' cannot be ' + value);
             e.dispatchEvent(new Event('input', { bubbles: true }))""", name, key, value)


def in_page(b, part, *steps):
    """Runs functions of a browser that is in the page of a result; what the last one returned."""
    b.call("POST", "/frame", {"id": b.run("const f = document.querySelectorAll('#result iframe')[arguments[0]]; f.scrollIntoView(); return f", part)})
    try:
        return [step(b) for step in steps][-1]
    finally:
        b.call("POST", "/frame", {"id": None})


def map_colours(b, part=0):
    """Per map of a result's page: how many colours it has."""
    return in_page(b, part, lambda b: b.wait("Page.maps.drawn > 0 && Page.maps.settled", 60, "the maps"),
                   lambda b: [colours for _, colours in b.run(HASH + "return Page.panels.map(p => hash(p.canvas))")])


def workers(b):
    return [t["url"] for t in b.cdp("Target.getTargets")["targetInfos"] if t["type"] == "worker"]


def native(pages, *words, code=0):
    done = subprocess.run([pages["dea"], *map(str, words)], cwd=pages["folder"], capture_output=True, text=True)
    same(done.returncode, code, f"native dea {' '.join(map(str, words))}: {done.stderr}")
    return done


def leaves(value, path=""):
    if isinstance(value, dict):
        for key, v in value.items():
            yield from leaves(v, f"{path}/{'*' if path.endswith('/bodies') else key}")
    elif isinstance(value, list):
        for v in value:
            yield from leaves(v, path + "[]")
    else:
        yield path, value


def same_words(found, expected, what):
    """Of two texts: words are the same, numbers to the last of six digits; what is 0 but for rounding is."""
    number = re.compile(r"(?<![\w.])-?\d+(?:\.\d+)?(?:e[-+]?\d+)?")
    same(number.sub("#", found), number.sub("#", expected), what)
    for x, y in zip(number.findall(found), number.findall(expected)):
        true(math.isclose(float(x), float(y), rel_tol=2e-5, abs_tol=1e-6), f"{what}: {x} for {y}")


def same_numbers(found, expected, what, near=1e-8):
    """Of two JSON values; how far they are apart at most, in parts of the largest number of the same name."""
    # how long it took; what is left of an equation that is solved is rounding alone
    rounding = re.compile(r"/timings|residual|complementarity|/message|sphere|/text")
    a, b = ([x for x in leaves(v) if not rounding.search(x[0])] for v in (found, expected))
    same([p for p, _ in a], [p for p, _ in b], f"{what}: keys")
    largest, worst = {}, (0.0, "")
    for path, v in b:
        if isinstance(v, float):
            largest[path] = max(largest.get(path, 0.0), abs(v))
    true(len(b) > 50, f"{what}: only {len(b)} values")
    for (path, x), (_, y) in zip(a, b):
        if isinstance(x, float) and isinstance(y, float) and not math.isnan(y):
            apart = abs(x - y) / largest[path] if x != y else 0.0
            worst = max(worst, (apart, path))
        else:
            same(x, y, f"{what}: {path}")
    # a search for balance ends within its tolerance, 1e-9 of the load, and WebAssembly's logarithms lead it there by other digits
    true(worst[0] <= near, f"{what}: {worst[1]} is apart by {worst[0]:.1e}")
    return worst


# ---- checks: each gets a browser and what make() has returned ----

@check
def the_sample_is_one_click_from_a_map(b, pages):
    b.log("performance")
    ready(b, pages)
    start = time.monotonic()
    b.click("#sample")
    same(solved(b), ["Result"], "parts")
    took = time.monotonic() - start
    true(min(map_colours(b)) > 20, "a map is blank")
    name, content = saved(b, ".json")
    same(name, "hip_walking_dea.json", "name")
    worst = same_numbers(json.loads(content), pages["hip"], "hip")
    print(f"        numbers within {worst[0]:.1e} ({worst[1]}); click to page {took:.1f} s, native {pages['hip seconds']:.1f} s, ratio {took / pages['hip seconds']:.1f}")
    same(b.run("return document.getElementById('age').hidden"), True, "it is of now")
    no_network(b, "the page")
    no_faults(b, "the page")


@check
def the_file_is_small_and_whole(b, pages):
    size = os.path.getsize(pages["page"])
    true(size <= MOST_BYTES, f"{size} bytes")
    html = pathlib.Path(pages["page"]).read_text()
    same(re.findall(r"(?:src|href)\s*=\s*[\"']?(?!data:)[\w/]+[^\"'> ]*", re.sub(r"<script.*?</script>", "", html, flags=re.S)), [], "what it loads")
    ready(b, pages)
    for script in ("fetch('https://localhost/')", "new Promise((good, bad) => { const s = new WebSocket('ws://localhost/'); s.onopen = good; s.onerror = bad; })",
                   "navigator.sendBeacon('https://localhost/') ? 1 : Promise.reject(0)"):
        outcome = b.run(f"window.policy = 0; document.addEventListener('securitypolicyviolation', () => ++window.policy);"
                        f"try {{ await {script}; }} catch {{ }} await new Promise(r => setTimeout(r, 200)); return window.policy".join(("return (async () => {", "})()")))
        true(outcome >= 1, f"the policy lets {script} pass")
    b.log("browser")
    b.click("#foot summary")
    b.wait("document.getElementById('licences').textContent.length > 5000", 10, "the licences")


@check
def what_is_recognised_is_what_info_prints(b, pages):
    ready(b, pages)
    for model in (HIP, KNEE):
        drop(b, model)
        b.wait(f"document.getElementById('info').textContent.startsWith('{model.name}')", 60, "the model")
        info, faults = recognised(b)
        done = native(pages, "info", model.name)
        same_words(info.strip(), done.stdout.strip(), model.name)
        same(faults, done.stderr.splitlines(), "faults")


@check
def the_knee_has_the_same_numbers(b, pages):
    ready(b, pages)
    drop(b, KNEE)
    recognised(b)
    solve(b)
    # soft ligaments make more of what the tolerance leaves open: a sum in another order moves the patella by 6e-8
    worst = same_numbers(json.loads(saved(b, ".json")[1]), pages["knee"], "knee", 1e-7)
    print(f"        numbers within {worst[0]:.1e} ({worst[1]})")
    true(min(map_colours(b)) > 20, "a map is blank")
    name, table = saved(b, ".csv")
    same(len(list(csv.reader(table.decode().splitlines()))), len((pages["folder"] / "knee.csv").read_text().splitlines()), "rows of the CSV")
    name, plot = saved(b, ".xplt")
    (pages["folder"] / "page_knee.xplt").write_bytes(plot)
    compared = json.loads(native(pages, "compare", "page_knee.xplt", "knee.xplt", "--json", "-", "-q").stdout)
    true("nan" not in str(compared).lower() and len(plot) == os.path.getsize(pages["folder"] / "knee.xplt"), "the plot file")
    name, page = saved(b, ".html")
    true(page.startswith(b"<!doctype html>") and b"knee" in page, "the page")


@check
def faults_are_the_programs_own_lines(b, pages):
    ready(b, pages)
    folder = pages["folder"]
    (folder / "broken.feb").write_bytes(HIP.read_bytes()[:500000])
    (folder / "empty.feb").write_bytes(b"")
    (folder / "noise.feb").write_bytes(bytes(range(256)) * 40)
    (folder / "no_model.txt").write_text("hello\n")
    for name in ("broken.feb", "empty.feb", "noise.feb", "no_model.txt", "hip_walking_febio.xplt"):
        ready(b, pages)
        drop(b, folder / name)
        info, faults = recognised(b)
        same(faults, native(pages, "info", name, code=3).stderr.splitlines(), name)
        same(len(faults), 1, f"{name}: lines")
        true(b.run("return document.getElementById('solve').disabled"), f"{name} can be solved")
        true(b.run("return document.getElementById('faults').getAttribute('role')") == "alert", "it is announced")
    no_faults(b, "faults")


@check
def settings_are_typed_for_the_program(b, pages):
    ready(b, pages)
    drop(b, KNEE)
    recognised(b)
    setting(b, "--E", "-3")
    b.wait("document.querySelector('#faults .fault')", 30, "the fault")
    same(text(b, "#faults .fault"), native(pages, "info", "knee.feb", "--E", "-3", code=2).stderr.strip(), "the fault")
    true(b.run("return [...document.querySelectorAll('[aria-invalid=true]')].some(e => e.checkVisibility())"), "the field is marked, and in sight")
    true("femur" not in text(b, "#info"), "what was recognised before stands beside a fault")
    setting(b, "--E", "6", "medial_plateau")
    setting(b, "--law", "linear")
    setting(b, "--states", "last")
    setting(b, "--squash", "--no-squash")
    b.run("document.getElementById('more').value = \"--facets-csv 'my facets.csv'\"; document.getElementById('more').dispatchEvent(new Event('input', { bubbles: true }))")
    b.wait("document.getElementById('info').textContent.includes('E 6')", 60, "the setting in what is recognised")
    b.run("const more = document.getElementById('more'); window.typed = more.value; more.value += ' --lax linear'; more.dispatchEvent(new Event('input', { bubbles: true }))")
    b.wait("document.querySelector('#faults .fault')", 30, "the fault of an option that there is not")
    true("--lax" in text(b, "#faults .fault"), "its words")
    b.run("const more = document.getElementById('more'); more.value = window.typed; more.dispatchEvent(new Event('input', { bubbles: true }))")
    b.wait("!document.querySelector('#faults .fault') && document.getElementById('info').textContent.includes('E 6')", 60, "the settings as they were")
    solve(b)
    words = words_of_line(b)
    for wanted in (["--E", "medial_plateau=6"], ["--law", "linear"], ["--states", "last"], ["--facets-csv", "my facets.csv"]):
        at = words.index(wanted[0])
        same(words[at:at + 2], wanted, "the command line")
    # the line does natively what the page did
    native(pages, *words[1:], "--overwrite")
    for name in ("knee_dea.json",):
        worst = same_numbers(json.loads(saved(b, ".json")[1]), json.loads((pages["folder"] / name).read_text()), name)
    same(len(saved(b, "my facets.csv")[1].splitlines()), len((pages["folder"] / "my facets.csv").read_text().splitlines()), "a file of more options")
    # what is shown is no longer what would be solved
    setting(b, "--law", "layer")
    true(not b.run("return document.getElementById('age').hidden") and b.run("return document.getElementById('result').className") == "old", "an old result is not marked")
    setting(b, "--law", "linear")
    true(b.run("return document.getElementById('age').hidden"), "settings that are back")
    drop(b, HIP)
    b.wait("document.getElementById('info').textContent.startsWith('hip_walking')", 60, "the other model")
    true(not b.run("return document.getElementById('age').hidden"), "the result of another model is not marked")
    same(b.run("return Form.words('run')"), [], "settings of another model")


@check
def a_table_and_a_settings_file_lie_beside_the_model(b, pages):
    ready(b, pages)
    folder = pages["folder"]
    (folder / "walk.csv").write_text("time,fx,fy,fz\n0,200,-100,1200\n1,432,-262,1834\n")
    (folder / "hip.xml").write_text('<febiodea_settings version="1">\n<law>linear</law>\n</febiodea_settings>\n')
    drop(b, HIP, folder / "walk.csv", folder / "hip.xml")
    recognised(b)
    setting(b, "--loads", "walk.csv")
    setting(b, "--load-body", "femur")
    b.wait("document.getElementById('info').textContent.includes('walk.csv') && !document.querySelector('#faults .fault')", 60, "the table")
    true("law linear" in text(b, "#info"), "the settings file")
    solve(b)
    words = words_of_line(b)
    native(pages, *words[1:], "--overwrite")
    same_numbers(json.loads(saved(b, ".json")[1]), json.loads((folder / "hip_walking_dea.json").read_text()), "loads of a table")


@check
def a_result_of_febio_is_compared(b, pages):
    ready(b, pages)
    drop(b, HIP, HIP_FEBIO)
    recognised(b)
    setting(b, "--states", "last")
    same(solve(b), ["Result", "Comparison"], "parts")
    true(min(map_colours(b, 1)) > 20, "a map of the comparison is blank")
    run, compare = words_of_line(b, 0), words_of_line(b, 1)
    native(pages, *run[1:], "--overwrite")
    native(pages, *compare[1:], "--overwrite")
    worst = same_numbers(json.loads(saved(b, "_compare.json", 1)[1]), json.loads((pages["folder"] / "hip_walking_compare.json").read_text()), "the comparison")
    print(f"        numbers within {worst[0]:.1e} ({worst[1]})")
    # stopped in the comparison: what was solved stays
    b.run("""window.before = solved;
             new MutationObserver((_, o) => { if (/comparing/.test(document.getElementById('activity').textContent)) { o.disconnect(); document.getElementById('stop').click(); } })
               .observe(document.getElementById('activity'), { childList: true, characterData: true, subtree: true })""")
    b.click("#solve")
    same(solved(b), ["Result"], "parts of a run that was stopped while comparing")
    same(text(b, "#activity"), "The comparison was stopped.", "what happened")
    # two results without a model
    ready(b, pages)
    (pages["folder"] / "other.xplt").write_bytes((pages["folder"] / "hip.xplt").read_bytes())
    drop(b, pages["folder"] / "other.xplt", HIP_FEBIO)
    b.wait("document.getElementById('solve').textContent === 'Compare'", 20, "the button")
    same(solve(b), ["Comparison"], "parts")


@check
def names_are_text(b, pages):
    ready(b, pages)
    path = pages["folder"] / HOSTILE
    quoted = b"&lt;b&gt;tibia &quot;x&quot;&lt;/b&gt;"
    path.write_bytes(re.sub(rb'(name|mat)="tibia"|>tibia<', lambda m: m[1] + b'="' + quoted + b'"' if m[1] else b">" + quoted + b"<", KNEE.read_bytes()))
    drop(b, path)
    info, faults = recognised(b)
    same(faults, [], "faults")
    true(info.startswith(HOSTILE) and '<b>tibia "x"</b>' in info, "names in what is recognised")
    setting(b, "--states", "last")
    solve(b)
    words = words_of_line(b)
    same(words[:3], ["dea", "run", HOSTILE], "the command line")
    native(pages, *words[1:], "--overwrite")
    same_numbers(json.loads(saved(b, ".json")[1]), json.loads((pages["folder"] / words[words.index("--json") + 1]).read_text()), "numbers")
    in_page(b, 0, lambda b: same(b.run("return document.querySelectorAll('pre *, h1 *, td *, li *, script[src]').length"), 0, "elements of the result's page made of names"))
    same(b.run("return document.title"), "FEBioDEA", "title")
    same(b.run("return document.querySelectorAll('#files b, #files script, pre *, #result b, .fault *').length"), 0, "elements made of names")


@check
def stop_stops_within_a_second(b, pages):
    ready(b, pages)
    drop(b, HIP)
    recognised(b)
    setting(b, "--refine", "6")
    b.wait("recognising", 5, "the model to be looked at again")
    b.wait("!recognising", 120, "the model")
    b.click("#solve")
    time.sleep(1)
    same(b.run("return document.getElementById('solve').disabled"), True, "a second run while one goes on")
    b.wait("/springs|layers|state|thickness/.test(document.getElementById('activity').textContent)", 60, "progress")
    start = time.monotonic()
    b.click("#stop")
    b.wait("!solving && /^Stopped/.test(document.getElementById('activity').textContent)", 10, "the end")
    took = time.monotonic() - start
    true(took < STOP_SECONDS, f"it took {took:.2f} s")
    while workers(b) and time.monotonic() - start < WORKER_SECONDS:
        time.sleep(0.05)
    print(f"        stopped in {took:.2f} s, its worker gone after {time.monotonic() - start:.2f} s")
    same(workers(b), [], "workers that are left")
    true(b.run("return document.getElementById('result').hidden && document.getElementById('stop').hidden"), "a result of what was stopped")
    # and the next one is as good as the first
    setting(b, "--refine", "")
    setting(b, "--states", "0.5")
    recognised(b)
    solve(b)
    # other files stop a run
    setting(b, "--refine", "6")
    b.click("#solve")
    time.sleep(0.5)
    drop(b, KNEE)
    b.wait("!solving && /^The files have changed/.test(document.getElementById('activity').textContent) || document.getElementById('info').textContent.startsWith('knee')", 30, "the other model")
    same(b.run("return !!solving"), False, "the run of the files before")


@check
def what_is_too_large_gets_a_line(b, pages):
    ready(b, pages)
    path = pages["folder"] / "huge.feb"
    with open(path, "wb") as file:
        file.write(HIP.read_bytes()[:200000])
        file.truncate(5_000_000_000)
    start = time.monotonic()
    drop(b, path)
    info, faults = recognised(b, 60)
    same(faults, ["The model needs more memory than a browser gives a page: 4 GB, or less on a small computer. Take the program dea for it."], "lines")
    print(f"        5 GB: {faults[0]} ({time.monotonic() - start:.1f} s)")
    os.remove(path)
    ready(b, pages)
    drop(b, HIP)
    recognised(b)
    setting(b, "--refine", "40")
    b.wait("document.querySelector('#faults .fault')", 60, "a line on what --refine 40 needs")
    print(f"        {text(b, '#faults .fault')}")
    true(re.match(r"dea: --refine 40: \d+ springs need about \S+ GB of memory, and \S+ GB are free(; [^\n]+)?$", text(b, "#faults .fault")), "its words")
    setting(b, "--refine", "")


@check
def it_is_used_with_the_keyboard(b, pages):
    ready(b, pages)
    b.run("document.body.focus()")
    def tab():
        b.key("\ue004")
        return b.run("const e = document.activeElement, s = getComputedStyle(e); return [e.id || e.getAttribute('aria-label') || e.textContent, s.outlineStyle + ' ' + s.outlineWidth]")
    order = [tab() for _ in range(4)]
    same([name for name, _ in order][:3], ["theme", "choose", "sample"], "order")
    true(all(outline == "solid 2px" for _, outline in order[:3]), f"focus that is not seen: {order}")
    b.run("document.getElementById('sample').focus()")
    b.run("window.before = solved")
    b.key("\ue007")
    solved(b)
    same(b.run("return document.activeElement.id"), "result", "the focus is at the result")
    b.run("document.querySelectorAll('details').forEach(d => d.open = true)")
    same(b.run("""return [...document.querySelectorAll('button, input, select, progress, iframe, pre[tabindex]')].filter(e => !(e.labels && e.labels.length) && !e.getAttribute('aria-label')
        && !(e.tagName === 'BUTTON' && e.textContent.trim()) && !e.title).map(e => e.outerHTML.slice(0, 100))"""), [], "without a name")
    same(b.run("return [document.getElementById('status').getAttribute('role'), document.getElementById('faults').getAttribute('role')]"), ["status", "alert"], "what is announced")
    same(text(b, "#status"), "Solved.", "said")


@check
def it_fits(b, pages):
    for width in (1400, 390):
        for scheme in ("light", "dark"):
            b.scheme(scheme)
            b.size(width, 900)
            ready(b, pages)
            same(b.run("return document.documentElement.dataset.theme"), scheme, "theme")
            for step in ("start", "solved", "open"):
                if step == "solved":
                    b.run("window.before = solved")
                    b.click("#sample")
                    solved(b)
                    same(b.run("return document.querySelector('#result iframe').contentDocument.documentElement.dataset.theme"), scheme, "theme of the result")
                    inside = b.run("const d = document.querySelector('#result iframe').contentDocument; return [d.documentElement.scrollWidth, d.documentElement.clientWidth, d.documentElement.scrollHeight, d.documentElement.clientHeight]")
                    true(inside[0] <= inside[1] and inside[2] <= inside[3] + 2, f"{width} {scheme}: the result's page scrolls by itself: {inside}")
                if step == "open":
                    b.run("document.querySelectorAll('details').forEach(d => d.open = true)")
                true(b.run("return document.documentElement.scrollWidth") <= width, f"{step} at {width}, {scheme}: wider than the window")
    b.size(*WINDOW)
    b.scheme("light")
    no_faults(b, "widths")


@check
def it_is_fast_enough(b, pages):
    best = math.inf
    for _ in range(3):
        ready(b, pages)
        drop(b, HIP)
        recognised(b)
        start = time.monotonic()
        solve(b)
        page = time.monotonic() - start
        seconds, _ = run_native(pages, "hip", HIP)
        best = min(best, page / seconds)
        print(f"        hip, button to page {page:.1f} s, native {seconds:.1f} s, ratio {page / seconds:.2f}")
    true(best <= MOST_RATIO, f"{best:.2f} times the native program")


def without_webgl(pages):
    with Browser(webgl=False) as b:
        ready(b, pages)
        drop(b, KNEE)
        recognised(b)
        setting(b, "--states", "last")
        solve(b)
        true("WebGL" in b.run("return document.querySelector('#result iframe').contentDocument.getElementById('nowebgl').textContent"), "no word on WebGL")


def run_native(pages, stem, model):
    start = time.monotonic()
    native(pages, "run", model.name, *(w for o, e in (("-o", "xplt"), ("--json", "json"), ("--csv", "csv"), ("--report", "html")) for w in (o, f"{stem}.{e}")), "--overwrite")
    return time.monotonic() - start, json.loads((pages["folder"] / f"{stem}.json").read_text())


def make(folder, dea, page):
    pages = {"dea": dea, "page": page, "folder": pathlib.Path(folder)}
    for file in (HIP, HIP_FEBIO, KNEE):
        (pages["folder"] / file.name).write_bytes(file.read_bytes())
    pages["hip seconds"], pages["hip"] = run_native(pages, "hip", HIP)
    _, pages["knee"] = run_native(pages, "knee", KNEE)
    return pages


def run_all(checks, without, usage):
    """Of the command line; the exit code."""
    if len(sys.argv) < 3:
        print(usage, file=sys.stderr)
        return 2
    dea, page = map(os.path.abspath, sys.argv[1:3])
    return run_checks(checks, sys.argv[3:], lambda folder: make(folder, dea, page), without)


if __name__ == "__main__":
    sys.exit(run_all(CHECKS, without_webgl, __doc__))
