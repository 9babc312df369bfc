"""Robots taken in from MJCF and URDF, against MuJoCo's own model of the same file."""

from __future__ import annotations

import math
from pathlib import Path

import mujoco
import numpy as np
import pytest

from wsim.intake import IntakeError
from wsim.intake.robots import take_in
from wsim.scene import Scene, SceneError
from wsim.scene.check import check_stage
from wsim.scene.describe import describe
from wsim.sim import Simulation

# Anything that is to be carried is in it: a base that stands, an offset reference, springs, dampers, rotors, friction,
# a servo, a motor, a joint that follows, masks, a ball of several joints, what is seen apart from what collides.
ARM = """\
<mujoco><option timestep="0.0005"/><compiler angle="radian"/>
<worldbody><geom type="plane" size="1 1 1"/>
  <body name="base" pos="0 0 0.5"><geom type="box" size="0.05 0.05 0.05" mass="1" contype="0" conaffinity="1"/>
    <geom name="shell" type="cylinder" size="0.08 0.01" contype="0" conaffinity="0" mass="0" group="2"/>
    <body name="upper" pos="0 0 0.1" euler="0 0.3 0">
      <joint name="shoulder-pan" axis="0 0 1" damping="0.1" armature="0.02" range="-2 2"/>
      <joint name="shoulder" axis="0 1 0" ref="0.3" range="-1 2.5" frictionloss="0.05"/>
      <geom type="capsule" fromto="0 0 0 0.3 0 0.1" size="0.03" mass="1.5" contype="0" conaffinity="1"/>
      <body name="lower" pos="0.3 0 0.1"><joint name="elbow" axis="0 1 0" damping="0.05" stiffness="2" springref="0.4"/>
        <geom type="ellipsoid" pos="0.15 0 0" size="0.15 0.03 0.02" mass="0.8" contype="0" conaffinity="1"/>
        <body name="left" pos="0.3 0.02 0"><joint name="left" type="slide" axis="0 1 0" range="0 0.04"/>
          <geom type="box" size="0.03 0.005 0.01" mass="0.05"/></body>
        <body name="right" pos="0.3 -0.02 0"><joint name="right" type="slide" axis="0 -1 0" range="0 0.04"/>
          <geom type="box" size="0.03 0.005 0.01" mass="0.05"/></body>
      </body>
    </body>
  </body>
</worldbody>
<equality><joint joint1="right" joint2="left" polycoef="0 1 0 0 0"/></equality>
<actuator><position name="servo" joint="elbow" kp="30" kv="1" forcerange="-40 40"/>
  <motor name="pan" joint="shoulder-pan" gear="3" ctrlrange="-2 2"/></actuator>
<keyframe><key name="reach" qpos="0.2 0.5 -0.6 0.01 0.01"/></keyframe>
</mujoco>
"""
PENDULUM = """\
<mujoco><option timestep="0.0002" integrator="RK4"/><worldbody>
  <body name="stand" pos="0 0 2"><geom size="0.02" mass="1"/>
    <body name="one"><joint name="one" axis="0 1 0" damping="0.02" armature="0.01"/>
      <geom type="capsule" fromto="0 0 0 0.5 0 0" size="0.02" mass="1"/>
      <body name="two" pos="0.5 0 0"><joint name="two_x" axis="1 0 0"/><joint name="two_y" axis="0 1 0"/>
        <geom type="box" pos="0.2 0.05 0" size="0.2 0.05 0.02" mass="0.7"/></body></body></body>
</worldbody></mujoco>
"""
TABLE = """\
<mujoco><option timestep="0.0005"/><worldbody><geom type="plane" size="1 1 1" solref="0.002 1"/>
  <body name="top" pos="0 0 0.4"><freejoint/><geom type="box" size="0.3 0.3 0.03" mass="6"/>{legs}</body>
</worldbody><actuator>{servos}</actuator></mujoco>
"""
LEG = """<body name="leg{k}" pos="{x} {y} -0.2"><joint name="leg{k}" type="slide" axis="0 0 1" damping="20"/>
  <geom type="capsule" size="0.02 0.1" mass="0.2" solref="0.002 1"/></body>"""
URDF = """\
<robot name="lever"><link name="stand"/>
  <link name="lever"><inertial><mass value="2"/><origin xyz="0.2 0 0"/>
      <inertia ixx="0.01" iyy="0.05" izz="0.05" ixy="0" ixz="0" iyz="0"/></inertial>
    <collision><origin xyz="0.2 0 0"/><geometry>{shape}</geometry></collision></link>
  <joint name="pivot" type="revolute"><parent link="stand"/><child link="lever"/><origin xyz="0 0 0.5"/>
    <axis xyz="0 1 0"/><limit lower="-0.5" upper="0.75" effort="7" velocity="1"/>
    <dynamics damping="0.3" friction="0.1"/></joint></robot>
"""


