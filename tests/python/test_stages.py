"""Reading, recognising, analysing: the same bits as the program, and everything a user may do wrong."""
import json
import pickle

import numpy as np
import pytest

import febiodea


def without_times(result):
    result.pop("timings")
    return result


def test_every_sample_is_that_of_the_program_to_the_last_bit(sample, samples, dea, tmp_path):
    path = str(samples / sample)
    dea("run", path, "--json", "dea.json", "-o", "dea.xplt", cwd=tmp_path)
    result = febiodea.analyse(febiodea.recognise(febiodea.read_feb(path)))
    result.write_xplt(tmp_path / "python.xplt")
    expected = without_times(json.loads((tmp_path / "dea.json").read_text()))
    assert without_times(json.loads(result.to_json())) == expected
    assert without_times(result.to_dict()) == expected
    assert (tmp_path / "python.xplt").read_bytes() == (tmp_path / "dea.xplt").read_bytes()


def test_settings_mean_what_they_mean_on_the_command_line(samples, dea, tmp_path):
    path = str(samples / "hip/hip_walking.feb")
    dea("run", path, "--json", "dea.json", "--no-xplt", "--states", "last", "--law", "neo-Hookean",
        "--thickness", "acetabular_articulating=1.3", "--nu", "0.42", "--rotate", "pelvis=0,1,0,3.3", "--move",
        "femur=0.1,0,0", "--rotate-about", "pelvis=sphere-center", "--force", "femur=400,-200,1700", "--load-at",
        "femur=sphere-center", "--no-squash", "--refine", "2", "--free", "femur=x,y,z", cwd=tmp_path)
    recognition = febiodea.recognise(
        path, law="neo-Hookean", thickness={"acetabular_articulating": 1.3}, nu=np.float64(0.42),
        rotate=[("pelvis", (0, 1, 0), 3.3)], move=[("femur", np.array([0.1, 0, 0]))],
        rotate_about={"pelvis": "sphere-center"}, force={"femur": [400, -200, 1700]},
        load_at={"femur": "sphere-center"}, squash=False, refine=np.int32(2), free={"femur": ["x", "y", "z"]})
    expected = without_times(json.loads((tmp_path / "dea.json").read_text()))
    assert without_times(febiodea.analyse(recognition, "last").to_dict()) == expected


def test_a_recognition_prints_as_dea_info(samples, dea, tmp_path):
    path = str(samples / "knee/knee.feb")
    assert str(febiodea.recognise(path)) == dea("info", path, cwd=tmp_path)
    dea("info", path, "--json", "info.json", cwd=tmp_path)
    assert febiodea.recognise(path).info() == json.loads((tmp_path / "info.json").read_text())


def test_a_schema_is_that_of_the_program(dea, tmp_path):
    for name in ("run", "settings"):
        assert febiodea.schema(name) == json.loads(dea("schema", name, cwd=tmp_path))
    with pytest.raises(febiodea.UsageError):
        febiodea.schema("runs")


def test_a_setting_of_the_table_is_a_keyword():
    shown = febiodea.Settings().as_dict()
    help_text = febiodea.settings_help()
    assert len(shown) > 30
    for keyword in shown:
        if keyword == "placements":  # rotate and move once more, in the order in which they act
            continue
        assert f"\n  {keyword}=" in "\n" + help_text
        with pytest.raises(febiodea.UsageError) as fault:  # known, and its value looked at
            febiodea.Settings(**{keyword: object()})
        assert fault.value.place == keyword


def test_settings_file_comes_after_keywords(tmp_path, hip):
    file = tmp_path / "settings.xml"
    file.write_text('<febiodea_settings version="1"><law>linear</law><refine>2</refine></febiodea_settings>')
    used = febiodea.recognise(hip.model, file, refine=3).settings
    assert (used["law"], used["refine"]) == ("linear", 3)
    assert febiodea.recognise(hip.model, febiodea.Settings(file), refine=3).settings == used


