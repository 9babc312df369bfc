"""What is not known of forces where velocities are differences of poses.

A parabola through three poses misses h^2 / 3 of the third derivative at its ends, and h / 2 of a jump of the second: so
the mean acceleration of an interval, the difference of two such velocities, may be off by all that it changes by from
one interval to the next there. What comes and goes is not known, what lasts is. The outermost frames have poses on one
side alone. And what turns by more than 2 rad a frame, or may as it rolls, may as well have turned the other way.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsim.judge.evidence.evidence import Evidence

    Floats = NDArray[np.float64]
    Bools = NDArray[np.bool_]

AROUND = 3  # intervals to either side, that the parabolas of both its frames reach to
ENDS = 2  # intervals at either end of which a frame has poses on one side alone
ROUND = ("sphere", "cylinder", "capsule", "mesh")  # may roll
FOLLOWED = 2.0  # [rad] a frame


def by_differences(evidence: Evidence) -> bool:
    """Whether velocities are those of poses."""
    return evidence.recording.metadata.get("velocities") == "differences"


def followed(evidence: Evidence) -> Bools:
    """Bodies and intervals whose velocities the poses tell, (T - 1, B)."""
    motion = evidence.motion
    found = np.ones((len(motion.h), len(motion.mass)), dtype=bool)
    if by_differences(evidence):
        found[:ENDS] = found[-ENDS:] = False
        rate = np.linalg.norm(motion.w, axis=2).max(axis=0, initial=0.0)
        rolled = motion.speed.max(axis=0, initial=0.0) / np.maximum(motion.radius, 1e-9)
        round_ = [any(shape.kind in ROUND for shape in body.shapes) for body in evidence.world.bodies]
        told = np.maximum(rate, np.where(round_, rolled, 0.0)) * motion.dt_frames < FOLLOWED
        found &= np.array([told[motion.unit == unit].all() for unit in motion.unit], dtype=bool)
    return found


def missed(evidence: Evidence) -> Floats:
    """How unsure the kinetic energy of each frame is, (T, B) [J]; 0 of own velocities.

    A parabola about a frame misses h / 6 of what the acceleration changes by there, at the ends h / 3 of what it does
    beside them. What importers make good of that is less. It is of one frame alone, and does not add up.
    """
    motion = evidence.motion
    found = np.zeros(motion.speed.shape)
    if not by_differences(evidence) or len(motion.h) < 2:
        return found
    for rates, inertia in ((motion.v, motion.mass), (motion.spin, np.linalg.norm(motion.inertia, 2, axis=(1, 2)))):
        changed = np.linalg.norm(np.diff(np.diff(rates, axis=0) / motion.h[:, None, None], axis=0), axis=2)
        unsure = np.pad(changed / 6.0, ((1, 1), (0, 0)))
        unsure[[0, -1]] = 2.0 * unsure[[1, -2]]
        unsure *= np.pad(motion.h, (0, 1), mode="edge")[:, None]
        found += inertia * unsure * (np.linalg.norm(rates, axis=2) + 0.5 * unsure)
    return found


def unknown(evidence: Evidence, changes: Floats) -> Floats:
    """What may be missing of force and torque, (T - 1, B, 2), of changes (T - 1, B, 6); nothing of own velocities."""
    parts = changes.reshape(*changes.shape[:2], 2, 3)
    found = np.zeros(parts.shape[:3])
    if not by_differences(evidence) or len(changes) < 2:
        return found
    jumps = np.linalg.norm(np.diff(parts, axis=0), axis=3)  # (T - 2, B, 2)
    for shift in range(-AROUND, AROUND):
        low, high = max(0, -shift), min(len(found), len(jumps) - shift)
        found[low:high] = np.maximum(found[low:high], jumps[low + shift : high + shift])
    motion = evidence.motion
    found[:] = found.max(axis=2, keepdims=True)  # what is missing at an arm turns, too
    for unit in np.unique(motion.unit[motion.jointed]):  # what hangs together passes it on
        found = _shared(found, motion.mass, np.tile(motion.unit == unit, (len(found), 1)))
    return _shared(found, motion.mass, motion.meets)  # and so does what may touch


def _shared(unknown: Floats, mass: Floats, group: Bools) -> Floats:
    """What any body of a group (T - 1, B) may lack if all that is unknown of the group ends in it."""
    total = np.einsum("tbp,tb->tp", unknown, np.where(group, mass, 0.0))
    return np.where(group[..., None], total[:, None] / mass[:, None], unknown)
