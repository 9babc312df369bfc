"""Places that are drawn: how deep a fluid is, with what floats in it, and where an object is, with what it holds."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from pxr import Gf, Usd, UsdGeom, UsdPhysics

from wsim.errors import UserError
from wsim.geometry.shapes import Solid
from wsim.runs.drawn_objects import changeable, fluid_of, name_of, shift, solid_of
from wsim.scene.authoring import set_extent, set_pose
from wsim.scene.contact import within
from wsim.scene.usd_prims import rigid_frame
from wsim.scene.world import Body, Fluid, Joint, Static, World

TOUCH = 2e-3  # [m]: what is no further apart stands on the other


def set_level(stage: Usd.Stage, world: World, target: str, value: float, times: bool) -> None:
    """Of a fluid, or of the one in a tank: its depth, above a bottom that stays where it is. What floats rises too."""
    what = f"{target}.level"
    fluid = fluid_of(world, target, what)
    level = value * fluid.size[2] if times else value
    if level < fluid.spacing:
        raise UserError(f"{what} = {level:g} m is less than a particle ({fluid.spacing:g} m); give a larger one")
    prim, bottom = changeable(stage, fluid.prim, what), fluid.center[2] - fluid.size[2] / 2
    for tank in world.containers:
        rim = tank.inner_center[2] + tank.inner_size[2] / 2
        if tank.prim == fluid.container and bottom + level > rim + 1e-6:
            raise UserError(f"{what} = {level:g} m is above the rim, {rim - bottom:g} m; give a smaller one")
    rise = level - fluid.size[2]
    for body, lowest in afloat(world, fluid):
        if lowest + rise < bottom:
            raise UserError(
                f"{what} = {level:g} m: {body.prim} floats {bottom + fluid.size[2] - lowest:g} m deep in it, and would "
                "reach through its bottom; give a greater one"
            )
        shift(changeable(stage, body.prim, what), Gf.Matrix4d().SetTranslate(Gf.Vec3d(0.0, 0.0, rise)))
    size = (fluid.size[0], fluid.size[1], level)
    prim.GetAttribute("wsim:size").Set(Gf.Vec3f(*size))
    for child in prim.GetChildren():  # what is drawn of it
        if child.IsA(UsdGeom.Cube):
            set_pose(child, (0.0, 0.0, 0.0), scale=size)
            set_extent(child)
    shift(prim, Gf.Matrix4d().SetTranslate(Gf.Vec3d(0.0, 0.0, rise / 2)))


def afloat(world: World, fluid: Fluid) -> list[tuple[Body, float]]:
    """Loose bodies that go with a fluid's level, and how low each reaches [m]: those that its surface cuts and that do
    not stand on its bottom, and those that stand on them.

    Loose are those that nothing ties to another and that forces move.
    """
    tied = list(_ties(world))
    boxes = {
        body.prim: (body, *_box(body))
        for body in world.bodies
        if body.shapes and not body.kinematic and not any(within(end, body.prim) for end in tied)
    }
    low, high = np.array(fluid.center) - np.array(fluid.size) / 2, np.array(fluid.center) + np.array(fluid.size) / 2
    new = {
        prim
        for prim, (_, least, most) in boxes.items()
        if (least < high).all() and (most > low).all() and least[2] > low[2] + TOUCH and most[2] > high[2]
    }
    found: set[str] = set()
    while new:
        found |= new
        new = {
            prim
            for prim, (_, least, most) in boxes.items()
            if prim not in found
            and least[2] > high[2]
            and any((least < boxes[one][2] + TOUCH).all() and (most > boxes[one][1] - TOUCH).all() for one in found)
        }
    return [(boxes[prim][0], float(boxes[prim][1][2])) for prim in boxes if prim in found]


def _box(body: Body) -> tuple[np.ndarray, np.ndarray]:
    """The box along the world's axes that holds a body: its least and its greatest corner [m]."""
    ends = [Solid(body.shapes).reach(np.array([body.rotation]), axis) for axis in np.eye(3)]
    at = np.array(body.position)
    return at + [low[0] for low, _ in ends], at + [high[0] for _, high in ends]


