"""Plot files of whatever program."""
import importlib.util
import json

import numpy as np
import pytest

import febiodea


@pytest.fixture(scope="module")
def file(hip_result, tmp_path_factory):
    path = tmp_path_factory.mktemp("plot") / "hip.xplt"
    hip_result.write_xplt(path)
    return febiodea.read_xplt(path)


def test_a_result_comes_back_from_its_file(file, hip_result):
    state, contact = file.states[-1], hip_result.states[-1].contact()
    surface = state.surface(contact.source.surface)
    single = dict(rtol=1e-6, atol=1e-6)  # the file's numbers
    np.testing.assert_allclose(surface.facet("contact pressure"), contact.facets.pressure, **single)
    np.testing.assert_allclose(state.nodal("displacement"), hip_result.states[-1].displacements, **single)
    np.testing.assert_allclose(state.points, hip_result.recognition.model.points, rtol=1e-6, atol=1e-4)
    np.testing.assert_array_equal(state.cells, hip_result.recognition.model.cells)
    assert surface.headline() == contact.headline  # the same numbers to the last digit
    assert surface.nodal("contact pressure").max() == contact.headline.peak
    assert surface.nodal_areas.sum() == pytest.approx(surface.facet_areas.sum(), rel=1e-12)
    assert surface.distribution(nodal=True)["peak"] == contact.headline.peak


def test_fields_say_what_they_are(file):
    state = file.states[-1]
    fields = {(f.name, f.region): f for f in state.fields}
    displacement = fields["displacement", ""]
    assert (displacement.group, displacement.type, displacement.format) == ("nodal", "vec3", "node")
    assert displacement.values.shape == state.points.shape and displacement.values.dtype == np.float32
    assert not displacement.values.flags.owndata
    surface = state.surface("femoral_articulating")
    pressure = {f.name: f for f in surface.fields}["contact pressure"]
    assert (pressure.group, pressure.region) == ("surface", "femoral_articulating")
    assert len(surface.cell_types) == len(surface.facets) == len(surface.facet_areas)


def test_names_that_are_not_there(file):
    state = file.states[-1]
    for ask, meant in ((lambda: state.surface("femoral_articulatin"), "femoral_articulating"),
                       (lambda: state.nodal("displacment"), "displacement"),
                       (lambda: state.surface("femoral_articulating").facet("contact presure"), "contact pressure")):
        with pytest.raises(febiodea.UsageError) as caught:
            ask()
        assert f'did you mean "{meant}"' in caught.value.found
    with pytest.raises(febiodea.InputError, match="no state at time 7"):
        file.state(7)


def test_a_compressed_file_is_the_same(hip_result, file, tmp_path):
    hip_result.write_xplt(tmp_path / "small.xplt", compress=True)
    small = febiodea.read_xplt(tmp_path / "small.xplt")
    assert small.compressed and not file.compressed
    for a, b in zip(small.states[-1].fields, file.states[-1].fields):
        assert (a.name, a.region, a.values.tobytes()) == (b.name, b.region, b.values.tobytes())


def test_files_that_are_cut_off_or_none(hip, tmp_path):
    whole = tmp_path / "whole.xplt"
    febiodea.analyse(hip, [1, 2]).write_xplt(whole)
    cut = tmp_path / "cut.xplt"
    cut.write_bytes(whole.read_bytes()[:-1000])
    with pytest.raises(febiodea.InputError, match="cut off after 1 complete state,") as caught:
        febiodea.read_xplt(cut)
    assert caught.value.place == str(cut) and "partial=True" in caught.value.expected
    part = febiodea.read_xplt(cut, partial=True)
    assert part.truncated and len(part.states) == 1
    for content in (b"", b"no plot file", whole.read_bytes()[:200]):
        cut.write_bytes(content)
        with pytest.raises(febiodea.InputError) as caught:
            febiodea.read_xplt(cut)
        assert str(cut) in str(caught.value) and "\n" not in str(caught.value)


def test_reference_results_have_the_numbers_of_dea_compare(reference, dea, tmp_path):
    for path in sorted(reference.glob("*.xplt")):
        dea("compare", path, path, "--json", "same.json", "-q", cwd=tmp_path)
        compared = json.loads((tmp_path / "same.json").read_text())
        state = febiodea.read_xplt(path).states[-1]
        found = 0
        for surface in compared["surfaces"]:
            own = state.surface(surface["names"][0])
            expected = surface["regions"][0]["results"][0]
            for name in ("p99", "mean", "area", "peak"):
                assert expected["headline"][name] == getattr(own.headline(), name)
                assert expected["nodes"][0][name] == own.distribution()[name]
                assert expected["facets"][0][name] == own.distribution(nodal=False)[name]
            assert expected["resultant"] == list(own.resultant())
            found += 1
        assert found > 0 and len(state.cell_types) > 0


def test_statistics_on_paper():
    numbers = febiodea.distribution([1.0, 2.0, 3.0, 0.0], [1.0, 1.0, 2.0, 5.0], 0.5)
    assert (numbers["area"], numbers["peak"], numbers["mean"]) == (4, 3, 9 / 4)
    assert febiodea.percentile([3, 1, 2], [1, 1, 1], 0.5) == 2
    pattern = febiodea.pattern_difference([1, 2, 0], [0, 1, -0.0], [1, 1, 1], 0.5)
    assert (pattern["mean"], pattern["rms"], pattern["largest"]) == (1, 1, 1)
    assert pattern["dice"] == pytest.approx(2 / 3)
    with pytest.raises(febiodea.UsageError):
        febiodea.distribution([1.0], [1.0, 2.0])


def test_pictures_are_those_of_dea_plot(file, hip_result, dea, tmp_path):
    dea("plot", file.path, "-o", "hip.svg", "--label", "hip", cwd=tmp_path)
    assert febiodea.picture(file, tmp_path / "python.svg") == (tmp_path / "hip.svg").read_bytes()
    assert febiodea.picture(hip_result, format="png")[:4] == b"\x89PNG"
    assert "<svg" in hip_result._repr_html_()
    with pytest.raises(febiodea.UsageError, match="png, svg or pdf"):
        febiodea.picture(file, tmp_path / "hip.jpg")


def test_plot(file):
    if importlib.util.find_spec("matplotlib") is None:
        with pytest.raises(ImportError, match="needs matplotlib"):
            febiodea.plot(file)
        return
    import matplotlib
    matplotlib.use("svg")
    axes = febiodea.plot(file)
    values = axes.collections[0].get_array()
    assert np.nanmax(values) <= axes.collections[0].norm.vmax
