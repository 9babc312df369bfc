"""Joints that the simulator can take: in trees, one articulation root to each, and loops closed by joints left out.

`mark_articulations` makes a stage so. One that was written by other means says so itself, or is refused.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

from pxr import Sdf, Usd, UsdPhysics

from wsim.limits import MIN_FORCE, MIN_TORQUE, NO_BOUND, SHORTEST_WAY
from wsim.scene import schema
from wsim.scene.articulation import (
    dry_friction,
    geared_joints,
    is_kinematic,
    joint_ends,
    joints_of,
    may_break,
)
from wsim.scene.gears import contradicts, meshes_of
from wsim.scene.spanning import WORLD_END

_CLOSING = (UsdPhysics.FixedJoint, UsdPhysics.RevoluteJoint, UsdPhysics.SphericalJoint)
_ONE_FREEDOM = (UsdPhysics.RevoluteJoint, UsdPhysics.PrismaticJoint)
_ROOT = UsdPhysics.ArticulationRootAPI


def joint_problems(stage: Usd.Stage) -> Iterator[str]:
    """Problems of the joints of a stage, taken together."""
    tree, closing = Forest(), []
    holders: dict[Sdf.Path, Sdf.Path] = {}  # body → the joint that it hangs by
    for joint in joints_of(stage):
        if joint.GetPrim().IsA(UsdPhysics.DistanceJoint):
            yield f"{joint.GetPath()}: a distance joint is not supported; use a spherical joint, or a prismatic one"
            continue
        yield from _numbers(joint)
        yield from _kinematic(joint)
        if may_break(joint) or joint.GetExcludeFromArticulationAttr().Get():
            closing.append(joint)
        else:
            yield from _grown(tree, joint, holders)
    geared = geared_joints(stage) if closing else set()
    for joint in closing:
        yield from _constraint(joint, joint.GetPath() in geared)
    yield from _roots(tree, stage)
    gears = [prim for prim in stage.Traverse() if schema.has(prim, schema.GEAR)]
    for prim in gears:
        yield from _gear(prim)
    meshes = meshes_of(stage) if gears else []
    for k, mesh in enumerate(meshes):
        there = contradicts(meshes[:k], mesh)
        if there is not None:
            yield f"{mesh[1]}: a gear couples it to <{mesh[0]}> by {mesh[2]:g}, and others by {there:g}: all would lock"


def _numbers(joint: UsdPhysics.Joint) -> Iterator[str]:
    """Friction, and what a joint breaks at."""
    friction = dry_friction(joint.GetPrim())
    if not (math.isfinite(friction) and friction >= 0.0):
        yield f"{joint.GetPath()}.newton:friction: {friction:g} must be finite and >= 0"
    if friction > 0.0 and not any(joint.GetPrim().IsA(kind) for kind in _ONE_FREEDOM):
        yield f"{joint.GetPath()}.newton:friction: a revolute or a prismatic joint can rub, not this one"
    low, high = (_limit(joint.GetPrim(), end) for end in ("lower", "upper"))
    if low is not None and high is not None and not high - low >= SHORTEST_WAY:
        yield f"{joint.GetPath()}.physics:upperLimit: {high:g} must be above lowerLimit = {low:g}; or use a fixed joint"
    for attribute in (joint.GetBreakForceAttr(), joint.GetBreakTorqueAttr()):
        if not attribute.Get() > 0.0:
            yield f"{attribute.GetPath()}: {attribute.Get():g} must be > 0; inf never breaks"
    for attribute, least, unit in (
        (joint.GetBreakForceAttr(), MIN_FORCE, "N"),
        (joint.GetBreakTorqueAttr(), MIN_TORQUE, "N m"),
    ):
        if 0.0 < attribute.Get() < 0.99 * least:  # of single precision
            yield f"{attribute.GetPath()}: {attribute.Get():g} must be >= {least:g} {unit}; inf never breaks"
    saturates = joint.GetPrim().GetAttribute("wsim:saturates")
    if saturates and saturates.Get() and not _bounded(joint.GetPrim()):
        yield f"{joint.GetPath()}.wsim:saturates: 1 {NO_BOUND} (drive:angular:physics:maxForce, or linear)"


def _bounded(prim: Usd.Prim) -> bool:
    """Whether a joint has a drive of a greatest effort."""
    drives = [UsdPhysics.DriveAPI.Get(prim, kind) for kind in ("angular", "linear")]
    return any(drive and math.isfinite(drive.GetMaxForceAttr().Get()) for drive in drives)


def _kinematic(joint: UsdPhysics.Joint) -> Iterator[str]:
    """A joint that is to hold what goes its own way."""
    stage = joint.GetPrim().GetStage()
    held = [path for path in joint_ends(joint) if path != WORLD_END and not is_kinematic(stage.GetPrimAtPath(path))]
    if not held:
        yield f"{joint.GetPath()}: a kinematic body goes its own way; a joint needs a body at one end that it can move"


def _grown(tree: Forest, joint: UsdPhysics.Joint, holders: dict[Sdf.Path, Sdf.Path]) -> Iterator[str]:
    """Hang a joint's child on its parent, or say why that cannot be."""
    parent, child = joint_ends(joint)
    if is_kinematic(joint.GetPrim().GetStage().GetPrimAtPath(child)):
        yield f"{joint.GetPath()}.physics:body1: <{child}> is kinematic; make it body0, or exclude the joint"
    elif tree.add(parent, child, joint.GetPath()):
        holders[child] = joint.GetPath()
    elif tree.root(parent) == tree.root(child):
        yield f"{joint.GetPath()}: closes a loop of joints; give it physics:excludeFromArticulation = 1"
    else:
        yield (
            f"{joint.GetPath()}.physics:body1: <{child}> is the body1 of <{holders[child]}>, too; swap body0 and body1 "
            "in one of the two, so that each body hangs on one"
        )


