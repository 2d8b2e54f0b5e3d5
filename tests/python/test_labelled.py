"""Results as xarray, meshio and pyvista have them, and in a pickle."""
import pickle
import subprocess
import sys

import numpy as np
import pytest

import febiodea

FEBIO = "hip/hip_walking_febio.xplt"


def test_xarray_of_a_result(hip):
    xarray = pytest.importorskip("xarray")
    result = febiodea.analyse(hip, [1.0, 2.0])
    data = result.to_xarray()
    assert isinstance(data, xarray.Dataset)
    contact = result["hip_contact"]
    assert data.p99.sel(contact="hip_contact")[-1] == contact.headline.p99
    both = [contact.source, contact.target]
    for side in both:
        here = data.pressure[-1][data.node_surface == side.surface]
        assert np.array_equal(here, side.nodes.pressure)
        here = data.facet_pressure[-1][data.facet_surface == side.surface]
        assert np.array_equal(here, side.facets.pressure)
    source = data.facet_surface == contact.source.surface
    force = float((data.facet_pressure * data.facet_area)[-1][source].sum())
    assert force == pytest.approx(float((contact.source.facets.pressure * contact.source.facets.area).sum()), rel=1e-12)
    for state, pose in enumerate(s.poses["femur"] for s in result.states):
        assert np.array_equal(data.translation.sel(body="femur")[state], pose[:3, 3])
        assert np.array_equal(data.rotation_matrix.sel(body="femur")[state], pose[:3, :3])
    assert list(data.time) == [s.time for s in result.states]


def test_xarray_has_units(hip):
    pytest.importorskip("xarray")
    data = febiodea.analyse(febiodea.recognise(hip.model, units="mm-N-s"), "last").to_xarray()
    assert (data.p99.attrs["units"], data.point.attrs["units"], data.translation.attrs["units"]) == ("MPa", "mm", "mm")
    assert data.area.attrs["units"] == "mm²" and "units" not in data.strain.attrs


def test_xarray_of_a_plot_file(samples):
    pytest.importorskip("xarray")
    file = febiodea.read_xplt(samples / FEBIO)
    data = file.to_xarray()
    for name in file.states[-1].surfaces:
        here = data["contact pressure"][-1][data.facet_surface == name]
        assert np.array_equal(here, file.states[-1].surface(name).facet("contact pressure"))
    assert np.array_equal(data.displacement[-1], file.states[-1].nodal("displacement"))
    force = next(f for f in file.states[-1].fields if f.name == "rigid force" and f.region == "femur")
    assert np.array_equal(data["rigid force"].sel(domain="femur")[-1], force.values[0])


def test_xarray_of_stress_in_elements(hip, tmp_path):
    pytest.importorskip("xarray")
    result = febiodea.analyse(febiodea.recognise(hip.model, inside=True), "last")
    result.write_xplt(tmp_path / "hip.xplt")
    file = febiodea.read_xplt(tmp_path / "hip.xplt")
    data = file.to_xarray()
    for field in (f for f in file.states[-1].fields if f.name == "stress"):
        assert np.array_equal(data.stress[-1][data.element_domain == field.region], field.values)
    assert list(data.component.values) == ["xx", "yy", "zz", "xy", "yz", "xz"]
    mesh = pytest.importorskip("meshio") and file.to_meshio()
    stress = np.concatenate(mesh.cell_data["stress"])
    kept = np.concatenate([f.values for f in file.states[-1].fields if f.name == "stress"])
    assert np.array_equal(stress[~np.isnan(stress[:, 0])], kept)


def test_xarray_of_a_study(hip, tmp_path):
    pytest.importorskip("xarray")
    study = febiodea.Study(hip.model.files[0], {"stiffness": "E={8|12}", "tilt": "rotate pelvis=0,1,0,{-5|5}"}, states="last", law="linear")
    results = study.run(tmp_path / "plan.db")
    data = results.to_xarray()
    assert dict(data.sizes) == {"case": 4, "state": 1, "contact": 1}
    for row in results.table():
        here = data.sel(case=row["case_id"], state=row["state"], contact=row["contact"])
        assert (here.p99, here.force_x, here.stiffness, here.tilt) == (row["headline_p99"], row["force_x"], row["stiffness"], row["tilt"])
    again = pickle.loads(pickle.dumps(results))
    assert again.table() == results.table()
    assert "4 of 4" in results._repr_html_() and "stiffness" in study._repr_html_()


