"""Inverse kinematics: the joints that reaches find, against closed forms and MuJoCo's own kinematics, and in a run."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from wsim.assets import assets_folder
from wsim.errors import UserError
from wsim.geometry.rotations import Floats, rotate
from wsim.intake.robot_read import read_robot
from wsim.intake.robot_write import write_robot
from wsim.scene import Scene, SceneError
from wsim.scene.check import check_stage
from wsim.scene.describe import describe
from wsim.scene.world import World
from wsim.sim import Simulation
from wsim.sim.arm import Arm
from wsim.sim.inverse import nearest
from wsim.sim.placed import coordinate
from wsim.sim.reaching import Track, tracks_of

DESK = assets_folder() / "robots" / "desk_arm.xml"
GRIP = (0.0, 0.0, 0.07)  # [m] between the fingers, in the hand's frame
DOWN = (180.0, 0.0, 90.0)
FIRST, SECOND = 0.3, 0.2  # [m], of the planar arm
PLANAR = f"""
<mujoco><compiler angle="degree"/><worldbody><body name="base"><geom size="0.02"/>
<body name="upper"><joint name="shoulder" axis="0 1 0" {{limits}}/><geom size="0.02" pos="{FIRST / 2} 0 0" mass="1"/>
<body name="lower" pos="{FIRST} 0 0"><joint name="elbow" axis="0 1 0"/>
<geom size="0.02" pos="{SECOND / 2} 0 0" mass="0.5"/></body></body></body></worldbody>
<actuator><position joint="shoulder" kp="200" kv="5"/>{{elbow}}</actuator></mujoco>
"""
SERVO = '<position joint="elbow" kp="100" kv="3"/>'


def planar(folder: Path, limits: str = "", elbow: str = SERVO) -> Path:
    """Two links that hinge about y, at the origin and at the first one's end."""
    file = folder / "planar.xml"
    file.write_text(PLANAR.format(limits=limits, elbow=elbow))
    made = folder / "planar.usda"
    write_robot(made, read_robot(file), file.name)
    return made


def solved(scene: Scene, name: str = "arm") -> dict[str, Track]:
    """The tracks that a scene's reaches give, by the joint's name."""
    world = describe(scene.stage)
    (tracks,) = tracks_of([world], [starts_of(world)], "cpu")
    return {prim.removeprefix(f"/World/{name}/joints/"): track for prim, track in tracks.items()}


def starts_of(world: World) -> dict[str, float]:
    bodies = {body.prim: body for body in world.bodies}
    return {j.prim: coordinate(j, bodies) for j in world.joints if j.kind in ("revolute", "prismatic")}


@pytest.mark.parametrize("elbow", [60.0, -60.0], ids=["down", "up"])
@pytest.mark.parametrize(("x", "z"), [(0.35, 0.1), (0.2, -0.3), (-0.1, 0.25), (0.12, 0.0)])
def test_a_planar_arm_stands_as_the_law_of_cosines_says(tmp_path: Path, elbow: float, x: float, z: float) -> None:
    """Two ways lead to a place; the one is found that is nearer to where the arm is."""
    scene, sign = Scene(), np.sign(elbow)
    bend = sign * np.arccos((x * x + z * z - FIRST**2 - SECOND**2) / (2.0 * FIRST * SECOND))
    # turning about +y takes +x to -z
    lift = -np.arctan2(z, x) - np.arctan2(SECOND * np.sin(bend), FIRST + SECOND * np.cos(bend))
    near = {"shoulder": np.degrees(lift) + 8.0, "elbow": np.degrees(bend) + 0.1 * elbow}
    arm = scene.robot("arm", planar(tmp_path), origin=True, joints=near)
    arm.reach("lower", position=(x, 0.0, z), point=(SECOND, 0.0, 0.0), by=1.0)
    found = solved(scene)
    ends = found["shoulder"].positions[-1], found["elbow"].positions[-1]
    assert ends == pytest.approx((lift, bend), abs=1e-4 / FIRST)
    at = FIRST * np.array([np.cos(ends[0]), -np.sin(ends[0])])
    at += SECOND * np.array([np.cos(sum(ends)), -np.sin(sum(ends))])
    assert at == pytest.approx((x, z), abs=1e-4)


@pytest.mark.parametrize(("place", "misses"), [((0.6, 0.0, 0.3), 0.6708204 - 0.5), ((0.03, 0.0, 0.04), 0.1 - 0.05)])
def test_what_is_out_of_reach_is_refused_with_what_is_left(tmp_path: Path, place: Any, misses: float) -> None:
    """Beyond both links' length, and nearer than their difference."""
    scene = Scene()
    arm = scene.robot("arm", planar(tmp_path), origin=True, joints={"shoulder": -20.0, "elbow": 30.0})
    arm.reach("lower", position=place, point=(SECOND, 0.0, 0.0), by=1.0)
    with pytest.raises(UserError, match="lower does not get to") as told:
        solved(scene)
    said = str(told.value)
    assert float(said.partition("misses by ")[2].partition(" mm")[0]) == pytest.approx(1e3 * misses, abs=0.5)
    assert "\n" not in said and "test_reaching.py:" in said and "deg" not in said


