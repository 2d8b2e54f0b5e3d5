"""Studies from Python: the same file as `dea study`'s, going on, Ctrl-C, what is read back, what a user may do wrong; and the
same cases by workers of dask.distributed, one of them killed."""
import copy
import importlib.util
import os
import pickle
import signal
import sqlite3
import subprocess
import sys
import threading

import numpy as np
import pytest

import febiodea

LAW = {"law": "linear", "facets": "flat"}
LINE = ["--law", "linear", "--facets", "flat"]


@pytest.fixture
def ball(tmp_path, monkeypatch):
    """A folder with a ball in its socket, of which a case takes some milliseconds."""
    subprocess.run([os.environ["DEA_MAKE_SAMPLES"], "--spheres", "4", tmp_path / "ball.feb"], check=True)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def content(path):
    """All that a study's file has, but for seconds."""
    with sqlite3.connect(path) as d:
        tables = [t for t, in d.execute("SELECT name FROM sqlite_master WHERE type = 'table'")]
        columns = {t: [c[1] for c in d.execute(f"PRAGMA table_info({t})") if c[1] != "seconds"] for t in tables}
        return {t: sorted(d.execute(f"SELECT {', '.join(c)} FROM {t}"), key=repr) for t, c in columns.items()}


def cases_in(path):
    with sqlite3.connect(path) as d:
        return d.execute("SELECT count(*) FROM cases").fetchone()[0]


# ------------------------------------------------------------------------------------------------ the same file


def test_the_file_is_that_of_the_program(ball, dea):
    dea("study", "ball.feb", *LINE, "--E", "9", "--rotate", "ball=1,0,0,5", "--vary", "tilt: rotate ball=0,1,0,{-10:10:10}",
        "--vary", "nu: nu={0.4|0.45}", "--states", "last", "--keep", "fields", "-o", "program.db", cwd=ball)
    study = febiodea.Study("ball.feb", {"tilt": "rotate ball=0,1,0,{-10:10:10}", "nu": "nu={0.4|0.45}"}, states="last", **LAW,
                           E=9, rotate=[("ball", (1, 0, 0), 5)])
    assert len(study) == 6 and study.factors == ["tilt", "nu"]
    assert study.case(6) == {"model": "ball.feb", "tilt": "10", "nu": "0.45"}
    told = []
    results = study.run("python.db", keep="fields", workers=2, progress=told.append)
    assert content("program.db") == content("python.db")
    assert [(p.stage, p.state, p.states, p.outcome) for p in told] == [("case", k, 6, "solved") for k in range(1, 7)]
    assert results.counts == {"solved": 6, "failed": 0, "refused": 0}
    dea("study", "ball.feb", *LINE, "--E", "9", "--rotate", "ball=1,0,0,5", "--vary", "tilt: rotate ball=0,1,0,{-10:10:10}",
        "--vary", "nu: nu={0.4|0.45}", "--states", "last", "--keep", "fields", "-q", "-o", "python.db", cwd=ball)  # goes on


def test_options_act_in_their_order(ball, dea):
    vary, turn = ("a", "rotate ball=0,1,0,{30|60}"), (None, "rotate ball=1,0,0,40")
    peaks = []
    for name, pairs, order in [("one", [vary, turn], ["--vary", "a: " + vary[1], "--rotate", "ball=1,0,0,40"]),
                               ("two", [turn, vary], ["--rotate", "ball=1,0,0,40", "--vary", "a: " + vary[1]])]:
        results = febiodea.Study("ball.feb", pairs, states="last", **LAW, rotate_about={"ball": "com"}).run(name + ".db")
        dea("study", "ball.feb", *LINE, "--rotate-about", "ball=com", *order, "--states", "last", "-o", name + "_dea.db",
            cwd=ball)
        assert content(name + ".db") == content(name + "_dea.db")
        peaks.append([r["peak_pressure"] for r in results.table()])
    assert peaks[0] != peaks[1]


