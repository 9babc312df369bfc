"""Policies in the simulator: what they see, what they set, how they are told where to go."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from pxr import Usd, UsdPhysics
from scipy.spatial.transform import Rotation

from tests.assets import policies
from wsim.assets.folders import VARIABLE
from wsim.assets.policies import PolicySpec
from wsim.errors import UserError
from wsim.scene import Scene, SceneError, schema
from wsim.scene.check import check_stage
from wsim.scene.describe import describe
from wsim.scene.world import Policy, World
from wsim.sim import Simulation
from wsim.sim.alike import alike
from wsim.sim.commands import Commands
from wsim.sim.policies import axes
from wsim.sim.time_step import choose_time_step

JOINTS = ["pan", "lift"]
SEEN = [
    "linear_velocity", "angular_velocity", "gravity", "command", "joint_position", "joint_velocity", "last_action",
]  # fmt: skip
SIZE = 18


def spec(**changed: Any) -> dict[str, Any]:
    return {
        "joints": JOINTS, "rate": 50.0, "observations": [{"of": each} for each in SEEN],
        "stiffness": 30.0, "damping": 1.0, "command_limit": [1.0, 0.5, 1.5],
    } | changed  # fmt: skip


def stage(folder: Path, weight: np.ndarray, command: tuple = (0.5, 0.0, 0.0), name: str = "stage", **changed) -> Path:
    """An arm that nothing holds, turned by 90 degrees, floats without gravity's pull and is set by a matrix."""
    if not (folder / "policies" / "matrix").exists():
        policies.write(folder, "matrix", spec(**changed), policies.linear(weight))
    scene = Scene()
    scene.simulation(duration=0.1, frame_rate=50.0, time_step=0.002, gravity=(0.0, 0.0, -9.81))
    arm = scene.robot("arm", "desk_arm", position=(0.0, 0.0, 5.0), yaw_deg=90.0, fixed=False)
    scene.policy("steer", arm, "matrix", command=command)
    return scene.save(folder / f"{name}.usda")