def test_settings_order_of_placements(hip):
    there = febiodea.recognise(hip.model, rotate=[("pelvis", (0, 0, 1), 90)], move=[("pelvis", (1, 0, 0))],
                               rotate_about={"pelvis": "com"})
    back = febiodea.recognise(hip.model, move=[("pelvis", (1, 0, 0))], rotate=[("pelvis", (0, 0, 1), 90)],
                              rotate_about={"pelvis": "com"})
    assert there.settings["rotate"] == back.settings["rotate"] == ["pelvis=0,0,1,90"]


@pytest.mark.parametrize("keywords, place, found, expected", [
    ({"lwa": "layer"}, "lwa", 'no setting of this name (did you mean "law"?)', '"law"'),
    ({"law": "lyr"}, 'law="lyr"', 'found "lyr"', "linear, logarithmic, neo-Hookean or layer"),
    ({"refine": 0}, "refine=0", 'found "0"', "a whole number from 1 to 1000"),
    ({"thickness": {"x": "abc"}}, 'thickness={"x": "abc"}', 'found "abc"', "a number"),
    ({"thickness": {"x": 1}}, 'thickness={"x": ...}', "no surface of this name", '"femoral_articulating"'),
    ({"thickness": {"x": float("nan")}}, 'thickness={"x": "nan"}', 'found "nan"', "a number"),
    ({"attach": "pelvis"}, 'attach="pelvis"', "no surface that it is for", "attach="),
    ({"law": {"x": "linear"}}, "law", 'found a value for "x"', "one value"),
    ({"rotate": [("pelvis", (0, 0, 0), 1)]}, 'rotate=[("pelvis", (0, 0, 0), 1)]', "0,0,0", "an axis"),
    ({"rotate": [("pelvs", (0, 1, 0), 1)]}, 'rotate=[("pelvs", ...)]', 'did you mean "pelvis"', '"femur"'),
    ({"rotate": [(0, 1, 0)]}, "rotate", "found (0, 1, 0)", "BODY"),
    ({"refine": 900}, "refine=900", "springs", "at most"),
])
def test_faults_name_keywords(hip, keywords, place, found, expected):
    with pytest.raises(febiodea.UsageError) as caught:
        febiodea.analyse(febiodea.recognise(hip.model, **keywords))
    fault = caught.value
    assert place in fault.place and found in fault.found and expected in fault.expected
    assert "\n" not in str(fault) and fault.place in str(fault) and "--" not in str(fault)
    again = pickle.loads(pickle.dumps(fault))
    assert (str(again), again.place, again.remedy) == (str(fault), fault.place, fault.remedy)


def test_faults_of_files(tmp_path, hip_result):
    with pytest.raises(febiodea.InputError, match="no such file") as caught:
        febiodea.read_feb(tmp_path / "no.feb")
    assert caught.value.place == str(tmp_path / "no.feb") and caught.value.found == "no such file"
    broken = tmp_path / "broken.feb"
    broken.write_text("<febio_spec version='4.0'>\n<Mesh>\n</febio_spec>")
    with pytest.raises(febiodea.InputError) as caught:
        febiodea.read_feb(broken)
    assert caught.value.place.startswith(f"{broken}:")
    with pytest.raises(febiodea.WriteError) as caught:
        hip_result.write_xplt(tmp_path / "no" / "x.xplt")
    assert caught.value.place == str(tmp_path / "no" / "x.xplt")
    assert not (tmp_path / "no").exists()


def test_a_recognition_keeps_its_faults(samples, tmp_path):
    text = (samples / "sphere_on_flat/sphere_on_flat.feb").read_text().replace("sliding-elastic", "sticky")
    (tmp_path / "sticky.feb").write_text(text)
    recognition = febiodea.recognise(tmp_path / "sticky.feb")
    assert not recognition.solvable and isinstance(recognition.faults[0], febiodea.InputError)
    for use in (febiodea.analyse, febiodea.prepare):
        with pytest.raises(febiodea.InputError) as caught:
            use(recognition)
        assert str(caught.value).startswith(str(recognition.faults[0]))
        assert len(caught.value.others) == len(recognition.faults) - 1