def placed(folder: Path, text: str, suffix: str = ".xml", **how) -> tuple[Path, object, mujoco.MjModel]:
    """A stage with the robot of a file, the robot, and MuJoCo's model of the file."""
    file = folder / f"model{suffix}"
    file.write_text(text)
    take_in(file, "robot", replace=True)
    scene = Scene()
    scene.simulation(frame_rate=100.0)
    robot = scene.robot("r", "robot", origin=True, **how)
    stage = scene.save(folder / "stage.usda")
    assert check_stage(stage, [folder]) == []
    return stage, robot, mujoco.MjModel.from_xml_path(str(file))


def full(model, data) -> np.ndarray:
    """The mass matrix in joint coordinates, rotors in it."""
    mujoco.mj_forward(model, data)
    matrix = np.zeros((model.nv, model.nv))
    mujoco.mj_fullM(model, data, matrix)
    return matrix


def test_masses_limits_and_what_acts_on_joints_are_those_of_the_file(own: Path, tmp_path: Path) -> None:
    stage, robot, model = placed(tmp_path, ARM, pose="reach")
    world = describe(stage)
    assert robot.joints == ["shoulder_pan", "shoulder", "elbow", "left", "right"]
    assert sum(body.mass for body in world.bodies) == pytest.approx(model.body_mass[2:].sum(), rel=1e-6)
    joints = {joint.prim.rpartition("/")[2]: joint for joint in world.joints}
    for k, joint in enumerate(joints.values()):
        low, high = model.jnt_range[k] if model.jnt_limited[k] else (None, None)
        assert joint.low == (None if low is None else pytest.approx(low, rel=1e-6, abs=1e-7))
        assert joint.high == (None if high is None else pytest.approx(high, rel=1e-6))
        assert joint.armature == pytest.approx(model.dof_armature[k])
        assert joint.friction == pytest.approx(model.dof_frictionloss[k])
    elbow, pan = joints["elbow"].drive, joints["shoulder_pan"].drive
    assert (elbow.stiffness, elbow.damping, elbow.max_effort) == pytest.approx((32.0, 1.05, 40.0))
    assert elbow.position == pytest.approx((30.0 * -0.6 + 2.0 * 0.4) / 32.0)  # the servo holds the start
    assert (pan.stiffness, pan.damping, pan.max_effort) == (0.0, pytest.approx(0.1), None)
    (gear,) = world.gears
    assert (gear.ratio, gear.offset) == pytest.approx((1.0, 0.0), abs=1e-6)
    seen = [shape for static in world.statics for shape in static.shapes if not shape.collides]
    assert [shape.kind for shape in seen] == ["cylinder", "box"]  # what collides is seen as well: no mesh shows it
    passing = {frozenset(name.split("/")[3] for name in pair) for pair in world.apart}
    assert frozenset(("upper", "lower")) in passing and frozenset(("left", "right")) not in {
        frozenset(pair) for pair in passing if "lower" in pair
    }


def test_the_mass_matrix_is_mujocos_where_the_joints_start(own: Path, tmp_path: Path) -> None:
    stage, _, model = placed(tmp_path, ARM, pose="reach")
    data = mujoco.MjData(model)
    data.qpos[:] = model.key_qpos[0]
    solver = Simulation(stage, "cpu").rigid.solver
    ours = full(solver.mj_model, solver.mj_data)
    names = [solver.mj_model.joint(j).name for j in range(solver.mj_model.njnt)]
    named = ("shoulder_pan", "shoulder", "elbow", "left", "right")
    order = [
        next(k for k, name in enumerate(names) if name.replace("/", "_").endswith(f"joints_{one}")) for one in named
    ]
    theirs = full(model, data)
    assert ours[np.ix_(order, order)] == pytest.approx(theirs, abs=2e-3 * theirs.max())


def test_a_passive_arm_falls_as_mujocos(own: Path, tmp_path: Path) -> None:
    stage, _, model = placed(tmp_path, PENDULUM, joints={"one": 20.0})
    data = mujoco.MjData(model)
    data.qpos[0] = math.radians(20.0)
    tip = model.body("two").id
    simulation = Simulation(stage, "cpu")
    (own_tip,) = (k for k, body in enumerate(simulation.world.bodies) if body.prim.endswith("/two"))
    way, worst = 0.0, 0.0
    mujoco.mj_forward(model, data)
    first = data.xipos[tip].copy()
    for frame in range(50):
        simulation.advance_frame()
        while data.time < (frame + 1) / 100.0 - 1e-9:
            mujoco.mj_step(model, data)
        mujoco.mj_forward(model, data)
        q = simulation.state.body_q.numpy()[simulation.built.bodies[own_tip]]
        way = max(way, float(np.linalg.norm(data.xipos[tip] - first)))
        worst = max(worst, float(np.linalg.norm(q[:3] - data.xpos[tip])))
    assert way > 0.5
    assert worst < 0.01 * way


