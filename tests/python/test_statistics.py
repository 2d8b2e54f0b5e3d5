"""Statistics of many cases and the page of a study from Python: on paper and against numpy."""
import os
import subprocess

import numpy as np
import pytest

import febiodea
from febiodea import statistics


@pytest.fixture
def ball(tmp_path, monkeypatch):
    subprocess.run([os.environ["DEA_MAKE_SAMPLES"], "--spheres", "4", tmp_path / "ball.feb"], check=True)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_box_plot_is_numpys():
    rng = np.random.default_rng(1)
    values = rng.normal(size=101)
    box = statistics.box_plot([*values, np.nan])
    assert box["count"] == 101 and box["left_out"] == 1
    assert np.allclose([box["q1"], box["median"], box["q3"]], np.percentile(values, [25, 50, 75]), rtol=1e-8)
    assert np.allclose([box["mean"], box["sd"]], [values.mean(), values.std(ddof=1)], rtol=1e-8)
    assert statistics.box_plot([])["median"] is None


def test_influence_is_least_squares():
    rng = np.random.default_rng(2)
    a, b = rng.uniform(size=(2, 60))
    y = 3 * a - b + 0.1 * rng.normal(size=60)
    found = statistics.influence({"a": a, "b": b}, y)
    standard = [(x - x.mean()) / x.std(ddof=1) for x in (a, b, y)]
    expected = np.linalg.lstsq(np.column_stack(standard[:2]), standard[2], rcond=None)[0]
    assert np.allclose([found["regression"]["a"], found["regression"]["b"]], expected, rtol=1e-8)
    ranks = [np.argsort(np.argsort(x)) for x in (a, y)]
    assert found["spearman"]["a"] == pytest.approx(np.corrcoef(*ranks)[0, 1], rel=1e-8)
    with pytest.raises(febiodea.UsageError):
        statistics.influence({"a": a[:-1]}, y)


def test_pairs_and_differences_on_paper():
    found = statistics.pairs([1, 2, 3, np.nan], [3, 5, 7, 1])  # differences -2, -3, -4
    assert (found["pairs"], found["left_out"], found["mean"], found["sd"]) == (3, 1, -3, 1)
    assert np.allclose(found["limits"], [-3 - 1.959963985, -3 + 1.959963985], atol=1e-8)
    groups = statistics.difference([5, 7], [1, 3])
    assert groups["mean"] == 4 and np.allclose(groups["interval"], 4 + 4.30265273 * np.sqrt(2) * np.array([-1, 1]), atol=1e-7)


def test_sobol_of_a_sum():
    """x + 2 y of independent uniform factors: 1/5 and 4/5 of the variance, first and total."""
    rng = np.random.default_rng(3)
    A, B = rng.uniform(size=(2, 4000, 2))
    f = lambda x: x[:, 0] + 2 * x[:, 1]  # noqa: E731
    mixed = [np.column_stack([B[:, 0], A[:, 1]]), np.column_stack([A[:, 0], B[:, 1]])]
    found = statistics.sobol_indices(np.concatenate([f(x) for x in (A, B, *mixed)]), 2, resamples=200)
    for index, share in zip(found, (0.2, 0.8)):
        assert index["first"] == pytest.approx(share, abs=0.04) and index["total"] == pytest.approx(share, abs=0.04)
        assert index["first_interval"][0] < index["first"] < index["first_interval"][1]


def test_dose_on_paper():
    times, pressures = [0, 1, 3], [[0, 5], [4, 5], [4, 5]]
    exposure, over = statistics.dose(times, pressures, 2)
    assert np.allclose(exposure, [10, 15]) and np.allclose(over, [0.5 * 0.5 * 2 + 4, 9])
    years = statistics.dose(times, pressures, 2, cycle_seconds=1.5, cycles_per_year=2e6, years=20)
    assert np.allclose(years[1], over * 0.5 * 2e6 * 20 / 31557600)
    assert statistics.share_above(over, [1, 3], 5) == 0.75
    with pytest.raises(febiodea.UsageError, match="cycles_per_year"):
        statistics.dose(times, pressures, 2, years=20)


def test_maps_and_regions():
    fields, areas = np.array([[1, 2.0], [3, 6]]), [1, 3]
    mean = statistics.mean_map(fields, areas)
    assert np.allclose(mean["mean"], [2, 4]) and np.allclose(mean["standard_deviation"], fields.std(axis=0, ddof=1))
    assert mean["area_mean"] == pytest.approx(3.5)
    difference = statistics.map_difference(fields, [[0, 1.0]], areas)
    assert np.allclose(difference["difference"], [2, 3]) and difference["area_mean"] == pytest.approx(2.75)
    index, names = statistics.sectors([[1, 0.1, 0], [-1, 0.1, 5], [0, 0, 1], [0.1, -1, 0]], (0, 0, 0), (0, 0, 1), (1, 0, 0), 2)
    assert list(index) == [0, 0, -1, 1] and names == ["0 to 180 degrees", "180 to 360 degrees"]
    square = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]
    assert np.allclose(statistics.vertex_areas(square, [[0, 1, 2], [0, 2, 3]]), [1 / 3, 1 / 6, 1 / 3, 1 / 6])
    with pytest.raises(febiodea.UsageError, match="vertex 4"):
        statistics.vertex_areas(square, [[0, 1, 4]])


