"""Loads, motion and thickness from memory as from files; placements in turn; what a worker sends back."""
import importlib.util
import os
import pickle
import subprocess
import sys

import numpy as np
import pytest

import febiodea

LOADS = {"time": [3.0, 4.0, 5.0], "fx": [100.0, 200.0, 432.0], "fy": [0.0, -100.0, -262.0], "fz": [900.0, 1400.0, 1834.0]}
MOTION = {"time": [3.0, 4.0, 5.0], "tx": [0.0, 0.0, 0.1], "ty": [0.0, 0.0, 0.0], "tz": [0.0, 0.0, 0.0],
          "rx": [0.0, 0.0, 1.0], "ry": [0.0, 2.5, 5.0], "rz": [0.0, 0.0, 0.0]}
TURNS = {"motion_body": "pelvis", "motion_rotation": "xyz", "motion_units": "deg-mm"}


def write(path, table):
    path.write_text("\n".join([",".join(table)] + [",".join(map(repr, row)) for row in zip(*table.values())]) + "\n")
    return path


def forms(table):
    """As a user may have it."""
    rows = list(zip(*table.values()))
    yield table
    yield {name: np.array(values, dtype=np.float32) for name, values in table.items()} if table is LOADS else table
    yield np.array(rows, dtype=[(name, float) for name in table])
    if importlib.util.find_spec("pandas"):
        import pandas
        yield pandas.DataFrame(table)


def bits(result):
    return [(s.time, [p.tobytes() for p in s.poses.values()], s.contact().springs.pressure.tobytes()) for s in result.states]


def test_loads_in_memory_are_those_of_a_file(hip, tmp_path):
    keywords = {"law": "linear", "load_body": "femur", "skip_steps": True}
    path = write(tmp_path / "loads.csv", LOADS)
    expected = febiodea.analyse(febiodea.recognise(hip.model, loads=path, **keywords))
    np.testing.assert_allclose(expected.states[-1].reactions["femur"][0], [432, -262, 1834], rtol=1e-6)
    for table in forms(LOADS):
        recognition = febiodea.recognise(hip.model, loads=table, **keywords)
        assert bits(febiodea.analyse(recognition)) == bits(expected)
    assert recognition.settings["loads"] == "table of loads"


def test_what_was_recognised_is_of_the_rows(hip):
    recognition = febiodea.recognise(hip.model, loads=LOADS, load_body="femur")
    assert recognition.info()["times"] == LOADS["time"]
    assert "femur: x free, y free, z free, Ru held, Rv held, Rw held; the load of the table of loads\n" in str(recognition)


def test_motion_and_thickness_in_memory_are_those_of_files(hip, tmp_path):
    nodes = febiodea.analyse(hip, [0]).states[0].contact().nodes
    thickness = {"node": hip.model.node_ids[nodes.index].tolist(), "thickness": [1.5] * len(nodes)}
    keywords = {"law": "linear", "skip_steps": True, **TURNS}
    expected = febiodea.recognise(hip.model, motion=write(tmp_path / "motion.csv", MOTION),
                                  thickness_from={"acetabular_articulating": write(tmp_path / "t.csv", thickness)}, **keywords)
    found = febiodea.recognise(hip.model, motion=MOTION, thickness_from={"acetabular_articulating": thickness}, **keywords)
    assert bits(febiodea.analyse(found)) == bits(febiodea.analyse(expected))
    assert not np.allclose(febiodea.analyse(found).states[-1].poses["pelvis"], np.eye(4))
    assert febiodea.analyse(found).states[-1].contact().nodes.thickness.max() == pytest.approx(1.5)


@pytest.mark.parametrize("loads, found", [
    ({**LOADS, "time": [3, 5, 4]}, "table of loads:3: found time 4 after 5"),
    ({**LOADS, "fx": [1, 2]}, "a dict that is no table of numbers"),
    ({**LOADS, "fx": ["a", "b", "c"]}, "a dict that is no table of numbers"),
    ({**LOADS, "fx": [1, float("nan"), 2]}, 'table of loads:2: column "fx": found nan'),
    ({**LOADS, "FX": [1, 2, 3]}, 'two columns named "FX"'),
    ({"time": [3.0], "fx": [1.0]}, "not all three columns of the force"),
    ({name: [] for name in LOADS}, "table of loads: found no row"),
    (np.ones((3, 4)), "a ndarray that is no table of numbers"),
    (5, "a int that is no table of numbers"),
])
def test_tables_that_are_none(hip, loads, found):
    with pytest.raises(febiodea.Error) as caught:
        febiodea.recognise(hip.model, loads=loads, load_body="femur")
    assert found in str(caught.value) and "\n" not in str(caught.value) and caught.value.expected


def test_settings_with_tables_are_compared_and_pickled(hip):
    ours = febiodea.Settings(loads=LOADS, load_body="femur", law="linear", skip_steps=True)
    other = febiodea.Settings(loads={**LOADS, "fx": [0.0, 0, 0]}, load_body="femur", law="linear", skip_steps=True)
    assert ours != other and pickle.loads(pickle.dumps(ours)) == ours
    given = {"thickness": {"acetabular_articulating": 1.7}}
    kept = febiodea.Settings(**given)
    given["thickness"]["acetabular_articulating"] = 3.0  # the caller's own
    assert pickle.loads(pickle.dumps(kept)) == kept and kept.as_dict()["thickness"] == {"acetabular_articulating": 1.7}
    recognition = febiodea.recognise(hip.model, ours, refine=1)
    again = pickle.loads(pickle.dumps(recognition))
    assert again.settings == recognition.settings and bits(febiodea.analyse(again)) == bits(febiodea.analyse(recognition))


