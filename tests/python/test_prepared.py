"""One joint for many loads and poses."""
import numpy as np
import pytest

import febiodea


def turned(axis, angle, shift=(0, 0, 0), about=(0, 0, 0)):
    """Rodrigues' rotation about a point, then a shift, as 4 x 4."""
    x, y, z = np.asarray(axis, float) / np.linalg.norm(axis)
    k = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    pose = np.eye(4)
    pose[:3, :3] = np.eye(3) + np.sin(angle) * k + (1 - np.cos(angle)) * k @ k
    pose[:3, 3] = np.asarray(about) - pose[:3, :3] @ about + shift
    return pose


@pytest.fixture(scope="module")
def joint(hip):
    return febiodea.prepare(hip)


def test_solve_is_the_last_state_of_the_analysis(joint, hip_result):
    solved, analysed = joint.solve(), hip_result.states[-1]
    # two searches from different starts, each to 1e-9 of the load
    np.testing.assert_allclose(solved.poses["femur"], analysed.poses["femur"], atol=1e-7)
    assert solved.contact().headline.p99 == pytest.approx(analysed.contact().headline.p99, rel=1e-6)


def test_a_load_takes_the_place_of_the_models(joint, hip):
    force = (400, -100, 1500)
    solved = joint.solve(body="femur", force=force, about="sphere-center")
    assert solved.solved
    np.testing.assert_allclose(solved.contact().target.force, -np.array(force), rtol=1e-6)
    analysed = febiodea.analyse(febiodea.recognise(hip.model, force={"femur": force},
                                                   load_at={"femur": "sphere-center"}), "last").states[-1]
    np.testing.assert_allclose(solved.poses["femur"], analysed.poses["femur"], atol=1e-7)


def test_the_same_call_gives_the_same_bits(joint):
    def numbers(state):
        return state.contact().springs.pressure.tobytes(), state.poses["femur"].tobytes()
    first = numbers(joint.solve(body="femur", force=(0, 0, 1500)))
    joint.solve(body="femur", force=(300, 0, 900), rotate=[("pelvis", (0, 1, 0), 4)])
    joint.press({"femur": turned((1, 0, 0), 0.02)})
    assert numbers(joint.solve(body="femur", force=(0, 0, 1500))) == first


def test_a_start_changes_the_way_and_not_the_answer(joint):
    far = joint.solve(body="femur", force=(0, 0, 900))
    near = joint.solve(body="femur", force=(0, 0, 1000))
    warm = joint.solve(body="femur", force=(0, 0, 1000), start=far)
    again = joint.solve(body="femur", force=(0, 0, 1000), start={"femur": far.poses["femur"]})
    np.testing.assert_allclose(warm.poses["femur"], near.poses["femur"], atol=1e-7)
    assert again.poses["femur"].tobytes() == warm.poses["femur"].tobytes()


def test_turned_bodies_are_placed(joint, hip):
    rotate = [("pelvis", (0, 1, 0), 5)]
    solved = joint.solve(rotate=rotate)
    analysed = febiodea.analyse(febiodea.recognise(hip.model, rotate=rotate), "last").states[-1]
    np.testing.assert_allclose(solved.poses["femur"], analysed.poses["femur"], atol=1e-6)


def test_a_start_moves_nothing_that_is_held(joint):
    """A state of a turned socket as the start of another: its socket is not taken over."""
    there = joint.solve(rotate=[("pelvis", (0, 1, 0), 5)])
    turned_on = joint.solve(rotate=[("pelvis", (0, 1, 0), 7)], start=there)
    np.testing.assert_allclose(turned_on.poses["pelvis"], turned((0, 1, 0), np.radians(7), about=center_of(turned_on)),
                               atol=1e-9)
    plain = joint.solve(rotate=[("pelvis", (0, 1, 0), 7)])
    np.testing.assert_allclose(turned_on.poses["femur"], plain.poses["femur"], atol=1e-6)
    back = joint.solve(start=there)
    np.testing.assert_array_equal(back.poses["pelvis"], np.eye(4))
    with pytest.raises(febiodea.UsageError, match="not free") as caught:
        joint.solve(start={"pelvis": there.poses["pelvis"]})
    assert caught.value.place == 'start["pelvis"]'


def center_of(state):
    """The point that the pelvis's pose leaves where it is, on the axis: least squares, for turns have a line of them."""
    pose = state.poses["pelvis"]
    return np.linalg.lstsq(np.eye(3) - pose[:3, :3], pose[:3, 3], rcond=None)[0]