def test_cases_of_a_file_and_of_memory(ball):
    pandas = pytest.importorskip("pandas")
    rows = [{"E": 8, "nu": 0.4}, {"E": 12.5, "nu": 0.45}]
    (ball / "cases.csv").write_text("E,nu\n8,0.4\n12.5,0.45\n")
    factors = {"E": "E={}", "nu": "nu={}"}
    found = []
    for name, cases in [("file", "cases.csv"), ("rows", rows), ("frame", pandas.DataFrame(rows))]:
        results = febiodea.Study("ball.feb", factors, cases=cases, states="last", **LAW).run(name + ".db")
        found.append(results.to_pandas().drop(columns="seconds"))
    assert list(found[0].E) == [8, 12.5] and found[0].headline_p99.notna().all()
    for other in found[1:]:
        pandas.testing.assert_frame_equal(found[0], other)
    # another content is another study
    rows[1]["nu"] = 0.44
    with pytest.raises(febiodea.InputError, match="a table in memory has changed since; overwrite=True begins anew"):
        febiodea.Study("ball.feb", factors, cases=rows, states="last", **LAW).run("rows.db")
    assert febiodea.Study("ball.feb", factors, cases=rows, states="last", **LAW).run("rows.db", overwrite=True).counts["solved"] == 2


def test_samples_and_shards_are_those_of_the_program(ball, dea):
    vary = ["--vary", "E: E={uniform(8,16)}", "--vary", "nu: nu={normal(0.4,0.01)}"]
    for i in (1, 2):
        dea("study", "ball.feb", *LINE, *vary, "--sample", "saltelli", "--count", "3", "--seed", "7", "--states", "last",
            "--shard", f"{i}/2", "-o", "program.db", cwd=ball)
    study = febiodea.Study("ball.feb", {"E": "E={uniform(8,16)}", "nu": "nu={normal(0.4,0.01)}"}, sample=("saltelli", 3, 7),
                           states="last", **LAW)
    results = study.run("python.db", shard="2/2")
    assert results.path == "python.2-of-2.db" and results.shard == (2, 2) and results.planned == 12
    assert content("program.2-of-2.db") == content("python.2-of-2.db")
    assert results.factors[1] == ("nu", "nu", "{}", "normal", 0.4, 0.01)


# ------------------------------------------------------------------------------------------------ going on

LONG = """
import febiodea, sys
study = febiodea.Study("ball.feb", {"E": "E={1:4000:1}"}, states="last", law="linear", facets="flat")
def tell(p):
    if p.state == 40:
        print("forty", flush=True)
try:
    study.run("plan.db", progress=tell)
except KeyboardInterrupt:
    print(febiodea.read_study("plan.db").counts["solved"], flush=True)
    if sys.argv[1] == "again":
        def stop(p):
            raise ValueError("enough")
        try:
            study.run("plan.db", progress=stop)  # nobody holds the file
        except ValueError as enough:
            print(enough, flush=True)
    raise
"""


@pytest.mark.parametrize("how", ["end", "again"])
def test_ctrl_c_keeps_what_is_done(ball, how):
    process = subprocess.Popen([sys.executable, "-c", LONG, how], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                               env={**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)})
    assert process.stdout.readline() == "forty\n", process.stderr.read()
    process.send_signal(signal.SIGINT)
    out, err = process.communicate(timeout=120)
    assert process.returncode == -signal.SIGINT, (out, err)
    lines = out.split()
    assert 40 <= int(lines[0]) < 4000 and (how == "end" or lines[1] == "enough")
    assert int(lines[0]) <= cases_in("plan.db") < 4000
    assert not (ball / ".plan.db.lock").exists()


def test_goes_on_and_solves_failed_ones_again(ball):
    class Enough(Exception):
        pass

    def stop(progress):
        if progress.state >= 5:
            raise Enough
    study = febiodea.Study("ball.feb", {"E": "E={1:200:1}"}, states="last", **LAW)
    with pytest.raises(Enough):
        study.run("plan.db", workers=1, progress=stop)
    there = cases_in("plan.db")
    assert 5 <= there < 200
    told = []
    study.run("plan.db", progress=lambda p: told.append(p.state))
    assert told == list(range(there + 1, 201))
    study.run("whole.db")
    assert content("plan.db") == content("whole.db")

    (ball / "bad.feb").write_text("<febio_spec")
    both = febiodea.Study(["ball.feb", "bad.feb"], {"E": "E={8|9}"}, states="last", **LAW)
    results = both.run("both.db")
    assert results.counts == {"solved": 2, "failed": 0, "refused": 2}
    failed = results.failed()
    assert [(f["case_id"], f["model"], f["E"], f["case_outcome"]) for f in failed] == [(3, "bad.feb", 8, "refused"),
                                                                                      (4, "bad.feb", 9, "refused")]
    assert "bad.feb" in failed[0]["case_message"]
    again = []
    both.run("both.db", again="failed", progress=lambda p: again.append(p.outcome))
    assert again == ["refused", "refused"]


