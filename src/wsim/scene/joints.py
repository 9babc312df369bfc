"""Joints between two bodies, or a body and the world, and the motors that drive them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, fields

from pxr import Gf, Sdf, Usd, UsdPhysics

from wsim.limits import MAX_POSITION, MIN_FORCE, MIN_TORQUE, NO_BOUND, bad_stops
from wsim.scene import schema
from wsim.scene.articulation import is_kinematic, mark_articulations, may_break
from wsim.scene.authoring import CONTACTS, Author, Handle, note_line, world_pose
from wsim.scene.gears import contradicts, meshes_of
from wsim.scene.usd_contacts import ends, tied
from wsim.scene.validate import Call, shown

_MAX_GAIN = 1e9
_MAX_LOAD = 1e12  # [N] or [N m]


@dataclass(frozen=True)
class Drive:
    """A motor: force = stiffness (position - q) + damping (velocity - q'), at most `max_force`.

    A revolute joint: `position` [deg], `velocity` [deg/s], `stiffness` [N m/rad], `damping` [N m s/rad],
    `max_force` [N m]. A prismatic joint: [m], [m/s], [N/m], [N s/m], [N]. Zero is where the joint starts.
    With a `velocity` alone give `damping` alone; with a `position` give both. A target beyond a stop of the joint
    presses against that stop, as a gripper or a preloaded spring does. A stiffness shortens the time step, and one that
    would need less than 10 microseconds is refused. `saturates` says that it is meant to end at its full `max_force`:
    a winch that slips, a motor that stalls.
    """

    position: float = 0.0
    velocity: float = 0.0
    stiffness: float = 0.0
    damping: float = 0.0
    max_force: float | None = None
    saturates: bool = False


class Joints(Author):
    """The calls that make joints.

    `parent` and `child` are bodies; a parent of None, or a static one, is the world. `anchor` is where they meet, in
    the world [m]; the child's origin if not given. It may lie outside both bodies, as a long pendulum's pivot does:
    what is between is an arm without mass, which touches nothing. `axis` is "X", "Y" or "Z" of the world, or a
    direction (x, y, z). The pose of the bodies at time 0 is the joint's zero. Joints may close loops, in any order: one
    of each loop becomes a constraint, and is a plain hinge, ball or fixed joint without drive, limits and friction.

    `friction` is dry: it holds up to so much, and slows by as much what moves. A joint breaks for good, between two
    steps, where what it bears reaches more than `break_force` [N] or, about its anchor, `break_torque` [N m].
    """

    def joint_fixed(
        self,
        name: str,
        parent: Handle | str | None,
        child: Handle | str,
        *,
        anchor: Sequence[float] | None = None,
        break_force: float | None = None,
        break_torque: float | None = None,
    ) -> Handle:
        """Hold two bodies together as they stand. For the arguments see `Joints`."""
        call = Call("joint_fixed", name)
        strength = _Strength.of(call, break_force, break_torque)
        prim = self._joint(call, UsdPhysics.FixedJoint, parent, child, anchor, None)
        strength.write(prim)
        return self._spanned(call, prim)

    def joint_revolute(
        self,
        name: str,
        parent: Handle | str | None,
        child: Handle | str,
        *,
        anchor: Sequence[float] | None = None,
        axis: str | Sequence[float] = "Z",
        limits_deg: Sequence[float] | None = None,
        limits: None = None,
        drive: Drive | None = None,
        friction: float = 0.0,
        break_force: float | None = None,
        break_torque: float | None = None,
    ) -> Handle:
        """Hinge two bodies about an axis, within `limits_deg` = (low, high) [deg], against `friction` [N m].

        For the rest see `Joints`. A hinge that may break has neither limits nor drive nor friction.
        """
        call = Call("joint_revolute", name)
        if limits is not None:
            call.fail(f"limits = {shown(limits)} are a slider's, in m; a hinge takes limits_deg = (low, high) in deg")
        bounds = None if limits_deg is None else _limits(call, "limits_deg", limits_deg, 36000.0, "deg")
        motor = _checked(call, drive, 36000.0)
        rubs = call.within("friction", friction, 0.0, _MAX_LOAD, "N m")
        strength = _Strength.of(call, break_force, break_torque)
        if strength and (bounds is not None or motor is not None or rubs):
            call.fail("a hinge that may break can have no limits_deg, drive or friction: put them on another joint")
        prim = self._joint(call, UsdPhysics.RevoluteJoint, parent, child, anchor, axis)
        _write_limits(prim, bounds)
        write_friction(prim, rubs)
        strength.write(prim)
        if motor is not None:
            # USD counts an angular drive's gains per degree.
            write_drive(prim, "angular", motor, math.pi / 180.0)
        return self._spanned(call, prim)

    def joint_prismatic(
        self,
        name: str,
        parent: Handle | str | None,
        child: Handle | str,
        *,
        anchor: Sequence[float] | None = None,
        axis: str | Sequence[float] = "Z",
        limits: Sequence[float] | None = None,
        limits_deg: None = None,
        drive: Drive | None = None,
        friction: float = 0.0,
        break_force: None = None,
        break_torque: None = None,
    ) -> Handle:
        """Let a body slide along an axis, within `limits` = (low, high) [m], against `friction` [N].

        For the rest see `Joints`. A slider cannot break: let a carriage slide, and a `joint_fixed` that breaks hold the
        body to it.
        """
        call = Call("joint_prismatic", name)
        if limits_deg is not None:
            call.fail(
                f"limits_deg = {shown(limits_deg)} are a hinge's, in deg; a slider takes limits = (low, high) in m"
            )
        if _Strength.of(call, break_force, break_torque):
            call.fail(
                "a slider cannot break: let a small carriage body slide, and hold the child to the carriage with a "
                "joint_fixed that has the break_force or break_torque"
            )
        bounds = None if limits is None else _limits(call, "limits", limits, MAX_POSITION, "m")
        motor = _checked(call, drive, MAX_POSITION)
        rubs = call.within("friction", friction, 0.0, _MAX_LOAD, "N")
        prim = self._joint(call, UsdPhysics.PrismaticJoint, parent, child, anchor, axis)
        _write_limits(prim, bounds)
        write_friction(prim, rubs)
        if motor is not None:
            write_drive(prim, "linear", motor, 1.0)
        return self._spanned(call, prim)

    def joint_spherical(
        self,
        name: str,
        parent: Handle | str | None,
        child: Handle | str,
        *,
        anchor: Sequence[float] | None = None,
        break_force: float | None = None,
        break_torque: None = None,
    ) -> Handle:
        """Hold two bodies at one point, free to turn: it bears no torque to break by. For the rest see `Joints`."""
        call = Call("joint_spherical", name)
        if break_torque is not None:
            call.fail(f"break_torque = {shown(break_torque)}: a ball joint bears no torque; give a break_force")
        strength = _Strength.of(call, break_force, None)
        prim = self._joint(call, UsdPhysics.SphericalJoint, parent, child, anchor, "X")
        strength.write(prim)
        return self._spanned(call, prim)

    def _joint(
        self,
        call: Call,
        kind: type,
        parent: Handle | str | None,
        child: Handle | str,
        anchor: Sequence[float] | None,
        axis: str | Sequence[float] | None,
    ) -> Usd.Prim:
        path = self._path(call)
        if axis is None and kind is not UsdPhysics.FixedJoint:
            call.fail('axis = None must be "X", "Y", "Z" or a direction (x, y, z)')
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
        if all(prim is None or is_kinematic(prim) for prim in (parent_prim, child_prim)):
            call.fail(f"{shown(child_prim.GetName())} is kinematic and goes its own way; a joint needs a body to move")
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
        return joint.GetPrim()

    def _spanned(self, call: Call, prim: Usd.Prim, kind: str = "joint") -> Handle:
        """Choose the joints of the trees anew; what `call` made is taken back where that, or a contact, forbids it."""
        stuck = mark_articulations(self._stage).stuck
        names = ", ".join(path.name for path in stuck)
        wrong = (
            f"the joints {names} make a loop in which each slides, or has a drive, limits, friction or a gear; "
            "a loop needs one plain hinge, ball or fixed joint, or bodies in between"
            if stuck
            else self._stated_apart(prim)
        )
        if wrong:
            self._stage.RemovePrim(prim.GetPath())
            mark_articulations(self._stage)
            call.fail(wrong)
        return Handle(name=prim.GetName(), path=str(prim.GetPath()), kind=kind)

    def _stated_apart(self, prim: Usd.Prim) -> str:
        """What is wrong where a contact was stated of two that a joint or a gear keeps from touching, else nothing."""
        scope = self._stage.GetPrimAtPath(CONTACTS)
        ties = tied([prim]) if scope else {}
        for pair in scope.GetChildren() if ties else []:
            tie = ties.get(frozenset(ends(pair)))
            if tie is not None:
                one, other = (shown(end.name) for end in ends(pair))
                return f"contact states how {one} and {other} touch, and they never do: {tie}; leave one of the two out"
        return ""

    def _body(self, call: Call, field: str, what: Handle | str) -> Usd.Prim:
        prim = self._find(call, field, what)
        known = isinstance(what, Handle) and what.kind in ("body", "static", "tank")
        if not known and not prim.HasAPI(UsdPhysics.RigidBodyAPI) and not _collides(prim):
            call.fail(f"{field} = {shown(prim.GetName())} is not a body; name a box, sphere, cylinder, capsule or mesh")
        return prim

    def gear(self, name: str, joint_a: Handle | str, joint_b: Handle | str, *, ratio: float) -> Handle:
        """Couple two hinges or sliders without play: `joint_b` goes `ratio` times as far as `joint_a`.

        Args:
            name: Of the prim.
            joint_a: A hinge or a slider.
            joint_b: Another.
            ratio: In rad or m of `joint_b` for a rad or a m of `joint_a`: two wheels of 20 and 40 teeth that mesh have
                -0.5 about parallel axes, a rack on a wheel of radius r has r or -r [m/rad].

        Raises:
            SceneError: If a joint is no hinge or slider, or may break, or the ratio is 0 or not that of other gears.
        """
        call = Call("gear", name)
        path = self._path(call)
        ends = [self._geared(call, field, what) for field, what in (("joint_a", joint_a), ("joint_b", joint_b))]
        if ends[0] == ends[1]:
            call.fail(f"joint_a = joint_b = {shown(ends[0].GetName())}: a gear couples two joints")
        value = call.within("ratio", ratio, -1e6, 1e6)
        if abs(value) < 1e-6:
            call.fail(f"ratio = {value:g} must be 1e-06 or more, or -1e-06 or less: it couples nothing")
        one, other = (str(end.GetPath()) for end in ends)
        there = contradicts(meshes_of(self._stage), (one, other, value))
        if there is not None:
            call.fail(f"ratio = {value:g}, and other gears couple the two by {there:g}: all would lock; leave one out")
        prim = self._stage.DefinePrim(path, "Scope")
        schema.apply(prim, schema.GEAR, {"ratio": (Sdf.ValueTypeNames.Double, value)})
        for key, end in zip(("wsim:joint0", "wsim:joint1"), ends, strict=True):
            prim.CreateRelationship(key, custom=False).SetTargets([end.GetPath()])
        note_line(prim)
        return self._spanned(call, prim, "gear")

    def _geared(self, call: Call, field: str, what: Handle | str) -> Usd.Prim:
        prim = self._find(call, field, what)
        if not any(prim.IsA(kind) for kind in (UsdPhysics.RevoluteJoint, UsdPhysics.PrismaticJoint)):
            call.fail(f"{field} = {shown(prim.GetName())} is no hinge and no slider, which a gear needs")
        if may_break(UsdPhysics.Joint(prim)):
            call.fail(f"{field} = {shown(prim.GetName())} may break; a gear needs joints that hold")
        return prim


@dataclass(frozen=True)
class _Strength:
    """What a joint breaks at [N], [N m]; None is never."""

    force: float | None
    torque: float | None

    @classmethod
    def of(cls, call: Call, force: float | None, torque: float | None) -> _Strength:
        """As a call gives it."""
        return cls(
            None if force is None else call.positive("break_force", force, _MAX_LOAD, "N", MIN_FORCE),
            None if torque is None else call.positive("break_torque", torque, _MAX_LOAD, "N m", MIN_TORQUE),
        )

    def __bool__(self) -> bool:
        return self.force is not None or self.torque is not None

    def write(self, prim: Usd.Prim) -> None:
        """State it on a joint."""
        if self.force is not None:
            UsdPhysics.Joint(prim).CreateBreakForceAttr(self.force)
        if self.torque is not None:
            UsdPhysics.Joint(prim).CreateBreakTorqueAttr(self.torque)


def _write_limits(prim: Usd.Prim, limits: tuple[float, float] | None) -> None:
    if limits is None:
        return
    prim.CreateAttribute("physics:lowerLimit", Sdf.ValueTypeNames.Float, False).Set(limits[0])
    prim.CreateAttribute("physics:upperLimit", Sdf.ValueTypeNames.Float, False).Set(limits[1])


def write_friction(prim: Usd.Prim, friction: float) -> None:
    """State the dry friction of a joint [N m] or [N]."""
    if friction:
        prim.AddAppliedSchema("NewtonJointAPI")
        prim.CreateAttribute("newton:friction", Sdf.ValueTypeNames.Float, False).Set(friction)


def write_drive(prim: Usd.Prim, freedom: str, drive: Drive, per_unit: float) -> None:
    """State a drive of a joint: "angular" or "linear", its gains times `per_unit` in USD's units."""
    api = UsdPhysics.DriveAPI.Apply(prim, freedom)
    api.CreateTypeAttr("force")
    api.CreateTargetPositionAttr(drive.position)
    api.CreateTargetVelocityAttr(drive.velocity)
    api.CreateStiffnessAttr(drive.stiffness * per_unit)
    api.CreateDampingAttr(drive.damping * per_unit)
    if drive.max_force is not None:
        api.CreateMaxForceAttr(drive.max_force)
    if drive.saturates:
        schema.apply(prim, schema.DRIVE, {"saturates": (Sdf.ValueTypeNames.Bool, True)})


def _limits(call: Call, field: str, value: Sequence[float], bound: float, unit: str) -> tuple[float, float]:
    low, high = call.range(field, value, bound, unit)
    if wrong := bad_stops(low, high, unit):
        call.fail(f"{field} = {wrong}")
    return low, high


def _checked(call: Call, drive: Drive | None, bound: float) -> Drive | None:
    if drive is None:
        return None
    if not isinstance(drive, Drive):
        names = ", ".join(f"{each.name}=" for each in fields(Drive))
        call.fail(f"drive = {shown(drive)} must be a Drive({names})")
    checked = Drive(
        position=call.within("drive.position", drive.position, -bound, bound),
        velocity=call.within("drive.velocity", drive.velocity, -1e6, 1e6),
        stiffness=call.within("drive.stiffness", drive.stiffness, 0.0, _MAX_GAIN),
        damping=call.within("drive.damping", drive.damping, 0.0, _MAX_GAIN),
        max_force=None if drive.max_force is None else call.positive("drive.max_force", drive.max_force, _MAX_GAIN, ""),
        saturates=call.flag("drive.saturates", drive.saturates),
    )
    if checked.saturates and checked.max_force is None:
        call.fail(f"drive.saturates = True {NO_BOUND}")
    if checked.stiffness == 0.0 and checked.damping == 0.0:
        call.fail("drive has stiffness = 0 and damping = 0 and would do nothing; give one of them")
    if checked.position != 0.0 and checked.stiffness == 0.0:
        call.fail(f"drive.position = {checked.position:g} needs drive.stiffness > 0")
    if checked.velocity != 0.0 and checked.damping == 0.0:
        call.fail(
            f"drive.velocity = {checked.velocity:g} needs drive.damping > 0: the force is stiffness (position - q) + "
            "damping (velocity - q'), and without damping nothing follows a velocity"
        )
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
