"""The gap between two objects, and how small it is when they touch."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from wsim.judge.evidence.contact import distance
from wsim.judge.evidence.recorded import MissingError

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsim.judge.language.signals import Signals

    Floats = NDArray[np.float64]


def gap(signals: Signals, one: str, other: str) -> Floats:
    """The gap between two objects' surfaces (W, T) [m], negative where one is in the other.

    Raises:
        MissingError: One of them has nothing that collides, or they are two meshes, whose distance is not measured.
    """
    a, b = signals.prim(one), signals.prim(other)
    if a == b:
        raise MissingError(f"{one!r} is named twice; name two objects")
    frames = signals.frames(one, other)
    kinds = [{shape.shape.kind for shape in frames.placed if shape.owner == prim} for prim in (a, b)]
    for prim, kind in zip((a, b), kinds, strict=True):
        if not kind:
            raise MissingError(f"{prim} has nothing that collides: it cannot touch")
    if kinds == [{"mesh"}, {"mesh"}] or kinds == [{"plane"}, {"plane"}]:
        raise MissingError(f"{a} and {b} are both a {next(iter(kinds[0]))}, whose distance is not measured")
    return signals.fold(distance(frames, a, b))


def moving_size(signals: Signals, one: str, other: str) -> float:
    """The smallest extent of the first of two objects that moves [m]."""
    return signals.solid(one if signals.moves(one) else other).smallest


def touch_reach(signals: Signals, one: str, other: str) -> tuple[Floats, str]:
    """The gap up to which two objects count as touching (W, T) [m], and why."""
    relative = np.linalg.norm(signals.velocity(one) - signals.velocity(other), axis=-1)
    fall = signals.gravity * signals.step**2 / 2
    source = f"the way that they close between two frames, {signals.step:.3g} s: by their speed, and by a fall"
    return relative * signals.step + fall, source
