"""Mark chains of jointed bodies as articulations, which is how a solver in joint coordinates takes them."""

from __future__ import annotations

import math
from collections.abc import Sequence

from pxr import Gf, Sdf, Usd, UsdGeom, UsdPhysics

from wsim.scene import schema
from wsim.scene.spanning import WORLD_END, Link, Tree, span
from wsim.scene.usd_values import targets_of, value_of

COORDINATES = ("position", "velocity", "effort")  # quantities of a joint that are of its coordinate
_HALF_TURN = {"X": Gf.Quatf(0.0, 0.0, 1.0, 0.0), "Y": Gf.Quatf(0.0, 1.0, 0.0, 0.0), "Z": Gf.Quatf(0.0, 1.0, 0.0, 0.0)}


def mark_articulations(stage: Usd.Stage, tops: Sequence[Sdf.Path] = (), needing: Sequence[Sdf.Path] = ()) -> Tree:
    """Put one articulation root on each tree of joints, and take joints that close a loop out of the tree.

    The root is the joint to the world, or the topmost body. A joint that points towards its root is turned round, its
    coordinate as it was. Called after each new joint: joints made by other means are marked with the rest, and roots
    set by other means give way.

    Args:
        stage: Changed in place.
        tops: Bodies at which trees are to begin that hang on nothing.
        needing: Joints that need a coordinate beside those of which the stage says so.
    """
    tree = span(*links_of(stage, needing), tops)
    for prim in stage.Traverse():
        if prim.HasAPI(UsdPhysics.ArticulationRootAPI):
            prim.RemoveAPI(UsdPhysics.ArticulationRootAPI)
    for joint in joints_of(stage):
        if joint.GetPath() in tree.closing:
            joint.CreateExcludeFromArticulationAttr(True)
        elif joint.GetExcludeFromArticulationAttr().HasAuthoredValue():
            joint.GetExcludeFromArticulationAttr().Clear()
        if joint.GetPath() in tree.reversed:
            _turn_round(joint)
    for path in tree.roots:
        UsdPhysics.ArticulationRootAPI.Apply(stage.GetPrimAtPath(path))
    return tree


def links_of(stage: Usd.Stage, needing: Sequence[Sdf.Path] = ()) -> tuple[list[Link], list[Sdf.Path]]:
    """The joints of a stage as `span` takes them, and the kinematic bodies."""
    coordinates = geared_joints(stage) | timed_joints(stage) | set(needing)
    links = [
        Link(
            joint.GetPath(),
            *joint_ends(joint),
            needs_coordinate(joint) or joint.GetPath() in coordinates,
            may_break(joint),
        )
        for joint in joints_of(stage)
    ]
    ends = dict.fromkeys(path for link in links for path in (link.parent, link.child) if path != WORLD_END)
    return links, [path for path in ends if is_kinematic(stage.GetPrimAtPath(path))]


def joints_of(stage: Usd.Stage) -> list[UsdPhysics.Joint]:
    """The joints that hold a body and are switched on."""
    joints = [UsdPhysics.Joint(prim) for prim in stage.Traverse() if prim.IsA(UsdPhysics.Joint)]
    return [joint for joint in joints if joint.GetJointEnabledAttr().Get() and joint_ends(joint)[1] != WORLD_END]


def joint_ends(joint: UsdPhysics.Joint) -> tuple[Sdf.Path, Sdf.Path]:
    """Bodies that a joint holds, parent and child as authored; `WORLD_END` is what never moves, and never the child."""
    stage = joint.GetPrim().GetStage()
    ends = []
    for relation in (joint.GetBody0Rel(), joint.GetBody1Rel()):
        targets = relation.GetTargets()
        ends.append(body_above(stage.GetPrimAtPath(targets[0])) if targets else WORLD_END)
    parent, child = ends
    return (child, parent) if child == WORLD_END else (parent, child)


def body_above(prim: Usd.Prim) -> Sdf.Path:
    """The rigid body that a prim is or is part of; `WORLD_END` if it is part of none."""
    while prim and not prim.IsPseudoRoot():
        if prim.HasAPI(UsdPhysics.RigidBodyAPI):
            return prim.GetPath()
        prim = prim.GetParent()
    return WORLD_END