def test_an_angle_that_is_left_is_said(tmp_path: Path) -> None:
    scene = Scene()
    arm = scene.robot("arm", planar(tmp_path), origin=True, joints={"shoulder": -20.0, "elbow": 30.0})
    arm.reach("lower", position=(0.3, 0.0, 0.1), point=(SECOND, 0.0, 0.0), rotation_deg=(40.0, 0.0, 0.0), by=1.0)
    with pytest.raises(UserError, match=r"misses by [\d.]+ mm and [\d.]+ deg"):
        solved(scene)


def test_limits_are_kept_and_named(tmp_path: Path) -> None:
    scene = Scene()
    arm = scene.robot("arm", planar(tmp_path, 'range="-30 30"'), origin=True, joints={"elbow": 30.0})
    arm.reach("lower", position=(0.0, 0.0, 0.45), point=(SECOND, 0.0, 0.0), by=1.0)
    with pytest.raises(UserError, match="shoulder is at its limit"):
        solved(scene)


def desk_hand(q: Floats) -> tuple[Floats, Floats]:
    """Where MuJoCo has desk_arm's hand, from its own file: place (3,) and rotation (3, 3)."""
    model = mujoco.MjModel.from_xml_path(str(DESK))
    data = mujoco.MjData(model)
    data.qpos[: len(q)] = q
    mujoco.mj_kinematics(model, data)
    return data.body("hand").xpos.copy(), data.body("hand").xmat.reshape(3, 3).copy()


@pytest.fixture(scope="module")
def desk() -> Arm:
    scene = Scene()
    scene.robot("arm", "desk_arm")
    return Arm.to(describe(scene.stage), "/World/arm/hand")


@given(shares=st.lists(st.floats(0.0, 1.0), min_size=15, max_size=15), turned=st.booleans())
@settings(max_examples=12, deadline=None)
def test_the_desk_arm_reaches_whatever_its_joints_can_make(desk: Arm, shares: list[float], turned: bool) -> None:
    """To 1 mm and 0.5 degrees by MuJoCo's kinematics of the file, and within the limits."""
    wanted = desk.low + np.array(shares).reshape(3, 5) * (desk.high - desk.low)
    start = np.tile([0.0, -0.3, 1.6, 0.9, 0.0], (3, 1))
    q, _, _ = nearest(desk, np.zeros(3), start, desk.reach(wanted, np.zeros(3)), turned, "cpu")
    assert (q >= desk.low).all() and (q <= desk.high).all()
    for found, goal in zip(q, wanted, strict=True):
        (place, axes), (there, facing) = desk_hand(found), desk_hand(goal)
        assert np.linalg.norm(place - there) < 1e-3
        if turned:
            assert np.trace(axes.T @ facing) > 1.0 + 2.0 * np.cos(np.radians(0.5))


@given(shares=st.lists(st.floats(0.0, 1.0), min_size=5, max_size=5))
@settings(max_examples=20, deadline=None)
def test_what_holds_the_weight_is_what_mujoco_says(desk: Arm, shares: list[float]) -> None:
    """Against the bias force at rest; the fingers stand as in the key frame, 30 mm out."""
    q = desk.low + np.array(shares) * (desk.high - desk.low)
    model = mujoco.MjModel.from_xml_path(str(DESK))
    data = mujoco.MjData(model)
    data.qpos[:] = (*q, 0.03, 0.03)
    mujoco.mj_forward(model, data)
    assert desk.holding(q[None])[0] == pytest.approx(data.qfrc_bias[:5], abs=1e-5)


SQUARE = [(0.35, 0.1, 0.25), (0.35, -0.1, 0.25), (0.25, -0.1, 0.25), (0.25, 0.1, 0.25), (0.35, 0.1, 0.25)]


