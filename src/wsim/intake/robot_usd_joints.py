"""Joints of a USD robot, one for each freedom: also those of `PhysicsJoint`s that leave several axes open."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np
from pxr import Usd, UsdGeom, UsdPhysics

from wsim.geometry.rotations import conjugate, multiply, rotate
from wsim.importers.mujoco_names import clean
from wsim.intake.model import Array, IntakeError
from wsim.scene.articulation import joint_ends
from wsim.scene.describe_joints import anchors_of
from wsim.scene.spanning import WORLD_END
from wsim.scene.world import Joint, Motor, World
from wsim.sim.placed import coordinate

Pose = tuple[Array, Array]
FIXED = "fixed"
_AXES = ("transX", "transY", "transZ", "rotX", "rotY", "rotZ")
_ONTO = {  # turns that bring X onto an axis
    "X": np.array([0.0, 0.0, 0.0, 1.0]),
    "Y": np.array([0.0, 0.0, math.sqrt(0.5), math.sqrt(0.5)]),
    "Z": np.array([0.0, -math.sqrt(0.5), 0.0, math.sqrt(0.5)]),
}


@dataclass(frozen=True)
class Hinge:
    """A joint of a child on a parent (None: the world), with one freedom, three of a ball, or none.

    Its frames, in the parent and in the child, have X along the axis, and meet where the coordinate is 0.
    """

    prim: str
    name: str
    kind: Any  # "revolute", "prismatic", "spherical" or "fixed"
    parent: str | None
    child: str
    parent_frame: Pose
    child_frame: Pose
    low: float | None = None
    high: float | None = None
    friction: float = 0.0
    armature: float = 0.0
    motor: Motor | None = None
    fastest: float | None = None
    at: float = 0.0  # as the file has it [rad] or [m]

    @property
    def group(self) -> tuple[str | None, str]:
        """What it joins."""
        return self.parent, self.child

    @property
    def moves(self) -> bool:
        """Whether it has one coordinate."""
        return bool(self.kind in ("revolute", "prismatic"))

    @property
    def between(self) -> Pose:
        """Where the child is in the parent at 0."""
        return _after(self.parent_frame, _inverse(self.child_frame))

    def turned(self) -> Hinge:
        """The same from the other end, its coordinate as it was.

        Raises:
            IntakeError: If the other end is the world.
        """
        if self.parent is None:
            raise IntakeError(f"file: {self.prim} ends at the world")
        half: Pose = np.zeros(3), np.array([0.0, 1.0, 0.0, 0.0])  # about Y: it turns X back
        return replace(
            self,
            parent=self.child,
            child=self.parent,
            parent_frame=_after(self.child_frame, half),
            child_frame=_after(self.parent_frame, half),
        )


def hinges_of(stage: Usd.Stage, world: World, notes: list[str]) -> Iterator[Hinge]:
    """All joints of a stage that hold a body.

    Args:
        stage: That they are on.
        world: What it states.
        notes: Told of what is not carried.
    """
    bodies, known = {body.prim: body for body in world.bodies}, {joint.prim for joint in world.joints}
    joints = [each for each in world.joints if _enabled(stage.GetPrimAtPath(each.prim))]
    joints.sort(key=lambda each: each.closing)  # what a file leaves out of its articulation closes a loop, if one does
    several = [(joint.parent, joint.child) for joint in joints]
    for joint in joints:
        alone = several.count((joint.parent, joint.child)) == 1
        at = coordinate(joint, bodies) if alone and joint.kind in ("revolute", "prismatic") else 0.0
        made = _plain(stage.GetPrimAtPath(joint.prim), joint, at)
        yield _scaled(stage, made)
    for prim in stage.Traverse():
        if not prim.IsA(UsdPhysics.Joint) or str(prim.GetPath()) in known or not _enabled(prim):
            continue
        if prim.GetTypeName() == "PhysicsJoint":
            yield from (_scaled(stage, made) for made in _open(prim, bodies))
        else:
            notes.append(f"not carried: joints of the kind {prim.GetTypeName()}")


def _enabled(joint: Usd.Prim) -> bool:
    return bool(UsdPhysics.Joint(joint).GetJointEnabledAttr().Get())


def _plain(prim: Usd.Prim, joint: Joint, at: float) -> Hinge:
    frames = (
        (np.array(getattr(joint, f"{end}_anchor") or (0.0, 0.0, 0.0)), np.array(getattr(joint, f"{end}_turn")))
        for end in ("parent", "child")
    )
    first, second = (_onto(frame, joint.axis) for frame in frames)
    motor = joint.drive
    return Hinge(
        joint.prim, clean(prim.GetName()), joint.kind, joint.parent, joint.child, first, second, joint.low, joint.high,
        joint.friction, joint.armature or _number(prim, "physxJoint:armature"), motor,
        joint.fastest or _fastest(prim, joint.kind), at,
    )  # fmt: skip


def _scaled(stage: Usd.Stage, joint: Hinge) -> Hinge:
    """The same with its places in metres: USD has them in the bodies' own, scaled spaces."""
    return replace(
        joint,
        parent_frame=_metres(stage, joint.parent, joint.parent_frame),
        child_frame=_metres(stage, joint.child, joint.child_frame),
    )


