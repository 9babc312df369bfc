"""What springs and ropes look like: the lines that pictures and recordings draw, as their bodies move."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from wsim.geometry.catenary import hanging
from wsim.geometry.ropes import path_points
from wsim.scene.cord_paths import moving_stops
from wsim.scene.world import Rope, Spring

Array = np.ndarray
WIRE = 0.14  # radius of a coil's wire, of the coil's
END = 0.08  # of a spring's length at each end that is straight
TUBE, ROD = 0.5, 0.2  # radii of a damper's parts, of its own
TUBE_LENGTH = 0.55  # of a damper's length
LEAST_SAG = 8  # points of a slack part


@dataclass(frozen=True)
class CordLine:
    """A line through `points` (P, 3) [m], in the world, as thick as `radius` [m]."""

    points: Array
    radius: float


def cord_lines(cord: Spring | Rope, poses: Mapping[str, Array], a_turn: int, pieces: int) -> list[CordLine]:
    """The lines that draw a cord at the first moment of `poses`; as many, as thick, at any moment.

    A spring is a coil, one without stiffness a damper: a tube and a rod. A rope takes its way; what is slack of it
    hangs in its last part.

    Args:
        cord: What the world states of it.
        poses: Position [m] and rotation (xyzw) of each body that it runs by, by prim, (T, 7).
        a_turn: Points on a turn of a coil; two make a zigzag.
        pieces: About as many pieces draw a slack rope.
    """
    stops = moving_stops(cord.path, poses)
    if isinstance(cord, Rope):
        return [CordLine(_slackened(path_points(stops), cord.length, pieces), line_radii(cord)[0])]
    start, end = (stop.position[0] for stop in stops)
    if cord.stiffness > 0.0:
        ways = [_coil(start, end, cord.radius, spring_turns(cord), a_turn)]
    else:
        ways = [np.stack([start, start + TUBE_LENGTH * (end - start)]), np.stack([start, end])]
    return [CordLine(way, radius) for way, radius in zip(ways, line_radii(cord), strict=True)]


def line_radii(cord: Spring | Rope) -> list[float]:
    """The radii [m] of a cord's lines, in their order."""
    if isinstance(cord, Rope):
        return [cord.radius]
    return [share * cord.radius for share in ((WIRE,) if cord.stiffness > 0.0 else (TUBE, ROD))]


def spring_turns(spring: Spring) -> int:
    """Turns of a drawn coil: as many as give it a pitch of about its radius, at its rest length."""
    return int(np.clip((spring.rest_length or 1.0) / (1.2 * spring.radius), 5, 14))


def _coil(start: Array, end: Array, radius: float, turns: int, a_turn: int) -> Array:
    apart = end - start
    length = max(float(np.linalg.norm(apart)), 1e-9)
    along = apart / length
    aside = np.eye(3)[int(np.argmin(np.abs(along)))]
    u = np.cross(along, aside)
    u /= np.linalg.norm(u)
    v = np.cross(along, u)
    way = np.linspace(0.0, 1.0, a_turn * turns + 1)
    turn = 2.0 * np.pi * turns * way
    middle = start + ((END + (1.0 - 2.0 * END) * way) * length)[:, None] * along
    ring = np.cos(turn)[:, None] * u + np.sin(turn)[:, None] * v
    points: Array = np.concatenate([start[None], middle + radius * ring, end[None]])
    return points


def _slackened(points: Array, length: float, pieces: int) -> Array:
    """A rope's way drawn out to its length: what is slack hangs in its last part."""
    last = float(np.linalg.norm(points[-1] - points[-2]))
    slack = length - float(np.linalg.norm(np.diff(points, axis=0), axis=1).sum())
    if slack <= 1e-3 * length:
        return points
    left = max(pieces + 2 - len(points), LEAST_SAG)
    return np.concatenate([points[:-2], hanging(points[-2], points[-1], last + slack, left)])
