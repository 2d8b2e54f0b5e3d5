"""`dea study` as users and scripts see it: python3 study.py DEA MAKE_SAMPLES [TEST ...].

Small models, many cases: going on after SIGKILL, shards, threads, the order of options, failed cases, a full disk, reading
while it runs, and what a user may do wrong. DEA_LONG_TESTS=1: 2000 cases are killed again and again."""
import csv
import io
import json
import os
import pathlib
import random
import re
import resource
import signal
import sqlite3
import subprocess
import sys
import tempfile
import time

import made_models

dea, make_samples = (pathlib.Path(a).resolve() for a in sys.argv[1:3])
LONG = os.environ.get("DEA_LONG_TESTS", "") not in ("", "0")
CLEAN = {k: v for k, v in os.environ.items() if not k.startswith(("SLURM_", "OMPI_", "PMI_"))}
kit = pathlib.Path(tempfile.mkdtemp(prefix="dea_study_"))
LAW = ["--law", "linear", "--facets", "flat"]


def small_model():
    """A ball in its socket: a case takes some milliseconds."""
    subprocess.run([make_samples, "--spheres", "4", kit / "ball.feb"], check=True)
    return (kit / "ball.feb").read_text()


BALL = small_model()


def small_knee():
    """Four contacts."""
    subprocess.run([make_samples, "--knee", "4", kit / "knee.feb"], check=True)
    text = (kit / "knee.feb").read_text()
    (kit / "knee.feb").unlink()
    return text


class Folder:
    """A folder with the model, in which commands are run."""

    def __init__(self):
        self.temporary = tempfile.TemporaryDirectory()
        self.path = pathlib.Path(self.temporary.name)
        self.write("ball.feb", BALL)

    def write(self, name, text):
        (self.path / name).write_text(text)

    def start(self, *words, **more):
        environment = {**CLEAN, **more.pop("env", {})}
        return subprocess.Popen([dea, "study", *words], cwd=self.path, env=environment, text=True,
                                stdout=subprocess.PIPE, stderr=subprocess.PIPE, **more)

    def run(self, *words, code=0, **more):
        done = self.start(*words, **more)
        out, err = done.communicate(timeout=600)
        assert done.returncode == code, f"{words}: exit code {done.returncode}, expected {code}\n{out}{err}"
        assert "nan" not in out.lower().replace("nano", ""), out
        return out, err

    def fault(self, *words, code, **more):
        """The one line on standard error."""
        out, err = self.run(*words, "-q", code=code, **more)
        assert err.count("\n") == 1 and out == "", f"{words}: expected one line\n{out}{err}"
        return err

    def query(self, file, sql):
        with sqlite3.connect(f"file:{self.path / file}?mode=ro", uri=True) as connection:
            return connection.execute(sql).fetchall()

    def results(self, file):
        """Rows of the CSV without their seconds."""
        out, _ = self.run(file, "--csv", "-", "-q", code=0)
        return without_seconds(out)


def without_seconds(text):
    rows = list(csv.reader(io.StringIO(text)))
    last = rows[0].index("seconds")
    return [row[:last] + row[last + 1:] for row in rows]


def many(count):
    return ["ball.feb", *LAW, "--vary", f"E: E={{1:{count}:1}}", "--states", "last"]


def turned(count):
    """As many cases of one joint: quicker."""
    return ["ball.feb", *LAW, "--vary", f"t: rotate ball=0,1,0,{{1:{count}:1}}", "--states", "last"]


def expect(text, *parts):
    for part in parts:
        assert part in text, f"expected: {part}\nfound: {text}"


# ---------------------------------------------------------------------------------------------- results


def page_data(path):
    """What the page of --report holds."""
    start = '<script type="application/json" id="report">'
    text = path.read_text().partition(start)[2].partition("</script>")[0]
    return json.loads(text)


def test_slopes_are_those_of_dea_run(f):
    """By E and by thickness, against central differences of single runs."""
    f.run("ball.feb", "--vary", "E: E={11|12|13}", "--vary", "h: thickness-scale={0.95|1|1.05}", "--states", "last", "--report",
          "plan.html", "-o", "plan.db")
    data = page_data(f.path / "plan.html")
    assert data["influence"]["base"] == 5, data["influence"]["base"]
    found = {data["columns"][s["column"]]["name"]: s for s in data["influence"]["numbers"][0][0][0]["slopes"]}

    def p99(E, h):
        run = subprocess.run([dea, "run", "ball.feb", "--E", E, "--thickness-scale", h, "--states", "last", "--no-xplt", "-q",
                              "--csv", "-"], cwd=f.path, capture_output=True, text=True, check=True)
        return float(next(csv.DictReader(io.StringIO(run.stdout)))["headline_p99"])

    by_E, by_h = (p99("13", "1") - p99("11", "1")) / 2, (p99("12", "1.05") - p99("12", "0.95")) / 0.1
    assert abs(by_E) > 1e-3 and abs(by_h) > 1e-2, f"{by_E}, {by_h}: nothing to compare"
    for name, slope in (("E", by_E), ("h", by_h)):
        # p99 itself is told to nine digits
        assert found[name]["kind"] == "central" and abs(found[name]["slope"] / slope - 1) < 1e-5, f"{name}: {found[name]}, {slope}"
    base = p99("12", "1")
    assert abs(found["E"]["relative"] - by_E * 12 / base) < 1e-5 * abs(found["E"]["relative"]) + 1e-9


def test_pages_and_what_is_wrong_with_them(f):
    f.run("ball.feb", *LAW, "--vary", "E: E={8|9|10}", "--states", "last", "--keep", "fields", "-o", "plan.db")
    before = (f.path / "plan.db").read_bytes()
    out, _ = f.run("plan.db", "--report", "plan.html", "--group", "E", "--regions", "sectors=3", "--up", "1,0,0", "--axis", "0,0,1")
    assert out == "" and (f.path / "plan.db").read_bytes() == before, "the study's file is only read"
    assert [p["part"] for p in page_data(f.path / "plan.html")["places"]] == ["", "0 to 120 degrees", "120 to 240 degrees", "240 to 360 degrees"]
    for words, code, part in [
            (["--report", "plan.pdf"], 2, "expected a name that ends in .html or .htm"),
            (["--group", "E"], 2, "--group E: belongs to --report FILE.html"),
            (["--report", "x.html", "--group", "nu"], 2, '--group nu: found no column "nu"'),
            (["--report", "x.html", "--pair", "E"], 2, "--pair E: found 3 values of E, expected two: --pair E=A,B"),
            (["--report", "x.html", "--regions", "sokket"], 2, "expected socket, anterior-superior-posterior or sectors=N"),
            (["--report", "x.html", "--regions", "socket", "--up", "0,0,1"], 2, "--regions socket needs --anterior x,y,z"),
            (["--report", "x.html", "--years", "20"], 2, "--cycles-per-year and --years go together"),
            (["--report", "x.html", "--dose-above", "-1"], 2, "expected a pressure of 0 or more"),
            (["--report", "plan.db"], 2, "expected a name that ends in .html or .htm"),
            (["--report", "none/x.html"], 4, "none")]:
        expect(f.fault("plan.db", *words, code=code), part)
        assert not (f.path / "x.html").exists()
    expect(f.fault("ball.feb", *LAW, "--vary", "E: E={8|9}", "-o", "new.db", "--report", "x.html", "--group", "F", code=2),
           '--group F: found no column "F"')
    assert not (f.path / "new.db").exists(), "nothing is solved"


