"""URDF and MJCF: bodies, what collides, masses and joints come along, and the joint moves within its limits."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from pxr import Usd, UsdPhysics

from tests.intake import models
from wsim.intake import IntakeError, Wanted, add
from wsim.scene.describe import describe

URDF = """\
<robot name="door">
  <link name="frame">
    <inertial><mass value="10"/><origin xyz="0 0 0.5"/>
      <inertia ixx="1" iyy="1" izz="0.2" ixy="0" ixz="0" iyz="0"/></inertial>
    <visual><origin xyz="0 0 0.5"/><geometry><mesh filename="frame.stl"/></geometry></visual>
    <collision><origin xyz="0 0 0.5"/><geometry><box size="0.1 0.1 1.0"/></geometry></collision>
  </link>
  <link name="leaf">
    <inertial><mass value="4"/><origin xyz="0 0.3 0"/>
      <inertia ixx="0.3" iyy="0.1" izz="0.2" ixy="0" ixz="0" iyz="0"/></inertial>
    <visual><origin xyz="0 0.3 0"/><geometry><box size="0.04 0.5 0.8"/></geometry></visual>
    <collision><origin xyz="0 0.3 0"/><geometry><box size="0.04 0.5 0.8"/></geometry></collision>
  </link>
  <joint name="hinge" type="revolute">
    <parent link="frame"/><child link="leaf"/><origin xyz="0 0.05 0.5"/><axis xyz="0 0 1"/>
    <limit lower="0" upper="1.5" effort="10" velocity="1"/>
  </joint>
</robot>
"""
MJCF = """\
<mujoco><worldbody><geom type="plane" size="1 1 1"/>
  <body name="case" pos="0 0 0.2"><freejoint/><geom type="box" size="0.2 0.2 0.2" mass="5"/>
    <body name="drawer" pos="0 0 0.3"><joint name="slide" type="slide" axis="1 0 0" range="0 0.15"/>
      <geom type="box" size="0.15 0.15 0.05" mass="1"/></body></body>
</worldbody></mujoco>
"""


def joint_of(path: Path) -> tuple[Usd.Prim, Usd.Stage]:
    stage = Usd.Stage.Open(str(path))
    (joint,) = (prim for prim in stage.Traverse() if prim.IsA(UsdPhysics.Joint))
    return joint, stage


def test_a_urdf_keeps_its_hinge(own: Path, tmp_path: Path) -> None:
    box = models.trimesh.creation.box(extents=(0.1, 0.1, 1.0))
    models.write(box, tmp_path / "frame.stl")
    (tmp_path / "door.urdf").write_text(URDF)
    asset = add(tmp_path / "door.urdf", Wanted("garden door", picture=False))
    assert asset.articulated and asset.mass == pytest.approx(14.0)
    assert asset.collision.method == "given" and asset.collision.parts == 2
    assert asset.size == pytest.approx((0.1, 0.65, 1.0), abs=1e-4)
    world = describe(asset.path)
    assert {body.prim.rpartition("/")[2]: body.mass for body in world.bodies} == pytest.approx(
        {"frame": 10.0, "leaf": 4.0}
    )
    joint, _stage = joint_of(asset.path)
    hinge = UsdPhysics.RevoluteJoint(joint)
    assert hinge.GetLowerLimitAttr().Get() == pytest.approx(0.0, abs=1e-4)
    assert hinge.GetUpperLimitAttr().Get() == pytest.approx(math.degrees(1.5), rel=1e-5)
    leaf = next(body for body in world.bodies if body.prim.endswith("leaf"))
    assert np.array(leaf.inertia).reshape(3, 3) == pytest.approx(np.diag([0.3, 0.1, 0.2]), abs=1e-4)


def test_an_mjcf_keeps_its_slide(own: Path, tmp_path: Path) -> None:
    (tmp_path / "chest.xml").write_text(MJCF)
    asset = add(tmp_path / "chest.xml", Wanted("chest", picture=False))
    assert asset.articulated and asset.mass == pytest.approx(6.0)
    assert any("world geoms are not carried" in note for note in asset.notes)
    joint, _stage = joint_of(asset.path)  # which keeps its prims
    slide = UsdPhysics.PrismaticJoint(joint)
    assert (slide.GetLowerLimitAttr().Get(), slide.GetUpperLimitAttr().Get()) == pytest.approx((0.0, 0.15))


def test_what_no_asset_can_be_is_refused(own: Path, tmp_path: Path) -> None:
    (tmp_path / "two.xml").write_text(MJCF.replace("</worldbody>", '<body><geom size="1"/></body></worldbody>'))
    with pytest.raises(IntakeError, match=r"bodies = 2 of two\.xml stand apart"):
        add(tmp_path / "two.xml", Wanted("two", picture=False))
    (tmp_path / "no.urdf").write_text("<robot>")
    with pytest.raises(IntakeError, match=r"no\.urdf cannot be read"):
        add(tmp_path / "no.urdf", Wanted("no", picture=False))
