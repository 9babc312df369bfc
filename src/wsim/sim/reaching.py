"""From where points of links are to be by time to where the joints are, in all worlds at once, before the run."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from wsim.errors import UserError
from wsim.geometry.paths import exponential, hermite, logarithm, slopes
from wsim.geometry.rotations import Floats, conjugate, lengths, multiply
from wsim.scene.world import Reach, World
from wsim.sim.arm import Arm
from wsim.sim.inverse import NEAR, Inverse, nearest

APART = 5e-3  # [m] of the way, at most, from one place that is solved for to the next
TURNED_APART = np.radians(3.0)
SAMPLES = 33  # of joints that go evenly
CORNER = np.cos(np.radians(20.0))  # where the way turns by more, the point rests
AT_LIMIT = 1e-3  # [rad] or [m]
FASTEST = 4.0 * np.pi, 2.0  # [rad/s], [m/s]: of a joint whose file says nothing of it


@dataclass(frozen=True)
class Track:
    """Where a joint is by time: T samples, and what its servo gives to hold the weight on it."""

    times: Floats  # (T,) [s]
    positions: Floats  # (T,) [rad] or [m]
    holding: Floats  # (T,) [N m] or [N]


@dataclass
class _Way:
    """A reach of one world: its chain, how that stands before, and samples of where the point is to be."""

    reach: Reach
    arm: Arm
    start: Floats  # (J,)
    times: Floats  # (T,)
    places: Floats  # (T, 3), in the root's frame
    turns: Floats  # (T, 4)


def tracks_of(worlds: Sequence[World], starts: Sequence[Mapping[str, float]], device: Any) -> list[dict[str, Track]]:
    """The tracks of all joints that reaches move, by prim, of each world.

    Args:
        worlds: Of one topology.
        starts: Where each world's hinges and sliders stand at the start [rad or m], by prim.
        device: Warp device.

    Raises:
        UserError: If a place cannot be reached, or a joint would have to go faster than it may.
    """
    now = [dict(start) for start in starts]
    parts: list[dict[str, list[Track]]] = [{} for _ in worlds]
    order = sorted(range(len(worlds[0].reaches)), key=lambda k: worlds[0].reaches[k].start)
    for k in order:
        ways = [_way(world, world.reaches[k], here) for world, here in zip(worlds, now, strict=True)]
        for w, (way, q) in enumerate(zip(ways, _solved(ways, device), strict=True)):
            _check_speed(way, q)
            holding = way.arm.holding(q)
            for j, prim in enumerate(way.arm.prims):
                earlier = parts[w].setdefault(prim, [])
                if earlier and earlier[-1].times[-1] > way.times[0] + 1e-9:
                    raise UserError(f"{_said(way.reach)}: {prim} is moved by a reach before until "
                                    f"{earlier[-1].times[-1]:g} s; start it then")  # fmt: skip
                earlier.append(Track(way.times, q[:, j], holding[:, j]))
                now[w][prim] = float(q[-1, j])
    return [{prim: _joined(tracks) for prim, tracks in own.items()} for own in parts]


def _joined(tracks: list[Track]) -> Track:
    times, positions, holding = (
        np.concatenate([getattr(each, name) for each in tracks]) for name in ("times", "positions", "holding")
    )
    new = np.append(True, np.diff(times) > 1e-9)
    return Track(times[new], positions[new], holding[new])


def _way(world: World, reach: Reach, now: Mapping[str, float]) -> _Way:
    arm = Arm.to(world, reach.link)
    start = np.array([now[prim] for prim in arm.prims])
    place, turn = arm.reach(start[None], np.array(reach.point))
    count = len(reach.times)
    turns = np.array(reach.rotations) if reach.rotations else np.tile([0.0, 0.0, 0.0, 1.0], (count, 1))
    keys, facing = arm.into(np.array(reach.positions), turns)
    if not reach.rotations:
        facing = np.broadcast_to(turn, (count, 4))
    times = np.array([reach.start, *reach.times])
    keys, facing = np.concatenate([place, keys]), np.concatenate([turn, facing])
    if reach.straight:
        return _Way(reach, arm, start, *_sampled(times, keys, facing))
    return _Way(reach, arm, start, times, keys, facing)


def _sampled(times: Floats, keys: Floats, turns: Floats) -> tuple[Floats, Floats, Floats]:
    """Samples of straight lines through keys: times (T,), places (T, 3) and turns (T, 4)."""
    steps, vectors = np.diff(keys, axis=0), logarithm(multiply(conjugate(turns[:-1]), turns[1:]))
    way, turned = lengths(steps), lengths(vectors)
    h = np.diff(times)
    slope = slopes(way / h, h)
    ahead = steps / np.maximum(way, 1e-12)[:, None]
    corner = (ahead[1:] * ahead[:-1]).sum(axis=1) < CORNER
    slope[1:-1][corner | (turned[1:] > 0.0) | (turned[:-1] > 0.0)] = 0.0
    found: list[tuple[Floats, Floats, Floats]] = [(times[:1], keys[:1], turns[:1])]
    for k, step in enumerate(steps):
        # the speed is half as much again as the mean, where it rests at both ends
        count = int(np.ceil(1.5 * max(way[k] / APART, turned[k] / TURNED_APART))) + 1
        s = np.arange(1, count + 1) / count
        if way[k] > 0.0:
            share = hermite(s * h[k], way[k], slope[k], slope[k + 1], h[k]) / way[k]
        else:
            share = s**2 * (3.0 - 2.0 * s)
        turn = multiply(turns[k], exponential(share[:, None] * vectors[k]))
        found.append((times[k] + s * h[k], keys[k] + share[:, None] * step, turn))
    parts = list(zip(*found, strict=True))
    return np.concatenate(parts[0]), np.concatenate(parts[1]), np.concatenate(parts[2])


def _solved(ways: list[_Way], device: Any) -> list[Floats]:
    """Coordinates (T, J) of each way; those of one chain, whatever they are of, are solved side by side."""
    found: list[Floats] = [np.zeros(0)] * len(ways)
    groups: dict[tuple[object, ...], list[int]] = {}
    for w, way in enumerate(ways):
        groups.setdefault((way.arm.shape, way.reach.point, bool(way.reach.rotations)), []).append(w)
    for members in groups.values():
        own = [ways[w] for w in members]
        solve = _along if own[0].reach.straight else _to
        for w, q in zip(members, solve(own, device), strict=True):
            found[w] = q
    return found


def _to(ways: list[_Way], device: Any) -> list[Floats]:
    """Joints that go evenly to the one place of each way; its samples of time are set."""
    first, start = ways[0], np.array([way.start for way in ways])
    wanted = np.array([way.places[-1] for way in ways]), np.array([way.turns[-1] for way in ways])
    turned = bool(first.reach.rotations)
    q, distance, angle = nearest(first.arm, np.array(first.reach.point), start, wanted, turned, device)
    share = np.linspace(0.0, 1.0, SAMPLES)
    smooth = share**2 * (3.0 - 2.0 * share)
    found = []
    for w, way in enumerate(ways):
        _check_there(way, q[w], way.places[-1], distance[w], angle[w])
        way.times = way.times[0] + share * (way.times[-1] - way.times[0])
        found.append(way.start + smooth[:, None] * (q[w] - way.start))
    return found


def _along(ways: list[_Way], device: Any) -> list[Floats]:
    """Joints that keep the point on each way, from one sample to the next."""
    first, count = ways[0], max(len(way.times) for way in ways)
    inverse = Inverse(first.arm, np.array(first.reach.point), bool(first.reach.rotations), len(ways), device)
    q = [np.array([way.start for way in ways])]
    for t in range(1, count):
        rows = [min(t, len(way.times) - 1) for way in ways]
        wanted = (
            np.array([way.places[row] for way, row in zip(ways, rows, strict=True)]),
            np.array([way.turns[row] for way, row in zip(ways, rows, strict=True)]),
        )
        guess = 2.0 * q[-1] - q[-2] if t > 1 else q[-1]  # as it went on the last part of the way
        found, distance, angle = inverse.solve(np.clip(guess, first.arm.low, first.arm.high), wanted)
        for w, way in enumerate(ways):
            _check_there(way, found[w], wanted[0][w], distance[w], angle[w])
        q.append(found)
    every = np.array(q)
    return [every[: len(way.times), w] for w, way in enumerate(ways)]


def _said(reach: Reach) -> str:
    line = f" ({reach.line})" if reach.line else ""
    return f"{reach.prim}{line}"


def _check_there(way: _Way, q: Floats, wanted: Floats, distance: float, angle: float) -> None:
    if distance <= NEAR[0] and angle <= NEAR[1]:
        return
    x, y, z = way.arm.out(wanted)
    turned = f" and {np.degrees(angle):.3g} deg" if way.reach.rotations else ""
    link = way.reach.link.rpartition("/")[2]
    on = " on its straight way" if way.reach.straight else ""
    stopped = (q <= way.arm.low + AT_LIMIT) | (q >= way.arm.high - AT_LIMIT)
    names = [prim.rpartition("/")[2] for prim, at in zip(way.arm.prims, stopped, strict=True) if at]
    limits = f", where {', '.join(names)} {'is at its limit' if len(names) == 1 else 'are at their limits'}"
    raise UserError(
        f"{_said(way.reach)}: {link} does not get to ({x:.6g}, {y:.6g}, {z:.6g}) m{on}: at best it misses by "
        f"{1e3 * distance:.3g} mm{turned}{limits if names else ''}; move the place, or the robot"
    )


def _check_speed(way: _Way, q: Floats) -> None:
    rates = np.abs(np.diff(q, axis=0) / np.diff(way.times)[:, None])
    most = np.where(np.isfinite(way.arm.fastest), way.arm.fastest, np.where(way.arm.slides, FASTEST[1], FASTEST[0]))
    t, j = np.unravel_index(int(np.argmax(rates / most)), rates.shape)
    if rates[t, j] > most[j]:
        unit, name = (1.0, "m/s") if way.arm.slides[j] else (np.degrees(1.0), "deg/s")
        raise UserError(
            f"{_said(way.reach)}: {way.arm.prims[j]} would have to go at {rates[t, j] * unit:.4g} {name} at "
            f"{way.times[t]:.3g} s, of {most[j] * unit:.4g} {name} at most; give it more time, or keep away from where "
            "the arm is stretched out or turns on the spot"
        )
