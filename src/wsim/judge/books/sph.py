"""What the SPH of a recording is: its settings, its fluid's particles, and what those of solids take from them.

A particle b of a solid takes the pressure and the velocity of the fluid f near it, and its way to that (Adami, Hu &
Adams 2012; docs/sph.md):

    p_b = sum_f (p_f + rho_0 g.(x_b - x_f)) W / sum_f W,   v_b = sum_f v_f W / sum_f W,   n_b ~ sum_f (x_f - x_b) W
"""

from __future__ import annotations

import math
from dataclasses import dataclass, fields
from typing import TYPE_CHECKING, Any

import numpy as np
from scipy.spatial import cKDTree

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from numpy.typing import NDArray

    from wsim.judge.evidence.evidence import Evidence

    Floats = NDArray[np.float64]

AT_ONCE = 2000  # particles of a solid, whose pairs fit into memory


@dataclass(frozen=True)
class Method:
    """Settings of the SPH that a recording was made with."""

    h: float  # smoothing length [m]
    sound: float  # [m/s]
    density: float  # at rest, of the densest fluid, which is in gaps that none is seen near [kg/m^3]
    artificial: float  # alpha h c: times rho_0 a viscosity [m^2/s]
    laminar: float  # K: times mu another
    background: float  # pressure [Pa]
    gravity: Floats  # (3,) [m/s^2]

    @staticmethod
    def of(evidence: Evidence) -> Method | None:
        """What a recording says; None where it does not."""
        facts: Any = evidence.recording.metadata.get("sph")
        fluids = evidence.world.fluids
        sound = evidence.sound(fluids[0])
        if not facts or sound <= 0.0:
            return None
        h = float(facts["smoothing_length"])
        return Method(
            h, sound, max(fluid.density for fluid in fluids), float(facts["artificial_viscosity"]) * h * sound,
            float(facts["laminar_factor"]), float(facts["background_pressure"]), np.array(evidence.world.gravity),
        )  # fmt: skip

    @property
    def reach(self) -> float:
        """Of a particle [m]."""
        return 2.0 * self.h

    def weight(self, distance: Floats) -> Floats:
        """Of Wendland's (1995) C2 kernel, up to a factor."""
        u = np.minimum(distance / self.reach, 1.0)
        return np.asarray((1.0 - u) ** 4 * (1.0 + 4.0 * u), dtype=np.float64)

    def slope(self, distance: Floats) -> Floats:
        """What the way x_ij is to be multiplied with for grad W [1/m^5]."""
        u = np.minimum(distance / self.reach, 1.0)
        return np.asarray(-5.0 * 21.0 / (16.0 * math.pi * self.h**5) * (1.0 - u) ** 3, dtype=np.float64)


@dataclass(frozen=True)
class Particles:
    """All fluids' at one frame."""

    place: Floats  # (N, 3) [m]
    velocity: Floats  # (N, 3) [m/s]
    pressure: Floats  # (N,) [Pa]
    volume: Floats  # (N,) [m^3]
    density: Floats  # (N,) at rest [kg/m^3]
    viscosity: Floats  # (N,) [Pa s]

    def about(self, low: Floats, high: Floats) -> Particles:
        """Those in a box."""
        rows = np.flatnonzero(((self.place >= low) & (self.place <= high)).all(axis=1))
        return Particles(*(getattr(self, field.name)[rows] for field in fields(self)))


@dataclass(frozen=True)
class Taken:
    """What n particles of solids take from the fluid near them; 0 where there is none."""

    wet: NDArray[np.bool_]  # (n,) whether there is any
    pressure: Floats  # (n,) [Pa]
    velocity: Floats  # (n, 3) [m/s]
    facing: Floats  # (n, 3) the way to it, of length 1
    gradient: Floats  # (n, 3) sum of V grad W over it [1/m]
    density: Floats  # (n,) at rest, of what is near in the mean; the densest's where nothing is [kg/m^3]
    viscosity: Floats  # (n,) [Pa s]


def pairs_within(tree: Any, place: Floats, reach: float) -> Iterator[tuple[slice, Any]]:
    """Pairs of places and a tree's points nearer than `reach` [m], part by part, as arrays of i, j and distance v."""
    for start in range(0, len(place), AT_ONCE):
        part = slice(start, start + AT_ONCE)
        yield part, cKDTree(place[part]).sparse_distance_matrix(tree, reach, output_type="ndarray")


def taken(method: Method, fluid: Particles, place: Floats, pairs: Any) -> Taken:
    """What particles at some places (n, 3) take, given their pairs with the fluid's."""
    b, f, n = pairs["i"], pairs["j"], len(place)
    way, weight = place[b] - fluid.place[f], method.weight(pairs["v"])

    def summed(values: Floats) -> Floats:
        columns = values.T if values.ndim == 2 else [values]
        return np.stack([np.bincount(b, weight * column, n) for column in columns], axis=1).astype(np.float64)

    total = summed(np.ones(len(b)))
    some = np.maximum(total, 1e-300)
    pressure = (summed(fluid.pressure[f] + fluid.density[f] * (way @ method.gravity)) / some)[:, 0]
    facing = -summed(way)
    facing /= np.maximum(np.linalg.norm(facing, axis=1), 1e-300)[:, None]
    slopes = method.slope(pairs["v"]) * fluid.volume[f]
    gradient = np.stack([np.bincount(b, slopes * column, n) for column in way.T], axis=1).astype(np.float64)
    wet = total[:, 0] > 0.0
    density, viscosity = ((summed(each[f]) / some)[:, 0] for each in (fluid.density, fluid.viscosity))
    return Taken(
        wet, np.maximum(pressure, -method.background), summed(fluid.velocity[f]) / some, facing, gradient,
        np.where(wet, density, method.density), viscosity,
    )  # fmt: skip


def own_gradient(method: Method, place: Floats, volume: Floats) -> Floats:
    """Sum of V grad W of each particle of a body over the others of it, (n, 3) [1/m]."""
    tree, total = cKDTree(place), np.zeros((len(place), 3))
    for part, pairs in pairs_within(tree, place, method.reach):
        way, slopes = place[part][pairs["i"]] - place[pairs["j"]], method.slope(pairs["v"]) * volume[pairs["j"]]
        total[part] = np.stack([np.bincount(pairs["i"], slopes * c, len(place[part])) for c in way.T], axis=1)
    return total


def joined(parts: Sequence[Taken]) -> Taken:
    """Of particles part by part."""
    flat, way = np.zeros(0), np.zeros((0, 3))
    none = Taken(np.zeros(0, dtype=bool), flat, way, way, way, flat, flat)
    return Taken(*(np.concatenate([getattr(each, field.name) for each in (none, *parts)]) for field in fields(Taken)))