def move(stage: Usd.Stage, world: World, target: str, kind: str, value: float) -> None:
    """An object, with all that joints hold to it: what hangs together keeps its shape. The ground stays."""
    what = f"{target}.pose"
    solid = solid_of(world, target, what)
    prims, joints = _linkage(world, solid)
    for prim in prims:
        _movable(world, prim, prims, what)
    own = changeable(stage, solid.prim, what)
    if not own.IsA(UsdGeom.Xformable):
        raise UserError(f"{what}: {solid.prim} has no place of its own; move it by a scene.param")
    place = UsdGeom.Xformable(own).ComputeLocalToWorldTransform(Usd.TimeCode.Default()).ExtractTranslation()
    if kind == "pose.turn":
        turn = Gf.Matrix4d().SetRotate(Gf.Rotation(Gf.Vec3d(0.0, 0.0, 1.0), value))
        by = Gf.Matrix4d().SetTranslate(-place) * turn * Gf.Matrix4d().SetTranslate(place)
    else:
        along = Gf.Vec3d(value, 0.0, 0.0) if kind == "pose.x" else Gf.Vec3d(0.0, value, 0.0)
        by = Gf.Matrix4d().SetTranslate(along)
    ends = [(end, end.frame * by) for joint in joints for end in _ends(stage, joint, what)]
    for prim in prims:
        if not any(within(prim, other) for other in prims if other != prim):  # else it goes with the one that it is in
            shift(changeable(stage, prim, what), by)
    for end, frame in ends:
        if not end.prim or not any(within(str(end.prim.GetPath()), prim) for prim in prims):
            end.put(frame)  # of the world, or of what stays in it


def held_together(world: World, target: str) -> str:
    """Of what hangs together with an object, the first prim: a pose of one of them is a pose of all."""
    return min(_linkage(world, solid_of(world, target, f"{target}.pose"))[0])


@dataclass(frozen=True)
class _End:
    """One side of a joint: where its frame is stated, in the frame of a prim or in the world's."""

    prim: Usd.Prim | None
    position: Usd.Attribute
    rotation: Usd.Attribute

    @property
    def frame(self) -> Gf.Matrix4d:
        """In the world."""
        own = Gf.Matrix4d().SetRotate(Gf.Quatd(self.rotation.Get()))
        own.SetTranslateOnly(Gf.Vec3d(self.position.Get()))
        return own * rigid_frame(self.prim) if self.prim else own

    def put(self, frame: Gf.Matrix4d) -> None:
        """State another one."""
        own = frame * rigid_frame(self.prim).GetInverse() if self.prim else frame
        self.position.Set(Gf.Vec3f(own.ExtractTranslation()))
        self.rotation.Set(Gf.Quatf(own.ExtractRotationQuat()))


def _ends(stage: Usd.Stage, joint: Joint, what: str) -> Iterator[_End]:
    usd = UsdPhysics.Joint(changeable(stage, joint.prim, what))
    sides = (
        (usd.GetBody0Rel(), usd.GetLocalPos0Attr(), usd.GetLocalRot0Attr()),
        (usd.GetBody1Rel(), usd.GetLocalPos1Attr(), usd.GetLocalRot1Attr()),
    )
    for relation, position, rotation in sides:
        targets = relation.GetTargets()
        yield _End(stage.GetPrimAtPath(targets[0]) if targets else None, position, rotation)


def _linkage(world: World, solid: Body | Static) -> tuple[list[str], list[Joint]]:
    """What joints hold together with an object, and they. The ground is in none: it is the same wherever it is."""
    endless = {static.prim for static in world.statics if any(shape.kind == "plane" for shape in static.shapes)}
    prims, joints = [solid.prim], list[Joint]()
    for prim in prims:  # it grows
        for joint in world.joints:
            ends = [end for end in (joint.parent, joint.child, joint.fixture) if end and end not in endless]
            if joint not in joints and any(within(end, prim) for end in ends):
                joints.append(joint)
                prims += [end for end in ends if end not in prims]
    return prims, joints


def _movable(world: World, prim: str, prims: Sequence[str], what: str) -> None:
    """Refuse what would be torn apart, or goes its own way."""
    holder = next((by for ends, by in _held(world) if any(within(end, prim) for end in ends)), None)
    if holder is not None:
        raise UserError(
            f"{what}: {holder} holds {name_of(prim)} to where it is; move what hangs together by a scene.param"
        )
    for body in world.bodies:
        if body.path is not None and body.prim == prim:
            raise UserError(
                f"{what}: {name_of(prim)} follows a path, which says where it is; move that by a scene.param"
            )
        if body.prim.startswith(prim + "/") and body.prim not in prims:
            raise UserError(
                f"{what}: {name_of(prim)} has bodies of its own within it; move each, or all by a scene.param"
            )


def _held(world: World) -> Iterator[tuple[list[str], str]]:
    """What each spring, rope and fluid holds in its place, and its prim."""
    for cord in world.cords:
        yield [end for guide in cord.path for end in (guide.body, guide.owner) if end], cord.prim
    for fluid in world.fluids:
        yield [fluid.container] if fluid.container else [], fluid.prim


def _ties(world: World) -> Iterator[str]:
    """What joints, springs and ropes are fixed to."""
    for joint in world.joints:
        yield from (end for end in (joint.parent, joint.child) if end)
    for cord in world.cords:
        yield from (end for guide in cord.path for end in (guide.body, guide.owner) if end)