# ------------------------------------------------------------------------------------------------ reading


def test_what_is_read_is_what_was_solved(ball):
    results = febiodea.Study("ball.feb", {"E": "E={8|12}"}, **LAW).run("plan.db", keep=["fields"])
    result = febiodea.analyse(febiodea.recognise("ball.feb", E=12, **LAW))
    single, read = result.states[-1], results.state(2)
    assert (read.case, read.state, read.time, read.outcome) == (2, len(result.states), single.time, single.outcome)
    (name, contact), = read.contacts.items()
    mine = single.contact()
    assert name == mine.name and contact["headline_p99"] == mine.headline.p99 and contact["springs"] == mine.statistics["springs"]
    body = read.bodies["ball"]
    pose = single.poses["ball"]
    angle = np.linalg.norm(body["rotation"])
    assert angle == pytest.approx(np.arccos(np.clip((np.trace(pose[:3, :3]) - 1) / 2, -1, 1)), abs=1e-6)
    surface, pressure = results.surface(2), results.fields(2)
    assert pressure.dtype == np.float32 and len(pressure) == len(surface.vertices) == surface.triangles.max() + 1
    assert pressure.max() == pytest.approx(contact["nodal_peak_pressure"], rel=0.5) and pressure.max() > 0
    assert len(results.table()) == 2 * len(result.states)
    assert results.fields(1, 1).shape == pressure.shape
    with pytest.raises(febiodea.UsageError, match="expected a state of case 2, which is solved"):
        results.state(2, 99)
    for wrong, match in [(lambda: results.state(3), "case: found 3, expected a case that is in the file, of 1 to 2"),
                         (lambda: results.fields(1, None, "hip"), "contact: found 'hip', expected one of " + name),
                         (lambda: results.table("case"), "name: found 'case', expected one of results")]:
        with pytest.raises(febiodea.UsageError, match=match):
            wrong()


def test_compartments_are_read(tmp_path, monkeypatch):
    pytest.importorskip("pandas")
    monkeypatch.chdir(tmp_path)
    subprocess.run([os.environ["DEA_MAKE_SAMPLES"], "--plateaus", "6", "knee.feb"], check=True)
    results = febiodea.Study("knee.feb", {"E": "E={8|9}"}, states="last", law="linear").run("plan.db")
    parts = results.parts()
    assert len(parts) == 4 and (parts.force_z.abs() > 0).all()
    with pytest.raises(febiodea.UsageError, match='found no pressures at nodes, expected a study that was run with keep="fields"'):
        results.fields(1)


def test_reading_changes_nothing(ball):
    febiodea.Study("ball.feb", {"E": "E={8|9}"}, states="last", **LAW).run("plan.db")
    before = (ball / "plan.db").read_bytes()
    os.chmod(ball / "plan.db", 0o444)
    results = febiodea.read_study("plan.db")
    assert results.state(1).outcome
    results.table(), results.counts, results.failed(), repr(results)
    assert (ball / "plan.db").read_bytes() == before
    assert sorted(p.name for p in ball.iterdir()) == ["ball.feb", "plan.db"]


