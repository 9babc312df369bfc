"""Linkages that what goes its own way pulls or pushes beyond what they allow.

From one thing that leads to another, over pieces that ball joints, hinges and fixed joints join, it is no further than
those joints are from one to the next: each piece keeps the distance of its own. It is no nearer than the longest of
these less the others. Where hinges whose axes are parallel are all there is on the way, nothing moves along the axes,
and the axes at both ends stay parallel; at a ball joint, an end is free to turn.
"""

from __future__ import annotations

import heapq
from collections import defaultdict
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from pxr import Sdf, Usd, UsdPhysics

from wsim.scene.articulation import joint_ends, joints_of, may_break
from wsim.scene.check_leads import SHORTEST_PARTING, Hold, Way, is_lead, led, pieces, points_of, tops
from wsim.scene.spanning import WORLD_END
from wsim.scene.usd_values import duration_of

Array = np.ndarray
LOOKS = 64  # within a run
PARALLEL = 1e-5  # by how much two axes that count as parallel differ at most [rad]


class Entry(NamedTuple):
    """A way over joints from a thing that leads, to a place on a piece.

    Attributes:
        at: The place [m].
        length: Of the way [m].
        longest: Of what it goes over a single piece [m].
        flat: Whether its joints are hinges, all of whose axes are parallel.
    """

    at: Array
    length: float
    longest: float
    flat: bool

    def to(self, place: Array) -> tuple[float, float]:
        """How far from its start a place on the same piece is at least and at most [m]."""
        step = float(np.linalg.norm(place - self.at))
        most = self.length + step
        return 2.0 * max(self.longest, step) - most, most


def overreached(stage: Usd.Stage) -> Iterator[str]:
    """Linkages of two pieces or more that end at two things which part, or near, further than they allow."""
    held = pieces(stage)
    if len({hold.lead for holds in held.values() for hold in holds}) < 2:
        return
    joined = _joined(stage)
    times = np.linspace(0.0, duration_of(stage), LOOKS + 1)
    ways: dict[Sdf.Path, Way] = {}
    told: set[Sdf.Path] = set()
    for piece, holds in held.items():
        for one in holds:
            entered = _entered(piece, one, joined)
            for far, others in held.items():
                for other in others:
                    if far == piece or far not in entered or other.lead == one.lead or other.joint.GetPath() in told:
                        continue
                    for lead in {one.lead, other.lead} - ways.keys():
                        ways[lead] = Way(stage, lead)
                    wrong = _wrong(one, other, entered[far], times, ways)
                    if wrong:
                        told |= {one.joint.GetPath(), other.joint.GetPath()}
                        yield _message(one, other, wrong)


def _wrong(one: Hold, other: Hold, entries: list[Entry], times: Array, ways: dict[Sdf.Path, Way]) -> str:
    """What is wrong with how two things that lead a linkage go, if anything."""
    first, second = (np.array([ways[each.lead].after(each.points, time) for time in times]) for each in (one, other))
    gap = second[:, 0] - first[:, 0]
    apart = np.linalg.norm(gap, axis=1)
    bounds = [entry.to(other.points[0]) for entry in entries]
    least, most = max(low for low, _ in bounds), min(high for _, high in bounds)
    for over, what in ((apart - most, f"reaches {most:.4g} m"), (least - apart, f"comes to {least:.4g} m at best")):
        k = int(np.argmax(over > SHORTEST_PARTING))
        if over[k] > SHORTEST_PARTING:
            return f"{what}, and after {times[k]:.2g} s these are {apart[k]:.4g} m apart"
    ends = _axis(other.points)
    if not any(entry.flat for entry in entries) or not (len(ends) == 0 or _parallel(_axis(one.points), ends)):
        return ""
    axes = first[:, 1] - first[:, 0]
    along = np.abs((gap * axes).sum(axis=1) - gap[0] @ axes[0])
    k = int(np.argmax(along > SHORTEST_PARTING))
    if along[k] > SHORTEST_PARTING:
        return f"goes not along its hinges' axes, and after {times[k]:.2g} s these part by {along[k]:.4g} m along them"
    if len(ends):
        turned = np.linalg.norm(np.cross(axes, second[:, 1] - second[:, 0]), axis=1)
        k = int(np.argmax(turned > SHORTEST_PARTING))
        if turned[k] > SHORTEST_PARTING:
            degrees = np.degrees(np.arcsin(min(1.0, turned[k])))
            return f"keeps its hinges' axes parallel, and after {times[k]:.2g} s these turn them {degrees:.4g}° apart"
    return ""


def _axis(points: Array) -> Array:
    """The axis of a hinge, from the points that it holds; empty for a ball joint."""
    return points[1] - points[0] if len(points) == 2 else np.zeros(0)


def _parallel(one: Array, other: Array) -> bool:
    return bool(len(one) and len(other) and np.linalg.norm(np.cross(one, other)) < PARALLEL)


def _message(one: Hold, other: Hold, wrong: str) -> str:
    names = [
        "the world" if each.lead == WORLD_END else f"<{each.lead}>"
        for each in sorted((one, other), key=lambda each: each.lead == WORLD_END)
    ]
    return (
        f"{other.joint.GetPath()}: what joints hold between {names[0]} and {names[1]} {wrong}, neither of which gives "
        "way; lead them otherwise, leave this joint out, or give it a break_force (physics:breakForce)"
    )


def _joined(stage: Usd.Stage) -> dict[Sdf.Path, list[tuple[Sdf.Path, Array]]]:
    """Of each piece those that ball joints and hinges hold to it, and the points that they hold [m]."""
    top, firm = tops(stage), led(stage)
    found: dict[Sdf.Path, list[tuple[Sdf.Path, Array]]] = defaultdict(list)
    for joint in joints_of(stage):
        prim, ends = joint.GetPrim(), joint_ends(joint)
        turns = prim.IsA(UsdPhysics.SphericalJoint) or prim.IsA(UsdPhysics.RevoluteJoint)
        if may_break(joint) or not turns or any(is_lead(stage, end) or end in firm for end in ends):
            continue
        points = points_of(joint, ends[1])
        one, other = (top.get(end, end) for end in ends)
        found[one].append((other, points))
        found[other].append((one, points))
    return found


def _entered(
    start: Sdf.Path, hold: Hold, joined: dict[Sdf.Path, list[tuple[Sdf.Path, Array]]]
) -> dict[Sdf.Path, list[Entry]]:
    """How each piece can be entered from a joint of one, by the shortest ways (Dijkstra 1959)."""
    entered: dict[Sdf.Path, list[Entry]] = defaultdict(list)
    seen: set[tuple[Sdf.Path, Sdf.Path, tuple[float, ...]]] = set()
    axis = _axis(hold.points)
    ahead: list[tuple[float, int, Sdf.Path, Entry]] = [(0.0, 0, start, Entry(hold.points[0], 0.0, 0.0, len(axis) > 0))]
    count = 0
    while ahead:
        _, _, piece, entry = heapq.heappop(ahead)
        entered[piece].append(entry)
        for other, points in joined.get(piece, ()):
            passed = (piece, other, tuple(points[0].tolist()))
            if passed not in seen:
                seen.add(passed)
                count += 1
                step = float(np.linalg.norm(points[0] - entry.at))
                flat = entry.flat and _parallel(axis, _axis(points))
                then = Entry(points[0], entry.length + step, max(entry.longest, step), flat)
                heapq.heappush(ahead, (then.length, count, other, then))
    return entered