def _constraint(joint: UsdPhysics.Joint, geared: bool) -> Iterator[str]:
    """A joint outside the trees is a constraint, which has no coordinate."""
    does, instead = "closes a loop", "let another joint of the loop close it"
    if may_break(joint):
        does, instead = "breaks", "let a carriage slide, and a fixed joint that breaks hold the body to it"
    prim = joint.GetPrim()
    if not any(prim.IsA(kind) for kind in _CLOSING):
        kind = prim.GetTypeName()
        yield f"{joint.GetPath()}: a {kind} {does}; only a fixed, revolute or spherical joint can: {instead}"
    elif what := _needs(prim, geared):
        yield f"{joint.GetPath()}: it {does}, and such a joint can have no {what}; put that on another joint"


def _needs(prim: Usd.Prim, geared: bool) -> str:
    """What a joint has that needs a coordinate."""
    has = {
        "drive": prim.HasAPI(UsdPhysics.DriveAPI, "angular"),
        "limits": any(_limit(prim, end) is not None for end in ("lower", "upper")),
        "friction": dry_friction(prim) > 0.0,
        "gear": geared,
    }
    return next((what for what, there in has.items() if there), "")


def _limit(prim: Usd.Prim, end: str) -> float | None:
    """Where a joint stops, [m] or [deg]; None where it does not."""
    attribute = prim.GetAttribute(f"physics:{end}Limit")
    value = attribute.Get() if attribute else None
    return value if value is not None and math.isfinite(value) else None


def _gear(prim: Usd.Prim) -> Iterator[str]:
    """A gear couples two joints of one freedom each."""
    targets = []
    for name in ("wsim:joint0", "wsim:joint1"):
        relation = prim.GetRelationship(name)
        path = next(iter(relation.GetTargets() if relation else []), None)
        joint = prim.GetStage().GetPrimAtPath(path) if path else None
        targets.append(path)
        if not joint or not any(joint.IsA(kind) for kind in _ONE_FREEDOM):
            yield f"{prim.GetPath()}.{name}: <{path or ''}> is no revolute or prismatic joint"
    if targets[0] == targets[1]:
        yield f"{prim.GetPath()}.wsim:joint1: <{targets[1]}> is the gear's other joint, too"
    value = prim.GetAttribute("wsim:ratio").Get() if prim.HasAttribute("wsim:ratio") else None
    if value is None or not math.isfinite(value) or value == 0.0:
        yield f"{prim.GetPath()}.wsim:ratio: {value} must be finite and not 0"


def _roots(tree: Forest, stage: Usd.Stage) -> Iterator[str]:
    """Trees without a root of their own. One body that is tied to the world needs none."""
    trees: dict[Sdf.Path, list[Sdf.Path]] = {}
    for body in tree.bodies():
        trees.setdefault(tree.top(body), []).append(body)
    taken: set[Sdf.Path] = set()
    for top, bodies in trees.items():
        anchor = tree.anchor(top)
        found = sorted({root for path in [*bodies, anchor] if path for root in _at_or_above(stage.GetPrimAtPath(path))})
        if len(found) > 1 or taken.intersection(found):
            yield f"{found[-1]}: its joints have another articulation root, or it has two chains; give each chain one"
        elif not found and len(bodies) > 1:
            yield f"{anchor or top}: its joints have no articulation root; apply PhysicsArticulationRootAPI here"
        taken.update(found)


def _at_or_above(prim: Usd.Prim) -> Iterator[Sdf.Path]:
    while prim and not prim.IsPseudoRoot():
        if prim.HasAPI(_ROOT):
            yield prim.GetPath()
        prim = prim.GetParent()


class Forest:
    """Rooted trees of bodies, grown a joint at a time."""

    def __init__(self) -> None:
        self._parent: dict[Sdf.Path, Sdf.Path] = {}
        self._anchor: dict[Sdf.Path, Sdf.Path] = {}  # body → the joint that ties it to the world
        self._bodies: dict[Sdf.Path, None] = {}

    def add(self, parent: Sdf.Path, child: Sdf.Path, joint: Sdf.Path) -> bool:
        """Hang `child` on `parent`; False, and nothing done, where that would give it two parents or close a loop."""
        if child in self._parent or self.top(parent) == child:
            return False
        self._parent[child] = parent
        if parent == WORLD_END:
            self._anchor[child] = joint
        for path in (parent, child):
            if path != WORLD_END:
                self._bodies[path] = None
        return True

    def root(self, path: Sdf.Path) -> Sdf.Path:
        """What a body's tree stands on: the world, or the topmost body."""
        top = self.top(path)
        return WORLD_END if top in self._anchor else top

    def bodies(self) -> list[Sdf.Path]:
        """Every body that a joint holds."""
        return list(self._bodies)

    def anchor(self, path: Sdf.Path) -> Sdf.Path | None:
        """The joint that ties a body to the world; None if none does."""
        return self._anchor.get(path)

    def top(self, path: Sdf.Path) -> Sdf.Path:
        """The topmost body of a body's tree."""
        while self._parent.get(path, WORLD_END) != WORLD_END:
            path = self._parent[path]
        return path