def test_subjects_are_columns_of_the_page(f):
    for name in ("one", "two", "three"):
        f.write(name + ".feb", BALL)
    models = ["one.feb", "two.feb", "three.feb"]
    table = "model;sex;age\none.feb;F;60\ntwo;M;70\nthree.feb;F;65\n"
    f.write("s.csv", table)
    f.run(*models, *LAW, "--states", "last", "-o", "plan.db", "--report", "plan.html", "--subjects", "s.csv", "--group", "sex")
    data = page_data(f.path / "plan.html")
    assert [(c["name"], c["of"]) for c in data["columns"]] == [("model", None), ("sex", "model"), ("age", "model")]
    assert [b["count"] for b in data["groups"]["numbers"][0][0][0]["boxes"]] == [2, 1]
    assert "--subjects s.csv" in data["command"]
    f.write("few.csv", table.replace("three.feb;F;65\n", ""))
    f.write("odd.csv", table.replace("three", "four"))
    f.write("twice.csv", table + "one;F;61\n")
    for words, code, part in [
            (["--subjects", "few.csv"], 3, 'few.csv: found no row of model "three.feb", expected one row each'),
            (["--subjects", "odd.csv"], 3, 'odd.csv:4: found model "four.feb"'),
            (["--subjects", "twice.csv"], 3, 'twice.csv:5: found model "one" as in line 2, expected one row each'),
            (["--subjects", "none.csv"], 3, "none.csv: found no readable file"),
            (["--subjects", "s.csv", "--group", "size"], 2, '--group size: found no column "size"'),
            (["--subjects", "s.csv", "--pair-by", "age"], 2, "--pair-by age: belongs to --pair and --subjects"),
            (["--subjects", "s.csv", "--csv", "s.csv"], 2, "--csv s.csv: would overwrite the table of subjects")]:
        expect(f.fault("plan.db", "--report", "x.html", *words, code=code), part)
        assert not (f.path / "x.html").exists() and (f.path / "s.csv").read_text() == table
    expect(f.fault("plan.db", "--subjects", "s.csv", code=2), "--subjects s.csv: belongs to --report FILE.html")
    expect(f.fault(*models, *LAW, "-o", "new.db", "--report", "x.html", "--subjects", "s.csv", "--pair", "side", code=2),
           '--pair side: found no column "side", expected one of "model", "sex", "age"')
    f.write("cases.csv", "model,sex\none.feb,F\n")
    expect(f.fault("--cases", "cases.csv", "-o", "new.db", code=3), "a column that only describes models is for --subjects")
    assert not (f.path / "new.db").exists(), "nothing is solved"


def test_cases_are_those_of_dea_run(f):
    f.run("ball.feb", *LAW, "--vary", "E: E={8|12.5}", "--vary", "m: move ball=0,0,{0:-0.02:-0.01}", "--csv", "all.csv",
          "-o", "plan.db")
    rows = list(csv.DictReader((f.path / "all.csv").open()))
    assert [(r["case_id"], r["E"], r["m"]) for r in rows if r["state"] == "1"] == [
        ("1", "8", "0"), ("2", "8", "-0.01"), ("3", "8", "-0.02"),
        ("4", "12.5", "0"), ("5", "12.5", "-0.01"), ("6", "12.5", "-0.02")]
    run = subprocess.run([dea, "run", "ball.feb", *LAW, "--E", "12.5", "--move", "ball=0,0,-0.01", "--no-xplt", "-q",
                          "--csv", "-"], cwd=f.path, capture_output=True, text=True)
    single = list(csv.DictReader(io.StringIO(run.stdout)))
    mine = [r for r in rows if r["case_id"] == "5"]
    assert len(single) == len(mine) > 1
    shared = [name for name in single[0] if name in mine[0] and name != "warnings"]
    assert len(shared) >= 40, shared
    for a, b in zip(single, mine):
        for name in shared:
            assert a[name] == b[name], f"{name}: dea run {a[name]}, dea study {b[name]}"


def test_layers_that_several_contacts_press_are_those_of_dea_run(f):
    subprocess.run([make_samples, "--knee", "8", f.path / "knee.feb"], check=True)
    f.write("knee.feb", made_models.with_one_trochlea((f.path / "knee.feb").read_text()))
    f.run("knee.feb", "--vary", "E: E={12|13}", "--states", "last", "-o", "plan.db")
    run = subprocess.run([dea, "run", "knee.feb", "--E", "12", "--states", "last", "--no-xplt", "-q", "--json", "-"], cwd=f.path,
                         capture_output=True, text=True)
    (layer,) = json.loads(run.stdout)["states"][-1]["layers"]
    assert layer["surfaces"] == ["trochlea"] and len(layer["contacts"]) == 2
    with sqlite3.connect(f.path / "plan.db") as plan:
        (mine,) = plan.execute("SELECT layer, headline_p99, headline_area, force FROM layer_results WHERE E = 12").fetchall()
    assert mine == ("trochlea", layer["headline"]["p99"], layer["headline"]["area"], layer["force"]), (mine, layer)


def test_parts_that_give_way_are_those_of_dea_run(f):
    f.write("disc.feb", made_models.disc())
    f.run("disc.feb", "--vary", "fibres: fibre-strain={0|0.03}", "--vary", "stiffness: E=top={4|8}", "--vary", "down: move upper=0,0,{0|-0.01}",
          "--states", "last", "-o", "plan.db")
    pressed = {}
    for fibres, stiffness, down, *mine in f.query("plan.db", "SELECT fibres, stiffness, down, soft_part, first_principal_stress_p99, fibre_stress_p99, "
                                                 "fibre_stress_peak, largest_strain, largest_turn, largest_displacement FROM soft_part_results"):
        run = subprocess.run([dea, "run", "disc.feb", "--fibre-strain", str(fibres), "--E", f"top={stiffness}", "--move", f"upper=0,0,{down}",
                              "--states", "last", "--no-xplt", "-q", "--json", "-"], cwd=f.path, capture_output=True, text=True, check=True)
        (part,) = json.loads(run.stdout)["states"][-1]["parts"]
        assert mine == [part[key] for key in ("name", "first_principal_stress_p99", "fibre_stress_p99", "fibre_stress_peak",
                                              "largest_strain", "largest_turn", "largest_displacement")], (mine, part)
        pressed[fibres, stiffness, down] = -part["fibre_stress_peak"]
    assert len(pressed) == 8 and all(pressed[f, 8, d] > pressed[f, 4, d] + 0.05 for f in (0, 0.03) for d in (0, -0.01)), pressed


def test_options_act_in_the_order_of_the_line(f):
    vary, turn = ["--vary", "a: rotate ball=0,1,0,{30|60}"], ["--rotate", "ball=1,0,0,40"]
    start, end = ["ball.feb", *LAW, "--rotate-about", "ball=com"], ["--states", "last"]
    peaks = []
    for name, order, single in [("first.db", [*vary, *turn], ["--rotate", "ball=0,1,0,60", *turn]),
                                ("last.db", [*turn, *vary], [*turn, "--rotate", "ball=0,1,0,60"])]:
        f.run(*start, *order, *end, "-o", name)
        run = subprocess.run([dea, "run", *start, *single, *end, "--no-xplt", "-q", "--csv", "-"], cwd=f.path,
                             capture_output=True, text=True, check=True).stdout
        peaks.append(dict(zip(*f.results(name)[::2]))["peak_pressure"])
        assert peaks[-1] == next(csv.DictReader(io.StringIO(run)))["peak_pressure"]
    assert peaks[0] != peaks[1]


