"""What the water in a gap too narrow for a particle gives to a body at a frame, worked out anew.

Particles s of walls and of other bodies push a particle b of a body where both are near fluid (docs/sph.md):

    F = -sum_b V_b sum_s V_s (p_b + p_s) grad W

and where none of the two has its fluid behind the other. All pressures are taken from the fluid's particles that a
recording has, those of solids stand where it says: on walls, and in bodies, which carry them.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy.spatial import cKDTree

from wsim.judge.books.sph import Method, Particles, Taken, pairs_within, taken

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

BEYOND = 0.5  # of the way to another solid: fluid that lies farther off behind it is none between the two


@dataclass(frozen=True)
class Solid:
    """Particles of solids, and what they take from the fluid."""

    place: Floats  # (n, 3) [m]
    volume: Floats  # (n,) [m^3]
    taken: Taken

    @staticmethod
    def near(method: Method, fluid: Particles, place: Floats, volume: Floats) -> Solid:
        """Of particles at some places."""
        tree = cKDTree(fluid.place)
        parts = [taken(method, fluid, place[part], pairs) for part, pairs in pairs_within(tree, place, method.reach)]
        return Solid(place, volume, joined(parts))

    def wet(self) -> Solid:
        """Those that fluid is near."""
        rows = np.flatnonzero(self.taken.wet)
        t = self.taken
        return Solid(
            self.place[rows], self.volume[rows], Taken(t.wet[rows], t.pressure[rows], t.velocity[rows], t.facing[rows])
        )


def joined(parts: list[Taken]) -> Taken:
    """Of particles part by part."""
    names = ("wet", "pressure", "velocity", "facing")
    if not parts:
        return Taken(np.zeros(0, dtype=bool), np.zeros(0), np.zeros((0, 3)), np.zeros((0, 3)))
    return Taken(*(np.concatenate([getattr(part, name) for part in parts]) for name in names))


def force_in_gaps(method: Method, body: Solid, others: Solid) -> Floats:
    """What the water between a body and other solids gives it, (3,) [N]."""
    body, others = body.wet(), others.wet()
    tree, total = cKDTree(others.place), np.zeros(3)
    for part, pairs in pairs_within(tree, body.place, method.reach):
        b, s = part.start + pairs["i"], pairs["j"]
        way = body.place[b] - others.place[s]
        own_way = -np.einsum("ij,ij->i", body.taken.facing[b], way)
        its_way = np.einsum("ij,ij->i", others.taken.facing[s], way)
        between = np.minimum(own_way, its_way) > -BEYOND * pairs["v"]
        pressure = body.taken.pressure[b] + others.taken.pressure[s] + 2.0 * method.background
        size = body.volume[b] * others.volume[s] * method.slope(pairs["v"]) * pressure
        total -= np.where(between, size, 0.0) @ way
    return total
