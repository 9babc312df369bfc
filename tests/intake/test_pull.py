"""A robot of a wheel becomes one that programs place by its name."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import mujoco
import numpy as np
import pytest
from pxr import UsdPhysics

from tests.assets import wheels
from tests.intake.go2 import go2
from wsim.assets import AssetError
from wsim.assets import sources as pinned
from wsim.assets.folders import VARIABLE
from wsim.assets.robots import missing, robots
from wsim.assets.sources import source
from wsim.assets.wheels import fetch
from wsim.intake.model import IntakeError
from wsim.intake.pull import complete, pull
from wsim.intake.robots import TakenIn
from wsim.plan.store import load
from wsim.recording.reader import read
from wsim.runs.iteration import Iteration
from wsim.runs.settings import Settings
from wsim.scene import Scene, SceneError
from wsim.scene.describe import describe

__all__ = ["go2"]

PROGRAM = """from wsim.scene import Scene


def build(scene: Scene) -> None:
    scene.ground()
    scene.robot("stand_in")
"""

STANDS = """from wsim.scene import Scene


def build(scene: Scene) -> None:
    scene.simulation(duration=2.0, frame_rate=50.0)
    scene.ground()
    scene.robot("go2")
"""

WALKS = """from wsim.scene import Scene


def build(scene: Scene) -> None:
    scene.simulation(duration=5.0, frame_rate=50.0)
    scene.ground()
    dog = scene.robot("go2")
    scene.policy("walk", dog, "go2_walk", command=(0.5, 0.0, 0.0))