def is_kinematic(body: Usd.Prim) -> bool:
    """Whether a body goes its own way."""
    return bool(UsdPhysics.RigidBodyAPI(body).GetKinematicEnabledAttr().Get())


def may_break(joint: UsdPhysics.Joint) -> bool:
    """Whether a joint has a force or a torque at which it breaks."""
    return math.isfinite(joint.GetBreakForceAttr().Get()) or math.isfinite(joint.GetBreakTorqueAttr().Get())


def needs_coordinate(joint: UsdPhysics.Joint) -> bool:
    """Whether a joint does what a constraint cannot: it slides, or is driven, limited or rubbed."""
    prim = joint.GetPrim()
    if not any(prim.IsA(kind) for kind in (UsdPhysics.FixedJoint, UsdPhysics.RevoluteJoint, UsdPhysics.SphericalJoint)):
        return True
    limits = (prim.GetAttribute(f"physics:{end}Limit") for end in ("lower", "upper"))
    limited = any(limit and math.isfinite(limit.Get()) for limit in limits)
    return limited or prim.HasAPI(UsdPhysics.DriveAPI, "angular") or dry_friction(prim) > 0.0


def dry_friction(prim: Usd.Prim) -> float:
    """A joint's dry friction [N m or N], `newton:friction`."""
    attribute = prim.GetAttribute("newton:friction")
    return float(attribute.Get() or 0.0) if attribute else 0.0


def geared_joints(stage: Usd.Stage) -> set[Sdf.Path]:
    """The joints that a gear or a mimic couples."""
    found: set[Sdf.Path] = set()
    for prim in stage.Traverse():
        if schema.has(prim, schema.GEAR):
            for name in ("wsim:joint0", "wsim:joint1"):
                found.update(prim.GetRelationship(name).GetTargets() if prim.HasRelationship(name) else [])
        elif prim.HasRelationship("newton:mimicJoint"):
            found.update([prim.GetPath(), *prim.GetRelationship("newton:mimicJoint").GetTargets()])
    return found


def timed_joints(stage: Usd.Stage) -> set[Sdf.Path]:
    """The joints that schedules push or lead, or of which events are."""
    found: set[Sdf.Path] = set()
    for prim in stage.Traverse():
        if not schema.has(prim, schema.SCHEDULE):
            continue
        if value_of(prim, "quantity", "") in COORDINATES:
            found.update(each.GetPath() for each in targets_of(prim, "target") if each.IsA(UsdPhysics.Joint))
        if value_of(prim, "event", "") == "joint":
            found.update(each.GetPath() for each in targets_of(prim, "eventOf"))
    return found


def _turn_round(joint: UsdPhysics.Joint) -> None:
    """Exchange a joint's ends; its axis is turned, too, so that its coordinate keeps its sign."""
    axis = joint.GetPrim().GetAttribute("physics:axis")
    half_turn = _HALF_TURN[axis.Get() if axis else "X"]
    ends = [
        (joint.GetBody0Rel(), joint.GetLocalPos0Attr(), joint.GetLocalRot0Attr()),
        (joint.GetBody1Rel(), joint.GetLocalPos1Attr(), joint.GetLocalRot1Attr()),
    ]
    said = [(body.GetTargets(), place.Get(), turn.Get()) for body, place, turn in ends]
    for (body, place, turn), (target, position, rotation) in zip(ends, said[::-1], strict=True):
        body.SetTargets(target)
        place.Set(position)
        turn.Set(rotation * half_turn)


def body_frame(prim: Usd.Prim) -> Gf.Matrix4d:
    """The frame that points of what a prim is part of are in: its body's, or the world's."""
    body = body_above(prim)
    if body == WORLD_END:
        return Gf.Matrix4d(1.0)
    owner = UsdGeom.Xformable(prim.GetStage().GetPrimAtPath(body))
    return owner.ComputeLocalToWorldTransform(Usd.TimeCode.Default()).RemoveScaleShear()
