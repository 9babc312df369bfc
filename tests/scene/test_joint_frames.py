"""A joint's anchors, limits and motor, as a stage has them: in SI units, seen from both ends."""

import math

import numpy as np
import pytest

from wsim.scene import Drive, Scene
from wsim.scene.describe import describe


def turned(q, v):
    axis, w = np.array(q[:3]), q[3]
    t = 2.0 * np.cross(axis, v)
    return np.array(v) + w * t + np.cross(axis, t)


def test_both_anchors_are_the_same_point_of_the_world():
    scene = Scene()
    upper = scene.box("upper", size=(0.5, 0.1, 0.1), mass=1.0, position=(0.25, 0.0, 1.0), rotation_deg=(0.0, 30.0, 0.0))
    lower = scene.box("lower", size=(0.5, 0.1, 0.1), mass=1.0, position=(0.75, 0.2, 1.0), rotation_deg=(0.0, 0.0, 70.0))
    scene.joint_revolute("elbow", upper, lower, anchor=(0.5, 0.1, 1.0), axis="Z")
    scene.joint_spherical("shoulder", None, upper, anchor=(0.0, 0.0, 1.0))
    world = describe(scene.stage)
    bodies = {body.prim: body for body in world.bodies}
    for joint, point in zip(
        sorted(world.joints, key=lambda j: j.prim), ((0.5, 0.1, 1.0), (0.0, 0.0, 1.0)), strict=True
    ):
        for prim, anchor in ((joint.parent, joint.parent_anchor), (joint.child, joint.child_anchor)):
            at = np.array(anchor)
            if prim is not None:
                at = np.array(bodies[prim].position) + turned(bodies[prim].rotation, at)
            assert at == pytest.approx(point, abs=1e-6)


def test_limits_and_motors_are_in_radians_and_metres():
    scene = Scene()
    arm = scene.box("arm", size=(0.5, 0.1, 0.1), mass=1.0, position=(0.25, 0.0, 1.0))
    cart = scene.box("cart", size=(0.2, 0.2, 0.2), mass=1.0, position=(0.0, 2.0, 1.0))
    motor = Drive(position=30.0, velocity=90.0, stiffness=40.0, damping=4.0, max_force=7.0)
    scene.joint_revolute("hinge", None, arm, axis="Y", limits_deg=(-45.0, 90.0), drive=motor)
    scene.joint_prismatic("rail", None, cart, axis="X", limits=(-0.5, 0.25), drive=Drive(position=0.2, stiffness=10.0))
    hinge, rail = sorted(describe(scene.stage).joints, key=lambda joint: joint.prim)
    assert (hinge.low, hinge.high) == pytest.approx((-math.pi / 4, math.pi / 2))
    assert (rail.low, rail.high) == pytest.approx((-0.5, 0.25))
    drive = hinge.drive
    assert (drive.stiffness, drive.damping, drive.max_effort) == pytest.approx((40.0, 4.0, 7.0))
    assert (drive.position, drive.velocity) == pytest.approx((math.pi / 6, math.pi / 2))
    assert rail.drive.stiffness == pytest.approx(10.0) and rail.drive.position == pytest.approx(0.2)
    assert rail.drive.max_effort is None


def test_a_free_joint_has_neither():
    scene = Scene()
    arm = scene.box("arm", size=(0.5, 0.1, 0.1), mass=1.0, position=(0.25, 0.0, 1.0))
    scene.joint_revolute("hinge", None, arm, axis="Y")
    joint = describe(scene.stage).joints[0]
    assert joint.low is None and joint.high is None and joint.drive is None