def test_the_same_bits_for_one_and_two_threads(f):
    line = ["ball.feb", "--vary", "E: E={8:20:2}", "--vary", "m: move ball=0,0,{0|-0.01|0.01}", "--states", "last"]
    f.run(*line, "--threads", "1", "-o", "one.db")
    f.run(*line, "--threads", "2", "-o", "two.db")
    assert f.results("one.db") == f.results("two.db")


def test_rows_of_a_table_of_loads_are_states(f):
    f.write("walk.csv", "time,fx,fy,fz\n0,0,0,500\n1,0,0,1000\n2,5,0,1500\n")
    f.run("ball.feb", *LAW, "--vary", "E: E={8|9}", "--loads", "walk.csv", "--load-body", "ball", "-o", "plan.db")
    assert f.query("plan.db", "SELECT case_id, time FROM states") == [(c, t) for c in (1, 2) for t in (0.0, 1.0, 2.0)]
    assert f.query("plan.db", "SELECT path FROM inputs") == [("ball.feb",), ("walk.csv",)]
    f.write("walk.csv", "time,fx,fy,fz\n0,0,0,600\n")
    expect(f.fault("ball.feb", *LAW, "--vary", "E: E={8|9}", "--loads", "walk.csv", "--load-body", "ball", "-o", "plan.db",
                   code=3), "plan.db: walk.csv has changed since; --overwrite begins anew, -o FILE.db makes another")


def test_tables_of_cases_and_samples(f):
    f.write("two.feb", BALL)
    f.write("cases.csv", "model,E,nu\ntwo.feb,8,0.4\nball.feb,9,0.45\n")
    both = ["--factor", "E: E={}", "--factor", "nu: nu={}"]
    f.run(*LAW, *both, "--cases", "cases.csv", "--states", "last", "-o", "table.db")
    assert f.query("table.db", "SELECT model, E, nu FROM results") == [("two.feb", 8, 0.4), ("ball.feb", 9, 0.45)]
    drawn = ["ball.feb", *LAW, "--factor", "E: E={uniform(8,16)}", "--factor", "nu: nu={normal(0.4,0.01)}", "--sample",
             "saltelli", "--count", "4", "--states", "last"]
    f.run(*drawn, "-o", "sample.db")
    assert f.query("sample.db", "SELECT count(*), min(E) >= 8, max(E) < 16 FROM cases") == [(16, 1, 1)]
    f.run(*drawn, "--seed", "1", "-o", "seed.db")
    assert f.query("sample.db", "SELECT E, nu FROM cases") == f.query("seed.db", "SELECT E, nu FROM cases")
    assert f.query("sample.db", "SELECT name, spread, a, b FROM factors") == [
        ("E", "uniform", 8.0, 16.0), ("nu", "normal", 0.4, 0.01)]


def test_fields_and_plot_files_are_kept(f):
    import array
    import zlib
    f.run("ball.feb", *LAW, "--vary", "E: E={8|9}", "--states", "last", "--keep", "fields", "--keep", "xplt", "-o", "plan.db")
    (vertices, triangles), = f.query("plan.db", "SELECT vertices, triangles FROM surfaces")
    points = len(array.array("d", zlib.decompress(vertices))) // 3
    assert max(array.array("i", zlib.decompress(triangles))) == points - 1
    for blob, peak in f.query("plan.db", "SELECT pressure, headline_peak FROM fields JOIN statistics "
                                         "USING (case_id, state, contact_id)"):
        pressures = array.array("f", zlib.decompress(blob))
        assert len(pressures) == points and abs(max(pressures) - peak) < 0.5 * peak
    files = sorted(p.name for p in (f.path / "plan_xplt").iterdir())
    assert files == ["000001.xplt", "000002.xplt"]
    subprocess.run([dea, "compare", "plan_xplt/000001.xplt", "plan_xplt/000002.xplt", "-q"], cwd=f.path, check=True)


# ---------------------------------------------------------------------------------------------- going on


def kill_and_go_on(f, line, kills, lines):
    """Kills the study at random moments, within as many cases as `lines`, then lets it end; how often it was killed."""
    random.seed(20)
    for n in range(kills):
        study = f.start(*line, "-o", "killed.db", "-v")
        for _ in range(random.randint(0, lines)):
            study.stderr.readline()
        time.sleep(random.uniform(0.0, 0.1))
        study.send_signal(signal.SIGKILL)
        study.communicate()
        if study.returncode == 0:
            return n
    f.run(*line, "-o", "killed.db", "-q")
    return kills