def test_keywords_lie_over_settings(hip):
    """A value per surface replaces that of this surface alone, as in a settings file."""
    ours = febiodea.Settings(thickness={"acetabular_articulating": 1.7}, E={"femoral_articulating": 9}, refine=2)
    used = febiodea.recognise(hip.model, ours, E={"acetabular_articulating": 12}, refine=1).settings
    assert used["E"] == {"femoral_articulating": 9, "acetabular_articulating": 12}
    assert used["thickness"] == {"acetabular_articulating": 1.7} and used["refine"] == 1


def test_placements_in_turn(hip, tmp_path):
    turns = [("rotate", "pelvis", (1, 0, 0), 20), ("move", "femur", (1, 0, 0)), ("rotate", "pelvis", (0, 1, 0), 10),
             ("move", "pelvis", (0, 0, 2))]
    file = tmp_path / "settings.xml"
    file.write_text('<febiodea_settings version="1"><rotate body="pelvis">1,0,0,20</rotate><move body="femur">1,0,0</move>'
                    '<rotate body="pelvis">0,1,0,10</rotate><move body="pelvis">0,0,2</move></febiodea_settings>')
    ours = febiodea.recognise(hip.model, placements=turns, law="linear")
    assert ours.settings["placements"] == febiodea.recognise(hip.model, file).settings["placements"]
    assert len(ours.settings["placements"]) == 4
    there = febiodea.prepare(ours).solve().poses["pelvis"]
    joint = febiodea.prepare(febiodea.recognise(hip.model, law="linear"))
    assert joint.solve(placements=turns).poses["pelvis"].tobytes() == there.tobytes()
    back = joint.solve(placements=[turns[2], turns[1], turns[0], turns[3]]).poses["pelvis"]
    assert np.abs(back - there)[:3, :3].max() > 0.01  # turns about x and y do not commute
    by_dictionary = febiodea.recognise(hip.model, rotate={"pelvis": ((0, 1, 0), 10)}).settings
    assert by_dictionary["rotate"] == febiodea.recognise(hip.model, rotate=[("pelvis", (0, 1, 0), 10)]).settings["rotate"]


@pytest.mark.parametrize("placements", [5, [("turn", "pelvis", (0, 1, 0), 10)], [("rotate", "pelvis", (0, 1, 0))],
                                        [("move", "pelvis")], [()], "rotate"])
def test_placements_that_are_none(placements):
    with pytest.raises(febiodea.UsageError) as caught:
        febiodea.Settings(placements=placements)
    assert caught.value.place in ("placements", "rotate", "move") and "BODY" in caught.value.expected


def test_a_load_leaves_the_motion(hip):
    """Of a table of motion the last row stays when a load is given."""
    table = febiodea.recognise(hip.model, law="linear", motion=MOTION, skip_steps=True, **TURNS)
    joint = febiodea.prepare(table)
    loaded = joint.solve(body="femur", force=(432, -262, 1834))
    np.testing.assert_array_equal(loaded.poses["pelvis"], joint.solve().poses["pelvis"])
    assert loaded.time == 5 and np.abs(loaded.poses["pelvis"] - np.eye(4)).max() > 0.05
    both = febiodea.prepare(febiodea.recognise(hip.model, law="linear", loads=LOADS, load_body="femur"))
    with pytest.raises(febiodea.UsageError, match='a table of loads on "femur"'):
        both.solve(body="pelvis", force=(0, 0, 1))


WORKER = """
import pickle, sys
import febiodea
state = febiodea.analyse(pickle.load(sys.stdin.buffer), "last").states[-1]
contact = state.contact()
pickle.dump({"statistics": state.statistics, "poses": state.poses, "reactions": state.reactions, "headline": contact.headline,
             "pressure": contact.nodes.pressure, "springs": contact.springs.pressure}, sys.stdout.buffer)
"""


def test_what_a_worker_sends_back(hip, hip_result, tmp_path):
    """A recognition goes to another process, in another folder, and numbers come back to the last bit."""
    finished = subprocess.run([sys.executable, "-c", WORKER], input=pickle.dumps(hip), capture_output=True, cwd=tmp_path,
                              env={**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)})
    assert finished.returncode == 0, finished.stderr
    sent = pickle.loads(finished.stdout)
    state = hip_result.states[-1]
    contact = state.contact()
    assert repr(sent["statistics"]) == repr(state.statistics) and sent["headline"] == contact.headline
    assert {b: p.tobytes() for b, p in sent["poses"].items()} == {b: p.tobytes() for b, p in state.poses.items()}
    assert all(np.array_equal(a, b) for body in state.reactions for a, b in zip(sent["reactions"][body], state.reactions[body]))
    np.testing.assert_array_equal(sent["pressure"], contact.nodes.pressure)
    np.testing.assert_array_equal(sent["springs"], contact.springs.pressure)
    for what in (state, contact):
        with pytest.raises(TypeError, match="pickle"):
            pickle.dumps(what)


def test_a_pickle_is_of_the_file_that_was_read(samples, tmp_path, monkeypatch):
    path = tmp_path / "hip.feb"
    path.write_bytes((samples / "hip/hip_walking.feb").read_bytes())
    monkeypatch.chdir(tmp_path)
    model = febiodea.read_feb("hip.feb")
    monkeypatch.chdir("/")
    assert pickle.loads(pickle.dumps(model)).points.tobytes() == model.points.tobytes()
    path.write_bytes(path.read_bytes().replace(b"0.45", b"0.44", 1))
    os.utime(path, ns=(0, 0))
    with pytest.raises(febiodea.InputError, match="has changed since it was read"):
        pickle.dumps(model)