@pytest.mark.parametrize("call, place", [
    (lambda hip: febiodea.recognise(hip), "model"), (lambda hip: febiodea.recognise(hip.model, 5), "settings"),
    (lambda hip: febiodea.analyse("hip.feb"), "recognition"), (lambda hip: febiodea.prepare(hip.model), "recognition"),
    (lambda hip: febiodea.analyse(hip, []), "states"), (lambda hip: febiodea.analyse(hip, ["a"]), "states"),
    (lambda hip: febiodea.plot(hip), "source"),
])
def test_arguments_of_another_type(hip, call, place):
    with pytest.raises(febiodea.UsageError) as caught:
        call(hip)
    assert caught.value.place == place and caught.value.expected and "\n" not in str(caught.value)


def test_states(hip):
    assert [s.time for s in febiodea.analyse(hip, [1, 2]).states] == [1, 2]
    with pytest.raises(febiodea.UsageError) as caught:
        febiodea.analyse(hip, "lst")
    assert caught.value.place == 'states="lst"' and 'did you mean "last"' in caught.value.found
    with pytest.raises(febiodea.UsageError, match="from 0 to 2"):
        febiodea.analyse(hip, 5)


def test_pickle(samples, tmp_path):
    path = tmp_path / "hip.feb"
    path.write_bytes((samples / "hip/hip_walking.feb").read_bytes())
    settings = febiodea.Settings(law="linear", thickness={"acetabular_articulating": 1.7})
    assert pickle.loads(pickle.dumps(settings)) == settings != febiodea.Settings(law="linear")
    recognition = febiodea.recognise(febiodea.read_feb(path), settings)
    bytes_of_it = pickle.dumps(recognition)
    table = febiodea.analyse(recognition, "last").table()
    again = febiodea.analyse(pickle.loads(bytes_of_it), "last").table()
    assert repr(again) == repr(table) == repr(pickle.loads(pickle.dumps(table)))  # all digits; NaN is NaN
    path.write_bytes(path.read_bytes().replace(b"0.45", b"0.44", 1))
    with pytest.raises(febiodea.InputError, match="another content"):
        pickle.loads(bytes_of_it)


def test_what_a_result_writes(hip_result, dea, tmp_path):
    hip_result.write_xplt(tmp_path / "a.xplt")
    hip_result.write_xplt(tmp_path / "a.xplt")  # its own is replaced
    (tmp_path / "b.xplt").write_bytes(b"something else")
    with pytest.raises(febiodea.WriteError, match="overwrite=True"):
        hip_result.write_xplt(tmp_path / "b.xplt")
    hip_result.write_xplt(tmp_path / "b.xplt", overwrite=True)
    assert (tmp_path / "a.xplt").read_bytes() == (tmp_path / "b.xplt").read_bytes()
    hip_result.write_xplt(tmp_path / "c.xplt", compress=True)
    assert (tmp_path / "c.xplt").stat().st_size < (tmp_path / "a.xplt").stat().st_size
    hip_result.write_vtu(tmp_path / "vtu")
    assert (tmp_path / "vtu" / "results.pvd").exists()
    hip_result.report(tmp_path / "hip.html")
    assert "hip_contact" in (tmp_path / "hip.html").read_text()
    with pytest.raises(febiodea.UsageError, match="html"):
        hip_result.report(tmp_path / "hip.txt")
    dea("run", hip_result.recognition.model.files[0], "--no-xplt", "--states", "last", "--facets-csv", "f.csv",
        cwd=tmp_path)
    assert hip_result.facets_csv() == (tmp_path / "f.csv").read_text()


def test_progress(hip):
    told = []
    febiodea.analyse(hip, "last", progress=lambda p: told.append((p.stage, p.state, p.states, p.outcome)))
    assert told[0][0] == "springs" and told[-1] == ("state", 2, 2, "Balanced")

    class Enough(Exception):
        pass

    def raise_at_state(p):
        if p.stage == "state":
            raise Enough
    with pytest.raises(Enough):
        febiodea.analyse(hip, "last", progress=raise_at_state)
