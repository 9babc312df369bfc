"""Robots of USD files that nobody here wrote, held against Newton's own importer of the same files."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import newton
import numpy as np
import pytest
from pxr import Sdf, Usd, UsdGeom, UsdPhysics

from wsim.intake.model import IntakeError
from wsim.intake.robot_usd import read_usd_robot
from wsim.intake.robot_write import write_robot
from wsim.scene import Scene
from wsim.scene.check import check_stage
from wsim.scene.describe import describe
from wsim.sim.model import build_model

EXAMPLES, TESTS = (Path(newton.__file__).parent / part / "assets" for part in ("examples", "tests"))
FILES = {
    "ant": EXAMPLES / "ant.usda",
    "cartpole": EXAMPLES / "cartpole.usda",
    "humanoid": EXAMPLES / "humanoid.usda",  # of `PhysicsJoint`s that leave two or three axes open
    "chain": TESTS / "four_link_chain_articulation.usda",
}
by_file = pytest.mark.parametrize("name", FILES)


def ours(name: str, folder: Path) -> Any:
    """The model of a world with the robot alone, where its file has it."""
    write_robot(folder / "robot.usda", read_usd_robot(FILES[name]), name)
    scene = Scene()
    scene.robot("bot", folder / "robot.usda", origin=True)
    stage = scene.save(folder / "stage.usda")
    assert check_stage(stage, [folder]) == []
    return build_model(stage, describe(stage), "cpu").model


def theirs(name: str) -> Any:
    builder = newton.ModelBuilder()
    builder.add_usd(str(FILES[name]), enable_self_collisions=False)  # collapsed, welded links would have other inertias
    return builder.finalize(device="cpu")


def weights(model: Any) -> dict[str, float]:
    """Masses of the bodies by name, with what carries several joints, or is welded to it, counted to its link."""
    owner = list(range(model.body_count))
    for kind, parent, child in zip(
        model.joint_type.numpy(), model.joint_parent.numpy(), model.joint_child.numpy(), strict=True
    ):
        if int(kind) == int(newton.JointType.FIXED) and parent >= 0:
            owner[child] = owner[parent]
    found: dict[str, float] = {}
    for body, mass in zip(owner, model.body_mass.numpy(), strict=True):
        link = str(model.body_label[body]).rpartition("/")[2].partition("__")[0]
        found[link] = found.get(link, 0.0) + float(mass)
    return found


def freedoms(model: Any) -> dict[str, int]:
    """Degrees of freedom of hinges and sliders by the joint's name, with the axis where it has several."""
    found: dict[str, int] = {}
    starts, axes = model.joint_qd_start.numpy(), model.joint_axis.numpy()
    for k, label in enumerate(model.joint_label):
        kind, name = int(model.joint_type.numpy()[k]), str(label).rpartition("/")[2]
        own = range(starts[k], starts[k + 1])
        if kind == int(newton.JointType.D6) and len(own) > 1:
            found |= {f"{name}_rot{'XYZ'[int(np.abs(axes[dof]).argmax())]}": dof for dof in own}
        elif len(own) == 1:
            found[name] = own[0]
    return found


def mass_matrix(model: Any) -> np.ndarray:
    """In joint coordinates, where they are 0; of what is adrift with its base as it follows, whichever that is."""
    state = model.state()
    q = model.joint_q.numpy()
    for k, kind in enumerate(model.joint_type.numpy()):
        if int(kind) not in (int(newton.JointType.FREE), int(newton.JointType.BALL)):
            q[model.joint_q_start.numpy()[k] : model.joint_q_start.numpy()[k + 1]] = 0.0
    state.joint_q.assign(q)
    newton.eval_fk(model, state.joint_q, state.joint_qd, state)
    found = np.asarray(newton.eval_mass_matrix(model, state).numpy()[0], dtype=np.float64)
    found -= np.diag(model.joint_armature.numpy()[: len(found)])  # which Newton reads by its own names alone
    base = [dof for dof in range(len(found)) if dof not in freedoms(model).values()]
    if not base:
        return found
    follows = np.linalg.solve(found[np.ix_(base, base)], found[base])
    return found - found[:, base] @ follows


@by_file
def test_masses_limits_and_the_mass_matrix_are_newtons(name: str, tmp_path: Path) -> None:
    """The matrix to 0.2 % of its largest entry: a thousandth of a link goes to what carries several joints of it."""
    mine, other = ours(name, tmp_path), theirs(name)
    carried, stated = weights(mine), weights(other)
    for link, mass in carried.items():
        assert mass == pytest.approx(stated[link], rel=1e-4)
    own, known = freedoms(mine), freedoms(other)
    assert set(own) == set(known)
    order, theirs_ = [own[each] for each in known], list(known.values())
    for limit in ("joint_limit_lower", "joint_limit_upper"):
        a, b = (getattr(model, limit).numpy() for model in (mine, other))
        for k, j in zip(order, theirs_, strict=True):
            assert (abs(a[k]) > 1e6 and abs(b[j]) > 1e6) or a[k] == pytest.approx(b[j], abs=1e-5)
    first, second = mass_matrix(mine)[np.ix_(order, order)], mass_matrix(other)[np.ix_(theirs_, theirs_)]
    assert first == pytest.approx(second, abs=2e-3 * np.abs(second).max())