def test_a_square_is_followed(tmp_path: Path) -> None:
    """Corners are at their times to 2 mm, what lies between within 3 mm of the lines: what the servos lack is what
    accelerates the arm, which they are not told. At the end it rests to 0.05 mm."""
    scene = Scene()
    scene.simulation(duration=4.1, frame_rate=50.0)
    arm = scene.robot("arm", "desk_arm")
    arm.reach("hand", position=SQUARE[0], rotation_deg=DOWN, point=GRIP, by=1.0)
    times = [1.0, 1.8, 2.4, 3.2, 3.8]
    arm.follow("hand", path=SQUARE[1:], times=times[1:], rotation_deg=DOWN, point=GRIP)
    stage = scene.save(tmp_path / "stage.usda")
    assert check_stage(stage, [tmp_path]) == []
    simulation = Simulation(stage, device="cpu")
    row = [body.prim for body in simulation.world.bodies].index("/World/arm/hand")
    assert simulation.controlled and not simulation.facts()["steered"]
    track = []
    while simulation.time < 4.0:
        simulation.advance_frame()
        pose = simulation.state.body_q.numpy()[simulation.built.bodies[row]].astype(np.float64)
        track.append((simulation.time, *(pose[:3] + rotate(pose[3:], np.array(GRIP)))))
    seen = np.array(track)
    for time, corner in zip(times, SQUARE, strict=True):
        place = [np.interp(time, seen[:, 0], seen[:, k]) for k in (1, 2, 3)]
        assert np.linalg.norm(np.subtract(place, corner)) < 2e-3
    assert max(_off(each[1:]) for each in seen if each[0] > 1.0) < 3e-3
    assert np.linalg.norm(seen[-1, 1:] - SQUARE[-1]) < 5e-5
    assert simulation.problems() == []


def _off(point: Floats) -> float:
    """From the square's sides [m]."""
    sides = [(np.array(a), np.array(b) - np.array(a)) for a, b in pairwise(SQUARE)]
    return min(np.linalg.norm(point - a - np.clip((point - a) @ u / (u @ u), 0.0, 1.0) * u) for a, u in sides)


def test_joints_keep_the_point_on_the_line_between_way_points(desk: Arm) -> None:
    """The chords between what is solved for are off by a hundredth of a millimetre at most, and speed never jumps."""
    scene = Scene()
    arm = scene.robot("arm", "desk_arm")
    arm.reach("hand", position=SQUARE[0], rotation_deg=DOWN, point=GRIP, by=1.0)
    arm.follow("hand", path=SQUARE[1:3], times=[2.0, 2.5], rotation_deg=DOWN, point=GRIP)
    tracks = solved(scene)
    times = tracks["lift"].times
    every = np.linspace(1.0, 2.5, 2000)
    q = np.stack(
        [np.interp(every, times, tracks[name].positions) for name in ("pan", "lift", "elbow", "wrist", "roll")]
    )
    points = desk.out(desk.reach(q.T, np.array(GRIP))[0])
    assert max(_off(each) for each in points) < 1e-4
    rates = np.abs(np.diff(tracks["lift"].positions) / np.diff(times))
    assert rates[-1] < 0.1 * rates.max()  # it comes to rest


def test_worlds_of_a_batch_go_to_places_of_their_own(tmp_path: Path) -> None:
    stages = []
    for k, (x, turned) in enumerate(((0.3, 0.0), (0.36, 90.0))):
        scene = Scene()
        scene.simulation(duration=1.6, frame_rate=50.0)
        arm = scene.robot("arm", "desk_arm", yaw_deg=turned)
        place = (x, 0.1, 0.2) if turned == 0.0 else (-0.1, x, 0.2)
        arm.reach("hand", position=place, point=GRIP, by=1.0)
        stages.append(scene.save(tmp_path / f"stage_{k}.usda"))
    simulation = Simulation(stages, device="cpu")
    while simulation.time < 1.5:
        simulation.advance_frame()
    poses = simulation.state.body_q.numpy().reshape(2, -1, 7).astype(np.float64)
    row = [body.prim for body in simulation.world.bodies].index("/World/arm/hand")
    at = poses[:, simulation.built.bodies[row]]
    points = at[:, :3] + rotate(at[:, 3:], np.array(GRIP))
    assert points == pytest.approx(np.array([(0.3, 0.1, 0.2), (-0.1, 0.36, 0.2)]), abs=1e-3)


def test_a_joint_goes_by_its_schedule(tmp_path: Path) -> None:
    """The pan has no weight to hold: it is where it is to be to what its own acceleration takes, I q'' / k."""
    scene = Scene()
    scene.simulation(duration=1.5, frame_rate=100.0)
    arm = scene.robot("arm", "desk_arm", pose="upright")
    arm.drive("pan", times=(0.2, 1.0), positions=(0.0, 40.0))
    stage = scene.save(tmp_path / "stage.usda")
    assert check_stage(stage, [tmp_path]) == []
    simulation = Simulation(stage, device="cpu")
    k = [str(label) for label in simulation.model.joint_label].index("/World/arm/joints/pan")
    at = int(simulation.model.joint_q_start.numpy()[k])
    seen = []
    while simulation.time < 1.4:
        simulation.advance_frame()
        seen.append((simulation.time, float(simulation.state.joint_q.numpy()[at])))
    for time, angle in seen:
        share = np.clip((time - 0.2) / 0.8, 0.0, 1.0)
        assert angle == pytest.approx(np.radians(40.0) * share**2 * (3.0 - 2.0 * share), abs=np.radians(0.5))
    assert seen[-1][1] == pytest.approx(np.radians(40.0), abs=1e-4)


