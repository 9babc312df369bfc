"""Someone else's simulations: MuJoCo runs of its own, judged from arrays and names."""

from __future__ import annotations

import json
import re
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
import pytest
from typer.testing import CliRunner

from tests.documents import ROOT, commands
from tests.patience import STUCK
from wsim.cli import app
from wsim.errors import UserError
from wsim.geometry.rotations import rotate
from wsim.importers import read_npz
from wsim.importers.mujoco_model import world_of
from wsim.importers.trajectory import save
from wsim.judge import judge
from wsim.judge.checks.stated import CheckPath
from wsim.judge.evidence.evidence import Evidence
from wsim.recording import Recording, read

NAMES = ["brick", "ball", "arm"]
SCENE = """\
<mujoco model="scene">
  <option timestep="0.001" gravity="0 0 -9.81" integrator="implicitfast"/>
  <default><geom solref="0.004 1"/></default>
  <worldbody>
    <geom name="ground" type="plane" size="0 0 1" friction="0.6"/>
    <body name="plate" pos="3 0 0.1"><geom name="slab" type="box" size="0.3 0.2 0.1" quat="0 0 0 1"/></body>
    <body name="brick" pos="0 0 0.06"><freejoint/><geom type="box" size="0.1 0.08 0.06" density="800"/></body>
    <body name="ball" pos="1 0 1.2"><freejoint/><geom type="sphere" size="0.1" density="900"/></body>
    <body name="arm" pos="-2 0 1.5">
      <joint name="hinge" type="hinge" axis="0 1 0" pos="0 0 0.25" limited="true" range="-120 120"/>
      <geom type="capsule" size="0.03 0.2" density="1000"/>
    </body>
  </worldbody>
</mujoco>
"""


def simulate(gravity: float = 9.81, seconds: float = 1.5, rate: int = 100) -> dict[str, np.ndarray]:
    """SCENE in MuJoCo's own stepper, as `qpos`, `qvel` and `xpos`, `xquat` at `rate` frames a second."""
    model = mujoco.MjModel.from_xml_string(SCENE)
    model.opt.gravity[2] = -gravity
    data = mujoco.MjData(model)
    data.joint("hinge").qpos[0] = 0.5
    frames: dict[str, list[Any]] = {name: [] for name in ("time", "qpos", "qvel", "xpos", "xquat")}
    every = round(1.0 / rate / model.opt.timestep)
    for step in range(round(seconds / model.opt.timestep) + 1):
        if step % every == 0:
            mujoco.mj_kinematics(model, data)
            for name, values in frames.items():
                values.append(np.copy(getattr(data, name)))
        mujoco.mj_step(model, data)
    return {name: np.array(values) for name, values in frames.items()}