@pytest.mark.parametrize("make, match", [
    (lambda: febiodea.Study("ball.feb", {"a": "E={8|nine}"}), r'vary="a: E=\{8\|nine\}": value nine: found "nine"'),
    (lambda: febiodea.Study("ball.feb", {"a": "rotat ball=0,1,0,{1|2}"}), 'did you mean "rotate"'),
    (lambda: febiodea.Study("ball.feb", [("a", "E={1|2}"), (None, "lw linear")]), r'found "lw" \(did you mean "law"'),
    (lambda: febiodea.Study("ball.feb", ["E={1|2}"]), r"vary: found 'E=\{1\|2\}', expected"),
    (lambda: febiodea.Study("ball.feb", {"a": "E={}"}, cases=[{"a": 1}, {"b": 2}]), r"cases\[1\]: found the columns b"),
    (lambda: febiodea.Study("ball.feb", {"a": "E={}"}, cases=3), "cases: found a int, expected a file"),
    (lambda: febiodea.Study("ball.feb", {"a": "E={uniform(1,2)}"}, sample=("sobl", 4)), 'did you mean "sobol"'),
    (lambda: febiodea.Study("ball.feb", {"a": "E={uniform(1,2)}"}, sample="sobol"), "sample: found 'sobol', expected"),
    (lambda: febiodea.Study("ball.feb", {"a": "E={1|2}"}, nonsense=3), "nonsense"),
    (lambda: febiodea.Study("ball.feb", {"a": "E={1|2}"}, loads={"time": [0.0]}), "loads"),
    (lambda: febiodea.Study("ball.feb", {"a": "E={1|2}"}, states="lst"), "states=\"lst\""),
    (lambda: febiodea.Study("ball.feb", {"a": "E={1|2}"}).run("a.db", again="all"), "again: found 'all'"),
    (lambda: febiodea.Study("ball.feb", {"a": "E={1|2}"}).run("a.db", keep="field"), 'did you mean "fields"'),
    (lambda: febiodea.Study("ball.feb", {"a": "E={1|2}"}).run("a.feb"), "path a.feb: found the ending of another kind of file"),
    (lambda: febiodea.Study("ball.feb", {"a": "E={1|2}"}).run("a.db", shard="3/2"), 'shard="3/2": found "3"'),
    (lambda: febiodea.Study("ball.feb", {"a": "E={1|2}"}).run("a.db", workers=0), "workers: found 0, expected a number"),
    (lambda: febiodea.Study("ball.feb", {"a": "E={1|2}"}).run("a.db", client="tcp://here"), "client: found a value of type str, expected"),
    (lambda: febiodea.Study("ball.feb", {"a": "E={1|2}"}).run("a.db", shard=(1, 2)), "shard: found a value of type tuple"),
    (lambda: febiodea.Study("ball.feb", {"a": "E={1|2}"}).run("a.db", keep=[3]), "keep: found a value of type int"),
    (lambda: febiodea.Study("ball.feb", {"a": "E={1|2}"}).run("a.db", progress="x"), "progress: found a value of type str"),
    (lambda: febiodea.Study("ball.feb", {"a": "E={1|2}"}).run(None), "path: found a value of type NoneType"),
    (lambda: febiodea.Study("ball.feb", {"a": "E={1|2}"}).case(1.5), "number: found 1.5, expected a case from 1 to 2"),
    (lambda: febiodea.Study(None, {"a": "E={1|2}"}), "models: found a value of type NoneType"),
    (lambda: febiodea.Study("ball.feb", {"a": "E={}"}, cases=[]), "cases: found no row"),
    (lambda: febiodea.Study("ball.feb", {"a": "E={}"}, cases=[{"a": None}]), "cases: found a value of type NoneType"),
    (lambda: febiodea.read_study(None), "path: found a value of type NoneType"),
])
def test_what_a_user_may_do_wrong(ball, make, match):
    with pytest.raises(febiodea.UsageError, match=match) as fault:
        make()
    assert "\n" not in str(fault.value) and not list(ball.glob("*.db"))


@pytest.mark.parametrize("value, found", [(float("nan"), "nan"), (True, "true"), ("eight", "eight")])
def test_values_of_a_table_in_memory_that_are_none(ball, value, found):
    for row in (1, 2):  # also the first, of which options of all cases are asked
        cases = [{"a": 8.0}, {"a": 9.0}]
        cases[row - 1]["a"] = value
        with pytest.raises(febiodea.InputError, match=f'cases:{row}: column "a": found "{found}", expected a'):
            febiodea.Study("ball.feb", {"a": "E={}"}, cases=cases)


