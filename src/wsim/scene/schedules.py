"""What happens by time or after an event: schedules, which the simulator follows in all worlds."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

from pxr import Gf, Sdf, Usd, UsdGeom, UsdPhysics, Vt

from wsim import quantities
from wsim.limits import MAX_DURATION, MAX_KEYS, MAX_POSITION
from wsim.quantities import Quantity
from wsim.scene import schema
from wsim.scene.articulation import COORDINATES, is_kinematic, mark_articulations, may_break, needs_coordinate
from wsim.scene.authoring import CONTACTS, SCHEDULES, WORLD, Author, Handle, note_line
from wsim.scene.usd_contacts import ends, owner
from wsim.scene.usd_schedules import OF_EVENTS, kind_of, lacks
from wsim.scene.validate import Call, shown, suggestion

UNBREAKABLE = 1e12  # [N]: a joint that lets go is one that breaks, at a load that nothing comes to
MOST_NAMES = 40  # in a message
_NAMES = Sdf.ValueTypeNames


@dataclass(frozen=True)
class Event:
    """What a schedule's times count from: the first moment at which it is so; give one of the five.

    Attributes:
        touch: Two objects that touch.
        body: One whose origin is above or below a value along the world's `axis` [m].
        joint: One that is above or below a value [deg] or [m].
        start: A schedule at its first key.
        end: A schedule at its last key.
        axis: "X", "Y" or "Z", with `body`.
        above: The value that is passed upwards, or in the axis's own direction;
        below: or the one that is passed downwards.
        delay: From the event to the schedule's time 0 [s].
    """

    touch: Sequence[Handle | str] | None = None
    body: Handle | str | None = None
    joint: Handle | str | None = None
    start: Handle | str | None = None
    end: Handle | str | None = None
    axis: str | None = None
    above: float | None = None
    below: float | None = None
    delay: float = 0.0


class Schedules(Author):
    """The call that says what happens by time."""

    def schedule(
        self,
        name: str,
        what: Handle | str | Sequence[Handle | str],
        quantity: str,
        *,
        times: Sequence[float],
        values: Sequence[float] | Sequence[Sequence[float]] | None = None,
        linear: bool | None = None,
        point: Sequence[float] | None = None,
        after: Event | None = None,
    ) -> Handle:
        """Say what a quantity of something is by time; until the first key it is as stated, from the last on as there.

        Of a joint "position" [deg] or [m], where its servo goes, "velocity" [deg/s] or [m/s], its motor's, "effort"
        [N m] or [N] beside its drive, or "release": it lets go for good. Of a loose body "force" [N] or "torque" [N m]
        in the world's axes, zero until the first key. Of a kinematic body without a path "velocity" [m/s] of its centre
        of mass or "angular_velocity" [deg/s], in the world's axes. Of what never moves "surface_velocity" [m/s] in its
        own axes, as `surface_velocity`. Of a pair (a, b) that `contact` states "friction".

        Args:
            name: Of the schedule.
            what: A joint, a body or a static object, or two objects; handles or names.
            quantity: One of those.
            times: Of the keys [s], rising from 0 or more; counted from the start of the run, or from an event.
            values: At each key a number, or (x, y, z); of a release none.
            linear: Whether it goes straight from key to key, or each is kept until the next; by default only positions
                go straight.
            point: Where a force acts, in the body's own frame [m]; by default its centre of mass.
            after: The event that the times count from.

        Raises:
            SceneError: If there is no such thing, it has no such quantity or a schedule of it already, its drive has
                not the stiffness or the damping for it, or a number is out of range.
        """
        call = Call("schedule", name)
        path = self._path(call, SCHEDULES)
        target = self._what_of(call, what)
        kind = kind_of(target)
        found = quantities.OF[kind].get(quantity) if isinstance(quantity, str) else None
        if (
            found is None
            and isinstance(quantity, str)
            and quantity in quantities.JOINT
            and (joints := _joints_of(target))
        ):
            call.fail(f"what = {target.GetName()} has joints of its own; name one: {_some(joints)}")
        if found is None:
            call.fail(
                f"quantity = {shown(quantity)}: what = {target.GetName()} is a {quantities.CALLED[kind]}, which has "
                f"{quantities.said(kind)}"
            )
        if quantity in COORDINATES:
            self._give_coordinate(target)
        if (wrong := lacks(target, quantity)) is not None:
            call.fail(f"{target.GetName()}: {wrong}")
        self._check_unscheduled(call, target, quantity)
        when = _times(call, times)
        given = _values(call, target, found, values, len(when))
        attributes: dict[str, tuple[Sdf.ValueTypeName, object]] = {
            "quantity": (_NAMES.Token, quantity),
            "times": (_NAMES.DoubleArray, Vt.DoubleArray(when)),
            "values": (_NAMES.DoubleArray, Vt.DoubleArray(given)),
            "linear": (_NAMES.Bool, found.linear if linear is None else call.flag("linear", linear)),
        }
        if point is not None:
            if quantity != "force":
                call.fail(f"point is where a force acts; this is a {quantity}")
            attributes["point"] = _NAMES.Point3d, Gf.Vec3d(*call.position("point", point))
        event, of_event = ({}, []) if after is None else self._event(call, after)
        if quantity == "release":
            self._let_go(call, target)
        prim = UsdGeom.Scope.Define(self._stage, SCHEDULES) and UsdGeom.Scope.Define(self._stage, path).GetPrim()
        schema.apply(prim, schema.SCHEDULE, attributes | event)
        prim.CreateRelationship("wsim:target", custom=False).SetTargets([target.GetPath()])
        if of_event:
            prim.CreateRelationship("wsim:eventOf", custom=False).SetTargets([end.GetPath() for end in of_event])
        note_line(prim)
        return Handle(prim.GetName(), path, "schedule")

    def _what_of(self, call: Call, what: object) -> Usd.Prim:
        """What is scheduled: a prim, or the one that states a pair."""
        if not isinstance(what, (tuple, list)):
            if isinstance(what, str) and what and not self._stage.GetPrimAtPath(_path_of(what)):
                joints = _joints_of(self._stage.GetPrimAtPath(WORLD))
                if joints:
                    told = suggestion(what, [*self._object_names(), *joints])
                    call.fail(f"what = {shown(what)} is not in the scene; {told}")
            return self._find(call, "what", what)
        if len(what) != 2:
            call.fail(f"what = {shown(what)}: a pair is two objects")
        pair = self._stated_pair(*(self._find(call, f"what[{k}]", each) for k, each in enumerate(what)))
        if pair is None:
            call.fail(f"what = {shown(what)}: the pair has no friction of its own; state one by scene.contact before")
        return pair

    def _stated_pair(self, one: Usd.Prim, other: Usd.Prim) -> Usd.Prim | None:
        wanted = {owner(one).GetPath(), owner(other).GetPath()}
        scope = self._stage.GetPrimAtPath(CONTACTS)
        return next((pair for pair in scope.GetChildren() if set(ends(pair)) == wanted), None) if scope else None

    def _check_unscheduled(self, call: Call, target: Usd.Prim, quantity: str) -> None:
        scope = self._stage.GetPrimAtPath(SCHEDULES)
        for other in scope.GetChildren() if scope else ():
            same = other.GetRelationship("wsim:target").GetTargets() == [target.GetPath()]
            if same and other.GetAttribute("wsim:quantity").Get() == quantity:
                call.fail(
                    f'the {quantity} of {target.GetName()} has the schedule "{other.GetName()}" already; put all keys '
                    "into one"
                )

    def _give_coordinate(self, joint: Usd.Prim) -> None:
        """Let another joint close a loop in place of one that is scheduled, or that an event is of, if one can."""
        api = UsdPhysics.Joint(joint)
        if joint.IsA(UsdPhysics.RevoluteJoint) and api.GetExcludeFromArticulationAttr().Get() and not may_break(api):
            mark_articulations(self._stage, needing=[joint.GetPath()])

    def _let_go(self, call: Call, joint: Usd.Prim) -> None:
        api = UsdPhysics.Joint(joint)
        if needs_coordinate(api):
            call.fail(
                f"{joint.GetName()} slides, or has limits, a drive or friction, and cannot let go: hold the body by a "
                "joint_fixed to a carriage that has them, and release that"
            )
        if not may_break(api):
            api.CreateBreakForceAttr(UNBREAKABLE)
            mark_articulations(self._stage)

    def _event(self, call: Call, event: object) -> tuple[dict[str, tuple[Sdf.ValueTypeName, object]], list[Usd.Prim]]:
        """Attributes of an event, and what it is of."""
        if not isinstance(event, Event):
            call.fail(f'after = {shown(event)} must be an Event, such as Event(touch=("ball", "floor"))')
        kinds = [kind for kind in OF_EVENTS if getattr(event, kind) is not None]
        if len(kinds) != 1:
            call.fail(f"after has {', '.join(kinds) or 'none'} of {', '.join(OF_EVENTS)}; give one")
        kind = kinds[0]
        delay = call.within("after.delay", event.delay, 0.0, MAX_DURATION, "s")
        found: dict[str, tuple[Sdf.ValueTypeName, object]] = {
            "event": (_NAMES.Token, OF_EVENTS[kind]), "eventDelay": (_NAMES.Double, delay),
        }  # fmt: skip
        passes = kind in ("body", "joint")
        bounds = [name for name in ("above", "below") if getattr(event, name) is not None]
        if len(bounds) != passes:
            call.fail(f"after: {', '.join(bounds) or 'no value'} with {kind}; a body or a joint is above or below one")
        if (event.axis is not None) != (kind == "body"):
            call.fail('after: axis ("X", "Y" or "Z") goes with body, and a body needs it')
        if passes:
            most = MAX_POSITION if kind == "body" else 36000.0
            value = call.within(f"after.{bounds[0]}", getattr(event, bounds[0]), -most, most)
            found |= {"eventValue": (_NAMES.Double, value), "eventAbove": (_NAMES.Bool, bounds[0] == "above")}
        if kind == "body":
            found["eventAxis"] = _NAMES.Token, call.axis(event.axis, "after.axis")
        return found, self._ends_of_event(call, kind, getattr(event, kind))

    def _ends_of_event(self, call: Call, kind: str, of: object) -> list[Usd.Prim]:
        field = f"after.{kind}"
        if kind in ("start", "end"):
            name = of.name if isinstance(of, Handle) else str(of).rsplit("/", 1)[-1]
            scope = self._stage.GetPrimAtPath(SCHEDULES)
            known = [prim.GetName() for prim in scope.GetChildren()] if scope else []
            if name not in known:
                call.fail(f"{field} = {shown(name)} is no schedule made before; {suggestion(name, known)}")
            return [scope.GetChild(name)]
        if kind == "body":
            return [self._rigid_body(call, field, of)]
        if kind == "joint":
            prim = self._find(call, field, of)
            if not any(prim.IsA(each) for each in (UsdPhysics.RevoluteJoint, UsdPhysics.PrismaticJoint)):
                call.fail(f"{field} = {shown(prim.GetName())} is no hinge and no slider, which alone pass a value")
            self._give_coordinate(prim)
            return [prim]
        pair = call.listed(field, of, "two objects")
        found = [self._find(call, f"{field}[{k}]", each) for k, each in enumerate(pair)]
        if len(found) != 2 or found[0] == found[1]:
            call.fail(f"{field} = {shown(of)} must be two objects")
        for prim in found:
            if not any(part.HasAPI(UsdPhysics.CollisionAPI) for part in Usd.PrimRange(prim)):
                call.fail(f"{field}: {shown(prim.GetName())} has nothing that collides; name two solids")
        if not any(prim.HasAPI(UsdPhysics.RigidBodyAPI) and not is_kinematic(prim) for prim in found):
            call.fail(f"{field}: neither of {shown(of)} is a loose body; they never meet")
        return found


def _path_of(what: str) -> str:
    path = what if what.startswith("/") else f"{WORLD}/{what}"
    return path if Sdf.Path.IsValidPathString(path) else "/"


def _joints_of(prim: Usd.Prim) -> list[str]:
    """The joints at or below a prim, as a call may name them."""
    below = Usd.PrimRange(prim) if prim else ()
    return [str(each.GetPath()).removeprefix(f"{WORLD}/") for each in below if each.IsA(UsdPhysics.Joint)]


def _some(names: list[str]) -> str:
    return ", ".join(names[:MOST_NAMES]) + (f", ... ({len(names)})" if len(names) > MOST_NAMES else "")


def _times(call: Call, times: object) -> list[float]:
    listed = call.listed("times", times, "numbers in s")
    when = [call.within(f"times[{k}]", time, 0.0, MAX_DURATION, "s") for k, time in enumerate(listed)]
    if not 1 <= len(when) <= MAX_KEYS:
        call.fail(f"times has {len(when)} keys; give 1 to {MAX_KEYS}")
    if any(later <= one for one, later in pairwise(when)):
        call.fail(f"times = {shown(tuple(when))} must rise")
    return when


def _values(call: Call, target: Usd.Prim, found: Quantity, values: object, count: int) -> list[float]:
    """The values of all keys, one after another."""
    if found.count == 0:
        if values is not None or count != 1:
            call.fail("a release has one time and no values")
        return []
    if values is None:
        call.fail(f"values is missing: one for each of times, {count}")
    items = call.listed("values", values, "one for each of times")
    if len(items) != count:
        call.fail(f"values has {len(items)} and times {count}; give one for each")
    unit = found.turning if target.IsA(UsdPhysics.RevoluteJoint) else found.unit
    if found.count == 1:
        return [call.within(f"values[{k}]", item, found.low, found.most, unit) for k, item in enumerate(items)]
    return [each for k, item in enumerate(items) for each in call.vector(f"values[{k}]", item, found.most, unit)]