def test_press_at_a_solution_has_its_forces(joint):
    state = joint.solve()
    pressed = joint.press(state).contact("hip_contact")
    np.testing.assert_allclose(pressed.force, state.contact().force, rtol=1e-8)
    np.testing.assert_allclose(pressed.springs.pressure, state.contact().springs.pressure, rtol=1e-6, atol=1e-9)
    np.testing.assert_allclose(pressed.force, -pressed.force_on_source, rtol=1e-12)
    np.testing.assert_allclose(pressed.headline, state.contact().headline, rtol=1e-5)  # in single precision, as in a plot file
    all_bodies = np.array([joint.press(state).poses[body] for body in joint.bodies])
    assert joint.press(all_bodies).contact().force.tobytes() == pressed.force.tobytes()


def test_press_at_the_identity_is_where_the_file_has_it(joint):
    poses = joint.press().poses
    assert all((pose == np.eye(4)).all() for pose in poses.values())
    assert joint.press({"femur": np.eye(4)}).contact().force.tobytes() == joint.press().contact().force.tobytes()


def test_press_does_not_care_where_the_joint_is(joint):
    """A rigid motion of all bodies turns the force and leaves the pressures."""
    state = joint.solve()
    moved = turned((1, 2, 3), 0.7, (10, -20, 30))
    here = joint.press(state).contact()
    there = joint.press({body: moved @ pose for body, pose in joint.press(state).poses.items()
                         if body != "ground"}).contact()
    np.testing.assert_allclose(there.force, moved[:3, :3] @ here.force, atol=1e-5)
    np.testing.assert_allclose(there.springs.pressure, here.springs.pressure, atol=1e-6)


def derivative_by_differences(joint, femur):
    """Central differences of force and moment on the femur, whose centre of mass is the origin of the file."""
    step = 1e-4
    found = np.empty((6, 6))
    for k in range(6):
        wrench = []
        for sign in (1, -1):
            axis = np.eye(3)[k % 3]
            scale = step if k < 3 else step / 25  # as far at the surface of the head
            motion = turned(axis, sign * scale, about=femur[:3, 3]) if k >= 3 else turned(axis, 0, sign * scale * axis)
            pressed = joint.press({"femur": motion @ femur}).contact()
            wrench.append(np.concatenate([pressed.force, pressed.moment]))
        found[:, k] = (wrench[0] - wrench[1]) / (2 * (step if k < 3 else step / 25))
    return found


# Law linear: the error of central differences falls with the square of the step, that of springs which come and go at the
# edge of contact with the step. Law layer: what of the target each foot covers is held in the derivative
# (docs/layer_law.md), which costs less than a hundredth.
@pytest.mark.parametrize("law, tolerance", [("linear", 1e-5), ("layer", 1e-2)])
def test_the_derivative_is_that_of_differences(hip, law, tolerance):
    joint = febiodea.prepare(febiodea.recognise(hip.model, law=law))
    state = joint.solve()
    femur = state.poses["femur"]  # its centre of mass is the origin of the file
    target = state.contact().target.body
    assert target == "femur"
    exact = joint.press(state).contact().derivative
    found = derivative_by_differences(joint, femur)
    length = np.array([1, 1, 1, 25, 25, 25])
    scale = np.abs(exact / np.outer(length, length)).max()
    assert np.abs((found - exact) / np.outer(length, length)).max() < tolerance * scale
    pressed = joint.press(state).contact()
    np.testing.assert_array_equal(pressed.stiffness, -pressed.derivative)
    assert np.linalg.eigvalsh((pressed.stiffness + pressed.stiffness.T)[:3, :3]).min() > 0


# docs/python.md: how far off each block is that takes what lies under a spring as fixed, of its norm
@pytest.mark.parametrize("refine, most", [(1, [0.005, 0.015, 0.017, 0.055]), (2, [0.005, 0.009, 0.016, 0.019])])
def test_stiffness_is_as_far_off_as_is_said(hip, refine, most):
    joint = febiodea.prepare(febiodea.recognise(hip.model, refine=refine))
    state = joint.solve()
    found = -derivative_by_differences(joint, state.poses["femur"])
    stiffness = joint.press(state).contact().stiffness
    blocks = [(rows, columns) for rows in (slice(0, 3), slice(3, 6)) for columns in (slice(0, 3), slice(3, 6))]
    off = [np.linalg.norm(stiffness[b] - found[b]) / np.linalg.norm(found[b]) for b in blocks]
    assert np.all(np.array(off) < most), off