def test_names_in_other_letters(ball):
    folder = os.fsencode(ball) + "/Hüfte ?#%20".encode()
    os.mkdir(folder)
    for name in ("bäll.feb".encode(), b"b\xff.feb"):
        with open(folder + b"/" + name, "wb") as file:
            file.write((ball / "ball.feb").read_bytes())
        results = febiodea.Study(os.fsdecode(folder + b"/" + name), {"E": "E={8|9}"}, states="last", **LAW).run(
            folder + b"/" + name + b".db", shard="2/2")
        assert os.fsencode(results.path) == folder + b"/" + name.replace(b".feb", b".feb.2-of-2") + b".db"
        assert [row["E"] for row in results.table()] == [9] and results.state(2).case == 2
        assert febiodea.read_study(os.fsencode(results.path)).counts["solved"] == 1


def test_a_study_without_cases_yet_is_a_table_without_rows(ball):
    pytest.importorskip("pandas")
    results = febiodea.Study("ball.feb", {"E": "E={8|9}"}, states="last", **LAW).run("plan.db")
    columns = list(results.to_pandas().columns)
    with sqlite3.connect("plan.db") as d:
        for table in ("poses", "parts", "statistics", "states", "warnings", "cases"):
            d.execute(f"DELETE FROM {table}")
    d.close()
    empty = results.to_pandas()
    assert len(empty) == 0 and list(empty.columns) == columns and "headline_p99" in columns and "E" in columns
    assert results.table() == [] and results.failed() == [] and sum(results.counts.values()) == 0
    for wrong, match in [(lambda: results.state(1), "case: found 1, expected a case that is in the file"),
                         (lambda: results.state(1.0), "case: found 1.0, expected a case"),
                         (lambda: results.state("one"), "case: found 'one', expected a case")]:
        with pytest.raises(febiodea.UsageError, match=match):
            wrong()


def test_a_study_is_pickled_as_what_was_asked_for(ball):
    study = febiodea.Study("ball.feb", {"a": "E={}"}, cases=[{"a": 8.0}, {"a": 9.5}], states="last", **LAW)
    again = pickle.loads(pickle.dumps(study))
    assert len(again) == 2 and again.case(2) == study.case(2) == {"model": "ball.feb", "a": "9.5"}
    study.run("one.db")
    results = pickle.loads(pickle.dumps(again.run("two.db")))
    assert content("one.db") == content("two.db") and results.counts["solved"] == 2
    assert copy.copy(study).run("one.db").counts["solved"] == 2  # of the same study: it is gone on with


def test_two_threads_and_one_file(ball):
    study, ended = febiodea.Study("ball.feb", {"E": "E={1:1000:1}"}, states="last", **LAW), []
    begun = threading.Event()

    def solve():
        try:
            ended.append(study.run("plan.db", workers=1, progress=lambda p: begun.set()).counts["solved"])
        except febiodea.WriteError as refused:
            ended.append(str(refused))
    first = threading.Thread(target=solve)
    first.start()
    assert begun.wait(60)
    solve()
    first.join()
    assert "another run" in ended[0] and "is at work on it" in ended[0] and ended[1] == 1000


def test_files_that_are_no_study(ball):
    for name, text in [("missing.db", None), ("text.db", "nothing of the kind " * 500)]:
        if text is not None:
            (ball / name).write_text(text)
        with pytest.raises(febiodea.InputError, match=name):
            febiodea.read_study(name)
    with pytest.raises(febiodea.InputError, match="none.feb: found no readable file"):
        febiodea.Study("none.feb", {"a": "E={1|2}"})


# ------------------------------------------------------------------------------------------------ dask.distributed


@pytest.fixture(scope="module")
def client():
    """Three worker processes of one thread each."""
    if importlib.util.find_spec("distributed") is None:
        pytest.skip("no dask.distributed (python3-distributed)")
    import dask
    import distributed
    path = os.pathsep.join(sys.path)
    before, os.environ["PYTHONPATH"] = os.environ.get("PYTHONPATH"), path
    with dask.config.set({"distributed.worker.daemon": True, "distributed.comm.timeouts.connect": "60s"}):
        with distributed.LocalCluster(n_workers=3, threads_per_worker=1, dashboard_address=None) as cluster:
            with distributed.Client(cluster) as made:
                yield made
    if before is None:
        del os.environ["PYTHONPATH"]
    else:
        os.environ["PYTHONPATH"] = before


