"""Schedules of a stage, held against what the simulator needs of them."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from itertools import pairwise

from pxr import Usd, UsdPhysics

from wsim import quantities
from wsim.limits import MAX_DURATION, MAX_KEYS, MAX_POSITION
from wsim.quantities import What
from wsim.scene import schema
from wsim.scene.articulation import COORDINATES, is_kinematic, may_break
from wsim.scene.usd_values import duration_of, targets_of, value_of

OF_EVENTS = {"touch": "touch", "body": "place", "joint": "joint", "start": "start", "end": "end"}


def kind_of(prim: Usd.Prim) -> What:
    """What sort of thing it is, of which schedules know the quantities."""
    if schema.has(prim, schema.CONTACT):
        return "pair"
    if prim.IsA(UsdPhysics.Joint):
        return "joint"
    if prim.HasAPI(UsdPhysics.RigidBodyAPI):
        return "kinematic" if is_kinematic(prim) else "body"
    return "solid"


def lacks(target: Usd.Prim, quantity: str) -> str | None:
    """What a thing lacks for a schedule of a quantity of its kind; None where it has all."""
    if quantity in COORDINATES and target.IsA(UsdPhysics.Joint):
        return _joint_lacks(target, quantity)
    if quantity in quantities.KINEMATIC and not target.IsA(UsdPhysics.Joint) and schema.has(target, schema.PATH):
        return "it has a path, which says where it goes; leave one of the two out"
    if quantity == "surface_velocity":
        parts = Usd.PrimRange(target, Usd.TraverseInstanceProxies())
        if not any(part.HasAPI(UsdPhysics.CollisionAPI) for part in parts):
            return "nothing of it collides, and carries anything; name a solid"
    if quantity == "friction" and not target.GetAttribute("wsim:friction").HasAuthoredValue():
        return "the pair states no friction, which the schedule would change; give its contact one"
    return None


def _joint_lacks(joint: Usd.Prim, quantity: str) -> str | None:
    if not any(joint.IsA(kind) for kind in (UsdPhysics.RevoluteJoint, UsdPhysics.PrismaticJoint)):
        return f"a joint of its kind has no {quantity}; a hinge or a slider has"
    if UsdPhysics.Joint(joint).GetExcludeFromArticulationAttr().Get():
        if may_break(UsdPhysics.Joint(joint)):
            return f"it may break or let go, and has no {quantity}: schedule a force or a torque of its body"
        return (
            f"it closes a loop, and has no {quantity}: the other joints of the loop slide, or have drives, limits, "
            "friction, gears or schedules; leave one of them a plain hinge, or schedule one of them"
        )
    drive = UsdPhysics.DriveAPI.Get(joint, "angular" if joint.IsA(UsdPhysics.RevoluteJoint) else "linear")
    if quantity == "effort":
        return None
    gain = "stiffness" if quantity == "position" else "damping"
    attribute = getattr(drive, f"Get{gain.title()}Attr")() if drive else None
    if attribute is None or not (attribute.Get() or 0.0) > 0.0:
        return f"a {quantity} is what its drive aims at, and it has none with a {gain}; give it a drive={gain}"
    if schema.has(joint, schema.JOINT_PATH):
        return "it goes by times and positions of its robot's drive already; leave one of the two out"
    return None


def schedule_problems(prims: Iterable[Usd.Prim]) -> Iterator[str]:
    """Problems of the schedules among a stage's prims."""
    seen: dict[tuple[str, str], Usd.Prim] = {}
    before: list[Usd.Prim] = []
    for prim in prims:
        if not schema.has(prim, schema.SCHEDULE):
            continue
        problems = [*_keys(prim, seen), *_of_event(prim, before)] or [*_beyond_the_end(prim)]
        yield from (f"{prim.GetPath()}.wsim:{problem}" for problem in problems)
        before.append(prim)


