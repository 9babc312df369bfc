"""Where joints of a robot, or points of its links, are to be by time, written on the stage."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

from pxr import Gf, Sdf, Usd, UsdPhysics, Vt

from wsim.limits import MAX_DURATION, MAX_KEYS
from wsim.scene import schema
from wsim.scene.authoring import note_line, rotation
from wsim.scene.validate import Call, shown

REACHES = "reaches"  # the scope of a robot that holds them
_NAMES = Sdf.ValueTypeNames


def write_joint_path(call: Call, joint: Usd.Prim, times: list[float], positions: list[float]) -> None:
    """Author where a joint's servo goes by time.

    Args:
        call: For what it says.
        joint: A hinge or a slider.
        times: [s].
        positions: [deg] or [m].
    """
    if len(times) != len(positions):
        call.fail(f"times has {len(times)} entries and positions {len(positions)}; give as many of both")
    if schema.has(joint, schema.JOINT_PATH):
        call.fail(f"{joint.GetName()} has a schedule already; put both their times and positions into one call")
    schema.apply(joint, schema.JOINT_PATH, {
        "times": (_NAMES.DoubleArray, Vt.DoubleArray(times)),
        "positions": (_NAMES.DoubleArray, Vt.DoubleArray(positions)),
    })  # fmt: skip


def rising(call: Call, field: str, times: Sequence[float]) -> list[float]:
    """Times that rise [s]."""
    found = [call.within(f"{field}[{k}]", time, 0.0, MAX_DURATION, "s") for k, time in
             enumerate(call.listed(field, times, "times in s"))]  # fmt: skip
    if not 1 <= len(found) <= MAX_KEYS:
        call.fail(f"{field} has {len(found)} entries; give 1 to {MAX_KEYS}")
    if any(two <= one for one, two in pairwise(found)):
        call.fail(f"{field} = {shown(tuple(found))} must rise")
    return found


def write_reach(
    call: Call,
    robot: Usd.Prim,
    link: Usd.Prim,
    times: Sequence[float],
    path: Sequence[Sequence[float]],
    rotation_deg: Sequence[float] | None,
    point: Sequence[float],
    start: float | None,
    straight: bool,
) -> None:
    """Author where a point of a link is to be by time, after what the robot does before."""
    if not link.HasAPI(UsdPhysics.RigidBodyAPI):
        call.fail(f"link = {shown(link.GetName())} is held to the world; name one that joints move")
    when = rising(call, "times", times)
    places = [call.position(f"path[{k}]", each) for k, each in enumerate(call.listed("path", path, "points (x, y, z)"))]
    if len(places) != len(when):
        call.fail(f"path has {len(places)} points and times {len(when)}; give as many of both")
    busy = _busy(robot)
    begins = busy if start is None else call.within("start", start, 0.0, MAX_DURATION, "s")
    if begins < busy:
        call.fail(f"start = {begins:g} s is before {busy:g} s, when what it does before is done")
    if when[0] <= begins:
        call.fail(f"times[0] = {when[0]:g} s must be after {begins:g} s, when it sets out; give it time to get there")
    place = call.vector("point", point, 100.0, "m")
    turned = [] if rotation_deg is None else [rotation(call.angles(rotation_deg))] * len(when)
    stage, scope = robot.GetStage(), f"{robot.GetPath()}/{REACHES}"
    stage.DefinePrim(scope, "Scope")
    made = stage.DefinePrim(f"{scope}/reach_{len(robot.GetChild(REACHES).GetChildren())}", "Scope")
    schema.apply(made, schema.REACH, {
        "point": (_NAMES.Point3d, Gf.Vec3d(*place)),
        "start": (_NAMES.Double, begins),
        "times": (_NAMES.DoubleArray, Vt.DoubleArray(when)),
        "positions": (_NAMES.Point3dArray, Vt.Vec3dArray([Gf.Vec3d(*each) for each in places])),
        "straight": (_NAMES.Bool, straight),
        **({"rotations": (_NAMES.QuatdArray, Vt.QuatdArray(turned))} if turned else {}),
    })  # fmt: skip
    made.CreateRelationship("wsim:link", custom=False).SetTargets([link.GetPath()])
    note_line(made)


def _busy(robot: Usd.Prim) -> float:
    """When the last of a robot's reaches is done [s]."""
    scope = robot.GetChild(REACHES)
    done = [each.GetAttribute("wsim:times").Get()[-1] for each in (scope.GetChildren() if scope else ())]
    return max(done, default=0.0)