def test_workers_of_dask_one_of_them_killed(ball, client):
    study = febiodea.Study(str(ball / "ball.feb"), {"E": "E={5:14:1}", "tilt": "rotate ball=0,1,0,{1:60:1}"}, states="last",
                           **LAW)
    study.run("here.db", keep="fields")
    killed, workers = [], client.run(os.getpid)
    assert len(set(workers.values()) - {os.getpid()}) == 3

    def kill(progress):
        if progress.state >= len(study) // 4 and not killed:
            killed.append(list(workers.values())[0])
            os.kill(killed[0], signal.SIGKILL)
    results = study.run("dask.db", client=client, keep="fields", progress=kill)
    assert killed and results.counts == {"solved": 600, "failed": 0, "refused": 0}
    assert content("dask.db") == content("here.db")
    assert list(client.run(os.getpid).values()) != list(workers.values())


def test_what_is_done_by_dask_is_kept(ball, client):
    study = febiodea.Study(str(ball / "ball.feb"), {"tilt": "rotate ball=0,1,0,{1:300:1}"}, states="last", **LAW)

    def stop(progress):
        if progress.state == 30:
            raise KeyboardInterrupt
    with pytest.raises(KeyboardInterrupt):
        study.run("dask.db", client=client, progress=stop)
    there = cases_in("dask.db")
    assert 30 <= there < 300
    told = []
    study.run("dask.db", client=client, progress=lambda p: told.append(p.state))
    assert told == list(range(there + 1, 301))
    study.run("here.db")
    assert content("dask.db") == content("here.db")


def test_cases_that_fail_by_dask_are_rows_and_again(ball, client):
    (ball / "bad.feb").write_text("<febio_spec")
    study = febiodea.Study([str(ball / "ball.feb"), str(ball / "bad.feb")], {"E": "E={8:12:1}"}, states="last", **LAW)
    told = []
    results = study.run("dask.db", client=client, progress=lambda p: told.append((p.state, p.states)))
    study.run("here.db")
    assert results.counts == {"solved": 5, "failed": 0, "refused": 5} and content("dask.db") == content("here.db")
    assert told == [(k, 10) for k in range(1, 11)]
    again = []
    study.run("dask.db", client=client, again="failed", progress=lambda p: again.append(p.outcome))
    assert again == ["refused"] * 5 and content("dask.db") == content("here.db")


def test_a_cluster_that_drops_the_work(ball, client, monkeypatch):
    study = febiodea.Study(str(ball / "ball.feb"), {"tilt": "rotate ball=0,1,0,{1:400:1}"}, states="last", **LAW)

    given, submit = [], client.submit

    def drop(progress):
        if progress.state == 20:
            client.cancel(given)
    with monkeypatch.context() as spied, pytest.raises(
            febiodea.Error, match="the cluster has dropped them, .*; what is done is in the file, and the same call goes on"):
        spied.setattr(client, "submit", lambda *words, **more: given.append(submit(*words, **more)) or given[-1])
        study.run("dask.db", client=client, progress=drop)
    assert 20 <= cases_in("dask.db") < 400
    assert study.run("dask.db", client=client).counts["solved"] == 400
    study.run("here.db")
    assert content("dask.db") == content("here.db")


def test_memory_of_workers_is_shared_by_all_studies_that_they_keep(client):
    from febiodea import _study_dask
    limits = client.run(lambda dask_worker: dask_worker.memory_manager.memory_limit)
    shares = {worker: client.submit(_study_dask._memory, workers=[worker], pure=False).result() for worker in limits}
    assert shares
    for worker, share in shares.items():
        assert 0 < share * _study_dask._MOST_STUDIES <= 0.5 * limits[worker]


def test_a_model_that_is_another_on_the_workers(ball, client):
    study = febiodea.Study(str(ball / "ball.feb"), {"E": "E={8:12:1}"}, states="last", **LAW)
    text = (ball / "ball.feb").read_text()
    (ball / "ball.feb").write_text(text + "\n")
    with pytest.raises(febiodea.InputError, match=r"worker tcp://.*ball.feb: found another content than where the study was begun") as fault:
        study.run("dask.db", client=client)
    assert "\n" not in str(fault.value)
    with pytest.raises(febiodea.UsageError, match="keep: found \"xplt\" beside a client"):
        study.run("dask.db", client=client, keep="xplt")
    (ball / "ball.feb").write_text(text)
    assert study.run("dask.db", client=client).counts["solved"] == 5
