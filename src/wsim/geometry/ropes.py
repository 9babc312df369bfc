"""The way of a taut rope through points and round cylinders, as long as it is: straight lines, arcs and helices."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

Array = np.ndarray
ARC_STEP = 0.2  # [rad] between the points that draw an arc
TOUCHES = 1e-6  # [rad] short of a whole turn, from which on an arc is none
ON_RIM = 1.0 - 1e-6  # of a cylinder's radius: what is so far from its axis is not inside


@dataclass(frozen=True)
class Stop:
    """What a rope runs through or round, at T moments.

    `position` (T, 3) [m] is a point, or the centre of a cylinder of `radius` [m] along the unit vectors `axis` (T, 3),
    which the rope passes on the side that `side` (T, 3) points to. With a `groove` it is a pulley that swivels: the
    rope stays in the plane of the cylinder's centre and the points before and after.
    """

    position: Array
    radius: float = 0.0
    axis: Array | None = None
    side: Array | None = None
    groove: bool = False


@dataclass(frozen=True)
class Strand:
    """A straight part of a taut rope at T moments, from where it leaves one stop to where it comes to another."""

    stops: tuple[int, int]  # their places in the list
    start: Array  # (T, 3) [m]
    end: Array
    along: Array  # unit vectors from start to end, (T, 3)


@dataclass(frozen=True)
class _Wrap:
    """Where the way from one point to another meets a cylinder between them, in the plane across its axis."""

    length: Array  # (T,) [m]
    first: Array  # (T, 2), where it comes to the cylinder, in radii; the points themselves where it passes by
    angle: Array  # (T,) that it turns through, signed [rad]; 0 where it passes by
    before: Array  # (T,), length of the straight part before it, in the plane [m]
    climb: Array  # (T,), along the axis, a metre of way in the plane
    strays: Array  # (T,), whether a simulation would take another way
    frame: tuple[Array, Array, Array]  # (T, 3) axes of the plane, and the cylinder's own


def path_length(stops: list[Stop]) -> Array:
    """Length of a taut rope [m], (T,). The first and last stops are points, and so is one of any two in a row."""
    total = np.zeros(len(stops[0].position))
    for before, stop, after in _legs(stops):
        if stop is None:
            total += np.linalg.norm(after.position - before.position, axis=1)
        else:
            total += _wrap(before.position, after.position, stop).length
    return total


def strands(stops: list[Stop]) -> list[Strand]:
    """The straight parts of a taut rope, which pull at what is at their ends.

    Between them it lies on cylinders, which it presses as both its ends there pull: without friction and mass it has
    one tension. Where it passes a cylinder by, its straight way counts as two whose pulls there cancel.
    """
    place = {id(stop): k for k, stop in enumerate(stops)}
    found = []
    for before, stop, after in _legs(stops):
        along = _unit(after.position - before.position)
        if stop is None:
            found.append(Strand((place[id(before)], place[id(after)]), before.position, after.position, along))
            continue
        wrap = _wrap(before.position, after.position, stop)
        come, leave = _touches(before.position, stop, wrap)
        past = (wrap.angle == 0.0)[:, None]
        middle = 0.5 * (before.position + after.position)
        for ends, start, end in (((before, stop), before.position, come), ((stop, after), leave, after.position)):
            one, other = (place[id(each)] for each in ends)
            way = np.where(past, along, _unit(end - start))
            start, end = (
                np.where(past & (each is stop), middle, at) for each, at in zip(ends, (start, end), strict=True)
            )
            found.append(Strand((one, other), start, end, way))
    return found


def strayed(stops: list[Stop]) -> list[tuple[int, Array]]:
    """Where a rope runs round a cylinder by more than MuJoCo follows.

    Returns:
        Of each cylinder its place in the list and, at each moment, the angle [rad] if it is too large, else 0, (T,).
    """
    found = []
    for before, stop, after in _legs(stops):
        if stop is not None:
            wrap = _wrap(before.position, after.position, stop)
            place = next(k for k, other in enumerate(stops) if other is stop)
            found.append((place, np.where(wrap.strays, np.abs(wrap.angle), 0.0)))
    return found


def path_points(stops: list[Stop]) -> Array:
    """Points that draw a taut rope at the first moment, (P, 3) [m]."""
    points = [stops[0].position[:1]]
    for before, stop, after in _legs(stops):
        if stop is not None:
            points.append(_arc(before, stop, _wrap(before.position[:1], after.position[:1], stop)))
        points.append(after.position[:1])
    return np.concatenate(points)


def common_tangent(before: Array, one: Stop, other: Stop, after: Array) -> Array:
    """The point midway on the straight rope between two cylinders of parallel axes in a row, at the first moment.

    A rope that goes round a cylinder in the sense w about the axis n, in direction u where it leaves, leaves it at
    c - w r n x u from its centre; the line between two cylinders follows from that.

    Args:
        before: Where the rope comes from, (3,) [m].
        one: The cylinder that it leaves.
        other: The one that it comes to.
        after: Where it goes on to, (3,) [m].
    """
    axis = _frame(one)[2][0]
    senses = [_sense(stop, axis, way) for stop, way in ((one, other.position[0] - before),
                                                        (other, after - one.position[0]))]  # fmt: skip
    apart = other.position[0] - one.position[0]
    flat = apart - (apart @ axis) * axis
    offset = senses[1] * other.radius - senses[0] * one.radius
    reach = float(flat @ flat)
    length = np.sqrt(max(reach - offset**2, 0.0))
    along = (length * flat - offset * np.cross(axis, flat)) / max(reach, 1e-12)
    across = np.cross(axis, along)
    ends = [stop.position[0] - w * stop.radius * across for stop, w in zip((one, other), senses, strict=True)]
    middle: Array = 0.5 * (ends[0] + ends[1])
    return middle


def _sense(stop: Stop, axis: Array, way: Array) -> float:
    """Whether a rope on its side of a cylinder, going a way, turns with (1) or against (-1) the axis."""
    return 1.0 if np.cross(axis, _frame(stop)[0][0]) @ way >= 0.0 else -1.0


def _legs(stops: list[Stop]) -> list[tuple[Stop, Stop | None, Stop]]:
    """The parts of a way between points, each with the cylinder that is on it."""
    legs: list[tuple[Stop, Stop | None, Stop]] = []
    before, between = stops[0], None
    for stop in stops[1:]:
        if stop.radius > 0.0:
            between = stop
        else:
            legs.append((before, between, stop))
            before, between = stop, None
    return legs


def _frame(stop: Stop, start: Array | None = None, end: Array | None = None) -> tuple[Array, Array, Array]:
    """Axes of the plane across a cylinder, the first towards the side that the rope passes on, and its own axis."""
    assert stop.axis is not None and stop.side is not None
    axis, side = stop.axis, stop.side
    if stop.groove and start is not None and end is not None:
        axis, side, centre = (x[: len(start)] for x in (axis, side, stop.position))
        normal = np.cross(start - centre, end - centre)
        size = np.linalg.norm(normal, axis=1, keepdims=True)
        axis = np.where(size > 1e-9, normal / np.maximum(size, 1e-12), axis)
    across = side - (side * axis).sum(axis=1, keepdims=True) * axis
    across /= np.maximum(np.linalg.norm(across, axis=1, keepdims=True), 1e-12)
    return across, np.cross(axis, across), axis


def _wrap(start: Array, end: Array, stop: Stop) -> _Wrap:
    """The way between two points round a cylinder, on its side; straight where the cylinder is not in the way."""
    u, v, w = _frame(stop, start, end)
    frame = (u[: len(start)], v[: len(start)], w[: len(start)])
    p, q = (np.stack([((x - stop.position[: len(x)]) * axis).sum(axis=1) for axis in frame], axis=1)
            for x in (start, end))  # fmt: skip
    r, rise = stop.radius, q[:, 2] - p[:, 2]
    p, q = p[:, :2], q[:, :2]
    straight = np.linalg.norm(q - p, axis=1)
    far = [np.linalg.norm(x, axis=1) for x in (p, q)]
    lines = [np.sqrt(np.maximum(x * x - r * r, 0.0)) for x in far]
    # The rope comes to the cylinder a quarter turn, less what it sees of it, before or after the point's own direction.
    bearing = [np.arctan2(x[:, 1], x[:, 0]) for x in (p, q)]
    open_ = [np.arccos(np.clip(r / np.maximum(x, 1e-12), -1.0, 1.0)) for x in far]
    best = np.full(len(p), np.inf)
    angle, first = np.zeros(len(p)), np.zeros(len(p))
    crossed = []
    for turn in (1.0, -1.0):
        t0, t1 = bearing[0] + turn * open_[0], bearing[1] - turn * open_[1]
        # Over the cylinder's own side, direction 0, and not round it once more, with strands that cross.
        swept = np.mod(turn * (t1 - t0), 2.0 * np.pi)
        swept = np.where(swept > 2.0 * np.pi - TOUCHES, 0.0, swept)  # a rope that just touches it, less rounding
        middle = t0 + turn * 0.5 * swept
        off = swept + np.where(np.cos(middle) >= 0.0, 0.0, 2.0 * np.pi)
        better = off < best
        best = np.where(better, off, best)
        angle, first = np.where(better, turn * swept, angle), np.where(better, t0, first)
        crossed.append(_cross(p, _on_circle(r, t0), q, _on_circle(r, t1)))
    share = np.clip(-((q - p) * p).sum(axis=1) / np.maximum(straight**2, 1e-24), 0.0, 1.0)
    nearest = p + share[:, None] * (q - p)
    past = (np.linalg.norm(nearest, axis=1) > r) & (nearest[:, 0] >= 0.0)
    past |= (far[0] < ON_RIM * r) | (far[1] < ON_RIM * r)
    flat = np.where(past, straight, lines[0] + r * np.abs(angle) + lines[1])
    touch = np.where(past[:, None], p, _on_circle(r, first))
    climb = rise / np.maximum(flat, 1e-12)
    # MuJoCo takes the side by the middle between the two ends of the arc, which past a half turn is on the other side,
    # unless the strands cross on that way and not on this one.
    own, other = (np.where(angle > 0.0, *pair) for pair in (crossed, crossed[::-1]))
    strays = ~past & (np.abs(angle) > np.pi) & (own | ~other)
    return _Wrap(np.hypot(flat, rise), touch, np.where(past, 0.0, angle), lines[0], climb, strays, frame)


def _on_circle(radius: float, angle: Array) -> Array:
    points: Array = radius * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    return points


def _cross(a: Array, b: Array, c: Array, d: Array) -> Array:
    """Whether the lines from a to b and from c to d meet, (T,), all (T, 2)."""

    def side(p: Array, q: Array, x: Array) -> Array:
        area: Array = (q[:, 0] - p[:, 0]) * (x[:, 1] - p[:, 1]) - (q[:, 1] - p[:, 1]) * (x[:, 0] - p[:, 0])
        return area

    meets: Array = (side(a, b, c) * side(a, b, d) < 0.0) & (side(c, d, a) * side(c, d, b) < 0.0)
    return meets


def _unit(vectors: Array) -> Array:
    unit: Array = vectors / np.maximum(np.linalg.norm(vectors, axis=1, keepdims=True), 1e-12)
    return unit


def _touches(start: Array, stop: Stop, wrap: _Wrap) -> tuple[Array, Array]:
    """Where a rope from `start` (T, 3) comes to a cylinder and where it leaves it, (T, 3) each [m]."""
    across, along, axis = wrap.frame
    centre = stop.position[: len(start)]
    height = ((start - centre) * axis).sum(axis=1)
    turn = np.arctan2(wrap.first[:, 1], wrap.first[:, 0])
    found = []
    for way, angle in ((wrap.before, turn), (wrap.before + stop.radius * np.abs(wrap.angle), turn + wrap.angle)):
        x, y = _on_circle(stop.radius, angle).T[:, :, None]
        found.append(centre + x * across + y * along + (height + wrap.climb * way)[:, None] * axis)
    return found[0], found[1]


def _arc(before: Stop, stop: Stop, wrap: _Wrap) -> Array:
    """Points of the rope on a cylinder, (P, 3); none where it passes by."""
    angle = float(wrap.angle[0])
    if angle == 0.0:
        return np.zeros((0, 3))
    turned = np.linspace(0.0, angle, 2 + int(abs(angle) / ARC_STEP))
    start = np.arctan2(wrap.first[0, 1], wrap.first[0, 0])
    across, along, axis = (vector[0] for vector in wrap.frame)
    # The rope climbs evenly along its way, as a straight line does on the cylinder rolled out.
    way_there = wrap.before[0] + stop.radius * np.abs(turned)
    heights = float((before.position[0] - stop.position[0]) @ axis) + wrap.climb[0] * way_there
    way = start + turned
    flat_points = stop.radius * (np.cos(way)[:, None] * across + np.sin(way)[:, None] * along)
    points: Array = stop.position[0] + flat_points + heights[:, None] * axis
    return points