def test_goes_on_after_it_was_killed(f):
    count, wanted = (2000, 60) if LONG else (300, 6)
    line = many(count)
    f.run(*line, "-o", "whole.db", "-q")
    kills = kill_and_go_on(f, line, wanted, count // (wanted + 2))
    assert kills >= wanted // 2, f"only {kills} kills"
    assert f.query("killed.db", "SELECT count(*), min(case_id), max(case_id) FROM cases") == [(count, 1, count)]
    assert f.query("killed.db", "PRAGMA integrity_check") == [("ok",)]
    assert f.query("killed.db", "SELECT count(*) FROM pragma_foreign_key_check") == [(0,)]
    assert f.results("killed.db") == f.results("whole.db")
    assert not [p for p in f.path.iterdir() if p.name.endswith(("-journal", ".tmp"))]
    _, err = f.run(*line, "-o", "killed.db")
    expect(err, f"killed.db: all {count} cases are there already")


def test_ctrl_c_keeps_what_is_done(f):
    line = many(4000)
    study = f.start(*line, "-v", "-o", "plan.db")
    done = [study.stderr.readline() for _ in range(40)]
    assert done[-1].startswith("case "), done
    study.send_signal(signal.SIGINT)
    _, err = study.communicate(timeout=60)
    assert study.returncode == 130, study.returncode
    expect(err.splitlines()[-1], "dea: stopped; cases that are done are in the file, the same command goes on")
    shown = len(done) + sum(line.startswith("case ") for line in err.splitlines())
    kept = f.query("plan.db", "SELECT count(*) FROM cases")[0][0]
    assert kept >= shown - 1 >= 38, (kept, shown)
    assert not (f.path / ".plan.db.lock").exists()


def test_states_that_are_no_solution_are_told_from_the_others(f):
    """The ball pulled out of its socket: its rows have numbers, and `solved` is 0."""
    f.run("ball.feb", *LAW, "--vary", "pull: force ball=0,0,{900|-900}", "--free", "ball=z", "--states", "last", "-q", "-o",
          "plan.db", code=1)
    rows = f.query("plan.db", "SELECT outcome, solved FROM results ORDER BY case_id")
    assert {solved for outcome, solved in rows} == {0, 1}, rows
    assert all(solved == (outcome in ("Prescribed", "Balanced", "BalancedToOneSpring")) for outcome, solved in rows), rows
    names = [c[1] for c in f.query("plan.db", "PRAGMA table_info(results)")]
    assert names[-3:] == ["seconds", "solved", "codes"], names
    _, err = f.run("ball.feb", *LAW, "--vary", "pull: force ball=0,0,{900|-900}", "--free", "ball=z", "--states", "last", "-o",
                   "plan.db", "--again", "failed", code=1)
    expect(err, "; 1 was there already")
    out, _ = f.run("plan.db", "--csv", "-", "-q", code=1)
    assert [row["solved"] for row in csv.DictReader(io.StringIO(out))] == [str(solved) for _, solved in rows]


def test_warnings_are_counted_at_the_end(f):
    """Cartilage so soft that it is pressed together by more than half: each case has a warning."""
    line = ["ball.feb", "--vary", "E: E={0.5|0.6}", "--states", "last"]
    _, err = f.run(*line, "-o", "plan.db")
    last = err.splitlines()[-1]
    warning = f.query("plan.db", "SELECT text FROM warnings WHERE case_id = 1 ORDER BY number")[0][0]
    assert last == f"plan.db: 2 of 2 cases with warnings, such as case 1: {warning}", err
    _, err = f.run(*line, "-q", "-o", "plan.db")
    assert err == "", err


def test_codes_that_are_quiet_or_refused(f):
    """What dea run has of --quiet CODE and --error-on CODE, a study and its dry run have, too."""
    line = ["ball.feb", "--vary", "E: E={0.5|0.6}", "--states", "last"]
    f.run(*line, "-o", "plan.db")
    codes = sorted({code for text, in f.query("plan.db", "SELECT codes FROM results") for code in text.split(" ")})
    assert codes == sorted(code for code, in f.query("plan.db", "SELECT DISTINCT code FROM warnings")), codes
    quiet = [word for code in codes for word in ("--quiet", code)]
    _, err = f.run(*line, "-o", "plan.db", *quiet)
    assert "with warnings" not in err, err
    _, err = f.run(*line, "-o", "plan.db", *quiet[2:])  # all but one
    assert "with warnings" in err, err
    refused = f"error: found {codes[0]}, which --error-on refuses"
    expect(f.fault(*line, "-o", "plan.db", "--error-on", codes[0], code=1), refused)
    _, err = f.run(*line, "--dry-run", "--error-on", codes[0], "-v", code=1)
    assert err.strip("\n") == err[:-1] and refused in err and "\n\n" not in err, err
    f.run(*line, "--dry-run", "-v", *quiet)
    expect(f.fault(*line, "--dry-run", "--error-on", "motion-table", code=2),
           "--error-on motion-table: found a note, which a study does not keep")


def test_files_of_others_are_kept(f):
    f.write("r.csv", "x,y\n1,2\n")
    expect(f.fault(*many(2), "-o", "plan.db", "--csv", "r.csv", code=4),
           "r.csv: it is there already, not made by dea; --overwrite replaces it and begins plan.db anew, --csv writes another")
    f.run(*many(2), "-o", "plan.db", "--csv", "own.csv")
    f.run(*many(2), "-o", "plan.db", "--csv", "own.csv")
    expect(f.fault("plan.db", "--csv", "r.csv", code=4), "r.csv: it is there already, not made by dea; --overwrite replaces it, --csv writes another")
    f.run("plan.db", "--csv", "r.csv", "--overwrite")
    assert (f.path / "r.csv").read_text() == (f.path / "own.csv").read_text()
    assert f.query("plan.db", "SELECT count(*) FROM cases")[0][0] == 2


def test_failed_cases_are_rows_and_are_solved_again(f):
    f.write("bad.feb", "<febio_spec")
    line = ["ball.feb", "bad.feb", *LAW, "--vary", "E: E={8|9}", "--states", "last", "-o", "plan.db"]
    _, err = f.run(*line, code=1)
    expect(err.splitlines()[-1], "plan.db: 2 of 4 cases no solution (0 failed, 2 refused), first case 3: bad.feb, E=8, bad.feb")
    rows = f.query("plan.db", "SELECT case_id, case_outcome, case_message, headline_p99 IS NULL FROM results")
    assert [r[1] for r in rows] == ["solved", "solved", "refused", "refused"] and rows[2][3] == 1
    expect(rows[2][2], "bad.feb")
    _, err = f.run(*line, code=1)
    expect(err, "all 4 cases are there already", "2 of 4 cases no solution")
    first = f.query("plan.db", "SELECT seconds FROM cases WHERE case_id = 1")
    _, err = f.run(*line, "--again", "failed", "-v", code=1)
    assert [l.split(":")[0] for l in err.splitlines() if l.startswith("case ")] in (["case 3", "case 4"],
                                                                                   ["case 4", "case 3"]), err
    assert f.query("plan.db", "SELECT seconds FROM cases WHERE case_id = 1") == first
    assert f.query("plan.db", "SELECT count(*) FROM cases") == [(4,)]


def test_a_misspelt_name_is_mended_without_overwrite(f):
    line = ["ball.feb", *LAW, "--states", "last", "-o", "plan.db", "--vary"]
    _, err = f.run(*line, "a: move bal=0,0,{0|0.01}", code=1)
    expect(err, "2 of 2 cases no solution (0 failed, 2 refused)", "did you mean \"ball\"?")
    f.run(*line, "a: move ball=0,0,{0|0.01}")
    assert f.query("plan.db", "SELECT DISTINCT case_outcome FROM cases") == [("solved",)]


def test_is_read_while_it_runs(f):
    study = f.start(*many(3000), "-o", "plan.db", "-q")
    seen, end = set(), time.monotonic() + 60
    while len(seen) < 3 and time.monotonic() < end and study.poll() is None:
        time.sleep(0.3)
        if not (f.path / "plan.db").exists():
            continue
        reading = f.start("plan.db", "--csv", "-", "-q")
        out, err = reading.communicate(timeout=60)
        if reading.returncode == 0:
            seen.add(out.count("\n"))
    study.send_signal(signal.SIGINT)
    _, err = study.communicate()
    assert study.returncode == 130 and len(seen) >= 3, (seen, err)


def test_a_second_one_is_refused(f):
    study = f.start(*many(3000), "-v", "-o", "plan.db")
    study.stderr.readline()
    expect(f.fault(*many(3000), "-o", "plan.db", code=4), f"another run (process {study.pid}) is at work on it")
    study.send_signal(signal.SIGINT)
    study.communicate()


def test_a_full_disk(f):
    def limit():
        resource.setrlimit(resource.RLIMIT_FSIZE, (1_000_000, 1_000_000))

    err = f.fault(*many(2000), "-o", "plan.db", code=4, preexec_fn=limit)
    expect(err, "dea: cannot write plan.db: File too large")
    count = f.query("plan.db", "SELECT count(*) FROM cases")[0][0]
    assert 0 < count < 2000, count
    assert f.query("plan.db", "PRAGMA integrity_check") == [("ok",)]
    assert f.query("plan.db", f"SELECT count(*) FROM statistics") == [(count,)]


def test_a_disk_without_room_and_then_with_more(f):
    """A disk in memory of 400 kB, for this test alone; where nobody may make one, the file's limit above is the test."""
    line = " ".join(f"'{word}'" for word in map(str, [dea, "study", *turned(1000), "-q", "-o", "disk/plan.db"]))
    script = (f"mkdir disk && mount -t tmpfs -o size=400k none disk || exit 77\n{line}; echo $?\ncp disk/plan.db full.db\n"
              f"mount -o remount,size=10m disk && {line}; echo $?\ncp disk/plan.db more.db")
    done = subprocess.run(["unshare", "--map-root-user", "--mount", "sh", "-c", script], cwd=f.path, env=CLEAN, text=True,
                          capture_output=True, timeout=600)
    if done.returncode != 0 and not done.stdout:
        print("        not tried: " + done.stderr.strip().splitlines()[-1])
        return
    assert done.stdout.split() == ["4", "0"], done
    expect(done.stderr, "dea: cannot write disk/plan.db: database or disk is full\n")
    count = f.query("full.db", "SELECT count(*) FROM cases")[0][0]
    # whole batches or none: a fast machine's first one is larger than the disk
    assert count < 1000 and f.query("full.db", "SELECT count(*) FROM statistics") == [(count,)], count
    f.run(*turned(1000), "-o", "whole.db", "-q")
    assert f.results("more.db") == f.results("whole.db")


TABLES = [  # what stands in a group of the columns: its query, and what tells its items apart
    ("/", "SELECT * FROM cases", ()),
    ("/", "SELECT DISTINCT case_id, state, time, outcome, iterations, residual_force, solved FROM results WHERE state", ()),
    ("/", "SELECT * FROM statistics LEFT JOIN inside USING (case_id, state, contact_id)", ("contact",)),
    ("/parts", "SELECT * FROM parts LEFT JOIN inside_parts USING (case_id, state, contact_id, part_id)", ("contact", "part")),
    ("/layers", "SELECT * FROM layers", ("layer",)), ("/soft_parts", "SELECT * FROM soft_parts", ("soft_part",)),
    ("/poses", "SELECT * FROM poses", ("body",))]
ELSEWHERE = {"case_id", "state", "model_id", "contact_id", "part_id", "layer_id", "soft_part_id", "body_id"}


def columns_differ(f, study, file):
    """(variable, where) of what the columns have otherwise than the study's file."""
    import h5py
    import numpy

    def values(variable):
        if variable.dtype == object:
            return variable.asstr()[()]
        meanings = variable.attrs.get("flag_meanings")
        if meanings is None:
            return variable[()]
        return numpy.array((meanings.decode() if isinstance(meanings, bytes) else meanings).split())[variable[()]]

    def same(value, wanted):
        if wanted is None:
            return value == "" or value != value
        return value == ({0: "no", 1: "yes"}[wanted] if value in ("no", "yes") else wanted)

    found = []
    with h5py.File(f.path / file) as h5, sqlite3.connect(f"file:{f.path / study}?mode=ro", uri=True) as connection:
        connection.row_factory = sqlite3.Row
        for place, sql, keys in TABLES:
            rows = connection.execute(sql).fetchall()
            if not rows:
                assert place not in h5, place
                continue
            group = h5[place]
            of = {name: values(group[name]) for name in rows[0].keys() if name not in ELSEWHERE and name in group}
            found += [(name, "is not there") for name in set(rows[0].keys()) - set(of) - ELSEWHERE if any(row[name] is not None for row in rows)]
            case_at = {number: i for i, number in enumerate(group["case"][()].tolist())}
            item_at = {key: i for i, key in enumerate(zip(*(of[key].tolist() for key in keys)))}
            for row in rows:
                at = (case_at[row["case_id"]],) + ((row["state"] - 1,) if "state" in row.keys() else ())
                item = (item_at[tuple(row[key] for key in keys)],) if keys else ()
                for name, value in of.items():
                    # what says of an item what it is stands over the items alone
                    place_of = item if value.ndim == 1 and keys else at + item
                    # a contact of the same name in two models may be between other bodies
                    of_several = name in ("source", "target") and row[name] in value[place_of].split("\n")
                    if not of_several and not same(value[place_of], row[name]):
                        found.append((name, place_of))
    return found


def test_columns_have_the_numbers_of_the_file(f):
    """Several models, of which two have their contacts in different orders, states, the inside, compartments, factors of
    numbers and of words, cases without a solution and refused."""
    try:
        import h5py
        import zlib
    except ImportError:
        print("        not tried: there is no h5py")
        return
    subprocess.run([make_samples, "--plateaus", "4", f.path / "plateaus.feb"], check=True)
    knee = small_knee()
    contacts = re.findall(r"<contact .*?</contact>", knee, re.S)
    swapped = knee.replace(contacts[0], "FIRST").replace(contacts[1], contacts[0]).replace("FIRST", contacts[1])
    f.write("knee.feb", knee)
    f.write("swapped.feb", swapped)
    f.write("bad.feb", BALL[:5000])
    f.run("ball.feb", "plateaus.feb", "knee.feb", "swapped.feb", "bad.feb", "--facets", "flat", "--inside", "--vary", "E: E={8|12}", "--vary", "poisson: nu={0.4|0.45}",
          "--vary", "spring: law={linear|layer}", "--keep", "fields", "-o", "plan.db", "--hdf5", "plan.h5", "-q", code=1)
    outcomes = {o for o, in f.query("plan.db", "SELECT case_outcome FROM cases")}
    assert {"refused", "solved"} <= outcomes, outcomes
    for table in ("parts", "inside"):
        assert f.query("plan.db", f"SELECT count(*) FROM {table}")[0][0] > 0, f"no {table}"
    differ = columns_differ(f, "plan.db", "plan.h5")
    assert differ == [], differ[:5]
    with h5py.File(f.path / "plan.h5", "r+") as h5:
        h5["headline_mean"][1, 0, 0] += 1e-9
    assert columns_differ(f, "plan.db", "plan.h5") == [("headline_mean", (1, 0, 0))], "a number that is another is found"
    f.run("plan.db", "--hdf5", "plan.h5", "--csv", "plan.csv", "-q", code=1)
    with h5py.File(f.path / "plan.h5") as h5, open(f.path / "plan.csv") as table:
        rows = [row for row in csv.DictReader(table) if row["contact"]]
        case, contacts = h5["case"][()].tolist(), h5["contact"].asstr()[()].tolist()
        at = [(case.index(int(row["case_id"])), int(row["state"]) - 1, contacts.index(row["contact"])) for row in rows]
        for name in ("headline_p99", "force_z", "source_bone_max_shear_stress_p99"):
            differ = [(h5[name][place], row[name]) for place, row in zip(at, rows) if f"{h5[name][place]}" != f"{float(row[name] or 'nan')}"]
            assert differ == [], (name, differ)
        surfaces = list(h5["fields"].values())
        said = lambda s, name: s.attrs[name].decode() if isinstance(s.attrs[name], bytes) else s.attrs[name]  # noqa: E731
        assert len(surfaces) == 6, [said(s, "surface") for s in surfaces]
        assert len(contacts) == len(set(contacts)), contacts
        for case_id, state, contact, source, pressure in f.query("plan.db", "SELECT case_id, state, contact, source, pressure FROM fields JOIN statistics USING "
                                                               "(case_id, state, contact_id)"):
            there = [s["pressure"][s["case"][()].tolist().index(case_id), state - 1] for s in surfaces
                     if case_id in s["case"][()] and (said(s, "contact"), said(s, "source")) == (contact, source)]
            assert len(there) == 1 and there[0].tobytes() == zlib.decompress(pressure), (case_id, state, contact)
        solved = dict(((case_id, state), solved) for case_id, state, solved in f.query("plan.db", "SELECT case_id, state, solved FROM results"))
        assert {0, 1} <= set(solved.values()), solved
        for s in surfaces:
            for i, case_id in enumerate(s["case"][()].tolist()):
                assert s["solved"][i].tolist() == [solved.get((case_id, state), 0) for state in s["state"][()].tolist()], case_id
        assert said(h5, "cases") == "40 of 40 of the study", said(h5, "cases")


def test_columns_of_parts_that_give_way(f):
    try:
        import h5py  # noqa: F401
    except ImportError:
        print("        not tried: there is no h5py")
        return
    subprocess.run([make_samples, "--menisci", "8", f.path / "menisci.feb"], check=True)
    f.run("menisci.feb", "--vary", "E: E={8|12}", "--states", "last", "-o", "plan.db", "--hdf5", "plan.h5", "-q")
    assert f.query("plan.db", "SELECT count(*) FROM soft_parts")[0][0] == 4
    assert columns_differ(f, "plan.db", "plan.h5") == []


def test_columns_of_contacts_of_one_name(f):
    try:
        import h5py
    except ImportError:
        print("        not tried: there is no h5py")
        return
    knee = small_knee()
    first, second, *_ = re.findall(r'<contact name="([^"]+)"', knee)
    f.write("knee.feb", knee.replace(f'<contact name="{second}"', f'<contact name="{first}"'))
    line = ["knee.feb", *LAW, "--vary", "E: E={8|12}", "--states", "last", "-q"]
    f.run(*line, "-o", "plan.db", "--hdf5", "plan.h5")
    with h5py.File(f.path / "plan.h5") as h5:
        found = h5["headline_p99"][()]
        assert sorted(h5["contact"].asstr()[()].tolist()).count(first) == 2
    assert sorted(found.ravel().tolist()) == sorted(p for p, in f.query("plan.db", "SELECT headline_p99 FROM statistics"))
    f.run(*line, "--keep", "fields", "-o", "kept.db")
    if len(f.query("kept.db", "SELECT * FROM surfaces")) < len(f.query("kept.db", "SELECT DISTINCT contact_id FROM fields")):
        expect(f.fault("kept.db", "--hdf5", "kept.h5", code=3), f'found two contacts of the name "{first}"', "expected other names")


def test_columns_are_netcdf(f):
    f.run(*turned(3), "--keep", "fields", "-o", "plan.db", "--hdf5", "plan.h5", "-q")
    tried = 0
    read = ("import xarray; d = xarray.open_dataset('plan.h5'); b = xarray.open_dataset('plan.h5', group='poses'); "
            "p = xarray.open_dataset('plan.h5', group='fields/surface_1'); print(*d.headline_p99.dims, *p.pressure.dims, *d.t.values, "
            "str(d.model.values[2]), sorted(b.body.values.tolist())[0], repr(str(d.case_message.values[0])), sep=' ')")
    done = subprocess.run([sys.executable, "-c", read], cwd=f.path, text=True, capture_output=True)
    if "No module named" in done.stderr or "unrecognized engine" in done.stderr or "netcdf" in done.stderr.lower():
        print("        not tried: " + done.stderr.strip().splitlines()[-1])
    else:
        assert done.stdout == "case state contact case state vertex 1.0 2.0 3.0 ball.feb ball ''\n", done
    try:
        dump = subprocess.run(["h5dump", "-d", "/headline_p99", "plan.h5"], cwd=f.path, text=True, capture_output=True)
    except FileNotFoundError:
        print("        not tried: there is no h5dump")
        return
    p99 = f.query("plan.db", "SELECT headline_p99 FROM statistics")
    assert all(f"{value:.6g}" in dump.stdout for value, in p99), dump.stdout


def test_columns_that_cannot_be_written(f):
    f.run(*turned(200), "--keep", "fields", "-o", "plan.db", "-q")
    f.write("mine.h5", "mine")
    for words, code, part in [
            (["--hdf5", "mine.h5"], 4, "mine.h5: it is there already, not made by dea"), (["--hdf5", "-"], 2, "--hdf5 -"),
            (["--hdf5", "/dev/null"], 4, "is no file"), (["--hdf5", "none/x.h5"], 4, "there is no folder none"),
            (["--hdf5", "plan.db"], 2, "would overwrite the study")]:
        expect(f.fault("plan.db", *words, code=code), part)
    assert (f.path / "mine.h5").read_text() == "mine"
    f.run("plan.db", "--hdf5", "plan.h5", "-q")
    whole = (f.path / "plan.h5").read_bytes()

    def limit(size):
        return lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (size, size))

    for part in (1, 3, 9, 30):
        expect(f.fault("plan.db", "--hdf5", "plan.h5", code=4, preexec_fn=limit(len(whole) * part // 31)), "cannot write plan.h5: File too large")
    assert (f.path / "plan.h5").read_bytes() == whole, "the old file"
    killed = 0
    for n in range(20):  # killed while it writes: the old file, or none
        study = f.start("plan.db", "--hdf5", ("plan.h5", "new.h5")[n % 2], "-q")
        time.sleep(0.004 * n)
        study.send_signal(signal.SIGKILL)
        study.communicate()
        killed += study.returncode != 0
        assert (f.path / "plan.h5").read_bytes() == whole, "the old file"
        assert not (f.path / "new.h5").exists() or (f.path / "new.h5").read_bytes() == whole
        (f.path / "new.h5").unlink(missing_ok=True)
    assert killed > 3, killed


def test_databases_that_are_no_study_any_more(f):
    f.run(*turned(300), "-q", "-o", "plan.db")
    whole = (f.path / "plan.db").read_bytes()

    def changed(name, sql):
        (f.path / name).write_bytes(whole)
        with sqlite3.connect(f.path / name) as connection:
            connection.executescript(sql)
        connection.close()
    changed("older.db", "PRAGMA user_version = 0")
    changed("newer.db", "PRAGMA user_version = 3")
    changed("empty.db", "DELETE FROM study")
    changed("words.db", "UPDATE study SET value = 'many' WHERE key = 'cases'")
    (f.path / "half.db").write_bytes(whole[:len(whole) // 2])
    (f.path / "noise.db").write_bytes(whole[:100] + random.Random(1).randbytes(len(whole) - 100))
    damaged = bytearray(whole)
    damaged[len(whole) // 4:len(whole) // 2] = random.Random(1).randbytes(len(whole) // 2 - len(whole) // 4)
    (f.path / "inside.db").write_bytes(damaged)
    (f.path / "folder.db").mkdir()
    for name, words in [("older.db", "found dea.study/0, expected dea.study/2"), ("newer.db", "found dea.study/3, expected dea.study/2"),
                        ("empty.db", 'found no "version" in table study'), ("words.db", 'found cases = "many"'),
                        ("half.db", "found a damaged database"), ("noise.db", "found a damaged database"),
                        ("folder.db", "Is a directory")]:
        expect(f.fault(name, code=3), f"{name}: {words}")
        expect(f.fault("--merge", name, "-o", "all.db", code=3), f"{name}: {words}")
        if name != "folder.db":
            expect(f.fault(*turned(300), "-o", name, code=3), f"{name}: {words}", "; --overwrite begins anew, -o FILE.db makes another")
    expect(f.fault("inside.db", "--csv", "x.csv", code=3), "inside.db: found a damaged database")
    expect(f.fault("--merge", "inside.db", "-o", "all.db", code=3), "inside.db: found a damaged database")
    assert not (f.path / "x.csv").exists() and not (f.path / "all.db").exists()
    if os.geteuid() != 0:
        (f.path / "plan.db").chmod(0)
        expect(f.fault("plan.db", code=3), "plan.db: ")


def test_what_differs_is_named(f):
    f.run(*many(2), "-o", "plan.db")
    end = "; --overwrite begins anew, -o FILE.db makes another"
    expect(f.fault(*many(3), "-o", "plan.db", code=3),
           "plan.db: it was made with --vary 'E: E={1:2:1}', not --vary 'E: E={1:3:1}'" + end)
    expect(f.fault(*many(2), "--nu", "0.3", "-o", "plan.db", code=3), "plan.db: it was made without --nu 0.3" + end)
    f.write("ball.feb", BALL.replace("11.85", "11.86", 1))
    expect(f.fault(*many(2), "-o", "plan.db", code=3), "plan.db: ball.feb has changed since" + end)
    f.run(*many(2), "-o", "plan.db", "--overwrite")
    with sqlite3.connect(f.path / "plan.db") as connection:
        connection.execute("UPDATE study SET value = '0.0 (old)' WHERE key = 'version'")
    expect(f.fault(*many(2), "-o", "plan.db", code=3), "plan.db: it was made by dea 0.0 (old), this is dea " ,  end)
    f.write("note.db", "nothing of the kind " * 500)
    expect(f.fault(*many(2), "-o", "note.db", code=3), "note.db: found no SQLite database", end)
    assert (f.path / "note.db").read_text().startswith("nothing")


def test_an_included_file_that_changes_is_noticed(f):
    start, end = BALL.index("<Material>"), BALL.index("</Material>") + len("</Material>")
    f.write("ball.feb", BALL[:start] + '<Include>material.feb</Include>' + BALL[end:])
    material = '<?xml version="1.0"?>\n<febio_spec version="4.0">' + BALL[start:end] + "</febio_spec>"
    f.write("material.feb", material)
    f.run(*many(2), "-o", "plan.db")
    f.write("material.feb", material.replace("11.85", "11.86", 1))
    expect(f.fault(*many(2), "-o", "plan.db", code=3), "plan.db: material.feb has changed since")


# ---------------------------------------------------------------------------------------------- shards


def test_shards_merged_are_the_whole(f):
    line = many(10)
    f.run(*line, "-o", "whole.db")
    for i in (1, 2, 3):
        f.run(*line, "--shard", f"{i}/3", "-o", "plan.db", "-q")
    names = [f"plan.{i}-of-3.db" for i in (1, 2, 3)]
    assert [f.query(n, "SELECT count(*) FROM cases")[0][0] for n in names] == [3, 3, 4]
    _, err = f.run("--merge", *reversed(names), "-o", "all.db")
    expect(err, "all.db: 10 cases of 3 files")
    assert f.results("all.db") == f.results("whole.db")
    expect(f.fault("--merge", *names, "-o", "all.db", code=4), "is there already; --overwrite replaces it")
    _, err = f.run("--merge", names[0], names[2], "-o", "part.db", code=1)
    expect(err, "lacks shard 2, cases 4-6; ")
    f.run(*line, "-o", "part.db")
    assert f.results("part.db") == f.results("whole.db")
    f.run(*many(11), "--shard", "2/3", "-o", "other.db", "-q")
    expect(f.fault("--merge", names[0], "other.2-of-3.db", "-o", "x.db", code=3), "is of another study than plan.1-of-3.db")
    expect(f.fault("--merge", names[0], names[0], "-o", "x.db", code=3), "expected each shard once")
    expect(f.fault("--merge", names[0], "missing.db", "-o", "x.db", code=3), "missing.db: found no readable file")
    assert not (f.path / "x.db").exists()


def test_shards_by_the_environment(f):
    cases = [({"SLURM_ARRAY_TASK_ID": "3", "SLURM_ARRAY_TASK_MIN": "1", "SLURM_ARRAY_TASK_MAX": "5",
               "SLURM_ARRAY_TASK_STEP": "2", "SLURM_ARRAY_TASK_COUNT": "3", "SLURM_PROCID": "0"}, "2-of-3"),
             ({"SLURM_PROCID": "1", "SLURM_STEP_NUM_TASKS": "4"}, "2-of-4"),
             ({"OMPI_COMM_WORLD_RANK": "0", "OMPI_COMM_WORLD_SIZE": "2"}, "1-of-2"),
             ({"PMI_RANK": "2", "PMI_SIZE": "3"}, "3-of-3"),
             ({"SLURM_ARRAY_TASK_ID": "1", "SLURM_ARRAY_TASK_MIN": "0", "SLURM_ARRAY_TASK_MAX": "1",
               "SLURM_ARRAY_TASK_COUNT": "2", "SLURM_PROCID": "0", "SLURM_STEP_NUM_TASKS": "2"}, "3-of-4")]
    for environment, shard in cases:
        f.run(*many(4), "--shard", "auto", "-o", f"of{shard}.db", "-q", env=environment)
        assert (f.path / f"of{shard}.{shard}.db").exists(), (environment, list(f.path.iterdir()))
    expect(f.fault(*many(4), "--shard", "auto", "-o", "plan.db", code=2), "found none of SLURM_ARRAY_TASK_ID")
    gaps = {"SLURM_ARRAY_TASK_ID": "5", "SLURM_ARRAY_TASK_MIN": "1", "SLURM_ARRAY_TASK_MAX": "9",
            "SLURM_ARRAY_TASK_COUNT": "3"}
    expect(f.fault(*many(4), "--shard", "auto", "-o", "plan.db", code=2, env=gaps), "without gaps")
    again = {"SLURM_ARRAY_TASK_ID": "3", "SLURM_ARRAY_TASK_MIN": "3", "SLURM_ARRAY_TASK_MAX": "3",
             "SLURM_ARRAY_TASK_COUNT": "1"}  # one task of an array submitted again would be the whole study
    expect(f.fault(*many(4), "--shard", "auto", "-o", "plan.db", code=2, env=again), "an array without gaps")


def array_task(task, first, last):
    return {"SLURM_ARRAY_TASK_ID": str(task), "SLURM_ARRAY_TASK_MIN": str(first), "SLURM_ARRAY_TASK_MAX": str(last),
            "SLURM_ARRAY_TASK_COUNT": str(last - first + 1)}


def test_arrays_from_any_number_and_parts_of_them_submitted_again(f):
    auto = [*many(4), "--shard", "auto", "-o", "plan.db"]
    for task in (5, 6, 8):  # the third is lost
        f.run(*auto, "-q", env=array_task(task, 5, 8))
    names = [f"plan.{i}-of-4.db" for i in (1, 2, 4)]
    assert sorted(p.name for p in f.path.glob("*.db")) == names
    assert [f.query(n, "SELECT case_id FROM cases") for n in names] == [[(1,)], [(2,)], [(4,)]]
    # tasks 7 and 8 again would be two halves of the study, not its quarters
    expect(f.fault(*auto, code=2, env=array_task(7, 7, 8)), "--shard auto: found plan.1-of-4.db, one of 4 shards, where this "
           "is one of 2, expected the shard of that division: --shard I/4, or another name")
    assert sorted(p.name for p in f.path.glob("*.db")) == names
    f.run(*auto[:-3], "3/4", *auto[-2:], "-q", env=array_task(7, 7, 8))
    assert f.query("plan.3-of-4.db", "SELECT case_id FROM cases") == [(3,)]
    (f.path / "sub").mkdir()
    f.run(*auto[:-1], "sub/plan.db", "-q", env=array_task(7, 7, 8))
    assert (f.path / "sub/plan.1-of-2.db").exists()


def test_threads_and_tasks_of_a_slurm_job(f):
    """Cases that --dry-run counts on are those of this task's processors."""
    words = ["ball.feb", *LAW, "--vary", "E: E={10:19:1}", "--states", "last", "--dry-run"]
    cores = len(os.sched_getaffinity(0))
    for environment, threads in [({"SLURM_CPUS_PER_TASK": "1"}, 1), ({"SLURM_CPUS_PER_TASK": "1000"}, cores),
                                 ({"SLURM_CPUS_ON_NODE": "2", "SLURM_STEP_TASKS_PER_NODE": "2(x2),1"}, 1),
                                 ({}, cores)]:
        out, _ = f.run(*words, env=environment)
        expect(out, f" with {threads} thread" + ("s" if threads > 1 else ""))


# ---------------------------------------------------------------------------------------------- the rest


def test_a_dry_run_counts_and_estimates(f):
    out, _ = f.run("ball.feb", *LAW, "--vary", "E: E={10:1009:1}", "--vary", "nu: nu={0.4|0.45}", "--states", "last", "--dry-run")
    expect(out, "2000 cases: 1 model, E 1000 values, nu 2 values\nabout ", "s each (median of 6)")
    assert sorted(p.name for p in f.path.iterdir()) == ["ball.feb"]


def test_what_a_user_may_do_wrong(f):
    f.write("cases.csv", "E,tlit\n8,1\n")
    f.write("empty.csv", "E\n8\n\n9\nNaN\n")
    f.write("words.csv", "E\n8\neight\n")
    f.write("gap.csv", "E,nu\n,0.4\n")
    f.write("none_below.csv", "E\n")
    f.write("first.csv", "E\neight\n8\n")
    f.write("short.csv", "E,nu\n8,0.4\n9\n")
    f.write("old.db", "")
    with sqlite3.connect(f.path / "other.db") as connection:
        connection.execute("CREATE TABLE a (b)")
    vary, db = ["ball.feb", "--vary"], ["-o", "plan.db"]
    table = ["ball.feb", "--factor", "E: E={}", *db, "--cases"]
    for words, code, *parts in [
            ([*vary, "E: E={8|9}"], 2, "found no -o"),
            ([*vary, "E: E={8|9}", "-o", "-"], 2, "cannot go to standard output"),
            ([*vary, "E: E={8|9}", "-o", "ball.feb"], 2, "expected .db"),
            ([*vary, "E: E={8|9}", "-o", "no/plan.db"], 4, "there is no folder no"),
            ([*vary, "e E={8|9}", *db], 2, "--vary e E={8|9}: found", "NAME: OPTION VALUE"),
            ([*vary, "a: rotat ball=0,1,0,{1|2}", *db], 2, "did you mean \"rotate\"?"),
            ([*vary, "a: rotate ball=0,1,{1|2}", *db], 2, "an axis and an angle"),
            ([*vary, "a: E={8|nine}", *db], 2, "--vary a: E={8|nine}: value nine: found \"nine\""),
            ([*vary, "a: E={0:5:0}", *db], 2, "a step that is not 0"),
            ([*vary, "a: E={5:1:1}", *db], 2, "a step of the other sign"),
            ([*vary, "a: E={1:1000000000:1}", *db], 2, "found 1000000000 values"),
            ([*vary, "a: E={1:10000:1}", "--vary", "b: nu={1:10000:1}", *db], 2, "found 100000000 cases"),
            ([*vary, "a: E={1|2}", "--vary", "a: nu={0.1|0.2}", *db], 2, "two factors named \"a\""),
            ([*vary, "outcome: E={1|2}", *db], 2, "results have a column of this one"),
            ([*vary, "a: E={1|2}", "--E", "8", *db], 2, "given twice"),
            (["ball.feb", "--factor", "a: E={}", *db], 2, "factor \"a\": found {} in its option"),
            ([*table, "cases.csv"], 3, "cases.csv:1: found column \"tlit\""),
            ([*table, "empty.csv"], 3, "empty.csv:5: column \"E\": found \"NaN\", expected a value"),
            ([*table, "words.csv"], 3, "words.csv:3: column \"E\": found \"eight\""),
            ([*table, "gap.csv", "--factor", "nu: nu={}"], 3, "gap.csv:2: column \"E\": found \"\", expected a value"),
            ([*table, "none_below.csv"], 3, "found no row, expected at least one"),
            ([*vary, "a: E={1:2}", *db], 2, "expected START:STOP:STEP in the braces"),
            ([*vary, "a: E={8|9", *db], 2, "NAME: OPTION VALUE with one {...}"),
            ([*vary, "a: E={8|}", *db], 2, "expected a value on both sides of each |"),
            ([*vary, "a: E={unifrm(1,2)}", *db], 2, "did you mean \"uniform\"?"),
            ([*table, "first.csv"], 3, "first.csv:2: column \"E\": found \"eight\""),
            ([*table, "short.csv"], 3, "short.csv:3: found 1 values, expected 2"),
            ([*table, "none.csv"], 3, "none.csv: found no readable file"),
            ([*table, "cases.csv", "--sample", "sobol", "--count", "4"], 2, "expected one of them"),
            ([*vary, "a: E={uniform(1,2)}", *db], 2, "found a spread"),
            ([*vary, "a: E={uniform(1,2)}", "--sample", "sobol", *db], 2, "found no --count"),
            ([*vary, "a: E={uniform(1,2)}", "--sample", "sobl", "--count", "4", *db], 2, "did you mean \"sobol\"?"),
            ([*vary, "a: E={uniform(1,2)}", "--sample", "saltelli", "--count", "4", *db], 2, "found one factor"),
            ([*vary, "a: E={8|9}", "--sample", "sobol", "--count", "4", *db], 2, "found no factor with a spread"),
            ([*vary, "a: E={8|9}", "--count", "4", *db], 2, "--count 4: found no --sample"),
            ([*vary, "a: E={8|9}", "--seed", "4", *db], 2, "--seed 4: found no --sample"),
            ([*vary, "a: E={uniform(-2,2)}", "--sample", "sobol", "--count", "9", *db], 2, "expected a number > 0"),
            ([*vary, "a: E={8|9}", "--keep", "field", *db], 2, "did you mean \"fields\"?"),
            ([*vary, "a: E={8|9}", "--again", "all", *db], 2, "expected failed"),
            ([*vary, "a: E={8|9}", "--shard", "5/4", *db], 2, "--shard 5/4: found \"5\""),
            ([*vary, "a: E={8|9}", "--shard", "2", *db], 2, "expected I/N"),
            ([*vary, "a: E={8|9}", "--states", "lst", *db], 2, "--states lst"),
            ([*vary, "a: E={8|9}", "--threads", "0", *db], 2, "--threads 0"),
            (["none.feb", *db], 3, "none.feb: found no readable file"),
            ([*db], 2, "found no model"),
            (["other.db"], 3, "other.db: found a database of another program"),
            (["old.db"], 3, "old.db: found a database of another program"),
            (["missing.db"], 3, "missing.db: found no readable file"),
            (["other.db", "--E", "8"], 2, "found --E beside a study that is read"),
            (["--merge", *db], 2, "--merge: found no file"),
            (["--merge", "other.db", *db], 3, "another program"),
    ]:
        expect(f.fault(*words, code=code), *parts)
        assert not (f.path / "plan.db").exists(), words


tests = [(name, test) for name, test in sorted(globals().items()) if name.startswith("test_")]
failed = 0
for name, test in tests:
    if sys.argv[3:] and not any(word in name for word in sys.argv[3:]):
        continue
    began = time.monotonic()
    try:
        test(Folder())
        print(f"passed  {name[5:]} ({time.monotonic() - began:.1f} s)", flush=True)
    except (AssertionError, subprocess.SubprocessError, sqlite3.Error, KeyError, IndexError, ValueError, OSError) as fault:
        failed += 1
        print(f"FAILED  {name[5:]}: {type(fault).__name__}: {fault}", flush=True)
(kit / "ball.feb").unlink()
kit.rmdir()
sys.exit(failed > 0)