def test_a_table_stands_on_its_servos_as_high_as_mujocos(own: Path, tmp_path: Path) -> None:
    places = [(x, y) for x in (-0.25, 0.25) for y in (-0.25, 0.25)]
    legs = "".join(LEG.format(k=k, x=x, y=y) for k, (x, y) in enumerate(places))
    servos = "".join(f'<position joint="leg{k}" kp="2000"/>' for k in range(4))
    stage_text = TABLE.format(legs=legs, servos=servos)
    file = tmp_path / "table.xml"
    file.write_text(stage_text)
    take_in(file, "table")
    scene = Scene()
    scene.simulation(frame_rate=50.0)
    scene.ground()
    scene.robot("r", "table")
    simulation = Simulation(scene.save(tmp_path / "stage.usda"), "cpu")
    for _ in range(100):
        simulation.advance_frame()
    (top,) = (k for k, body in enumerate(simulation.world.bodies) if body.prim.endswith("/top"))
    model = mujoco.MjModel.from_xml_path(str(file))
    data = mujoco.MjData(model)
    data.qpos[2] = 0.32
    while data.time < 2.0:
        mujoco.mj_step(model, data)
    height = float(simulation.state.body_q.numpy()[simulation.built.bodies[top], 2])
    assert height == pytest.approx(0.32 - 6.0 * 9.81 / 4.0 / 2000.0, abs=2e-4)  # the top's weight on four springs
    assert height == pytest.approx(float(data.qpos[2]), abs=5e-4)


def test_a_urdf_brings_its_effort_friction_and_damping(own: Path, tmp_path: Path) -> None:
    text = URDF.format(shape='<box size="0.4 0.04 0.04"/>')
    stage, robot, _ = placed(tmp_path, text, ".urdf", joints={"pivot": 10.0})
    (joint,) = describe(stage).joints
    assert (joint.low, joint.high) == pytest.approx((-0.5, 0.75))
    assert (joint.friction, joint.drive.damping) == pytest.approx((0.1, 0.3))
    robot.drive("piv*", position=20.0, stiffness=80.0, damping=2.0)
    drive = describe(robot._prim.GetStage()).joints[0].drive
    assert (drive.position, drive.stiffness, drive.damping) == pytest.approx((math.radians(20.0), 80.0, 2.3))
    assert drive.max_effort == 7.0
    robot.drive("pivot", velocity=30.0, damping=2.0)
    drive = describe(robot._prim.GetStage()).joints[0].drive
    assert (drive.stiffness, 2.3 * drive.velocity) == pytest.approx((0.0, 2.0 * math.radians(30.0)))


def test_what_cannot_be_is_said_in_a_line(own: Path, tmp_path: Path) -> None:
    with pytest.raises(IntakeError, match=r"no\.urdf is not there"):
        take_in(tmp_path / "no.urdf", "no")
    file = tmp_path / "lever.urdf"
    file.write_text(URDF.format(shape='<mesh filename="package://lever/meshes/bar.stl"/>'))
    with pytest.raises(IntakeError, match=r"mesh = package://lever/meshes/bar\.stl of link lever .* is not there"):
        take_in(file, "lever")
    file.write_text(URDF.format(shape='<box size="0.4 0.04 0.04"/>'))
    take_in(file, "lever")
    scene = Scene()
    with pytest.raises(SceneError, match=r"no robot 'leaver'; did you mean 'lever'\?"):
        scene.robot("r", "leaver")
    with pytest.raises(SceneError, match=r'joints = "pivo" is none of r; did you mean "pivot"\?'):
        scene.robot("r", "lever", joints={"pivo": 1.0})
    with pytest.raises(SceneError, match=r"pivot would start at 60 deg, beyond its limits -28\.6479 to 42\.9718 deg"):
        scene.robot("r", "lever", joints={"pivot": 60.0})
    with pytest.raises(SceneError, match=r"its base stand has no mass in its file; leave it fixed"):
        scene.robot("r", "lever", fixed=False)
    robot = scene.robot("r", "lever")  # none of which left anything behind
    with pytest.raises(SceneError, match=r"pivot: its file has no servo for that"):
        robot.drive("pivot", position=1.0)
