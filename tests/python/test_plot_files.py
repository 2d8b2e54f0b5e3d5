"""Plot files of whatever program."""
import base64
import importlib.util
import json
import pathlib
import re
import struct

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
    assert febiodea.percentile(np.array([3, 1, 2, 9]), np.array([1, 1, 1, 0]), 0.5) == 2  # no weight: not there
    pattern = febiodea.pattern_difference([1, 2, 0], [0, 1, -0.0], [1, 1, 1], 0.5)
    assert (pattern["mean"], pattern["rms"], pattern["largest"]) == (1, 1, 1)
    assert pattern["dice"] == pytest.approx(2 / 3)
    for with_nan in (([1, 2, 0, np.nan], [0, 1, 0, 1]), ([1, 2, 0, 1], [0, 1, 0, np.nan])):
        assert febiodea.pattern_difference(*with_nan, [1, 1, 1, 1], 0.5) == pattern


@pytest.mark.parametrize("call, place", [
    (lambda: febiodea.distribution([1.0], [1.0, 2.0]), "areas"),
    (lambda: febiodea.distribution([1.0], [-1.0]), "areas[0]"),
    (lambda: febiodea.distribution([[1.0]], [1.0]), "values"),
    (lambda: febiodea.distribution("many", [1.0]), "values"),
    (lambda: febiodea.percentile([1, np.nan], [1, 1], 0.5), "values[1]"),
    (lambda: febiodea.percentile([1], [1], 99), "fraction"),
    (lambda: febiodea.pattern_difference([1], [1, 2], [1]), "b"),
])
def test_statistics_of_what_has_none(call, place):
    with pytest.raises(febiodea.UsageError) as caught:
        call()
    assert caught.value.place == place and caught.value.found and caught.value.expected


def test_fields_of_another_kind(file):
    surface = file.states[-1].surface("femoral_articulating")
    names = {field.name: field for field in surface.fields}
    others = [name for name, field in names.items() if field.type != "float" or field.format == "region"]
    assert others
    for name in others:
        with pytest.raises(febiodea.UsageError) as caught:
            surface.facet(name)
        assert '"contact pressure"' in caught.value.expected and f'"{name}"' not in caught.value.expected
    with pytest.raises(febiodea.UsageError, match="expected 2809, one per point of the other surface"):
        surface.carry_from(surface, [1.0])


def test_domains_without_a_name_have_that_of_their_part(file, tmp_path):
    domain_name = struct.pack("<I", 0x01032105)  # then the chunk's size, the name's length, the name

    def empty(chunk):
        return chunk[1] + bytes(len(chunk[2]))

    path = tmp_path / "nameless.xplt"
    named = pathlib.Path(file.path).read_bytes()
    path.write_bytes(re.sub(rb"(%s.\0\0\0.\0\0\0)([^\0]+)" % re.escape(domain_name), empty, named, flags=re.DOTALL))
    state = febiodea.read_xplt(path).states[-1]
    assert set(file.states[-1].domains) - set(state.domains)  # domains and parts are called otherwise
    assert state.domains and all(state.domains)
    assert {f.region for f in state.fields if f.group == "domain"} <= set(state.domains)


def test_pictures_are_those_of_dea_plot(file, hip_result, dea, tmp_path):
    dea("plot", file.path, "-o", "hip.svg", cwd=tmp_path)
    drawn = (tmp_path / "hip.svg").read_bytes()
    assert febiodea.picture(file, tmp_path / "python.svg") is None
    assert febiodea.picture(file) == drawn == (tmp_path / "python.svg").read_bytes()
    assert febiodea.picture(hip_result, format="png")[:4] == b"\x89PNG"
    for keywords, place in (({"path": tmp_path / "hip.jpg"}, "format"), ({"path": ""}, "path"), ({"width": -1}, "width"), ({"dpi": "fine"}, "dpi"),
                            ({"source": "hip.xplt"}, "source"), ({"states": []}, "states")):
        with pytest.raises(febiodea.UsageError) as caught:
            febiodea.picture(**{"source": file, **keywords})
        assert caught.value.place == place
    with pytest.raises(febiodea.WriteError):
        febiodea.picture(file, tmp_path / "no" / "hip.svg")