@pytest.fixture
def own(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv(VARIABLE, str(tmp_path / "own"))
    (tmp_path / "own").mkdir()
    return tmp_path / "own"


def picked(row: int, gain: float = 1.0) -> np.ndarray:
    """Sets the first joint to one of the numbers that it sees."""
    weight = np.zeros((SIZE, 2))
    weight[row, 0] = gain
    return weight


def test_a_stage_says_its_policy(own: Path) -> None:
    path = stage(own, picked(6))
    assert check_stage(path, [own]) == []
    (policy,) = describe(path).policies
    assert policy.base == "/World/arm/base"
    assert policy.joints == [f"/World/arm/joints/{name}" for name in JOINTS]
    assert policy.spec == PolicySpec.model_validate(spec())
    assert policy.commands == [(0.5, 0.0, 0.0)]
    drives = {joint.prim: joint.drive for joint in describe(path).joints}
    assert drives[policy.joints[0]].stiffness == pytest.approx(30.0)
    assert check_stage(path, [own / "elsewhere"]) == [
        f"stage.usda: @{own}/policies/matrix/policy.onnx@ lies outside the folders that a stage may read"
    ]


def test_a_policy_of_an_instance_is_checked_as_it_is_read(own: Path) -> None:
    path = stage(own, picked(6))
    changed = Usd.Stage.Open(str(path))
    changed.CreateClassPrim("/kept")
    changed.DefinePrim("/kept/second", "Scope").AddAppliedSchema(schema.POLICY)
    held = changed.DefinePrim("/World/held", "Scope")
    held.GetReferences().AddInternalReference("/kept")
    held.SetInstanceable(True)
    changed.Save()
    said = check_stage(path, [own])
    assert len(said) == 1
    assert said[0].startswith("/World/held/second.wsim:description: Invalid JSON")


@pytest.mark.parametrize("kind", ["Scope", "PhysicsSphericalJoint"])
def test_a_policy_sets_joints_of_one_freedom_alone(own: Path, kind: str) -> None:
    path = stage(own, picked(6))
    changed = Usd.Stage.Open(str(path))
    other = changed.DefinePrim("/World/other", kind)
    UsdPhysics.DriveAPI.Apply(other, "linear")
    other.CreateRelationship("physics:body1").SetTargets(["/World/arm/base"])
    relation = changed.GetPrimAtPath("/World/steer").GetRelationship("wsim:joints")
    relation.SetTargets(["/World/other", *relation.GetTargets()[1:]])
    changed.Save()
    said = "is a Scope; it must be a joint" if kind == "Scope" else "is no revolute or prismatic joint"
    assert f"/World/steer.wsim:joints: </World/other> {said}" in check_stage(path, [own])


@pytest.mark.parametrize(
    ("row", "value"),
    [(8, -1.0), (9, 0.5), (12, "start")],  # gravity along z, the command, the joint itself
    ids=["gravity", "command", "joint"],
)
def test_a_target_is_what_the_network_makes_of_what_it_sees(own: Path, row: int, value: float | str) -> None:
    simulation = Simulation(stage(own, picked(row)), device="cpu")
    simulation.step()
    wanted = simulation.model.joint_q.numpy()[7] if value == "start" else value
    assert simulation.control.joint_target_q.numpy()[7] == pytest.approx(wanted, abs=1e-6)
    assert simulation.controlled and simulation.facts()["steered"] is False


def test_velocities_are_those_of_the_base_in_its_own_frame(own: Path) -> None:
    """It falls from rest: after 0.02 s its base goes down by g t in its own z, and along nothing else."""
    simulation = Simulation(stage(own, picked(2)), device="cpu")
    while simulation.time < 0.0205:  # the second turn is before the step that begins at 0.02 s
        simulation.step()
    fallen = simulation.control.joint_target_q.numpy()[7]
    assert fallen == pytest.approx(-9.81 * 0.02, rel=0.15)  # the arm's own motors move the base a little


def test_axes_of_a_frame_are_those_of_its_rotation() -> None:
    turns = Rotation.random(20, random_state=1)
    np.testing.assert_allclose(axes(turns.as_quat()), np.swapaxes(turns.as_matrix(), 1, 2), atol=1e-12)


def test_scales_offsets_and_limits(own: Path) -> None:
    observations = [{"of": "command", "scale": [2.0, 1.0, 1.0], "offset": 0.1}]
    weight = np.zeros((3, 2))
    weight[0] = 1.0, 100.0
    changed = {"observations": observations, "action_limit": 3.0, "action_scale": [1.0, 0.1], "action_offset": 0.05}
    simulation = Simulation(stage(own, weight, **changed), device="cpu")
    simulation.step()
    targets = simulation.control.joint_target_q.numpy()[7:9]
    np.testing.assert_allclose(targets, [0.05 + 2.0 * 0.4, 0.05 + 0.1 * 3.0], rtol=1e-6)


def test_worlds_that_differ_by_their_commands_are_one_batch(own: Path) -> None:
    stages = [stage(own, picked(9), (speed, 0.0, 0.0), f"stage_{k}") for k, speed in enumerate((0.2, 0.9))]
    assert len(alike([describe(path) for path in stages])) == 1
    simulation = Simulation(stages, device="cpu")
    simulation.step()
    targets = simulation.control.joint_target_q.numpy().reshape(2, -1)[:, 7]
    np.testing.assert_allclose(targets, [0.2, 0.9], rtol=1e-6)


def test_a_network_that_has_changed_is_refused(own: Path) -> None:
    path = stage(own, picked(6))
    (own / "policies" / "matrix" / "policy.onnx").write_bytes(policies.linear(picked(7)))
    with pytest.raises(UserError, match="has changed since the stage was made; build it again"):
        Simulation(path, device="cpu")


STILL = np.zeros((1, 3))


def commanded(route: tuple = (), speed: float = 0.0, **changed: Any) -> Commands:
    given = {"times": [0.0, 1.0], "commands": [(2.0, 0.0, 0.0), (0.0, 0.0, 1.0)]}
    policy = Policy(
        prim="/World/p", base="/World/b", joints=["/World/j"] * 2, network="", sha256="",
        route=list(route), speed=speed,
        spec=PolicySpec.model_validate(spec(**changed)), **given,
    )  # fmt: skip
    return Commands([policy])


def test_a_command_holds_from_its_time_on_within_its_limits() -> None:
    commands = commanded()
    np.testing.assert_allclose(commands.at(0.0, STILL, STILL), [[1.0, 0.0, 0.0]])
    np.testing.assert_allclose(commands.at(0.98, STILL, STILL), [[1.0, 0.0, 0.0]])
    np.testing.assert_allclose(commands.at(1.0, STILL, STILL), [[0.0, 0.0, 1.0]])


def test_a_command_comes_on_as_quickly_as_it_may() -> None:
    commands = commanded(command_slew=[2.5, 2.0, 5.0])
    speeds = [commands.at(0.02 * k, STILL, STILL)[0, 0] for k in range(25)]
    np.testing.assert_allclose(speeds[:3], [0.05, 0.10, 0.15])
    assert speeds[-1] == 1.0


def test_the_trim_adds_what_the_robot_lacks_up_to_its_limit() -> None:
    """It lacks 0.2 m/s: the sum grows by 1.5 x 0.2 a second once the smoothing has caught up."""
    commands = commanded(trim={"smoothing": 0.3, "gain": [1.5, 1.5, 2.0], "limit": [0.4, 0.3, 0.6]})
    measured = np.array([[0.8, 0.0, 0.0]])
    told = np.array([commands.at(0.0, measured, STILL)[0, 0] for _ in range(300)])
    assert told[-1] == pytest.approx(1.4)
    slow = commanded(trim={"smoothing": 0.3, "gain": [1.5, 1.5, 2.0], "limit": [9.0, 0.3, 0.6]})
    late = np.array([slow.at(0.0, measured, STILL)[0, 0] for _ in range(300)])
    assert (late[250] - late[200]) / 1.0 == pytest.approx(1.5 * 0.2, rel=0.01)


def test_a_route_is_gone_point_by_point_and_ends_at_the_last() -> None:
    """A robot that does what it is told at once: it never leaves the way by more than the nearness to a point."""
    quarter = np.pi / 2.0
    commands = commanded([(1.0, 0.0, 0.0), (1.0, 1.0, quarter), (0.0, 1.0, -quarter)], speed=0.4)
    where, passed = np.array([[0.0, 0.0, 0.0]]), []
    for _ in range(600):
        told = commands.at(0.0, STILL, where)[0]
        c, s = np.cos(where[0, 2]), np.sin(where[0, 2])
        where += 0.02 * np.array([[c * told[0] - s * told[1], s * told[0] + c * told[1], told[2]]])
        assert np.hypot(*told[:2]) <= 0.4 + 1e-9
        passed.append(where[0].copy())
    ends = np.array(passed)
    for point in ((1.0, 0.0), (1.0, 1.0), (0.0, 1.0)):
        assert np.linalg.norm(ends[:, :2] - point, axis=1).min() < 0.15
    np.testing.assert_allclose(ends[-1], [0.0, 1.0, -quarter], atol=0.01)


def test_a_robot_that_is_held_has_no_policy(own: Path) -> None:
    policies.write(own, "matrix", spec(), policies.linear(picked(9)))
    scene = Scene()
    arm = scene.robot("arm", "desk_arm")
    with pytest.raises(SceneError, match="has no one base that is free to move"):
        scene.policy("steer", arm, "matrix")
    assert not scene.stage.GetPrimAtPath("/World/steer")
    free = scene.robot("free", "desk_arm", position=(3.0, 0.0, 0.0), fixed=False)
    scene.policy("one", free, "matrix")
    with pytest.raises(SceneError, match='has the policy "one" already'):
        scene.policy("two", free, "matrix")


def test_headings_of_a_route_are_those_of_its_ways_unless_they_are_given(own: Path) -> None:
    policies.write(own, "matrix", spec(), policies.linear(picked(9)))
    scene = Scene()
    arm = scene.robot("arm", "desk_arm", position=(1.0, 1.0, 5.0), fixed=False)
    scene.policy("steer", arm, "matrix", route=((3.0, 1.0), (3.0, 2.0), (3.0, 5.0, -30.0)), speed=0.3)
    (policy,) = describe(scene.stage).policies
    assert policy.speed == 0.3
    np.testing.assert_allclose(
        policy.route, [(3.0, 1.0, 0.0), (3.0, 2.0, np.pi / 2.0), (3.0, 5.0, -np.pi / 6.0)], atol=1e-6
    )


def test_where_there_is_no_way_to_go_the_last_heading_is_kept(own: Path) -> None:
    """At first the base's own."""
    policies.write(own, "matrix", spec(), policies.linear(picked(9)))
    scene = Scene()
    arm = scene.robot("arm", "desk_arm", position=(1.0, 1.0, 5.0), yaw_deg=120.0, fixed=False)
    scene.policy("steer", arm, "matrix", route=((1.0, 1.0), (1.0, 3.0), (1.0, 3.0), (2.0, 3.0, -30.0), (2.0, 3.0)))
    (policy,) = describe(scene.stage).policies
    headings = np.degrees([point[2] for point in policy.route])
    np.testing.assert_allclose(headings, [120.0, 90.0, 90.0, -30.0, -30.0], atol=1e-4)


@pytest.mark.parametrize(
    ("changed", "said"),
    [
        ({"action_scale": [1.0]}, "action_scale has 1 numbers and needs 2"),
        ({"joints": ["pan", "pan"]}, "one is named twice"),
        ({"command_limit": [1.0]}, "command_limit has 1 numbers and needs 3"),
        ({"observations": [{"of": "gravity", "scale": [1.0]}]}, "gravity: scale has 1 numbers and needs 3"),
    ],
)
def test_a_description_that_does_not_fit_is_told(changed: dict[str, Any], said: str) -> None:
    with pytest.raises(ValueError, match=said):
        PolicySpec.model_validate(spec(**changed))


@pytest.mark.parametrize(
    ("frames", "rate", "steps"),
    [
        (50.0, 50.0, 16),  # a frame is an interval
        (30.0, 50.0, 30),  # 3/5 of a frame; 27 steps would make it 50.6 times a second
        (24.0, 50.0, 50),  # 12/25
        (60.0, 50.0, 15),  # 6/5
        (30.0, 200.0, 40),  # 3/20
        (30.0, 10.0, 27),  # three frames
        (29.97, 50.0, 30),  # 3/5 but for a thousandth
        (7.0, 59.0, 118),  # 7/59, of 115 steps
        (40.0, 59.0, 28),  # 40/59, of which 28 are 18.98
        (60.0, 1000.0, 17),  # 1020 times a second; by 14 it would be 840
    ],
)
def test_steps_are_such_that_policies_keep_their_rate(own: Path, frames: float, rate: float, steps: int) -> None:
    policies.write(own, "matrix", spec(rate=rate), policies.linear(np.zeros((SIZE, 2))))
    scene = Scene()
    scene.simulation(duration=1.0, frame_rate=frames, gravity=(0.0, 0.0, 0.0))
    arm = scene.robot("arm", "desk_arm", position=(0.0, 0.0, 5.0), fixed=False)
    scene.policy("steer", arm, "matrix")
    chosen = choose_time_step(describe(scene.save(own / "stage.usda")), None)
    assert (chosen.substeps, chosen.reason) == (steps, "rigid bodies")


def test_steps_are_such_that_sensors_and_policies_keep_their_rates(own: Path) -> None:
    policies.write(own, "matrix", spec(), policies.linear(np.zeros((SIZE, 2))))
    scene = Scene()
    scene.simulation(duration=1.0, frame_rate=30.0, gravity=(0.0, 0.0, 0.0))
    arm = scene.robot("arm", "desk_arm", position=(0.0, 0.0, 5.0), fixed=False)
    scene.policy("steer", arm, "matrix")
    scene.sensor_imu("imu", scene.box("box", size=(0.1, 0.1, 0.1), mass=1.0, position=(2.0, 0.0, 1.0)), rate=400.0)
    assert choose_time_step(describe(scene.save(own / "stage.usda")), None).substeps == 40  # 3/5 of a frame, and 3/40


def test_a_world_without_a_policy_has_none() -> None:
    assert World().policies == []