def test_what_cannot_reach_says_why(tmp_path: Path) -> None:
    def told(scene: Scene) -> str:
        with pytest.raises(UserError) as error:
            solved(scene)
        return str(error.value)

    def arm(**given: Any) -> tuple[Scene, Any]:
        scene = Scene()
        return scene, scene.robot("arm", "desk_arm", **given)

    scene, loose = arm(fixed=False)
    loose.reach("hand", position=(0.3, 0.0, 0.2), by=1.0)
    assert "hold the robot's base" in told(scene)
    scene, quick = arm()
    quick.reach("hand", position=(-0.3, 0.2, 0.3), point=GRIP, by=0.05)
    assert "deg/s" in told(scene) and "more time" in told(scene)
    scene = Scene()
    weak = scene.robot("arm", planar(tmp_path, elbow=""), origin=True)
    weak.reach("lower", position=(0.4, 0.0, 0.0), by=1.0)
    assert "elbow, on which it hangs, has no servo" in told(scene)
    scene, follows = arm()
    follows.reach("right_finger", position=(0.3, 0.0, 0.2), by=1.0)
    assert "right_finger, on which it hangs, follows another" in told(scene)


def test_a_joint_is_set_by_one_thing_alone(tmp_path: Path) -> None:
    scene = Scene()
    arm = scene.robot("arm", "desk_arm")
    arm.reach("hand", position=(0.3, 0.0, 0.2), by=1.0)
    arm.drive("elbow", times=(0.0, 1.0), positions=(90.0, 60.0))
    with pytest.raises(UserError, match="a reach moves it, and a schedule"):
        Simulation(scene.save(tmp_path / "stage.usda"), device="cpu")


@pytest.mark.parametrize(
    ("call", "said"),
    [
        (lambda arm: arm.reach("hnd", position=(0.3, 0, 0.2), by=1.0), 'did you mean "hand"'),
        (lambda arm: arm.reach("base", position=(0.3, 0, 0.2), by=1.0), "is held to the world"),
        (lambda arm: arm.follow("hand", path=[(0.3, 0, 0.2)], times=[1.0, 2.0]), "1 points and times 2"),
        (lambda arm: arm.follow("hand", path=[(0.3, 0, 0.2)] * 2, times=[2.0, 1.0]), "must rise"),
        (lambda arm: arm.reach("hand", position=(0.3, 0, float("nan")), by=1.0), "must be finite"),
        (lambda arm: arm.reach("hand", position=(0.3, 0, 0.2), by=0.0), "must be after 0 s"),
        (lambda arm: arm.drive("elbow", times=(0.0, 1.0), positions=(3.0,)), "2 entries and positions 1"),
        (lambda arm: arm.drive("elbow", times=(0.0, 1.0), positions=(3.0, 4.0), velocity=3.0), "one or the other"),
    ],
)
def test_a_wrong_call_is_refused(call: Any, said: str) -> None:
    arm = Scene().robot("arm", "desk_arm")
    with pytest.raises(SceneError, match=said):
        call(arm)


def test_a_reach_comes_after_the_one_before() -> None:
    scene = Scene()
    arm = scene.robot("arm", "desk_arm")
    arm.reach("hand", position=(0.3, 0.0, 0.2), by=1.0)
    arm.reach("hand", position=(0.3, 0.1, 0.2), by=2.0)
    assert [each.start for each in describe(scene.stage).reaches] == [0.0, 1.0]
    with pytest.raises(SceneError, match="before 2 s"):
        arm.reach("hand", position=(0.3, 0.0, 0.2), start=1.5, by=3.0)


@pytest.mark.parametrize(
    ("name", "value", "said"),
    [
        ("times", [2.0, 1.0], "they must rise"),
        ("start", 5.0, "before the first of times"),
        ("positions", [(0.0, 0.0, 1e9), (0.0, 0.0, 0.0)], "within 10000 m"),
        ("positions", [(0.0, 0.0, 0.0)], "2 are there, and 1 positions"),
    ],
)
def test_a_stage_with_a_wrong_reach_is_refused(tmp_path: Path, name: str, value: Any, said: str) -> None:
    scene = Scene()
    arm = scene.robot("arm", "desk_arm")
    arm.follow("hand", path=[(0.3, 0.0, 0.2), (0.3, 0.1, 0.2)], times=[1.0, 2.0])
    scene.stage.GetPrimAtPath("/World/arm/reaches/reach_0").GetAttribute(f"wsim:{name}").Set(value)
    assert any(said in problem for problem in check_stage(scene.save(tmp_path / "stage.usda"), [tmp_path]))
