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

    from wsim.judge.books.followed import Pose
    from wsim.judge.books.forces import Poses
    from wsim.judge.books.touching import Contacts, Touching
    from wsim.judge.evidence.motion import Motion
    from wsim.scene.contact import Pair

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
    yields = sum(normal @ _of(motion, poses, row, arm[side], arm[side]) @ normal for row, side in gives)
    push, found = bounce / max(float(yields), 1e-300), 0.0
    friction, bounces = touching.laws(others.shapes)[0], touching.bounces(others.shapes)
    impulses = push * (normal + np.concatenate([np.zeros((1, 3)), rubs]))
    for row, side in gives:
        for n in np.flatnonzero((others.one == row) | (others.two == row)):
            end = int(others.two[n] == row)
            at, way = others.surface(end)[n], (1.0 if end else -1.0) * others.normal[n]  # it would push this way
            passed = _of(motion, poses, row, at, arm[side])  # from the blow to the contact
            closing = float((-(2.0 * side - 1.0) * impulses @ passed.T @ way).max())
            if closing <= 0.0:
                continue
            answer = (1.0 + bounces[n]) * closing / float(way @ _of(motion, poses, row, at, at) @ way)
            found += answer * (abs(float(way @ passed @ normal)) + friction[n] * float(np.linalg.norm(passed @ normal)))
    return found


def answers(free: list[tuple[Pose, float, Floats]], normal: Floats, one: Floats, two: Floats, law: Pair) -> float:
    """By how much two points of a pair part on the mean otherwise than at e, of one impulse on the second [m/s / N s].

    Points meet one after another, each at e times its approach as it meets. With impulses P of all and p of the second,
    K the mobility between them, their mean, weighted by impulses, parts faster by (1 - e) p (P - p) / P n K n, which
    mostly is negative: what the second does pulls the first back. Friction of both does the same, by its cone at most.

    Args:
        free: Bodies that give way: pose, mass [kg], inertia [kg m^2].
        normal: Of both contacts, (3,).
        one: Where the first pushed, (3,) [m].
        two: Where the second did.
        law: Of the pair.
    """
    passed = np.sum([mobility(pose.q, mass, own, one - pose.com, two - pose.com) for pose, mass, own in free], axis=0)
    across = [way - (way @ normal) * normal for way in (passed @ normal, normal @ passed)]
    rubbed = float(np.linalg.norm(across[1]) + law.restitution * np.linalg.norm(across[0]))
    return (1.0 - law.restitution) * abs(float(normal @ passed @ normal)) + law.friction * rubbed


def mobility(q: Floats, mass: float, inertia: Floats, at: Floats, by: Floats) -> Floats:
    """Velocity that impulses on a body give its point, by their arms from its centre of mass (3,), (3, 3) [1/kg]."""
    turn = matrices(q)
    return np.eye(3) / mass - _cross(at) @ (turn @ np.linalg.inv(inertia) @ turn.T) @ _cross(by)


def _of(motion: Motion, poses: Poses, row: int, at: Floats, by: Floats) -> Floats:
    com = poses.com[row]
    return mobility(poses.q[row, 3:], float(motion.mass[row]), motion.inertia[row], at - com, by - com)


def _cross(arm: Floats) -> Floats:
    return np.array([[0.0, -arm[2], arm[1]], [arm[2], 0.0, -arm[0]], [-arm[1], arm[0], 0.0]])
