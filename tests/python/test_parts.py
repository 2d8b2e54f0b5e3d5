"""Parts that give way, from Python: two menisci."""
import os
import subprocess

import numpy as np
import pytest

import febiodea


@pytest.fixture(scope="module")
def menisci(tmp_path_factory):
    path = tmp_path_factory.mktemp("menisci") / "menisci.feb"
    subprocess.run([os.environ["DEA_MAKE_SAMPLES"], "--menisci", "8", path], check=True)
    return febiodea.recognise(path, inside=True)


@pytest.fixture(scope="module")
def result(menisci):
    result = febiodea.analyse(menisci, "last")
    assert result.solved, result
    return result


def test_arrays_and_numbers(menisci, result):
    state = result.states[-1]
    assert [part.name for part in state.parts] == ["medial_meniscus", "lateral_meniscus"]
    points = menisci.model.points
    for part in state.parts:
        assert part.displacements.shape == points[part.index].shape
        np.testing.assert_array_equal(part.displacements, state.displacements[part.index])
        assert part.stress.shape == part.strain.shape == (len(part.element), 6)
        assert len(set(part.element)) == len(part.element)
        numbers = part.statistics
        assert numbers["name"] == part.name
        assert np.linalg.norm(part.displacements, axis=1).max() == pytest.approx(numbers["largest_displacement"], rel=1e-12)
        tensors = part.stress[:, [[0, 3, 5], [3, 1, 4], [5, 4, 2]]]
        assert np.linalg.eigvalsh(tensors).max() == pytest.approx(numbers["first_principal_stress_peak"], rel=1e-9)
        assert 0 < numbers["fibre_stress_p99"] <= numbers["fibre_stress_peak"]
        # what is pressed from its inner edge is pushed outwards
        across = points[part.index, 0] - (-20 if part.name.startswith("medial") else 20)
        outwards = np.column_stack([across, points[part.index, 1]])
        assert (part.displacements[:, :2] * outwards).sum() > 0
    assert state.part("lateral_meniscus").name == "lateral_meniscus"
    with pytest.raises(febiodea.UsageError, match="medial_meniscus"):
        state.part()


def test_press_is_what_was_solved(menisci, result):
    """Springs on the menisci pull in a press, too: without them each would stand elsewhere."""
    state = result.states[-1]
    pressed = febiodea.prepare(menisci).press(state)
    for contact in state.contacts:
        np.testing.assert_allclose(pressed.contact(contact.name).force, contact.force, atol=1e-3)


def test_inside_has_the_stress_of_parts(result):
    state = result.states[-1]
    shown = {part["part"]: part for part in state.inside}
    for part in state.parts:
        np.testing.assert_array_equal(shown[part.name]["element"], part.element)
        np.testing.assert_array_equal(shown[part.name]["stress"], part.stress)
    assert np.abs(shown["medial_plateau_cartilage"]["stress"]).max() > 0.1
    assert not {"inside-unused", "inside-unknown"} & {finding.code for finding in result.findings}


def test_one_modulus_for_a_part(menisci):
    with pytest.raises(febiodea.UsageError, match='another surface of part "medial_meniscus" has 50'):
        febiodea.recognise(menisci.model, E={"medial_meniscus_bottom": 50, "medial_meniscus_top": 60})
