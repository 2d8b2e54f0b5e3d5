"""Stress and strain inside the cartilage, from Python."""
import numpy as np
import pytest

import febiodea


def tensors(rows):
    """(n, 6) xx yy zz xy yz xz as (n, 3, 3)."""
    return rows[:, [[0, 3, 5], [3, 1, 4], [5, 4, 2]]]


@pytest.fixture(scope="module")
def ball(samples):
    recognition = febiodea.recognise(samples / "spheres/two_layers.feb", inside=True)
    return febiodea.analyse(recognition, "last")


def test_elements_and_facets(ball):
    state = ball.states[-1]
    assert len(state.inside) == 2
    shear = []
    for part in state.inside:
        assert part["stress"].shape == part["strain"].shape == (len(part["element"]), 6)
        principal = np.linalg.eigvalsh(tensors(part["stress"]))
        shear.append((principal[:, 2] - principal[:, 0]).max() / 2)
    contact = state.contact()
    for side in (contact.source, contact.target):
        facets = side.facets
        for end in ("bone", "surface"):
            measured = [getattr(facets, f"{end}_{m}") for m in
                        ("max_shear_stress", "first_principal_strain", "third_principal_strain")]
            assert all(len(v) == len(facets) for v in measured)
            assert (measured[1] >= measured[2]).all()
    # an element is the layer's between both ends: no greater shear than twice what is found there
    most = max(side.facets.bone_max_shear_stress.max() for side in (contact.source, contact.target))
    assert 0.3 * most < max(shear) < 2 * most


def test_numbers(ball):
    contact = ball.states[-1].contact()
    inside = contact.statistics["inside"]
    for side in ("source", "target"):
        for end in ("bone", "surface"):
            of = inside[side][end]
            assert of["max_shear_stress"]["peak"] >= of["max_shear_stress"]["p99"] >= of["max_shear_stress"]["mean"] > 0
            assert of["third_principal_strain"]["peak"] <= of["third_principal_strain"]["mean"] < 0
    row = ball.table()[-1]
    assert row["inside_source_bone_max_shear_stress_p99"] == inside["source"]["bone"]["max_shear_stress"]["p99"]


def test_prepared_is_the_same(ball):
    solved = febiodea.prepare(ball.recognition).solve()
    ours, theirs = solved.inside, ball.states[-1].inside
    most = np.abs(theirs[0]["stress"]).max()
    assert most > 0
    for a, b in zip(ours, theirs):
        np.testing.assert_array_equal(a["element"], b["element"])
        np.testing.assert_allclose(a["stress"], b["stress"], atol=1e-4 * most)


def test_plot_file(ball, tmp_path):
    ball.write_xplt(tmp_path / "a.xplt")
    state = febiodea.read_xplt(tmp_path / "a.xplt").states[-1]
    contact = ball.states[-1].contact()
    written = state.surface(contact.source.surface).facet("max shear stress at the bone")
    np.testing.assert_allclose(written, contact.source.facets.bone_max_shear_stress, rtol=1e-6)


def test_without(hip_result):
    state = hip_result.states[-1]
    assert state.inside == []
    assert state.contact().source.facets.bone_max_shear_stress is None
    assert state.contact().statistics["inside"] is None
    assert not any(key.startswith("inside") for key in hip_result.table()[-1])


def test_other_laws_are_refused(samples):
    with pytest.raises(febiodea.UsageError, match="found law linear"):
        febiodea.recognise(samples / "spheres/one_layer.feb", law="linear", inside=True)
