"""Compound joints: sliders, then up to three hinges through one point, between the same two bodies."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from wsim.geometry.rotations import rotate

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsim.scene.world import Joint

    Floats = NDArray[np.float64]

SINGULAR = 0.05  # sine of the angle between the first and the last of three hinges, below which the middle is not told


def axes(joint: Joint, above: Floats, below: Floats) -> list[Floats | None]:
    """The axes of a compound joint's moves in the world, (T, 3) each; None where the rotations do not tell.

    Args:
        joint: The joint.
        above: Rotations of its anchor as the parent has it, (T, 4).
        below: As the child has it.
    """
    own = [np.array(move.axis) for move in joint.moves]
    hinges = [n for n, move in enumerate(joint.moves) if move.kind == "revolute"]
    found: list[Floats | None] = [rotate(above, axis[None]) for axis in own]  # of sliders, and of the first hinge
    if len(hinges) > 1:
        found[hinges[-1]] = rotate(below, own[hinges[-1]][None])
    if len(hinges) > 2:
        first, middle, last = (own[n] for n in hinges)
        found[hinges[1]] = _middle(first, middle, last, found[hinges[0]], found[hinges[2]])
    return found


def _middle(first: Floats, middle: Floats, last: Floats, one: Floats | None, three: Floats | None) -> Floats | None:
    """The second of three hinges' axes now, by its angles with the others, which stay as they are at 0."""
    if one is None or three is None:
        return None
    between = np.einsum("ti,ti->t", one, three)
    square = 1.0 - between**2
    if square.min(initial=1.0) < SINGULAR**2:
        return None
    u, v = float(first @ middle), float(middle @ last)
    x, y = (u - v * between) / square, (v - u * between) / square
    rest = (1.0 - x**2 - y**2 - 2.0 * x * y * between) / square
    if rest.min(initial=1.0) < 0.0:
        return None
    side = np.sign(float(np.cross(first, last) @ middle))
    found: Floats = x[:, None] * one + y[:, None] * three + (side * np.sqrt(rest))[:, None] * np.cross(one, three)
    return found


def errors(joint: Joint, offset: Floats, turn: Floats) -> tuple[Floats, Floats]:
    """How far the child's anchor is from where the joint lets it be [m], and by what angle it is turned [rad], (T,).

    Args:
        joint: The joint.
        offset: Of the child's anchor from the parent's, in the parent's, (T, 3).
        turn: Of the child's anchor in the parent's, (T, 4), w not negative.
    """
    slides = np.array([move.axis for move in joint.moves if move.kind == "prismatic"]).reshape(-1, 3)
    hinges = [np.array(move.axis) for move in joint.moves if move.kind == "revolute"]
    basis, size, _ = np.linalg.svd(slides.T, full_matrices=False)
    basis = basis[:, size > 1e-9]
    apart = np.linalg.norm(offset - offset @ basis @ basis.T, axis=1)
    if not hinges:
        return apart, 2.0 * np.arctan2(np.linalg.norm(turn[:, :3], axis=1), turn[:, 3])
    if len(hinges) > 2:
        return apart, np.zeros(len(offset))
    now = np.clip(rotate(turn, hinges[-1][None]) @ hinges[0], -1.0, 1.0)
    return apart, np.abs(np.arccos(now) - np.arccos(np.clip(hinges[0] @ hinges[-1], -1.0, 1.0)))