def test_a_study_and_its_page(ball):
    study = febiodea.Study("ball.feb", {"E": "E={8:12:2}", "nu": "nu={0.4|0.45}"}, law="linear", facets="flat")
    results = study.run("plan.db", keep="fields")
    cases, peak = results.outputs("peak")
    rows = results.table()
    largest = [np.nanmax([np.nan if r["headline_peak"] is None else r["headline_peak"] for r in rows if r["case_id"] == c]) for c in cases]
    assert list(cases) == [1, 2, 3, 4, 5, 6] and np.allclose(peak, largest)
    found = results.influence("peak", state=1)
    direct = statistics.influence({"E": [8, 8, 10, 10, 12, 12], "nu": [0.4, 0.45] * 3}, results.outputs("peak", state=1)[1])
    assert {f["factor"]: f["coefficient"] for f in found["factors"]} == pytest.approx(direct["regression"])
    assert found["sobol"] is None and {s["factor"] for s in found["slopes"]} == {"E", "nu"}
    assert results.groups("nu")["levels"] == ["0.4", "0.45"]
    assert results.pairs("nu")["mean"] == pytest.approx(np.mean(results.outputs()[1][::2] - results.outputs()[1][1::2]))
    assert results.report("plan.html", group="nu", pair="nu", dose_above=0.1) == []
    page = (ball / "plan.html").read_text()
    assert page.startswith("<!doctype html>") and '"kind":"study"' in page
    for call, match in [(lambda: results.outputs("p98"), "p98"), (lambda: results.outputs(state=0), "largest"),
                        (lambda: results.outputs(place="knee"), "knee"), (lambda: results.groups("mu"), "mu"),
                        (lambda: results.report("plan.pdf"), "html"), (lambda: results.report("x.html", group="mu"), "mu"),
                        (lambda: results.report("x.html", regions="socket"), "anterior"),
                        (lambda: results.report("x.html", years=2), "cycles_per_year")]:
        with pytest.raises(febiodea.UsageError, match=match):
            call()
    assert not (ball / "x.html").exists()


SUBJECTS = [{"model": f"{stage}/S{k}", "subject": f"S{k}", "sex": "FM"[k % 2], "stage": stage} for stage in ("before", "after")
            for k in (1, 2, 3)]


def test_subjects_from_memory_and_from_a_file(ball, dea):
    """Three balls, the same files in two folders: what a table tells of them are groups and pairs."""
    text = (ball / "ball.feb").read_text()
    for row in SUBJECTS:
        (ball / row["stage"]).mkdir(exist_ok=True)
        (ball / (row["model"] + ".feb")).write_text(text)
    results = febiodea.Study([row["model"] + ".feb" for row in SUBJECTS], {"E": "E={8|12}"}, law="linear", facets="flat",
                             states="last").run("plan.db")
    (ball / "subjects.csv").write_text("\n".join(",".join(r) for r in [SUBJECTS[0], *map(dict.values, SUBJECTS)]) + "\n")
    for subjects in (SUBJECTS, "subjects.csv"):
        told = febiodea.read_study("plan.db", subjects=subjects)
        groups = told.groups("sex", "mean", state=1)
        assert groups["levels"] == ["M", "F"] and [b["count"] for b in groups["boxes"]] == [8, 4]
        found = told.pairs("stage", "mean", state=1)
        assert found["pairs"] == 6 and found["mean"] == 0 and found["levels"] == ["before", "after"]
        assert told.pairs("stage=after,before", "mean", state=1, by="subject")["pairs"] == 6
        assert told.report("plan.html", group="sex", pair="stage", pair_by="subject") == []
    with pytest.raises(febiodea.UsageError, match='found no column "sex"'):
        results.groups("sex")
    with pytest.raises(febiodea.InputError, match='subjects: found no row of model "after/S3.feb"'):
        febiodea.read_study("plan.db", subjects=SUBJECTS[:-1]).groups("sex")
    with pytest.raises(febiodea.UsageError, match="pair_by"):
        results.report("x.html", pair="stage", pair_by="subject")
    with pytest.raises(febiodea.UsageError, match="subjects: found a int"):
        febiodea.read_study("plan.db", subjects=3)
    line = ["study", "plan.db", "--report", "line.html", "--subjects", "subjects.csv", "--group", "sex", "--pair", "stage"]
    dea(*line, cwd=ball)
    assert '"subjects":"subjects.csv"' in (ball / "line.html").read_text()


def test_numbers_of_the_inside(ball):
    """Those of the file, for the sides that have a layer; the largest compression is the least number."""
    results = febiodea.Study("ball.feb", {"E": "E={8|12}"}, inside=True).run("inside.db")
    rows = results.table()
    name = "target_bone_third_principal_strain_p99"
    if all(r[name] is None for r in rows):
        name = name.replace("target", "source")
    per_case = [[r[name] for r in rows if r["case_id"] == c and r[name] is not None] for c in (1, 2)]
    assert all(per_case) and max(map(max, per_case)) < 0
    assert list(results.outputs(name)[1]) == pytest.approx([min(x) for x in per_case], rel=1e-12)
    shear = name.replace("third_principal_strain", "max_shear_stress")
    assert list(results.outputs(shear, state=1)[1]) == pytest.approx([r[shear] for r in rows if r["state"] == 1], rel=1e-12)
    assert results.influence(shear)["factors"][0]["factor"] == "E"
