"""Where the ends and pulleys of springs and ropes are as their bodies move: for simulator, pictures and judge."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from wsim.geometry.ropes import Stop
from wsim.geometry.rotations import rotate
from wsim.scene.world import Body, Guide, Spring

Array = np.ndarray


def moving_stops(path: list[Guide], poses: Mapping[str, Array]) -> list[Stop]:
    """The guides of a path where they are in the world.

    Args:
        path: Of a spring or a rope.
        poses: Position [m] and rotation (xyzw) of each body that moves, by prim, (T, 7).
    """
    frames = max((len(q) for q in poses.values()), default=1)
    return [_stop(guide, poses, frames) for guide in path]


def _stop(guide: Guide, poses: Mapping[str, Array], frames: int) -> Stop:
    own = [np.array([vector], dtype=np.float64) for vector in (guide.position, guide.axis, guide.side)]
    if guide.body is None:
        position, axis, side = (np.repeat(vector, frames, axis=0) for vector in own)
    else:
        q = np.asarray(poses[guide.body], dtype=np.float64)
        position, axis, side = (rotate(q[:, 3:], vector) for vector in own)
        position = position + q[:, :3]
    if guide.radius == 0.0:
        return Stop(position)
    return Stop(position, guide.radius, axis, side, guide.groove)


@dataclass(frozen=True)
class SpringTrack:
    """A spring through time, T moments."""

    length: Array  # (T,) [m]
    rate: Array  # of its length, (T,) [m/s]
    pull: Array  # its force, positive where it pulls its ends together, (T,) [N]
    along: Array  # unit vectors from its first end to the other, (T, 3)
    energy: Array  # that it holds, (T,) [J]


def spring_track(
    spring: Spring, bodies: Mapping[str, Body], poses: Mapping[str, Array], twists: Mapping[str, Array]
) -> SpringTrack:
    """What a spring does.

    Args:
        spring: What the world states of it.
        bodies: By prim.
        poses: (T, 7) of each body, as `moving_stops` takes them.
        twists: Velocity of the centre of mass and spin of each body, in the world, (T, 6) [m/s, rad/s].
    """
    ends = [stop.position for stop in moving_stops(spring.path, poses)]
    speeds = []
    for guide, point in zip(spring.path, ends, strict=True):
        if guide.body is None:
            speeds.append(np.zeros_like(point))
            continue
        q, twist = np.asarray(poses[guide.body], dtype=np.float64), np.asarray(twists[guide.body], dtype=np.float64)
        centre = q[:, :3] + rotate(q[:, 3:], np.array([bodies[guide.body].com]))
        speeds.append(twist[:, :3] + np.cross(twist[:, 3:], point - centre))
    apart = ends[1] - ends[0]
    length = np.linalg.norm(apart, axis=1)
    along = apart / np.maximum(length, 1e-12)[:, None]
    rate = np.einsum("ti,ti->t", speeds[1] - speeds[0], along)
    stretch = length - spring.rest_length
    pull = spring.stiffness * stretch + spring.damping * rate
    return SpringTrack(length, rate, pull, along, 0.5 * spring.stiffness * stretch**2)