"""


@pytest.fixture
def stand_in(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """A source whose wheel lies in a folder."""
    monkeypatch.setenv(VARIABLE, str(tmp_path / "own"))
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    wheels.pip_finds(tmp_path / "shelf", monkeypatch)
    sha256 = wheels.write(tmp_path / "shelf")
    file = tmp_path / "sources.toml"
    file.write_text(wheels.SOURCE.format(package=wheels.PACKAGE, version=wheels.VERSION, sha256=sha256))
    monkeypatch.setattr(pinned, "_FILE", file)
    pinned.sources.cache_clear()
    yield
    pinned.sources.cache_clear()


def test_a_pulled_robot_has_the_gains_and_the_pose_of_its_source(stand_in: None) -> None:
    with pytest.raises(SceneError, match="'stand_in' is not on this machine yet; `wsim assets pull stand_in` gets it"):
        Scene().robot("stand_in")
    made = pull("stand_in")
    assert robots()["stand_in"] == made.path
    assert made.path.with_name("stand_in.license.txt").read_text().endswith("Do as you like.")
    scene = Scene()
    robot = scene.robot("stand_in")
    prim = scene.stage.GetPrimAtPath("/World/stand_in/joints/left_hinge")
    drive = UsdPhysics.DriveAPI(prim, "angular")
    per_radian = 180.0 / 3.141592653589793
    assert drive.GetStiffnessAttr().Get() * per_radian == pytest.approx(20.0)
    assert drive.GetDampingAttr().Get() * per_radian == pytest.approx(0.6)  # with that of the file's joint
    assert drive.GetMaxForceAttr().Get() == 4.0
    assert drive.GetTargetPositionAttr().Get() == pytest.approx(0.5 * per_radian)
    assert made.robot.poses == {"home": {"left_hinge": 0.5}, "file_home": {"left_hinge": 0.2}}
    assert "from stand-in-robot 1.2, MIT" in robot.notes
    assert "not carried: friction against rolling and spinning (condim above 3)" in robot.notes


def test_a_program_that_names_it_pulls_it_and_says_so(stand_in: None, tmp_path: Path) -> None:
    (tmp_path / "program.py").write_text(PROGRAM)
    said: list[str] = []
    made = Iteration(tmp_path, progress=lambda stage, done, total: said.append(stage))
    assert missing(PROGRAM) == ["stand_in"]
    assert made.build().ok
    assert said[0] == "pulling stand_in (stand-in-robot 1.2, MIT)"
    assert missing(PROGRAM) == []


def test_a_robot_of_ones_own_of_that_name_is_kept(stand_in: None, tmp_path: Path) -> None:
    """No run takes its place, nor `wsim assets pull` where nobody says so."""
    own = pull("stand_in").path
    own.write_bytes(own.read_bytes() + b"my own")
    assert missing(PROGRAM) == []
    complete("stand_in")
    with pytest.raises(IntakeError, match="'stand_in' is there already; --replace takes its place"):
        pull("stand_in")
    assert own.read_bytes().endswith(b"my own")
    assert not pull("stand_in", replace=True).path.read_bytes().endswith(b"my own")


def test_without_a_wheel_a_run_ends_in_one_line(
    stand_in: None, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("PIP_FIND_LINKS", str(tmp_path / "nowhere"))
    (tmp_path / "program.py").write_text(PROGRAM)
    with pytest.raises(AssetError, match=r"stand-in-robot 1.2 could not be fetched"):
        Iteration(tmp_path).build()


def test_the_real_wheel_of_the_go2(go2: TakenIn) -> None:
    assert len(go2.robot.links) == 13
    assert sum(link.mass for link in go2.robot.links) == pytest.approx(15.206, abs=1e-3)
    efforts = {joint.name: joint.effort for joint in go2.robot.joints}
    assert (efforts["FL_hip_joint"], efforts["FL_thigh_joint"], efforts["FL_calf_joint"]) == (23.7, 23.7, 45.43)
    assert {joint.motor.stiffness for joint in go2.robot.joints if joint.motor} == {20.0}
    assert "Unitree Robotics" in go2.path.with_name("go2.license.txt").read_text()
    left_out = " ".join(note for note in go2.robot.notes if note.startswith("not carried"))
    assert all(what in left_out for what in ("solimp", "condim above 3", "condim 1", "impratio"))


def test_the_go2_stands_by_its_servos_as_in_mujoco(go2: TakenIn, tmp_path: Path) -> None:
    """Under 37 N a leg its soft servos give by some 0.3 rad: it sinks by 10 cm and leans back, and is accepted.

    The same file and gains in MuJoCo end likewise; dry friction of 0.2 N m at 20 N m/rad leaves each joint 0.01 rad.
    """
    (tmp_path / "program.py").write_text(STANDS)
    iteration = Iteration(tmp_path, settings=Settings(device="cpu", pictures=False))
    verdict = iteration.run()
    assert verdict.status == "accepted", verdict.summary
    recording = read(iteration.recording)
    base = [body.prim for body in recording.world.bodies].index("/World/go2/base")
    start, end = recording.body_q[0, base, :3], recording.body_q[-1, base, :3]
    ahead, up = mujoco_stands(float(start[2]))
    assert (end[0], end[2]) == (pytest.approx(ahead, abs=0.03), pytest.approx(up, abs=0.012))
    assert abs(end[1]) < 1e-3


def mujoco_stands(height: float) -> tuple[float, float]:
    """Where MuJoCo has its base after 2 s, x and z [m], if it starts at that height."""
    spec = mujoco.MjSpec.from_file(str(fetch(source("go2")) / source("go2").robot))
    spec.worldbody.add_geom(type=mujoco.mjtGeom.mjGEOM_PLANE, size=[0.0, 0.0, 0.1])
    model = spec.compile()
    model.opt.timestep = 0.0025
    data = mujoco.MjData(model)
    home = np.tile([0.0, 0.8, -1.5], 4)
    data.qpos[2], data.qpos[7:] = height, home
    for _ in range(800):
        data.ctrl[:] = 20.0 * (home - data.qpos[7:]) - 0.5 * data.qvel[6:]
        mujoco.mj_step(model, data)
    return float(data.qpos[0]), float(data.qpos[2])


def test_the_go2_walks_as_fast_as_it_is_told(go2: TakenIn, tmp_path: Path) -> None:
    """0.5 m/s for 5 s on flat ground: within 10 % once it is under way, straight and upright, and accepted."""
    (tmp_path / "program.py").write_text(WALKS)
    iteration = Iteration(tmp_path, settings=Settings(device="cpu", pictures=False))
    verdict = iteration.run()
    assert verdict.status == "accepted", verdict.summary
    recording = read(iteration.recording)
    base = [body.prim for body in recording.world.bodies].index("/World/go2/base")
    pose, time = recording.body_q[:, base], recording.time
    late = time >= 2.0
    speed = (pose[-1, 0] - pose[late][0, 0]) / (time[-1] - time[late][0])
    assert speed == pytest.approx(0.5, rel=0.1)
    assert abs(pose[-1, 1]) < 0.1
    assert (1.0 - 2.0 * (pose[:, 3] ** 2 + pose[:, 4] ** 2)).min() > 0.95  # how far its own z points up
    assert pose[late, 2] == pytest.approx(0.32, abs=0.03)
    assert (go2.path.parents[1] / "policies" / "go2_walk" / "LICENSE").read_text().count("Apache License") >= 1


def test_the_example_of_a_route_builds(go2: TakenIn, tmp_path: Path) -> None:
    program = Path(__file__).parents[2] / "examples" / "robots" / "go2_route.py"
    iteration = Iteration.of(program, tmp_path)
    assert iteration.build().ok
    (policy,) = describe(iteration.stage).policies
    assert [each[:2] for each in policy.route] == [(1.6, 0.0), (1.6, 1.6), (0.0, 1.6)]


def test_the_example_of_an_office_builds_what_its_plan_has(go2: TakenIn, tmp_path: Path) -> None:
    """Its objects are the plan's, and its route is; that the walk is accepted takes minutes: docs/robots.md."""
    examples = Path(__file__).parents[2] / "examples"
    plan = load(examples / "plans" / "go2_office.json")
    iteration = Iteration.of(examples / "robots" / "office_patrol.py", tmp_path, plan)
    assert iteration.build().ok
    world = describe(iteration.stage)
    made = {each.prim.split("/")[2] for each in (*world.bodies, *world.statics)}
    assert made == {item.name for item in plan.objects}
    (walk,) = plan.object("go2").registration.actuation
    (policy,) = world.policies
    assert [each[:2] for each in policy.route] == [point[:2] for point in walk.route]
    assert policy.speed == walk.speed
    assert sum(item.primitive == "asset" for item in plan.objects) == 26