@pytest.fixture(scope="module")
def model(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("model") / "scene.xml"
    path.write_text(SCENE)
    return path


@pytest.fixture(scope="module")
def run() -> dict[str, np.ndarray]:
    return simulate()


@pytest.fixture
def recording(tmp_path: Path, model: Path) -> Callable[..., Recording]:
    """Arrays through a file."""

    def one(**arrays: Any) -> Recording:
        np.savez(tmp_path / "run.npz", **arrays)
        return read_npz(tmp_path / "run.npz", model)

    return one


def states(run: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    return {name: run[name] for name in ("time", "qpos", "qvel")}


def failed(recording: Recording) -> set[str]:
    return {finding.check for finding in judge(recording).failures}


def test_a_sound_simulation_is_accepted(recording, run) -> None:
    verdict = judge(recording(**states(run)))
    assert verdict.status == "accepted", verdict.summary


def test_gravity_that_is_not_the_models_is_rejected(recording) -> None:
    weak = recording(**states(simulate(gravity=0.8 * 9.81)))
    assert "CheckFreeFlight" in failed(weak)


def test_a_teleport_of_one_frame_is_rejected(recording, run) -> None:
    arrays = {name: np.copy(array) for name, array in states(run).items()}
    arrays["qpos"][100, 0] += 0.4  # the brick, 0.4 m aside and back
    verdict = judge(recording(**arrays))
    assert verdict.status == "rejected"
    assert any(f.prim == "/World/brick" and abs((f.time or 0.0) - 1.0) < 0.02 for f in verdict.failures)


def test_the_model_is_what_mujoco_compiled(model) -> None:
    world, compiled = world_of(model), mujoco.MjModel.from_xml_path(str(model))
    assert [body.prim for body in world.bodies] == ["/World/brick", "/World/ball", "/World/arm"]
    assert {static.prim: static.shapes[0].kind for static in world.statics} == {
        "/World/ground": "plane",
        "/World/plate": "box",  # no joint lets it move
    }
    brick, ball, arm = world.bodies
    assert brick.mass == pytest.approx(800.0 * 0.2 * 0.16 * 0.12)
    assert brick.shapes[0].size == pytest.approx((0.2, 0.16, 0.12))
    assert np.array(brick.inertia).reshape(3, 3) == pytest.approx(
        np.diag([brick.mass / 12 * (y * y + z * z) for y, z in ((0.16, 0.12), (0.2, 0.12), (0.2, 0.16))])
    )
    assert ball.shapes[0].size == (0.1,)
    assert arm.shapes[0].size == pytest.approx((0.03, 0.4))
    assert arm.volume == pytest.approx(float(compiled.body("arm").mass[0]) / 1000.0, rel=0.02)
    (hinge,) = world.joints
    assert (hinge.kind, hinge.parent, hinge.child) == ("revolute", None, "/World/arm")
    assert hinge.parent_anchor == pytest.approx((-2.0, 0.0, 1.75))
    assert hinge.child_anchor == pytest.approx((0.0, 0.0, 0.25))
    for turn in (hinge.parent_turn, hinge.child_turn):
        assert rotate(np.array(turn), np.array([1.0, 0.0, 0.0])) == pytest.approx([0.0, 1.0, 0.0])
    assert (hinge.low, hinge.high) == pytest.approx((-2.0944, 2.0944), abs=1e-4)
    assert world.gravity == (0.0, 0.0, -9.81)


def test_quaternions_are_read_in_their_makers_order(tmp_path: Path) -> None:
    """A rotation with four different components: the corner of a brick must be where MuJoCo has it."""
    xml = tmp_path / "turned.xml"
    xml.write_text(
        '<mujoco><worldbody><body name="brick" pos="1 2 3" quat="0.1 0.5 -0.3 0.8"><freejoint/>'
        '<geom type="box" size="0.3 0.2 0.1" pos="0.05 0 0" euler="20 30 40"/></body></worldbody></mujoco>'
    )
    compiled = mujoco.MjModel.from_xml_path(str(xml))
    data = mujoco.MjData(compiled)
    mujoco.mj_kinematics(compiled, data)
    corner = data.geom_xpos[0] + data.geom_xmat[0].reshape(3, 3) @ np.array([0.3, 0.2, 0.1])

    time, wxyz = np.array([0.0, 0.1]), np.tile(data.xquat[1], (2, 1, 1))
    place = np.tile(data.xpos[1], (2, 1, 1))
    newton = np.concatenate([place, wxyz[..., [1, 2, 3, 0]]], axis=-1)
    forms: list[dict[str, Any]] = [
        {"xpos": place, "xquat": wxyz, "body_names": ["brick"]},
        {"body_q": newton, "body_names": ["/World/envs/env_0/brick"]},
        {"qpos": np.tile(data.qpos, (2, 1)), "qvel": np.zeros((2, 6))},
    ]
    for arrays in forms:
        np.savez(tmp_path / "run.npz", time=time, **arrays)
        recording = read_npz(tmp_path / "run.npz", xml)
        (shape,) = recording.world.bodies[0].shapes
        local = rotate(np.array(shape.rotation), np.array(shape.size) / 2) + np.array(shape.position)
        found = rotate(recording.body_q[0, 0, 3:].astype(float), local) + recording.body_q[0, 0, :3]
        assert found == pytest.approx(corner, abs=1e-6)


def test_velocities_are_those_of_the_centre_of_mass_in_the_worlds_frame(tmp_path: Path) -> None:
    """A body whose origin is not its centre of mass, thrown and spinning: from states, and from poses alone."""
    xml = tmp_path / "thrown.xml"
    xml.write_text(
        '<mujoco><option timestep="0.0005"/><worldbody><body name="club" pos="0 0 5" quat="0.1 0.5 -0.3 0.8">'
        '<freejoint/><geom type="box" size="0.2 0.1 0.05" pos="0.4 0.1 0"/></body></worldbody></mujoco>'
    )
    compiled = mujoco.MjModel.from_xml_path(str(xml))
    data = mujoco.MjData(compiled)
    data.qvel[:] = [1.0, 2.0, 3.0, 0.7, -0.4, 1.1]
    rows: dict[str, list[np.ndarray]] = {"qpos": [], "qvel": [], "xpos": [], "xquat": []}
    mujoco.mj_forward(compiled, data)
    for step in range(401):
        if step % 10 == 0:
            mujoco.mj_forward(compiled, data)
            for name, values in rows.items():
                array = getattr(data, name)
                values.append(np.copy(array[1:] if name.startswith("x") else array))
        mujoco.mj_step(compiled, data)
    time = np.arange(41) * 0.005
    np.savez(tmp_path / "a.npz", time=time, qpos=rows["qpos"], qvel=rows["qvel"])
    np.savez(tmp_path / "b.npz", time=time, body_names=["club"], xpos=rows["xpos"], xquat=rows["xquat"])
    own, derived = (read_npz(tmp_path / name, xml) for name in ("a.npz", "b.npz"))
    assert (own.metadata["velocities"], derived.metadata["velocities"]) == ("own", "differences")
    fall = own.velocity("/World/club")
    assert fall[:, 2] == pytest.approx(
        fall[0, 2] - 9.81 * time, abs=0.01
    )  # of the centre of mass, and of no other point
    assert np.ptp(fall[:, :2], axis=0) == pytest.approx(0.0, abs=0.01)
    assert derived.body_qd[1:-1] == pytest.approx(own.body_qd[1:-1], abs=0.02)


@pytest.mark.parametrize(
    ("arrays", "told"),
    [
        ({"xpos": np.zeros((2, 3, 3))}, "no array time"),
        ({"time": [0.0, 1.0], "body_names": NAMES}, "no poses"),
        ({"time": [0.0, 1.0], "body_names": ["brick"], "body_q": np.zeros((2, 1, 7))}, "/World/ball, /World/arm"),
        ({"time": [0.0, 0.0], "body_names": ["brick"]}, "increasing"),
        ({"time": [0.0, 1.0], "body_names": NAMES, "body_q": np.zeros((2, 2, 7))}, r"must be \(2, 3, 7\)"),
        ({"time": [0.0, 1.0], "qpos": np.zeros((2, 3)), "qvel": np.zeros((2, 3))}, r"needs \(2, 15\)"),
    ],
)
def test_what_does_not_fit_is_named(recording, arrays, told: str) -> None:
    with pytest.raises(UserError, match=told):
        recording(**arrays)


LED = """\
<mujoco><worldbody>
  <body name="table" mocap="true" pos="0 0 1"><geom type="cylinder" size="0.5 0.05"/></body></worldbody>
</mujoco>"""


@pytest.mark.parametrize(("stated", "failed"), [(1.5, False), (1.35, True), (0.0, False)])
def test_a_turntable_keeps_the_velocity_that_its_world_states(tmp_path: Path, stated: float, failed: bool) -> None:
    """A tenth slower than it goes is found; what states none is led by a script."""
    time, rate = np.arange(61) / 60.0, 1.5
    turned = np.zeros((61, 1, 7))
    turned[:, 0, 2], turned[:, 0, 5], turned[:, 0, 6] = 1.0, np.sin(0.5 * rate * time), np.cos(0.5 * rate * time)
    qd = np.zeros((61, 1, 6))
    qd[..., 5] = rate
    (tmp_path / "table.xml").write_text(LED)
    world = world_of(tmp_path / "table.xml")
    table = world.bodies[0].model_copy(update={"angular_velocity": (0.0, 0.0, stated)})
    world = world.model_copy(update={"bodies": [table]})
    arrays = {"time": time, "body_names": np.array([table.prim]), "body_q": turned, "body_qd": qd,
              "world": np.array(world.model_dump_json())}  # fmt: skip
    np.savez(tmp_path / "table.npz", **arrays)
    found = CheckPath().run(Evidence(read_npz(tmp_path / "table.npz", None)))
    assert any(not finding.passed for finding in found) == failed


def test_a_file_that_is_none_and_a_model_that_is_missing_are_said(tmp_path: Path, run) -> None:
    (tmp_path / "x.npz").write_text("no")
    with pytest.raises(UserError, match="cannot be read"):
        read_npz(tmp_path / "x.npz")
    np.savez(tmp_path / "y.npz", time=run["time"], body_names=["brick"], xpos=run["xpos"], xquat=run["xquat"])
    with pytest.raises(UserError, match="--model"):
        read_npz(tmp_path / "y.npz")


def test_the_command_judges_a_trajectory_and_keeps_it_as_a_recording(tmp_path: Path, model: Path, run) -> None:
    np.savez(tmp_path / "run.npz", **states(run))
    command = [sys.executable, "-m", "wsim.cli", "judge", "run.npz", "--model", str(model), "--json", "--save", "r.rrd"]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, timeout=STUCK, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    assert json.loads(done.stdout)["status"] == "accepted"
    written, imported = read(tmp_path / "r.rrd"), read_npz(tmp_path / "run.npz", model)
    assert np.array_equal(written.body_q, imported.body_q)
    assert written.world == imported.world


def test_the_readmes_trajectory_shows_the_gravity_that_it_had(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Its command, of a run under 7.85 m/s^2 of a model with 9.81, and the two lines that it says of it."""
    (tmp_path / "scene.xml").write_text(SCENE)
    np.savez(tmp_path / "run.npz", **states(simulate(gravity=7.85)))
    (command,) = (one for one in commands(ROOT / "README.md") if one.words[0] == "judge")
    said = (ROOT / "README.md").read_text(encoding="utf-8")
    lines = re.search(r"^    (✗ CheckFreeFlight: .*)\n    +(→ .*)$", said, re.MULTILINE)
    monkeypatch.chdir(tmp_path)
    done = CliRunner().invoke(app, command.words)
    assert done.exit_code == 1, done.output
    assert all(line in done.output for line in lines.groups()), done.output


def test_an_imported_recording_is_written_and_read_back_the_same(tmp_path: Path, recording, run) -> None:
    imported = recording(**states(run))
    written = read(save(imported, tmp_path / "out.rrd"))
    assert written.complete
    assert written.body_qd.tobytes() == imported.body_qd.tobytes()
