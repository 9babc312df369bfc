"""What a blow presses besides: a card that is hit above its edge sets the edge on the ground, which pushes back.

Contacts across a blow's normal have no share in it by themselves. But its impulse turns what it hits, and what that
touches is met at once: between the same two frames, mostly in the step after. By how much that changes how fast the
blow's points part is bounded here, contact by contact, from the mobility of rigid bodies (Featherstone 2008): of a
point's velocity by an impulse at another, K = 1 / m - [r] I^-1 [r'].
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from wsim.geometry.rotations import matrices

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsim.judge.books.forces import Poses
    from wsim.judge.books.touching import Contacts, Touching
    from wsim.judge.evidence.motion import Motion

    Floats = NDArray[np.float64]


def pushed_back(
    motion: Motion, touching: Touching, poses: Poses, blow: Contacts, others: Contacts, bounce: float, rubs: Floats
) -> float:
    """By how much contacts that a blow presses may change how fast its points part [m/s].

    Args:
        motion: Masses and inertias.
        touching: The shapes, and their laws.
        poses: Of all bodies, when the blow came.
        blow: Its one contact.
        others: What else its bodies touch then.
        bounce: By how much its points part faster than they met [m/s].
        rubs: What friction on the second body may be of the push, some ways of it, (k, 3).
    """
    rows = (int(blow.one[0]), int(blow.two[0]))
    normal, arm = blow.normal[0], [blow.surface(side)[0] for side in (0, 1)]
    gives = [(row, side) for side, row in enumerate(rows) if row >= 0 and not motion.kinematic[row]]
    yields = sum(normal @ _mobility(motion, poses, row, arm[side], arm[side]) @ normal for row, side in gives)
    push, found = bounce / max(float(yields), 1e-300), 0.0
    friction, bounces = touching.laws(others.shapes)[0], touching.bounces(others.shapes)
    impulses = push * (normal + np.concatenate([np.zeros((1, 3)), rubs]))
    for row, side in gives:
        for n in np.flatnonzero((others.one == row) | (others.two == row)):
            end = int(others.two[n] == row)
            at, way = others.surface(end)[n], (1.0 if end else -1.0) * others.normal[n]  # it would push this way
            passed = _mobility(motion, poses, row, at, arm[side])  # from the blow to the contact
            closing = float((-(2.0 * side - 1.0) * impulses @ passed.T @ way).max())
            if closing <= 0.0:
                continue
            answer = (1.0 + bounces[n]) * closing / float(way @ _mobility(motion, poses, row, at, at) @ way)
            found += answer * (abs(float(way @ passed @ normal)) + friction[n] * float(np.linalg.norm(passed @ normal)))
    return found


def _mobility(motion: Motion, poses: Poses, row: int, at: Floats, by: Floats) -> Floats:
    """Velocity that impulses on a body at a place give its point at another, (3, 3) [1/kg]."""
    turn = matrices(poses.q[row, 3:])
    inverse = turn @ np.linalg.inv(motion.inertia[row]) @ turn.T
    return np.eye(3) / motion.mass[row] - _cross(at - poses.com[row]) @ inverse @ _cross(by - poses.com[row])


def _cross(arm: Floats) -> Floats:
    return np.array([[0.0, -arm[2], arm[1]], [arm[2], 0.0, -arm[0]], [-arm[1], arm[0], 0.0]])
