"""Compound joints: sliders, then up to three hinges, between the same two bodies."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from wsim.geometry.rotations import rotate

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsim.scene.world import Joint

    Floats = NDArray[np.float64]

SINGULAR = 0.05  # sine of the angle between the first and the last of three hinges, below which the middle is not told


@dataclass(frozen=True)
class Anchors:
    """Both ends of a joint in the world: places (T, 3) [m] and rotations (T, 4)."""

    above: Floats
    above_turn: Floats
    below: Floats
    below_turn: Floats


@dataclass(frozen=True)
class Placed:
    """A move's axis and, of a hinge, a point of it in the world, (T, 3) each."""

    axis: Floats
    point: Floats


def placed(joint: Joint, anchors: Anchors) -> list[Placed | None]:
    """Where a compound joint's moves are; None where the rotations of its ends do not tell."""
    own = [np.array(move.axis) for move in joint.moves]
    hinges = [n for n, move in enumerate(joint.moves) if move.kind == "revolute"]
    found: list[Placed | None] = [Placed(rotate(anchors.above_turn, axis[None]), anchors.above) for axis in own]
    if not hinges:
        return found
    last = Placed(rotate(anchors.below_turn, own[hinges[-1]][None]), anchors.below)
    found[hinges[-1]] = last
    if len(hinges) == 1:
        return found
    points = [np.array(joint.moves[n].point) for n in hinges]
    slides = any(move.kind == "prismatic" for move in joint.moves)  # then all hinges go through the anchor
    first = Placed(
        rotate(anchors.above_turn, own[hinges[0]][None]),
        anchors.below if slides else anchors.above + rotate(anchors.above_turn, points[0][None]),
    )
    found[hinges[0]] = first
    if len(hinges) > 2:
        axis = _middle(own[hinges[0]], own[hinges[1]], own[hinges[2]], first.axis, last.axis)
        found[hinges[1]] = None
        if axis is not None:
            start = (
                rotate(anchors.above_turn, own[hinges[1]][None]),
                rotate(anchors.above_turn, (points[1] - points[0])[None]),
            )
            found[hinges[1]] = Placed(axis, first.point + _turned(start[1], first.axis, start[0], axis))
    return found


def _middle(first: Floats, middle: Floats, last: Floats, one: Floats, three: Floats) -> Floats | None:
    """The second of three hinges' axes now, by its angles with the others, which stay as they are at 0."""
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


def _turned(arm: Floats, axis: Floats, start: Floats, end: Floats) -> Floats:
    """Arms (T, 3) turned about an axis by the angle that takes `start` to `end`, (T, 3) each."""
    across = [way - np.einsum("ti,ti->t", way, axis)[:, None] * axis for way in (start, end)]
    sine = np.einsum("ti,ti->t", axis, np.cross(*across))
    angle = np.arctan2(sine, np.einsum("ti,ti->t", *across))[:, None]
    along = np.einsum("ti,ti->t", arm, axis)[:, None] * axis
    found: Floats = along + np.cos(angle) * (arm - along) + np.sin(angle) * np.cross(axis, arm)
    return found


def errors(joint: Joint, anchors: Anchors, offset: Floats, turn: Floats) -> tuple[Floats, Floats]:
    """How far the child's anchor is from where the joint lets it be [m], and by what angle it is turned [rad], (T,).

    Args:
        joint: The joint.
        anchors: Its ends.
        offset: Of the child's anchor from the parent's, in the parent's, (T, 3).
        turn: Of the child's anchor in the parent's, (T, 4), w not negative.
    """
    hinges = [n for n, move in enumerate(joint.moves) if move.kind == "revolute"]
    own = [np.array(joint.moves[n].axis) for n in hinges]
    apart = _apart(joint, anchors, offset, hinges)
    if not hinges:
        return apart, 2.0 * np.arctan2(np.linalg.norm(turn[:, :3], axis=1), turn[:, 3])
    if len(hinges) > 2:
        return apart, np.zeros(len(offset))
    now = np.clip(rotate(turn, own[-1][None]) @ own[0], -1.0, 1.0)
    return apart, np.abs(np.arccos(now) - np.arccos(np.clip(own[0] @ own[-1], -1.0, 1.0)))


def _apart(joint: Joint, anchors: Anchors, offset: Floats, hinges: list[int]) -> Floats:
    """Off what the sliders let; or off the last hinge's place by the ones before it."""
    slides = np.array([move.axis for move in joint.moves if move.kind == "prismatic"]).reshape(-1, 3)
    if len(slides):
        basis, size, _ = np.linalg.svd(slides.T, full_matrices=False)
        basis = basis[:, size > 1e-9]
        return np.asarray(np.linalg.norm(offset - offset @ basis @ basis.T, axis=1))
    found = placed(joint, anchors)
    before, last = found[hinges[-2]], found[hinges[-1]]
    if before is None or last is None:
        return np.zeros(len(offset))
    # The last hinge turns about the one before: its place is at the same distance from it, and along it.
    points = [np.array(joint.moves[n].point) for n in hinges]
    arm, axis = points[-1] - points[-2], np.array(joint.moves[hinges[-2]].axis)
    now = last.point - before.point
    along = np.einsum("ti,ti->t", now, before.axis)
    across = np.linalg.norm(now - along[:, None] * before.axis, axis=1)
    return np.asarray(np.hypot(along - arm @ axis, across - np.linalg.norm(arm - (arm @ axis) * axis)))
