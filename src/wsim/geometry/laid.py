"""How a chain of straight links lies along a way that points are given of: on what it bends round, and not in it."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

_CORNER = math.radians(45.0)  # a way that turns by as much at a point has a corner there, and is straight up to it
_LONG = 2.0  # a stretch so much longer than the next is straight, and the next begins to bend
_BENT = math.radians(1.0)  # a link that turns by less is on a straight line
_FIRST = math.sqrt(0.5)  # of the angle of a link on a bend, after which the first touches
_FINE = 64  # samples of a stretch, by which its arc length is found


def laid(way: Array, links: int) -> Array:
    """Ends of the links of a chain along a way, (links + 1, 3) [m].

    Each link touches the way in its middle, and they meet where those tangents do: a chain so drawn round a post lies
    on it. One whose joints are on the way cuts through what that bends round, by R (1 - cos a / 2) where a link turns
    by a round a radius R. Where a straight line begins to bend, or a bend ends, a link touches in its middle, too: its
    halves are as long as those of its neighbours. The links on a line, and those on a bend, share it evenly.

    Links of one length throughout would touch off their middles, by turns before and behind, and a pull unsettles such
    a chain: a link that touches at d from one joint, l - d from the next, hands it on leaning by d / (l - d) of how the
    first is bent.

    Args:
        way: Points on the way from end to end, (N, 3) [m]; an arc where it turns by less than 45 degrees at each. A
            stretch that is more than twice as long as the next is a straight line.
        links: How many, two or more.
    """
    curve = _Curve(way)
    touched, ends = _touched(curve, links)
    touch, along = curve.at(touched)
    joints, _ = curve.at(ends)
    for k in range(1, links):
        met = _meet(touch[k - 1], along[k - 1], touch[k], along[k], float(touched[k] - touched[k - 1]))
        if met is not None:
            joints[k] = met
    return joints


def _touched(curve: _Curve, links: int) -> tuple[Array, Array]:
    """Arc lengths at which each link touches the way, (links,), and nearest to its ends, (links + 1,) [m]."""
    mean = curve.length / links
    bounds, bent = curve.bends(mean)
    if not 0 < len(bounds) < links:
        even: Array = np.arange(links + 1, dtype=np.float64)
        return mean * (even[:-1] + 0.5), mean * even
    where = np.array([0.0, *bounds, curve.length])
    before = np.array([0.5, *np.full(len(bounds), _FIRST), 0.5])  # of a link on a bend, from an end of that
    more = np.where(bent, before[:-1] + before[1:] - 1.0, 0.0)
    into = np.array([0.0, *np.full(len(bounds), 0.5 * _FIRST), 0.0])  # of a link, by which a line's last passes its end
    longer = np.where(bent, -more, into[:-1] + into[1:])
    counts = _dealt(np.maximum(np.diff(where) + longer * mean, 0.0), links)
    shares = np.diff(where) / (counts + more)
    touched: list[float] = []
    ends = [0.0]
    for k, (start, end) in enumerate(pairwise(where)):
        if bent[k]:
            own = start + shares[k] * (before[k] + np.arange(counts[k]))
            joints = np.array([*0.5 * (own[1:] + own[:-1]), end - into[k + 1] * shares[k]])
        else:
            last = end + (into[k + 1] * shares[k + 1] if k + 1 < len(shares) else 0.0)
            joints = np.linspace(ends[-1], last, counts[k] + 1)
            own = np.clip(0.5 * (joints[1:] + joints[:-1]), start, end)
            joints = joints[1:]
        touched += own.tolist()
        ends += joints.tolist()
    return np.array(touched), np.array(ends)


def _dealt(lengths: Array, links: int) -> NDArray[np.int64]:
    """How many links each of some lengths gets, one at least.

    One by one, each to where it takes most off the sum of (share - mean share)^2 of all links, which makes that the
    least (Fox, Operations Research 14, 1966).
    """
    counts = np.ones(len(lengths), dtype=np.int64)
    for _ in range(links - len(lengths)):
        counts[np.argmax(lengths**2 / (counts * (counts + 1.0)))] += 1
    return counts


def _meet(one: Array, way: Array, other: Array, onward: Array, apart: float) -> Array | None:
    """Where a line from `one` meets one to `other`, `apart` [m] along the way; None where not between them, or at a
    corner."""
    cos = float(way @ onward)
    if not math.cos(_CORNER) < cos < 1.0 - 1e-12:
        return None
    step = other - one
    ahead, behind = float(step @ way), float(step @ onward)
    first = (ahead - cos * behind) / (1.0 - cos * cos)
    last = (behind - cos * ahead) / (1.0 - cos * cos)
    if not all(0.0 < each < 1.2 * apart for each in (first, last)):
        return None
    met: Array = 0.5 * (one + first * way + other - last * onward)
    return met


class _Curve:
    """Cubics from point to point, arcs of circles to the fourth order, each circle through three of the points."""

    def __init__(self, way: Array) -> None:
        chord = np.diff(way, axis=0)
        long = np.linalg.norm(chord, axis=1)
        unit = chord / long[:, None]
        begin, end = unit.copy(), unit.copy()
        for k in range(len(long) - 1):
            if unit[k] @ unit[k + 1] <= math.cos(_CORNER):
                continue
            before, after = long[k + 1], long[k]  # the shorter of the two chords is nearer to the tangent
            if after > _LONG * before:
                before, after = 1.0, 0.0
            elif before > _LONG * after:
                before, after = 0.0, 1.0
            tangent = before * unit[k] + after * unit[k + 1]
            end[k] = begin[k + 1] = tangent / np.linalg.norm(tangent)
        self._turn = turn = np.arccos(np.clip((begin * end).sum(axis=1), -1.0, 1.0))
        speed = (long / np.cos(0.25 * turn) ** 2)[:, None]  # at both ends of the cubic that is nearest to an arc
        self._from, self._to, self._leaves, self._arrives = way[:-1], way[1:], speed * begin, speed * end
        share = np.linspace(0.0, 1.0, _FINE + 1)
        piece = np.repeat(np.arange(len(long)), _FINE + 1)
        fine, _ = self._point(piece, np.tile(share, len(long)))
        steps = np.linalg.norm(np.diff(fine.reshape(len(long), _FINE + 1, 3), axis=1), axis=2)
        self._reach = np.concatenate([[0.0], np.cumsum(steps)])
        self._where = np.concatenate([[0.0], (np.arange(len(long))[:, None] + share[1:]).ravel()])
        self.length = float(self._reach[-1])

    def bends(self, share: float) -> tuple[Array, NDArray[np.bool_]]:
        """Arc lengths at which a line begins to bend or is straight again [m], and which of what is between is bent.

        What turns by a degree in a `share` [m] is.
        """
        ends = self._reach[::_FINE]
        bent = self._turn / np.diff(ends) * share > _BENT
        changes = np.flatnonzero(bent[1:] != bent[:-1])
        return ends[1:-1][changes], bent[np.array([0, *changes + 1])]

    def at(self, s: Array) -> tuple[Array, Array]:
        """Points at arc lengths [m], and the directions there, (M, 3) each."""
        where = np.interp(s, self._reach, self._where)
        piece = np.minimum(where.astype(int), len(self._from) - 1)
        point, way = self._point(piece, where - piece)
        return point, way / np.linalg.norm(way, axis=1, keepdims=True)

    def _point(self, piece: NDArray[np.int64], share: Array) -> tuple[Array, Array]:
        """Points of Hermite's cubics, and their derivatives."""
        s = share[:, None]
        ends = self._from[piece], self._leaves[piece], self._to[piece], self._arrives[piece]
        point = (2 * s**3 - 3 * s**2 + 1, s**3 - 2 * s**2 + s, 3 * s**2 - 2 * s**3, s**3 - s**2)
        slope = (6 * s**2 - 6 * s, 3 * s**2 - 4 * s + 1, 6 * s - 6 * s**2, 3 * s**2 - 2 * s)
        there = sum(weight * end for weight, end in zip(point, ends, strict=True))
        way = sum(weight * end for weight, end in zip(slope, ends, strict=True))
        return np.asarray(there), np.asarray(way)
