"""Joints between two bodies, or a body and the world, and the motors that drive them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from pxr import Gf, Sdf, Usd, UsdPhysics

from wsim.scene.articulation import WORLD_END, closes_loop, mark_articulations, second_parent
from wsim.scene.authoring import Author, Handle, note_line, world_pose
from wsim.scene.limits import MAX_POSITION
from wsim.scene.validate import Call, shown

_MAX_GAIN = 1e9


@dataclass(frozen=True)
class Drive:
    """A motor: force = stiffness (position - q) + damping (velocity - q'), at most `max_force`.

    A revolute joint: `position` [deg], `velocity` [deg/s], `stiffness` [N m/rad], `damping` [N m s/rad],
    `max_force` [N m]. A prismatic joint: [m], [m/s], [N/m], [N s/m], [N]. Zero is where the joint starts.
    With a `velocity` alone give `damping` alone; with a `position` give both. A stiffness shortens the time step, and
    one that would need less than 10 microseconds is refused.
    """

    position: float = 0.0
    velocity: float = 0.0
    stiffness: float = 0.0
    damping: float = 0.0
    max_force: float | None = None


class Joints(Author):
    """The calls that make joints.

    `parent` and `child` are bodies; a parent of None, or a static one, is the world. `anchor` is where they meet, in
    the world [m]; the child's origin if not given. `axis` is "X", "Y" or "Z" of the world, or a direction (x, y, z).
    The pose of the bodies at time 0 is the joint's zero.
    """

    def joint_fixed(
        self,
        name: str,
        parent: Handle | str | None,
        child: Handle | str,
        *,
        anchor: Sequence[float] | None = None,
    ) -> Handle:
        """Hold two bodies together as they stand. For the arguments see `Joints`."""
        call = Call("joint_fixed", name)
        return self._joint(call, UsdPhysics.FixedJoint, parent, child, anchor, None)

    def joint_revolute(
        self,
        name: str,
        parent: Handle | str | None,
        child: Handle | str,
        *,
        anchor: Sequence[float] | None = None,
        axis: str | Sequence[float] = "Z",
        limits_deg: Sequence[float] | None = None,
        drive: Drive | None = None,
    ) -> Handle:
        """Hinge two bodies about an axis, within `limits_deg` = (low, high) [deg]. For the rest see `Joints`."""
        call = Call("joint_revolute", name)
        limits = None if limits_deg is None else _limits(call, "limits_deg", limits_deg, 36000.0, "deg")
        motor = _checked(call, drive, 36000.0)
        driven = motor is not None or limits is not None
        handle = self._joint(call, UsdPhysics.RevoluteJoint, parent, child, anchor, axis, driven=driven)
        self._limit(handle, limits)
        if motor is not None:
            # USD counts an angular drive's gains per degree.
            self._drive(handle, "angular", motor, math.pi / 180.0)
        return handle

    def joint_prismatic(
        self,
        name: str,
        parent: Handle | str | None,
        child: Handle | str,
        *,
        anchor: Sequence[float] | None = None,
        axis: str | Sequence[float] = "Z",
        limits: Sequence[float] | None = None,
        drive: Drive | None = None,
    ) -> Handle:
        """Let a body slide along an axis, within `limits` = (low, high) [m]. For the rest see `Joints`."""
        call = Call("joint_prismatic", name)
        bounds = None if limits is None else _limits(call, "limits", limits, MAX_POSITION, "m")
        motor = _checked(call, drive, MAX_POSITION)
        handle = self._joint(call, UsdPhysics.PrismaticJoint, parent, child, anchor, axis)
        self._limit(handle, bounds)
        if motor is not None:
            self._drive(handle, "linear", motor, 1.0)
        return handle

    def joint_spherical(
        self,
        name: str,
        parent: Handle | str | None,
        child: Handle | str,
        *,
        anchor: Sequence[float] | None = None,
    ) -> Handle:
        """Hold two bodies at one point, free to turn. For the arguments see `Joints`."""
        call = Call("joint_spherical", name)
        return self._joint(call, UsdPhysics.SphericalJoint, parent, child, anchor, "X")

    def _joint(
        self,
        call: Call,
        kind: type,
        parent: Handle | str | None,
        child: Handle | str,
        anchor: Sequence[float] | None,
        axis: str | Sequence[float] | None,
        *,
        driven: bool = False,
    ) -> Handle:
        path = self._path(call)
        child_prim = self._body(call, "child", child)
        if not child_prim.HasAPI(UsdPhysics.RigidBodyAPI):
            call.fail(f"child = {shown(child_prim.GetName())} is static; a joint's child must be a body that moves")
        parent_prim = fixture = None if parent is None else self._body(call, "parent", parent)
        if parent_prim == child_prim:
            call.fail(f"parent = child = {shown(child_prim.GetName())}: a joint needs two bodies, or parent=None")
        if parent_prim is not None and not parent_prim.HasAPI(UsdPhysics.RigidBodyAPI):
            parent_prim = None  # what never moves is the world
        else:
            fixture = None
        self._check_one_parent(call, parent_prim, child_prim)
        self._check_closing(call, parent_prim, child_prim, kind, driven)
        position, turn = world_pose(child_prim)
        point = position if anchor is None else Gf.Vec3d(*call.position("anchor", anchor))
        token, frame = _axis(call, axis)

        joint = kind.Define(self._stage, path)  # type: ignore[attr-defined]
        note_line(joint.GetPrim())
        base = (Gf.Vec3d(0.0), Gf.Quatd(1.0)) if parent_prim is None else world_pose(parent_prim)
        if parent_prim is not None:
            joint.CreateBody0Rel().SetTargets([parent_prim.GetPath()])
        joint.CreateBody1Rel().SetTargets([child_prim.GetPath()])
        for suffix, (origin, rotation) in (("0", base), ("1", (position, turn))):
            back = rotation.GetInverse()
            getattr(joint, f"CreateLocalPos{suffix}Attr")(Gf.Vec3f(back.Transform(point - origin)))
            getattr(joint, f"CreateLocalRot{suffix}Attr")(Gf.Quatf(back * frame))
        if fixture is not None:
            joint.GetPrim().CreateRelationship("wsim:fixture", custom=False).SetTargets([fixture.GetPath()])
        if axis is not None:
            joint.CreateAxisAttr(token)
        mark_articulations(self._stage)
        return Handle(name=joint.GetPrim().GetName(), path=path, kind="joint")

    def _check_one_parent(self, call: Call, parent: Usd.Prim | None, child: Usd.Prim) -> None:
        """A chain grows from its root: what already hangs on one thing cannot be hung on a second chain."""
        above, below = (WORLD_END if prim is None else prim.GetPath() for prim in (parent, child))
        other = second_parent(self._stage, above, below)
        if other is None:
            return
        name = shown(child.GetName())
        holder = "the world" if other == WORLD_END else shown(other.name)
        if parent is None:
            call.fail(f"child = {name} already hangs on {holder}; make {name} the parent in that joint")
        call.fail(
            f"child = {name} already hangs on {holder}; swap them: parent={name}, child={shown(parent.GetName())}"
        )

    def _check_closing(self, call: Call, parent: Usd.Prim | None, child: Usd.Prim, kind: type, driven: bool) -> None:
        """What closes a loop is a constraint; the solver has one for hinges, ball joints and fixed ones alone."""
        above, below = (WORLD_END if prim is None else prim.GetPath() for prim in (parent, child))
        closed = closes_loop(self._stage, above, below)
        if closed == "bodies":
            call.fail(
                f"{shown(child.GetName())} and its parent both hang on the world: a loop is one chain from the world "
                "round to its last body, closed by a last joint with parent=None"
            )
        if closed and kind is UsdPhysics.PrismaticJoint:
            call.fail("a slider cannot close a loop: make it the first joint of the chain, and close with a hinge")
        if closed and driven:
            call.fail("the hinge that closes a loop can have no drive and no limits: put them on another joint of it")

    def _body(self, call: Call, field: str, what: Handle | str) -> Usd.Prim:
        prim = self._find(call, field, what)
        known = isinstance(what, Handle) and what.kind in ("body", "static", "tank")
        if not known and not prim.HasAPI(UsdPhysics.RigidBodyAPI) and not _collides(prim):
            call.fail(f"{field} = {shown(prim.GetName())} is not a body; name a box, sphere, cylinder, capsule or mesh")
        return prim

    def _limit(self, handle: Handle, limits: tuple[float, float] | None) -> None:
        if limits is None:
            return
        prim = self._stage.GetPrimAtPath(handle.path)
        prim.CreateAttribute("physics:lowerLimit", Sdf.ValueTypeNames.Float, False).Set(limits[0])
        prim.CreateAttribute("physics:upperLimit", Sdf.ValueTypeNames.Float, False).Set(limits[1])

    def _drive(self, handle: Handle, freedom: str, drive: Drive, per_unit: float) -> None:
        api = UsdPhysics.DriveAPI.Apply(self._stage.GetPrimAtPath(handle.path), freedom)
        api.CreateTypeAttr("force")
        api.CreateTargetPositionAttr(drive.position)
        api.CreateTargetVelocityAttr(drive.velocity)
        api.CreateStiffnessAttr(drive.stiffness * per_unit)
        api.CreateDampingAttr(drive.damping * per_unit)
        if drive.max_force is not None:
            api.CreateMaxForceAttr(drive.max_force)


def _limits(call: Call, field: str, value: Sequence[float], bound: float, unit: str) -> tuple[float, float]:
    low, high = call.range(field, value, bound, unit)
    if not low <= 0.0 <= high:
        call.fail(f"{field} = ({low:g}, {high:g}) {unit} must hold 0, where the joint starts")
    return low, high


def _checked(call: Call, drive: Drive | None, bound: float) -> Drive | None:
    if drive is None:
        return None
    if not isinstance(drive, Drive):
        call.fail(f"drive = {shown(drive)} must be a Drive(position=, velocity=, stiffness=, damping=, max_force=)")
    checked = Drive(
        position=call.within("drive.position", drive.position, -bound, bound),
        velocity=call.within("drive.velocity", drive.velocity, -1e6, 1e6),
        stiffness=call.within("drive.stiffness", drive.stiffness, 0.0, _MAX_GAIN),
        damping=call.within("drive.damping", drive.damping, 0.0, _MAX_GAIN),
        max_force=None if drive.max_force is None else call.positive("drive.max_force", drive.max_force, _MAX_GAIN, ""),
    )
    if checked.stiffness == 0.0 and checked.damping == 0.0:
        call.fail("drive has stiffness = 0 and damping = 0 and would do nothing; give one of them")
    if checked.position != 0.0 and checked.stiffness == 0.0:
        call.fail(f"drive.position = {checked.position:g} needs drive.stiffness > 0")
    if checked.velocity != 0.0 and checked.damping == 0.0:
        call.fail(f"drive.velocity = {checked.velocity:g} needs drive.damping > 0")
    return checked


def _axis(call: Call, axis: str | Sequence[float] | None) -> tuple[str, Gf.Quatd]:
    """USD's axis token, and the rotation of the joint's frame in the world."""
    if axis is None:
        return "X", Gf.Quatd(1.0)
    if isinstance(axis, str):
        return call.axis(axis), Gf.Quatd(1.0)
    direction = Gf.Vec3d(*call.vector("axis", axis, 1e6, ""))
    if direction.GetLength() < 1e-9:
        call.fail(f"axis = {shown(axis)} has no length; give a direction")
    return "X", Gf.Rotation(Gf.Vec3d.XAxis(), direction.GetNormalized()).GetQuat().GetNormalized()


def _collides(prim: Usd.Prim) -> bool:
    return any(child.HasAPI(UsdPhysics.CollisionAPI) for child in Usd.PrimRange(prim))
