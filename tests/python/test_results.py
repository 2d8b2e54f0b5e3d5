"""Results as arrays: what adds up on paper, and whose memory it is."""
import gc
import importlib.util
import math

import numpy as np
import pytest

import febiodea


def test_springs_add_up_to_the_force(hip_result):
    contact = hip_result.states[-1].contact("hip_contact")
    s = contact.springs
    force = (s.pressure * s.area) @ s.direction
    # sums in another order: some 2000 terms, rounding each
    np.testing.assert_allclose(force, contact.force, rtol=1e-12)
    assert contact.statistics["peak_pressure"] == s.pressure.max()
    assert contact.statistics["springs_active"] == np.count_nonzero(s.pressure > 0)
    assert np.linalg.norm(s.direction, axis=1) == pytest.approx(1, abs=1e-14)


def test_the_load_is_what_the_model_says(hip_result):
    state = hip_result.states[-1]
    force, _ = state.reactions["femur"]
    np.testing.assert_allclose(force, [432, -262, 1834], rtol=1e-8)
    np.testing.assert_allclose(state.contact().target.force + state.contact().source.force, 0, atol=1e-9)
    assert state.contact().target.body == "femur" and state.contact().source.body == "pelvis"


def test_poses_leave_the_held_body_where_the_file_has_it(hip_result):
    poses = hip_result.states[-1].poses
    np.testing.assert_array_equal(poses["pelvis"], np.eye(4))
    moved = hip_result.to_dict()["states"][-1]["bodies"]["femur"]["translation"]
    np.testing.assert_allclose(poses["femur"][:3, 3], moved, atol=1e-12)  # its centre of mass is the origin


def test_facets_and_nodes(hip_result):
    state = hip_result.states[-1]
    contact, model = state.contact(), hip_result.recognition.model
    for side in (contact.source, contact.target):
        facets, nodes = side.facets, side.nodes
        assert len(facets) == len(facets.pressure) == len(facets.center) == len(facets.nodes) == len(facets.strain)
        assert len(nodes) == len(nodes.pressure) == len(nodes.strain) == len(nodes.thickness)
        np.testing.assert_array_equal(nodes.point, model.points[nodes.index])
        assert facets.area.sum() == pytest.approx(nodes.area.sum(), rel=1e-12)
        # nodes of a flat-cut quadrilateral: the mean of its corners is near its centroid
        corners = model.points[facets.nodes].mean(axis=1)
        assert np.abs(corners - facets.center).max() < math.sqrt(facets.area.max())
        assert nodes.triangles.max() == len(nodes) - 1
    # whole facets carry the whole force: sum p A of facets against the springs', up to the facets' turning and to what bulges
    # out over the rim, which no facet has (docs/layer_law.md, L11)
    normal = contact.springs.pressure @ contact.springs.area
    assert contact.facets.pressure @ contact.facets.area == pytest.approx(normal, rel=6e-3)
    assert contact.statistics["facet_peak_pressure"] == contact.facets.pressure.max()
    assert state.displacements.shape == model.points.shape
    headline = contact.headline
    assert list(headline._asdict()) == ["p99", "mean", "area", "peak", "above"]
    assert contact.statistics["headline"]["p99"] == headline.p99 <= headline.peak


def test_compartments(models):
    result = febiodea.analyse(febiodea.recognise(models("plateaus/plateaus.feb")), "last")
    contact = result.states[-1].contact()
    assert len(contact.compartments) == 2
    np.testing.assert_allclose(sum(c.force for c in contact.compartments), contact.force, rtol=1e-12)
    assert [c.name for c in contact.compartments] == [c["name"] for c in contact.statistics["compartments"]]


def test_arrays_are_looks_that_outlive_their_result(hip):
    result = febiodea.analyse(hip, "last")
    springs = result.states[-1].contact().springs
    pressure, again = springs.pressure, springs.pressure
    assert not pressure.flags.owndata and not pressure.flags.writeable
    assert pressure.__array_interface__["data"][0] == again.__array_interface__["data"][0]
    with pytest.raises(ValueError):
        pressure[0] = 1
    kept = pressure.copy()
    del result, springs, again
    gc.collect()
    np.testing.assert_array_equal(pressure, kept)


def test_names_that_are_not_there(hip_result):
    with pytest.raises(febiodea.UsageError, match='did you mean "hip_contact"') as caught:
        hip_result.states[-1].contact("hip_contakt")
    assert caught.value.place == "contact"


def test_table_and_pandas(hip_result):
    row = hip_result.table()[-1]
    assert row["contact"] == "hip_contact" and row["headline_p99"] == hip_result.states[-1].contact().headline.p99
    assert row["force_x"] == hip_result.states[-1].contact().force[0]
    assert [name for name in row if not name.startswith("headline_")][:4] == ["time", "step", "outcome", "contact"]
    assert all(name.startswith("headline_") for name in list(row)[4:9]), list(row)[:10]
    if importlib.util.find_spec("pandas") is None:
        with pytest.raises(ImportError, match="needs pandas"):
            hip_result.to_pandas()
    else:
        assert hip_result.to_pandas().iloc[-1]["headline_p99"] == row["headline_p99"]
    assert f"{row['headline_p99']:.4g}" in hip_result._repr_html_()
