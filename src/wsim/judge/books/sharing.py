"""How friction shares its cone with what resists rolling and spinning, where a pair states a rolling resistance C.

The three have one cone, an ellipsoid, and each is resisted in proportion to its own speed (docs/rigid.md). Of a push N
on a patch of lever rho = C R, R the radius of the gap between both surfaces, a slip v takes the friction

    F = mu N * mu v / sqrt((mu v)^2 + (rho w)^2 + (pi mu rho s)^2),

w being the rate of rolling and s that of spinning: all of mu N where it only slips, and little where it rolls and
creeps. A wheel that rolls at w R needs a slip of C / mu * x / sqrt(1 - x^2) * w R for the share x of its friction.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from wsim.geometry.rotations import lengths, multiply, rotate
from wsim.scene.contact import curvature

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsim.judge.books.forces import Poses
    from wsim.judge.books.touching import Contacts, Touching
    from wsim.scene.world import Shape

    Floats = NDArray[np.float64]

ON_END = np.sqrt(0.5)  # cosine between a cylinder's axis and the contact's normal, above which its flat end touches
UPRIGHT = np.array([0.0, 0.0, 0.0, 1.0])


def share(friction: Floats, lever: Floats, slip: Floats, turning: Floats, normal: Floats) -> Floats:
    """The share of its most that friction takes against a slip, (n,); 1 where nothing resists rolling.

    Args:
        friction: Coefficients, (n,).
        lever: What resists rolling gives for a push of one, (n,) [m].
        slip: Its speed, (n,) [m/s].
        turning: Angular velocity of the second body over the first, (n, 3) [rad/s].
        normal: (n, 3).
    """
    spins = np.einsum("ni,ni->n", turning, normal)
    rolls = np.linalg.norm(turning - spins[:, None] * normal, axis=1)
    slides = friction * slip
    resisted = np.hypot(lever * rolls, np.pi * friction * lever * spins)
    found: Floats = np.where(resisted > 0.0, slides / np.maximum(np.hypot(slides, resisted), 1e-300), 1.0)
    return found


def lever(rolling: Floats, bends: Floats) -> Floats:
    """Of pairs of resistance C (n,), whose gap bends by so much (n,) [1/m]: C over that; 0 where both are flat."""
    return np.divide(rolling, bends, out=np.zeros_like(bends), where=bends > 0.0)


def bend(shape: Shape, turn: Floats, normal: Floats, *, moves: bool) -> Floats:
    """By how much a shape's surface bends at each of some contacts, (n,) [1/m]; a cylinder is flat at its ends.

    Args:
        shape: It.
        turn: Of its body, (n, 4) [xyzw].
        normal: (n, 3).
        moves: Whether its body does: a mesh that never moves is flat.
    """
    found = np.full(len(normal), curvature(shape, moves=moves))
    if shape.kind == "cylinder":
        axis = rotate(multiply(turn, np.tile(np.array(shape.rotation), (len(turn), 1))), np.array([0.0, 0.0, 1.0]))
        found[np.abs(np.einsum("ni,ni->n", axis, normal)) > ON_END] = 0.0
    return found


def of_contacts(touching: Touching, contacts: Contacts, poses: Poses, across: Floats) -> Floats:
    """The share of each of some contacts, (n,), at poses of all bodies, for its slip along surfaces (n, 3) [m/s]."""
    friction, rolling = touching.laws(contacts.shapes)
    turning, bends = np.zeros_like(across), np.zeros(len(contacts))
    if not len(poses.w) or not rolling.any():
        return np.ones(len(contacts))
    for side, rows, sign in ((0, contacts.one, -1.0), (1, contacts.two, 1.0)):
        moves, at = rows >= 0, np.maximum(rows, 0)
        turning += sign * np.where(moves[:, None], poses.w[at], 0.0)
        turn = np.where(moves[:, None], poses.q[at, 3:], UPRIGHT)
        for k in np.unique(contacts.shapes[:, side]):
            ours, (row, _, shape) = np.flatnonzero(contacts.shapes[:, side] == k), touching.shapes[k]
            bends[ours] += bend(shape, turn[ours], contacts.normal[ours], moves=row >= 0)
    return share(friction, lever(rolling, bends), lengths(across), turning, contacts.normal)
