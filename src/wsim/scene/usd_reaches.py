"""Schedules of joints and reaches of a stage, read back, and held against what the simulator needs of them."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from itertools import pairwise

from pxr import Usd, UsdPhysics

from wsim.limits import MAX_DURATION, MAX_KEYS, MAX_POSITION
from wsim.scene import schema
from wsim.scene.usd_shapes import to_quat, to_vec3
from wsim.scene.usd_values import line_of, targets_of, value_of
from wsim.scene.world import JointPath, Reach

_FARTHEST_TURN = 36000.0  # [deg]


def read_joint_paths(prims: Iterable[Usd.Prim]) -> Iterator[JointPath]:
    """The schedules among a stage's prims, which was checked."""
    for prim in prims:
        if schema.has(prim, schema.JOINT_PATH):
            unit = math.pi / 180.0 if prim.IsA(UsdPhysics.RevoluteJoint) else 1.0
            yield JointPath(
                prim=str(prim.GetPath()),
                times=list(value_of(prim, "times", ())),
                positions=[unit * each for each in value_of(prim, "positions", ())],
                line=line_of(prim),
            )


def read_reaches(prims: Iterable[Usd.Prim]) -> Iterator[Reach]:
    """The reaches among a stage's prims, which was checked."""
    for prim in prims:
        if schema.has(prim, schema.REACH):
            yield Reach(
                prim=str(prim.GetPath()),
                link=str(targets_of(prim, "link")[0].GetPath()),
                point=to_vec3(value_of(prim, "point", (0.0, 0.0, 0.0))),
                start=value_of(prim, "start", 0.0),
                times=list(value_of(prim, "times", ())),
                positions=[to_vec3(each) for each in value_of(prim, "positions", ())],
                rotations=[to_quat(each.GetNormalized()) for each in value_of(prim, "rotations", ())],
                straight=value_of(prim, "straight", True),
                line=line_of(prim),
            )


def reach_problems(prims: Iterable[Usd.Prim]) -> Iterator[str]:
    """Problems of the schedules and the reaches among a stage's prims."""
    for prim in prims:
        if schema.has(prim, schema.JOINT_PATH):
            yield from (f"{prim.GetPath()}.wsim:{problem}" for problem in _of_schedule(prim))
        if schema.has(prim, schema.REACH):
            yield from (f"{prim.GetPath()}.wsim:{problem}" for problem in _of_reach(prim))


def _of_schedule(prim: Usd.Prim) -> Iterator[str]:
    yield from _times(prim, len(value_of(prim, "positions", ())))
    if not any(prim.IsA(kind) for kind in (UsdPhysics.RevoluteJoint, UsdPhysics.PrismaticJoint)):
        yield "times: a schedule is of a revolute or prismatic joint"
        return
    freedom = "angular" if prim.IsA(UsdPhysics.RevoluteJoint) else "linear"
    if not prim.HasAPI(UsdPhysics.DriveAPI, freedom):
        yield "times: the joint has no drive, whose target it would set"
    if not all(abs(each) <= _FARTHEST_TURN for each in value_of(prim, "positions", ())):
        yield f"positions: each must be at most {_FARTHEST_TURN:g} in size"


def _of_reach(prim: Usd.Prim) -> Iterator[str]:
    links, places = targets_of(prim, "link"), value_of(prim, "positions", ())
    turns, start = value_of(prim, "rotations", ()), value_of(prim, "start", 0.0)
    yield from _times(prim, len(places), start)
    if len(links) != 1 or not links[0].HasAPI(UsdPhysics.RigidBodyAPI):
        yield "link: it must be one rigid body"
    if len(turns) not in (0, len(places)):
        yield f"rotations: {len(turns)} are there for {len(places)} positions; give none, or one for each"
    if any(abs(turn.GetLength() - 1.0) > 1e-3 for turn in turns):
        yield "rotations: each must be a unit quaternion"
    for name, points in (("positions", places), ("point", [value_of(prim, "point", (0.0, 0.0, 0.0))])):
        if not all(abs(x) <= MAX_POSITION for point in points for x in point):
            yield f"{name}: each must be within {MAX_POSITION:g} m"


def _times(prim: Usd.Prim, count: int, start: float | None = None) -> Iterator[str]:
    times = list(value_of(prim, "times", ()))
    if not 1 <= len(times) <= MAX_KEYS or len(times) != count:
        yield f"times: {len(times)} are there, and {count} positions; 1 to {MAX_KEYS}, as many of both"
        return
    if not all(0.0 <= time <= MAX_DURATION for time in times) or any(two <= one for one, two in pairwise(times)):
        yield f"times: they must rise from 0 or more to at most {MAX_DURATION:g} s"
    if start is not None and not 0.0 <= start < times[0]:
        yield f"start: {start:g} s must be at least 0 and before the first of times, {times[0]:g} s"
