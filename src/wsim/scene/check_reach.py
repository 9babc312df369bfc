"""Linkages that what goes its own way pulls beyond their reach.

From one thing that leads to another, over pieces that ball joints, hinges and fixed joints join, it is no further than
those joints are from one to the next: each piece keeps the distance of its own.
"""

from __future__ import annotations

import heapq
from collections import defaultdict
from collections.abc import Iterator

import numpy as np
from pxr import Sdf, Usd, UsdPhysics

from wsim.defaults import DURATION
from wsim.scene.articulation import joint_ends, joints_of, may_break
from wsim.scene.check_leads import SHORTEST_PARTING, Hold, Way, is_lead, pieces, place_of, tops
from wsim.scene.spanning import WORLD_END
from wsim.scene.usd_prims import value_of

Array = np.ndarray
LOOKS = 64  # within a run


def overreached(stage: Usd.Stage) -> Iterator[str]:
    """Linkages of two pieces or more that end at two things which part further than they reach."""
    held = pieces(stage)
    if len({hold.lead for holds in held.values() for hold in holds}) < 2:
        return
    joined = _joined(stage)
    times = np.linspace(0.0, _duration(stage), LOOKS + 1)
    ways: dict[Sdf.Path, Way] = {}
    told: set[Sdf.Path] = set()
    for piece, holds in held.items():
        for one in holds:
            reaches = _reaches(piece, one.points[0], joined)
            for far, others in held.items():
                for other in others:
                    if far == piece or far not in reaches or other.lead == one.lead or other.joint.GetPath() in told:
                        continue
                    reach = min(way + float(np.linalg.norm(other.points[0] - at)) for at, way in reaches[far])
                    apart = _apart(stage, one, other, times, ways)
                    k = int(np.argmax(apart > reach + SHORTEST_PARTING))
                    if apart[k] > reach + SHORTEST_PARTING:
                        told |= {one.joint.GetPath(), other.joint.GetPath()}
                        yield _message(one, other, reach, float(apart[k]), float(times[k]))


def _message(one: Hold, other: Hold, reach: float, apart: float, time: float) -> str:
    names = [
        "the world" if each.lead == WORLD_END else f"<{each.lead}>"
        for each in sorted((one, other), key=lambda each: each.lead == WORLD_END)
    ]
    return (
        f"{other.joint.GetPath()}: what joints hold between {names[0]} and {names[1]} reaches {reach:.4g} m, and after "
        f"{time:.2g} s these are {apart:.4g} m apart, neither of which gives way; keep them nearer, leave this joint "
        "out, or give it a physics:breakForce"
    )


def _duration(stage: Usd.Stage) -> float:
    scenes = (prim for prim in stage.Traverse() if prim.IsA(UsdPhysics.Scene))
    return next((float(value_of(prim, "duration", DURATION)) for prim in scenes), DURATION)


def _joined(stage: Usd.Stage) -> dict[Sdf.Path, list[tuple[Sdf.Path, Array]]]:
    """Of each piece those that ball joints and hinges hold to it, and where [m]."""
    top = tops(stage)
    found: dict[Sdf.Path, list[tuple[Sdf.Path, Array]]] = defaultdict(list)
    for joint in joints_of(stage):
        prim, ends = joint.GetPrim(), joint_ends(joint)
        turns = prim.IsA(UsdPhysics.SphericalJoint) or prim.IsA(UsdPhysics.RevoluteJoint)
        if may_break(joint) or not turns or any(is_lead(stage, end) for end in ends):
            continue
        place = place_of(joint, ends[1])
        one, other = (top.get(end, end) for end in ends)
        found[one].append((other, place))
        found[other].append((one, place))
    return found


def _reaches(
    start: Sdf.Path, place: Array, joined: dict[Sdf.Path, list[tuple[Sdf.Path, Array]]]
) -> dict[Sdf.Path, list[tuple[Array, float]]]:
    """Where each piece can be entered from a place on one, and how far that is at most [m] (Dijkstra 1959)."""
    entered: dict[Sdf.Path, list[tuple[Array, float]]] = defaultdict(list)
    seen: set[tuple[Sdf.Path, Sdf.Path, tuple[float, ...]]] = set()
    ahead: list[tuple[float, int, Sdf.Path, Array]] = [(0.0, 0, start, place)]
    count = 0
    while ahead:
        way, _, piece, at = heapq.heappop(ahead)
        entered[piece].append((at, way))
        for other, there in joined.get(piece, ()):
            passed = (piece, other, tuple(there.tolist()))
            if passed not in seen:
                seen.add(passed)
                count += 1
                heapq.heappush(ahead, (way + float(np.linalg.norm(there - at)), count, other, there))
    return entered


def _apart(stage: Usd.Stage, one: Hold, other: Hold, times: Array, ways: dict[Sdf.Path, Way]) -> Array:
    """How far apart two things hold their points over time [m]."""
    for lead in (one.lead, other.lead):
        if lead not in ways:
            ways[lead] = Way(stage, lead)
    first, second = (
        np.array([ways[each.lead].after(each.points[:1], time)[0] for time in times]) for each in (one, other)
    )
    return np.asarray(np.linalg.norm(first - second, axis=1))
