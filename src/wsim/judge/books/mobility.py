"""How much a unit effort along a joint speeds it up where all that hangs together gives way as its joints let it.

Bodies of masses M, and rotors A_j along their own joints' d_j, accelerate by a with M a + sum A_j d_j d_j a = d + C' f,
C a = 0, C what joints hold; d a is what is asked. In the metric of the masses that is the square of the part of d that
no held way is along. Nothing that touches, and no drive of another joint, holds anything here: it is the most.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from scipy.linalg import solve_triangular

from wsim.geometry.rotations import rotate
from wsim.judge.evidence.joints import AXES, anchors_of, broken

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsim.judge.evidence.evidence import Evidence
    from wsim.scene.world import Joint

    Floats = NDArray[np.float64]

FRAMES = 9  # of a run, at which it is worked out
SAME = 1e-9  # of the greatest: ways that joints hold twice
POINT = 1e-12  # of the mean of masses and moments: a body that has no moment of inertia turns all the same


def mobilities(evidence: Evidence) -> dict[str, float]:
    """Of each hinge and slider whose ends are known, by its prim, the most in some frames [1/kg or 1/(kg m^2)]."""
    motion, found = evidence.motion, dict[str, float]()
    joints = [joint for joint in evidence.world.joints if None not in (joint.parent_anchor, joint.child_anchor)]
    row = {body.prim: i for i, body in enumerate(evidence.world.bodies)}
    frames = np.unique(np.linspace(0, len(evidence.time) - 1, FRAMES).astype(int))
    for unit in np.unique([motion.unit[row[joint.child]] for joint in joints]):
        own = [joint for joint in joints if motion.unit[row[joint.child]] == unit]
        place = {int(body): n for n, body in enumerate(np.flatnonzero((motion.unit == unit) & ~motion.kinematic))}
        if not place:
            continue
        ways = [_ways(evidence, joint, row, place, frames) for joint in own]
        for k, frame in enumerate(frames):
            inertia = np.zeros((6 * len(place), 6 * len(place)))
            for body, n in place.items():
                turn = rotate(evidence.body_q[frame, body, 3:], np.eye(3)).T
                inertia[6 * n : 6 * n + 3, 6 * n : 6 * n + 3] = motion.mass[body] * np.eye(3)
                inertia[6 * n + 3 : 6 * n + 6, 6 * n + 3 : 6 * n + 6] = turn @ motion.inertia[body] @ turn.T
            moves = {joint.prim: free[k, 0] for joint, (free, _) in zip(own, ways, strict=True) if len(free[k])}
            for joint in own:
                if joint.prim in moves:
                    inertia += joint.armature * np.outer(moves[joint.prim], moves[joint.prim])
            held = np.concatenate([held[k] for _, held in ways])
            for prim, value in zip(moves, _loose(inertia, held, np.array(list(moves.values()))), strict=True):
                found[prim] = max(found.get(prim, 0.0), float(value))
    return found


def _loose(inertia: Floats, held: Floats, along: Floats) -> Floats:
    """The square of each way's part (j, n) that is along none of those that are held (c, n), by masses, (j,)."""
    if not len(along):
        return np.zeros(0)
    factor = np.linalg.cholesky(inertia + POINT * np.trace(inertia) / len(inertia) * np.eye(len(inertia)))
    fixed, moves = (solve_triangular(factor, each.T, lower=True) for each in (held, along))
    fixed = fixed / np.maximum(np.linalg.norm(fixed, axis=0), 1e-300)
    basis, size, _ = np.linalg.svd(fixed, full_matrices=False)
    basis = basis[:, size > SAME * size.max(initial=0.0)]
    rest = moves - basis @ (basis.T @ moves)
    return np.asarray(np.sum(rest**2, axis=0))


def _ways(
    evidence: Evidence, joint: Joint, row: dict[str, int], place: dict[int, int], frames: NDArray[np.intp]
) -> tuple[Floats, Floats]:
    """The wrenches along a hinge's or a slider's own motion, and what each joint holds, (F, f, 6 b) and (F, h, 6 b)."""
    above_turn, below = anchors_of(evidence, joint).above_turn[frames], anchors_of(evidence, joint).below[frames]
    axes = np.stack([rotate(turn, np.eye(3)) for turn in above_turn])  # (F, 3, 3), rows
    linear, twists = np.concatenate([axes, 0.0 * axes], axis=2), np.concatenate([0.0 * axes, axes], axis=2)
    along, across = [AXES[joint.axis]], [n for n in range(3) if n != AXES[joint.axis]]
    free, held = linear[:, :0], np.concatenate([linear, twists], axis=1)
    if joint.kind == "revolute":
        free, held = twists[:, along], np.concatenate([linear, twists[:, across]], axis=1)
    elif joint.kind == "prismatic":
        free, held = linear[:, along], np.concatenate([linear[:, across], twists], axis=1)
    elif joint.kind == "spherical":
        held = linear
    if joint.kind == "compound" or broken(evidence, joint).any():  # own motions are not asked, and all may give way
        held = linear[:, :0]
    return tuple(_on(evidence, joint, row, place, frames, below, each) for each in (free, held))  # type: ignore[return-value]


def _on(
    evidence: Evidence, joint: Joint, row: dict[str, int], place: dict[int, int], frames: NDArray[np.intp],
    point: Floats, wrench: Floats,
) -> Floats:  # fmt: skip
    """Wrenches (F, w, 6) at a point (F, 3) on the child, and back on the parent, about centres of mass, (F, w, 6 b)."""
    found = np.zeros((*wrench.shape[:2], 6 * len(place)))
    for end, sign in ((joint.parent, -1.0), (joint.child, 1.0)):
        if end not in row or row[end] not in place:
            continue
        arm, first = point - evidence.motion.com[frames, row[end]], 6 * place[row[end]]
        turned = wrench[..., 3:] + np.cross(arm[:, None], wrench[..., :3])
        found[..., first : first + 6] += sign * np.concatenate([wrench[..., :3], turned], axis=2)
    return found
