"""What springs and ropes do, from the recorded poses and velocities of the bodies at their ends."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from wsim.geometry.ropes import path_length
from wsim.geometry.rotations import rotate
from wsim.scene.cord_paths import SpringTrack, moving_stops, spring_track

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsim.judge.evidence.recorded import Recorded
    from wsim.scene.world import Rope, Spring

    Floats = NDArray[np.float64]


def track_of_spring(recorded: Recorded, spring: Spring) -> SpringTrack:
    """A spring's length, force and energy, (T,) each."""
    held = [guide.body for guide in spring.path if guide.body is not None]
    bodies = {prim: recorded.body(prim) for prim in held}
    poses = {prim: recorded.body_q[:, recorded.index(prim)] for prim in held}
    twists = {prim: recorded.body_qd[:, recorded.index(prim)] for prim in held}
    return spring_track(spring, bodies, poses, twists)


def length_of_rope(recorded: Recorded, rope: Rope) -> Floats:
    """How long a rope would have to be for its taut way, (T,) [m]."""
    held = {guide.body for guide in rope.path if guide.body is not None}
    poses = {prim: recorded.body_q[:, recorded.index(prim)] for prim in held}
    length: Floats = path_length(moving_stops(rope.path, poses))
    return length


def spring_energy(recorded: Recorded) -> Floats:
    """Energy that springs hold, shared by the bodies at the ends of each that move by themselves, (T, B) [J]."""
    energy = np.zeros((len(recorded.time), len(recorded.world.bodies)))
    for spring in recorded.world.springs:
        held = [recorded.index(guide.body) for guide in spring.path if guide.body is not None]
        rows = [row for row in held if not recorded.world.bodies[row].kinematic] or held
        for row in rows:
            energy[:, row] += track_of_spring(recorded, spring).energy / len(rows)
    return energy


def spring_power(recorded: Recorded) -> Floats:
    """The power of springs' elastic forces, without their dampers', on each body, (T, B) [W]."""
    power = np.zeros((len(recorded.time), len(recorded.world.bodies)))
    for spring in recorded.world.springs:
        track = track_of_spring(recorded, spring)
        pull = spring.stiffness * (track.length - spring.rest_length)
        for guide, sign in zip(spring.path, (1.0, -1.0), strict=True):
            if guide.body is None:
                continue
            row, com = recorded.index(guide.body), np.array(recorded.body(guide.body).com)
            q, qd = recorded.body_q[:, row], recorded.body_qd[:, row]
            arm = rotate(q[:, 3:], (np.array(guide.position) - com)[None])
            speed = qd[:, :3] + np.cross(qd[:, 3:], arm)
            power[:, row] += sign * pull * np.einsum("ti,ti->t", track.along, speed)
    return power