@pytest.mark.parametrize("made_of", ["result", "file"])
def test_meshio(made_of, hip_result, samples, tmp_path):
    meshio = pytest.importorskip("meshio")
    source = hip_result if made_of == "result" else febiodea.read_xplt(samples / FEBIO)
    source.to_meshio().write(tmp_path / "hip.vtu")
    back = meshio.read(tmp_path / "hip.vtu")
    if made_of == "result":
        contact = hip_result["hip_contact"]
        for side in (contact.source, contact.target):
            assert np.array_equal(back.point_data["contact pressure"][side.nodes.index], side.nodes.pressure)
        assert np.array_equal(back.points, hip_result.recognition.model.points)
    else:
        state = source.states[-1]
        surface = state.surface("acetabular_articulating")
        rows = np.unique(surface.facets[surface.facets >= 0])
        assert np.allclose(np.sort(back.point_data["contact pressure"][rows]), np.sort(surface.nodal("contact pressure")), atol=0)
        assert np.array_equal(back.point_data["displacement"], state.nodal("displacement"))


def test_pyvista(hip_result, tmp_path):
    pyvista = pytest.importorskip("pyvista")
    hip_result.to_pyvista().save(tmp_path / "hip.vtu")
    back = pyvista.read(tmp_path / "hip.vtu")
    side = hip_result["hip_contact"].source
    assert np.array_equal(back.point_data["contact pressure"][side.nodes.index], side.nodes.pressure)


def test_what_is_missing_is_said(hip_result, monkeypatch):
    for module in ("xarray", "meshio", "pyvista"):
        monkeypatch.setitem(sys.modules, module, None)
        with pytest.raises(ImportError, match=f"to_{module} needs {module}"):
            getattr(hip_result, f"to_{module}")()


def test_states_and_contacts_by_name(hip_result):
    assert hip_result[-1].time == hip_result.states[-1].time
    assert hip_result["hip_contact"].headline == hip_result[-1]["hip_contact"].headline
    with pytest.raises(KeyError, match="knee.*hip_contact"):
        hip_result["knee"]
    with pytest.raises(IndexError):
        hip_result[99]
    with pytest.raises(febiodea.UsageError, match="state"):
        hip_result.to_meshio(99)
    for shown in (hip_result, hip_result[-1], hip_result["hip_contact"]):
        assert f"{hip_result['hip_contact'].headline.p99:.4g}" in shown._repr_html_()


def test_a_result_in_a_pickle_is_solved_on_elsewhere(hip, tmp_path):
    """Another process has the same bits, and goes on from its last state."""
    result = febiodea.analyse(hip, [1.0, 2.0])
    (tmp_path / "result.pickle").write_bytes(pickle.dumps(result))
    program = """if True:
        import pickle, sys
        sys.path.insert(0, sys.argv[1])
        import febiodea
        result = pickle.load(open(sys.argv[2], "rb"))
        state = febiodea.prepare(result.recognition).solve(start=result[-1])
        print([s.time for s in result.states], result["hip_contact"].nodes.pressure.tobytes().hex(), state.solved, state.iterations)
        """
    folder = febiodea.__path__[0].removesuffix("/febiodea")
    done = subprocess.run([sys.executable, "-c", program, folder, tmp_path / "result.pickle"], capture_output=True, text=True, check=True)
    assert done.stdout.split("] ")[0] + "]" == str([s.time for s in result.states])
    times, bits, solved, iterations = done.stdout.rsplit(" ", 3)
    assert (bits, solved) == (result["hip_contact"].nodes.pressure.tobytes().hex(), "True") and int(iterations) <= 1