@pytest.mark.parametrize("pose, found", [
    ({"femur": np.eye(3)}, "3 x 3"),
    ({"femur": np.diag([1.0, 1, -1, 1])}, "no rotation"),
    ({"femur": np.full((4, 4), np.nan)}, "not finite"),
    ({"femr": np.eye(4)}, 'did you mean "femur"'),
    ({"femur": "here"}, "no array"),
    ("here", "no poses"),
    (np.array(1.0), "no poses"),
    (np.zeros((2, 4, 4)), "2 poses"),
    (5, "no poses"),
])
def test_poses_that_are_none(joint, pose, found):
    with pytest.raises(febiodea.UsageError) as caught:
        joint.press(pose)
    assert found in caught.value.found and caught.value.expected


@pytest.mark.parametrize("keywords, place", [
    ({"force": (1, 2, 3)}, "force"), ({"moment": (1, 2, 3)}, "moment"), ({"about": (1, 2, 3)}, "about"),
    ({"body": "femr", "force": (0, 0, 1)}, "body"), ({"body": "femur", "force": (0, 1)}, "force"),
    ({"body": "femur", "force": (0, 0, np.inf)}, "force"), ({"rotate": [("femr", (0, 1, 0), 1)]}, "rotate"),
    ({"start": "there"}, "start"), ({"body": "femur"}, "body"), ({"body": "femur", "about": "sphere-center"}, "body"),
])
def test_loads_that_are_none(joint, keywords, place):
    with pytest.raises(febiodea.UsageError) as caught:
        joint.solve(**keywords)
    assert place in caught.value.place and caught.value.expected


def test_a_load_by_bodies_is_told_how_it_is_said(joint):
    with pytest.raises(febiodea.UsageError, match="found a dictionary, expected .*body="):
        joint.solve(force={"femur": (0, 0, 1)})


def test_a_misspelt_body_of_a_placing_is_told_as_one(joint):
    for keywords in ({"move": [("femurr", (0, 0, 1))]}, {"rotate": [("femurr", (0, 1, 0), 4)]}):
        with pytest.raises(febiodea.UsageError, match='"femurr".*no rigid body of this name .did you mean "femur"'):
            joint.solve(**keywords)


def test_a_load_that_nothing_carries_is_an_answer(joint):
    state = joint.solve(body="femur", force=(0, 0, -500))
    assert not state.solved and state.message and np.isfinite(state.poses["femur"]).all()


def test_loads_that_a_body_cannot_follow_are_refused(joint, hip):
    """The pelvis is held, and the femur does not turn: what is asked for would change nothing."""
    with pytest.raises(febiodea.UsageError, match='"pelvis" is not free to move along z') as caught:
        joint.solve(body="pelvis", force=(0, 0, -50))
    assert caught.value.place == "force" and 'free={"pelvis": ["x", "y", "z"]}' in caught.value.expected
    with pytest.raises(febiodea.UsageError, match="not free to turn about x") as caught:
        joint.solve(body="femur", moment=(50, 0, 0))
    assert caught.value.place == "moment" and '"z", "Ru", "Rv", "Rw"]' in caught.value.expected
    with pytest.warns(UserWarning, match="^moment: .*not free to turn about y at the end of the last step; these parts"):
        assert joint.solve(body="femur", force=(0, 0, 1500), moment=(0, 10, 0)).solved
    with pytest.warns(UserWarning, match="not free to move along x at"):
        joint.solve(body="femur", force=(100, 0, 1500), free={"femur": ["y", "z"]})
    held = febiodea.recognise(hip.model, force={"pelvis": (0, 0, -50)})
    for solve in (febiodea.analyse, lambda r: febiodea.prepare(r).solve()):
        with pytest.raises(febiodea.UsageError, match="no effect") as caught:
            solve(held)
        assert "pelvis" in caught.value.place
    partly = febiodea.analyse(febiodea.recognise(hip.model, force={"femur": (100, 0, 1500)}, free={"femur": ["y", "z"]}), "last")
    assert [f for f in partly.findings if "this part of the force has no effect" in f and f.startswith("warning: ")]


def test_loads_of_nothing_are_no_idle_ones(joint):
    assert joint.solve(body="pelvis", force=(0, 0, 0)).solved
