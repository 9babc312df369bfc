"""How surfaces rub, bounce and roll on each other."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

Array = np.ndarray


@dataclass(frozen=True)
class Surfaces:
    """The surfaces of one world, each of a class; a pair of classes has one law of contact.

    Attributes:
        classes: Of each surface, (surfaces,).
        law: Friction, restitution and rolling resistance of two classes, (classes, classes, 3).
        curvature: Of each surface's round side [1/m], (surfaces,); 0 for a flat one.
    """

    classes: Array
    law: Array
    curvature: Array

    def taken(self, indices: Array) -> Surfaces:
        """Those with these indices, modulo the number of surfaces; a flat one of the first class for -1."""
        rows = np.maximum(indices, 0) % len(self.classes)
        classes, curvature = (np.where(indices >= 0, of[rows], 0) for of in (self.classes, self.curvature))
        return Surfaces(classes, self.law, curvature)