def _keys(prim: Usd.Prim, seen: dict[tuple[str, str], Usd.Prim]) -> Iterator[str]:
    targets, quantity = targets_of(prim, "target"), str(value_of(prim, "quantity", ""))
    if len(targets) != 1:
        yield "target: it must be one joint, body, static object or pair"
        return
    kind = kind_of(targets[0])
    found = quantities.OF[kind].get(quantity)
    if found is None:
        yield f"quantity: <{targets[0].GetPath()}> is a {quantities.CALLED[kind]}, which has {quantities.said(kind)}"
        return
    if (wrong := lacks(targets[0], quantity)) is not None:
        yield f"target: <{targets[0].GetPath()}>: {wrong}"
    if quantity == "release" and not may_break(UsdPhysics.Joint(targets[0])):
        yield "target: a joint that lets go is one that may break; give it a physics:breakForce"
    if (other := seen.setdefault((str(targets[0].GetPath()), quantity), prim)) != prim:
        yield f"target: <{other.GetPath()}> is of the same {quantity}; put all keys into one"
    times, values = list(value_of(prim, "times", ())), list(value_of(prim, "values", ()))
    if not 1 <= len(times) <= MAX_KEYS or (found.count == 0 and len(times) != 1):
        yield f"times: {len(times)} keys; 1 to {MAX_KEYS}, of a release one"
    elif not all(0.0 <= time <= MAX_DURATION for time in times) or any(b <= a for a, b in pairwise(times)):
        yield f"times: they must rise from 0 or more to at most {MAX_DURATION:g} s"
    if len(values) != found.count * len(times):
        yield f"values: {len(values)} numbers; {found.count} for each of {len(times)} times"
    elif not all(found.low <= value <= found.most for value in values):
        yield f"values: each must be from {found.low:g} to {found.most:g}"
    if quantity != "force" and value_of(prim, "point", None) is not None:
        yield f"point: it is where a force acts; this is a {quantity}"


def _beyond_the_end(prim: Usd.Prim) -> Iterator[str]:
    """Of a sound schedule: keys of which no run comes to know."""
    end, clock, last = duration_of(prim.GetStage()), _earliest(prim), value_of(prim, "times", ())[-1]
    at = "times" if not str(value_of(prim, "event", "")) else "eventDelay" if clock > end else "times"
    if (wrong := quantities.beyond_the_end(clock, last, end)) is not None:
        yield f"{at}: {wrong}"


def _earliest(prim: Usd.Prim) -> float:
    """The first moment at which a schedule's clock may begin [s]."""
    kind, ends = str(value_of(prim, "event", "")), targets_of(prim, "eventOf")
    came = 0.0
    if kind in ("start", "end"):
        came = _earliest(ends[0]) + value_of(ends[0], "times", ())[0 if kind == "start" else -1]
    return float(came + value_of(prim, "eventDelay", 0.0)) if kind else 0.0


def _of_event(prim: Usd.Prim, before: list[Usd.Prim]) -> Iterator[str]:
    kind, ends = str(value_of(prim, "event", "")), targets_of(prim, "eventOf")
    if not kind:
        return
    if kind not in OF_EVENTS.values():
        yield f'event: "{kind}" is none of {", ".join(OF_EVENTS.values())}'
    elif len(ends) != (2 if kind == "touch" else 1):
        yield f"eventOf: names {len(ends)}; a touch has two objects, all else one"
    elif kind == "place" and not ends[0].HasAPI(UsdPhysics.RigidBodyAPI):
        yield f"eventOf: <{ends[0].GetPath()}> is no body"
    elif kind == "place" and str(value_of(prim, "eventAxis", "")) not in ("X", "Y", "Z"):
        yield "eventAxis: it must be X, Y or Z"
    elif kind == "joint" and not any(ends[0].IsA(k) for k in (UsdPhysics.RevoluteJoint, UsdPhysics.PrismaticJoint)):
        yield f"eventOf: <{ends[0].GetPath()}> is no hinge and no slider"
    elif kind == "joint" and UsdPhysics.Joint(ends[0]).GetExcludeFromArticulationAttr().Get():
        yield (
            f"eventOf: <{ends[0].GetPath()}> closes a loop, or may break or let go, and where it is is not told; let "
            "the event be of its body: body, axis, and above or below"
        )
    elif kind in ("start", "end") and ends[0] not in before:
        yield f"eventOf: <{ends[0].GetPath()}> is no schedule that stands before this one"
    if not 0.0 <= value_of(prim, "eventDelay", 0.0) <= MAX_DURATION:
        yield f"eventDelay: it must be from 0 to {MAX_DURATION:g} s"
    if not abs(value_of(prim, "eventValue", 0.0)) <= max(MAX_POSITION, 36000.0):
        yield f"eventValue: it must be within {MAX_POSITION:g} m"