def test_drives_are_carried(tmp_path: Path) -> None:
    """The ant's, USD's per degree: Newton has them per radian, as a description has."""
    write_robot(tmp_path / "ant.usda", read_usd_robot(FILES["ant"]), "ant")
    scene = Scene()
    scene.robot("bot", tmp_path / "ant.usda")
    mine = {joint.prim.rpartition("/")[2]: joint.drive for joint in describe(scene.stage).joints}
    file = {joint.prim.rpartition("/")[2]: joint.drive for joint in describe(FILES["ant"]).joints}
    assert mine.keys() == file.keys()
    for name, drive in mine.items():
        assert (drive.stiffness, drive.damping) == pytest.approx((file[name].stiffness, file[name].damping), rel=1e-5)
        assert drive.max_effort == pytest.approx(file[name].max_effort)


def test_it_stands_as_in_the_file_or_held() -> None:
    assert [link.name for link in read_usd_robot(FILES["ant"]).links if link.free] == ["torso"]
    held = read_usd_robot(FILES["cartpole"])
    assert not any(link.free for link in held.links)  # its rail is fixed to the world


@pytest.mark.parametrize(
    ("file", "said"),
    [
        (EXAMPLES / "boxes_fourbar.usda", "has 0 prims with PhysicsArticulationRootAPI"),
        (TESTS / "ant_multi.usda", "has 64 prims with PhysicsArticulationRootAPI"),
    ],
)
def test_what_is_no_one_robot_is_refused(file: Path, said: str) -> None:
    with pytest.raises(IntakeError, match=said):
        read_usd_robot(file)


def test_a_file_of_other_units_is_refused_with_its_own(tmp_path: Path) -> None:
    stage = Usd.Stage.Open(str(FILES["ant"]))
    UsdGeom.SetStageMetersPerUnit(stage, 0.01)
    stage.GetRootLayer().Export(str(tmp_path / "ant.usda"))
    with pytest.raises(IntakeError, match=r"metersPerUnit = 0\.01"):
        read_usd_robot(tmp_path / "ant.usda")


@pytest.mark.parametrize("flipped", [False, True])
def test_a_joint_from_either_end_keeps_its_coordinate(tmp_path: Path, flipped: bool) -> None:
    """Two boxes on a hinge about Y at (0.2, 0, 0), the outer one authored at 30 degrees; held is the first."""
    stage = Usd.Stage.CreateNew(str(tmp_path / "two.usda"))
    UsdGeom.SetStageUpAxis(stage, UsdGeom.Tokens.z)
    UsdGeom.SetStageMetersPerUnit(stage, 1.0)
    stage.SetDefaultPrim(UsdGeom.Xform.Define(stage, "/two").GetPrim())
    UsdPhysics.ArticulationRootAPI.Apply(stage.GetPrimAtPath("/two"))
    for name in ("one", "other"):
        body = UsdGeom.Cube.Define(stage, f"/two/{name}")
        body.CreateSizeAttr(0.1)
        UsdPhysics.RigidBodyAPI.Apply(body.GetPrim())
        UsdPhysics.CollisionAPI.Apply(body.GetPrim())
        UsdPhysics.MassAPI.Apply(body.GetPrim()).CreateMassAttr(1.0)
    hold = UsdPhysics.FixedJoint.Define(stage, "/two/hold")
    hold.CreateBody1Rel().SetTargets(["/two/one"])
    hinge = UsdPhysics.RevoluteJoint.Define(stage, "/two/hinge")
    hinge.CreateAxisAttr("Y")
    ends = ["/two/other", "/two/one"] if flipped else ["/two/one", "/two/other"]
    hinge.CreateBody0Rel().SetTargets(ends[:1])
    hinge.CreateBody1Rel().SetTargets(ends[1:])
    places = [(-0.2, 0.0, 0.0), (0.2, 0.0, 0.0)] if flipped else [(0.2, 0.0, 0.0), (-0.2, 0.0, 0.0)]
    hinge.CreateLocalPos0Attr(places[0])
    hinge.CreateLocalPos1Attr(places[1])
    turn = -30.0 if flipped else 30.0  # of the second body in the first, about Y
    hinge.CreateLowerLimitAttr(-10.0)
    hinge.CreateUpperLimitAttr(70.0)
    outer = UsdGeom.Xformable(stage.GetPrimAtPath("/two/other"))
    c, s = np.cos(np.radians(turn if not flipped else 30.0)), np.sin(np.radians(30.0))
    outer.AddTranslateOp().Set((0.2 + 0.2 * c, 0.0, -0.2 * s))
    outer.AddRotateYOp().Set(30.0)
    stage.Save()
    robot = read_usd_robot(tmp_path / "two.usda")
    (joint,) = robot.joints
    assert (joint.parent, joint.child) == ("one", "other")
    assert robot.poses["home"]["hinge"] == pytest.approx(np.radians(turn), abs=1e-6)
    if flipped:
        return  # beyond its limits, which stay with the coordinate
    write_robot(tmp_path / "robot.usda", robot, "two")
    scene = Scene()
    scene.robot("bot", tmp_path / "robot.usda", origin=True)
    body = describe(scene.stage).body("/World/bot/other")
    assert body.position == pytest.approx((0.2 + 0.2 * c, 0.0, -0.2 * s), abs=1e-6)