def test_a_notebook_shows_table_and_map(hip_result):
    page = hip_result._repr_html_()
    drawn = re.search('src="data:image/svg\\+xml;base64,([^"]+)"', page).group(1)
    assert b"<svg" in base64.b64decode(drawn)
    assert page.count("<tr>") == 2 and "id=" not in page  # no names that another result in the same notebook has too


def band_fills(svg):
    """Colours of the map's values, and the outline of its surface: from the fill that says "no contact" to the first stroke."""
    fills, outline = [], None
    for style, path in re.findall(r'<path ([^>]*?) ?\bd="([^"]*)"', svg):  # cairo 1.16 writes styles, 1.18 attributes
        numbers = re.search(r'\bfill(?:=")?:?rgb\(([\d.]+)%, ?([\d.]+)%, ?([\d.]+)%\)', style)
        if outline is not None and (re.search('fill(:|=")none', style) or numbers is None):
            return fills, outline
        if numbers is None:  # a letter
            continue
        colour = tuple(round(float(x) * 2.55) for x in numbers.groups())
        if outline is not None:
            fills.append(colour)
        elif len(set(colour[:2])) == 1 and colour[0] < 250:  # the first grey area
            outline = np.array(re.findall(r"(-?[\d.]+) (-?[\d.]+)", path), float)
    raise AssertionError("no map in the picture")


@pytest.mark.parametrize("smooth", [False, True])
def test_plot_is_the_picture_on_axes(file, dea, tmp_path, smooth):
    if importlib.util.find_spec("matplotlib") is None:
        with pytest.raises(ImportError, match="needs matplotlib"):
            febiodea.plot(file)
        pytest.skip("no matplotlib")
    import matplotlib
    matplotlib.use("agg")
    from matplotlib import collections, pyplot
    dea("plot", file.path, "-o", "hip.svg", *(["--smooth"] if smooth else []), cwd=tmp_path)
    fills, outline = band_fills((tmp_path / "hip.svg").read_text())
    figure, axes = pyplot.subplots()
    assert febiodea.plot(file, axes, smooth=smooth) is axes
    figure.canvas.draw()
    colours = set()
    for c in axes.collections:
        # contours: before matplotlib 3.8 a collection for each band, since then one with a path for each
        if smooth and (isinstance(c, collections.PathCollection) or type(c).__name__.endswith("ContourSet")):
            one_each = len(c.get_paths()) == len(c.get_facecolor())
            drawn = [len(p.vertices) > 0 for p in c.get_paths()] if one_each else [any(len(p.vertices) for p in c.get_paths())]
        elif not smooth and isinstance(c, collections.PolyCollection) and c.get_array() is not None:
            drawn = [True] * len(c.get_facecolor())
        else:
            continue
        colours |= {tuple(round(x * 255) for x in face[:3]) for face, there in zip(c.get_facecolor(), drawn) if there}
    assert len(colours) > 50 and colours == set(fills)
    # the same outline, but for scale and place: up is down on paper
    rim = np.vstack([line for c in axes.collections if isinstance(c, collections.LineCollection) for line in c.get_segments()
                     if len(line) > 20])
    scale = (np.ptp(outline, axis=0) / np.ptp(rim, axis=0))
    assert scale[0] == pytest.approx(scale[1], rel=5e-4)  # places on paper are rounded
    on_paper = np.column_stack([rim[:, 0] - rim[:, 0].min(), rim[:, 1].max() - rim[:, 1]]) * scale + outline.min(axis=0)
    away = np.linalg.norm(outline[:, None] - on_paper[None], axis=2).min(axis=1)
    assert away.max() < 0.15  # pixels, of which the map is some hundreds wide
    (bar,) = [other for other in figure.axes if other is not axes]
    assert bar.get_ylabel().startswith("contact pressure")
    pyplot.close(figure)


def test_plot_of_two_states(hip):
    pytest.importorskip("matplotlib")
    with pytest.raises(febiodea.UsageError, match="found 2 panels") as caught:
        febiodea.plot(febiodea.analyse(hip, [1, 2]), state="1,2")
    assert caught.value.place == "state"
