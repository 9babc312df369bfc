"""How surfaces rub, bounce and roll on each other."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

Array = np.ndarray


@dataclass(frozen=True)
class Surfaces:
    """The surfaces of N worlds, each of a class; a pair of classes has one law of contact. N = 1: all worlds' alike.

    Attributes:
        classes: Of each surface, (N, surfaces).
        law: Friction, restitution and rolling resistance of two classes, (N, classes, classes, 3).
        curvature: Of each surface's round side [1/m], (N, surfaces); 0 for a flat one.
    """

    classes: Array
    law: Array
    curvature: Array

    @classmethod
    def of(cls, worlds: Sequence[Surfaces]) -> Surfaces:
        """Those of several worlds with as many surfaces each."""
        most = max(world.law.shape[1] for world in worlds)
        law = np.zeros((len(worlds), most, most, 3))
        for k, world in enumerate(worlds):
            count = world.law.shape[1]
            law[k, :count, :count] = world.law[0]
        return cls(
            np.concatenate([world.classes for world in worlds]), law, np.concatenate([w.curvature for w in worlds])
        )

    def taken(self, indices: Array) -> Surfaces:
        """Those with these indices, (worlds, taken), modulo the number of surfaces; a flat one of the first class
        for -1."""
        indices = indices[: len(self.classes)]
        rows = np.maximum(indices, 0) % self.classes.shape[1]
        classes, curvature = (
            np.where(indices >= 0, np.take_along_axis(of, rows, axis=1), 0) for of in (self.classes, self.curvature)
        )
        return Surfaces(classes, self.law, curvature)