def joined(path: Path, *joints: tuple[str, str, str], kind: str = "Revolute") -> Usd.Stage:
    """Boxes of 1 kg side by side, the first one held, and joints of names between two of them."""
    stage = Usd.Stage.CreateNew(str(path))
    UsdGeom.SetStageUpAxis(stage, UsdGeom.Tokens.z)
    UsdGeom.SetStageMetersPerUnit(stage, 1.0)
    stage.SetDefaultPrim(UsdGeom.Xform.Define(stage, "/r").GetPrim())
    UsdPhysics.ArticulationRootAPI.Apply(stage.GetPrimAtPath("/r"))
    names = list(dict.fromkeys(end for _, *ends in joints for end in ends))
    for k, name in enumerate(names):
        body = UsdGeom.Cube.Define(stage, f"/r/{name}")
        body.CreateSizeAttr(0.1)
        body.AddTranslateOp().Set((0.2 * k, 0.0, 0.0))
        UsdPhysics.RigidBodyAPI.Apply(body.GetPrim())
        UsdPhysics.MassAPI.Apply(body.GetPrim()).CreateMassAttr(1.0)
    hold = UsdPhysics.FixedJoint.Define(stage, "/r/hold")
    hold.CreateBody1Rel().SetTargets([f"/r/{names[0]}"])
    for place, one, other in joints:
        joint = getattr(UsdPhysics, f"{kind}Joint").Define(stage, f"/r/{place}")
        joint.CreateBody0Rel().SetTargets([f"/r/{one}"])
        joint.CreateBody1Rel().SetTargets([f"/r/{other}"])
        joint.CreateLocalPos0Attr((0.2 * (names.index(other) - names.index(one)), 0.0, 0.0))
        joint.CreateAxisAttr("Y")
    return stage


def test_a_joint_that_is_switched_off_holds_nothing(tmp_path: Path) -> None:
    stage = joined(tmp_path / "r.usda", ("hinge", "base", "arm"))
    stage.Save()
    held = read_usd_robot(tmp_path / "r.usda")
    assert [joint.name for joint in held.joints] == ["hinge"] and not held.links[0].free
    UsdPhysics.Joint(stage.GetPrimAtPath("/r/hold")).CreateJointEnabledAttr(False)
    stage.Save()
    assert read_usd_robot(tmp_path / "r.usda").links[0].free


def test_what_is_left_out_of_the_articulation_closes_its_loop(tmp_path: Path) -> None:
    """It stands first in the file, and the joints that make the tree are those that are not left out."""
    stage = joined(tmp_path / "r.usda", ("loop", "base", "a"), ("first", "base", "b"), ("second", "b", "a"))
    UsdPhysics.Joint(stage.GetPrimAtPath("/r/loop")).CreateExcludeFromArticulationAttr(True)
    stage.Save()
    robot = read_usd_robot(tmp_path / "r.usda")
    assert {joint.name for joint in robot.joints} == {"first", "second"}
    assert "not carried: joints that close a loop" in robot.notes


def test_two_joints_of_one_name_are_refused(tmp_path: Path) -> None:
    stage = joined(tmp_path / "r.usda", ("left/elbow", "base", "a"), ("right/elbow", "base", "b"))
    stage.Save()
    with pytest.raises(IntakeError, match="two joints of the name elbow; rename one"):
        read_usd_robot(tmp_path / "r.usda")


def test_one_limit_is_carried_and_no_speed_limit_is_none(tmp_path: Path) -> None:
    stage = joined(tmp_path / "r.usda", ("hinge", "base", "arm"))
    UsdPhysics.RevoluteJoint(stage.GetPrimAtPath("/r/hinge")).CreateLowerLimitAttr(-30.0)
    name, kind = "physxJoint:maxJointVelocity", Sdf.ValueTypeNames.Float
    stage.GetPrimAtPath("/r/hinge").CreateAttribute(name, kind).Set(1e6)
    stage.Save()
    robot = read_usd_robot(tmp_path / "r.usda")
    (joint,) = robot.joints
    assert joint.fastest is None and (joint.low, joint.high) == (pytest.approx(np.radians(-30.0)), None)
    write_robot(tmp_path / "robot.usda", robot, "r")
    written = Usd.Stage.Open(str(tmp_path / "robot.usda"))
    (hinge,) = [UsdPhysics.RevoluteJoint(prim) for prim in written.Traverse() if prim.IsA(UsdPhysics.RevoluteJoint)]
    assert hinge.GetLowerLimitAttr().Get() == pytest.approx(-30.0)
    assert not np.isfinite(hinge.GetUpperLimitAttr().Get())