def _metres(stage: Usd.Stage, body: str | None, frame: Pose) -> Pose:
    if body is None:
        return frame
    matrix = UsdGeom.Xformable(stage.GetPrimAtPath(body)).ComputeLocalToWorldTransform(Usd.TimeCode.Default())
    return frame[0] * np.array([matrix.GetRow3(k).GetLength() for k in range(3)]), frame[1]


def _open(prim: Usd.Prim, bodies: dict[str, Any]) -> Iterator[Hinge]:
    """A `PhysicsJoint` as one joint for each axis that it leaves open; those along lines come first."""
    parent, child = (None if path == WORLD_END else str(path) for path in joint_ends(UsdPhysics.Joint(prim)))
    if child is None or child not in bodies:
        return
    anchors = anchors_of(UsdPhysics.Joint(prim), parent, child)
    ends = [(np.array(anchors[f"{end}_anchor"]), np.array(anchors[f"{end}_turn"])) for end in ("parent", "child")]
    limits = {axis: _limits(prim, axis) for axis in _AXES}
    free = [axis for axis, (low, high) in limits.items() if low < high]
    if not free:
        yield Hinge(str(prim.GetPath()), clean(prim.GetName()), FIXED, parent, child, ends[0], ends[1])
        return
    for axis in free:
        kind: Literal["revolute", "prismatic"] = "revolute" if axis.startswith("rot") else "prismatic"
        low, high = limits[axis]
        name = prim.GetName() if len(free) == 1 else f"{prim.GetName()}_{axis}"
        first, second = (_onto(frame, axis[-1]) for frame in ends)
        yield Hinge(
            f"{prim.GetPath()}", clean(name), kind, parent, child, first, second,
            low if math.isfinite(low) else None, high if math.isfinite(high) else None,
            _number(prim, "newton:friction"), _number(prim, "newton:armature") or _number(prim, "physxJoint:armature"),
            _motor(prim, axis, kind), _fastest(prim, kind),
        )  # fmt: skip


def _limits(prim: Usd.Prim, axis: str) -> tuple[float, float]:
    """Of a freedom [rad] or [m]; where the first is above the second there is none."""
    if not prim.HasAPI(UsdPhysics.LimitAPI, axis):
        return -math.inf, math.inf
    api = UsdPhysics.LimitAPI(prim, axis)
    unit = math.pi / 180.0 if axis.startswith("rot") else 1.0
    return float(api.GetLowAttr().Get()) * unit, float(api.GetHighAttr().Get()) * unit


def _motor(prim: Usd.Prim, axis: str, kind: str) -> Motor | None:
    if not prim.HasAPI(UsdPhysics.DriveAPI, axis):
        return None
    api, unit = UsdPhysics.DriveAPI(prim, axis), math.pi / 180.0 if kind == "revolute" else 1.0
    most = float(api.GetMaxForceAttr().Get())
    return Motor(
        stiffness=float(api.GetStiffnessAttr().Get()) / unit, damping=float(api.GetDampingAttr().Get()) / unit,
        max_effort=most if math.isfinite(most) else None,
    )  # fmt: skip


def _fastest(prim: Usd.Prim, kind: str) -> float | None:
    unit = math.pi / 180.0 if kind == "revolute" else 1.0
    found = [_number(prim, name) for name in ("newton:velocityLimit", "physxJoint:maxJointVelocity")]
    return next((each * unit for each in found if 0.0 < each < 1e5), None)  # PhysX's own, 1e6, stands for none


def _number(prim: Usd.Prim, name: str) -> float:
    attribute = prim.GetAttribute(name)
    return float(attribute.Get() or 0.0) if attribute else 0.0


def _onto(frame: Pose, axis: str) -> Pose:
    return frame[0], multiply(frame[1], _ONTO[axis])


def _after(first: Pose, second: Pose) -> Pose:
    return first[0] + rotate(first[1], second[0]), multiply(first[1], second[1])


def _inverse(pose: Pose) -> Pose:
    back = conjugate(pose[1])
    return -rotate(back, pose[0]), back
