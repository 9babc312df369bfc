"""What the particles of a fluid give to bodies at a frame, worked out anew from where they are.

The simulator's fluid is SPH, and its push on a body is a sum over pairs of the fluid's particles f and particles b that
fill the body (Adami, Hu & Adams 2012; docs/sph.md):

    F = sum_b V_b sum_f V_f ( (A + K mu) v_bf . x_bf / (r^2 + 1e-4 h^2) - p_b - p_f ) grad W

with p_b and v_b taken from the fluid near b, A = alpha h c rho_0 between what approaches each other and K mu between
all; and what the water in gaps gives beside it (`wsim.judge.books.gaps`). All that it takes is in a recording: places,
velocities and densities of the fluid's particles, poses of bodies, the settings of the method, and the particles of
solids. How particles fill a body follows from its shape, or the recording says it of a mesh. So the force that a
recording says that a fluid gave can be held against the one that its own particles give, of bodies of any size,
anywhere, near the floor and near each other, without what SPH and real water differ by.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from scipy.spatial import cKDTree

from wsim.geometry.filled import Samples
from wsim.geometry.rotations import rotate
from wsim.judge.books.filling import filled
from wsim.judge.books.fluids import particle_mass
from wsim.judge.books.gaps import WALL, Solid, forces_in_gaps
from wsim.judge.books.sph import Method, Particles, Taken, joined, own_gradient, pairs_within, taken

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from wsim.judge.evidence.evidence import Evidence
    from wsim.recording.solids import SolidParticles

    Floats = NDArray[np.float64]

COINCIDENT = 1e-4  # of h^2, as the method adds it to r^2


@dataclass(frozen=True)
class Carried:
    """The particles of a solid at a frame."""

    place: Floats  # (n, 3) [m]
    volume: Floats  # (n,) [m^3]
    velocity: Floats  # (n, 3) [m/s]
    gradient: Floats  # (n, 3) sum of V grad W of each over the others of the same body [1/m]


class FluidPush:
    """What the fluids' particles give to each body.

    Attributes:
        vessels: Bodies that fluid is in.
    """

    def __init__(self, evidence: Evidence, method: Method) -> None:
        self._evidence, self._method = evidence, method
        self._tracks = [evidence.track(fluid) for fluid in evidence.world.fluids]
        counts = [track.position.shape[1] for track in self._tracks]
        self._mass, self._at_rest, self._viscosity = (
            np.repeat([of(fluid) for fluid in evidence.world.fluids], counts)
            for of in (particle_mass, lambda fluid: fluid.density, lambda fluid: fluid.viscosity)
        )
        holders = {fluid.container for fluid in evidence.world.fluids if fluid.volume is not None}
        self.vessels = frozenset(i for i, body in enumerate(evidence.world.bodies) if body.prim in holders)
        self.filled = _filled(evidence)
        solids = evidence.recording.solids
        self._walls = _in_double(solids.walls) if solids else None
        none = np.zeros((0, 3))
        self._gradients = [
            none if each is None or not solids else own_gradient(method, each.position, each.volume)
            for each in self.filled
        ]

    def at(self, k: int, frame: int, bodies: Sequence[int]) -> Floats:
        """Force on each of some bodies [N], (len(bodies), 3), at the fluids' frame k, the recording's `frame`."""
        fluid = self._particles(k)
        carried = {i: self._carried(i, frame, each) for i, each in enumerate(self.filled) if each is not None}
        wanted = [i for i in (bodies if self._walls is None else carried) if i in carried]
        forces = np.full((len(self.filled), 3), math.nan)
        found = {}
        for i in wanted:
            forces[i], found[i] = self._in_fluid(carried[i], fluid)
        if self._walls is not None and wanted:
            forces += forces_in_gaps(self._method, self._solid(self._walls, carried, found, fluid), len(self.filled))
        return forces[list(bodies)]

    def _particles(self, k: int) -> Particles:
        place, velocity, density = (
            np.concatenate([getattr(track, name)[k] for track in self._tracks]).astype(np.float64)
            for name in ("position", "velocity", "density")
        )
        pressure = self._method.sound**2 * (density - self._at_rest)
        return Particles(place, velocity, pressure, self._mass / density, self._at_rest, self._viscosity)

    def _in_fluid(self, body: Carried, fluid: Particles) -> tuple[Floats, Taken]:
        """What fluid that is near a body gives it, (3,) [N], and what its particles take from it."""
        reach, place = self._method.reach, body.place
        near = fluid.about(place.min(axis=0) - reach, place.max(axis=0) + reach)
        tree, total, parts = cKDTree(near.place), np.zeros(3), []
        for part, pairs in pairs_within(tree, place, reach):
            parts.append(taken(self._method, near, place[part], pairs))
            total += self._force(near, place[part], body.velocity[part], body.volume[part], parts[-1], pairs)
        return total, joined(parts)

    def _solid(self, walls: Samples, carried: dict[int, Carried], found: dict[int, Taken], fluid: Particles) -> Solid:
        """All bodies that have particles, and the walls within their reach."""
        reach, near = self._method.reach, np.zeros(len(walls.volume), dtype=bool)
        for body in carried.values():
            low, high = body.place.min(axis=0) - reach, body.place.max(axis=0) + reach
            near |= ((walls.position >= low) & (walls.position <= high)).all(axis=1)
        place = walls.position[near]
        standing = Carried(place, walls.volume[near], np.zeros_like(place), np.zeros_like(place))
        of_walls = self._in_fluid(standing, fluid)[1] if len(place) else joined([])
        solids, takes = [*carried.values(), standing], [*(found[i] for i in carried), of_walls]
        owner = np.repeat([*carried, WALL], [len(each.volume) for each in solids])
        place, volume, gradient = (
            np.concatenate([getattr(each, name) for each in solids]) for name in ("place", "volume", "gradient")
        )
        return Solid(place, volume, owner, gradient, joined(takes), self.vessels)

    def _carried(self, i: int, frame: int, samples: Samples) -> Carried:
        q = self._evidence.body_q[frame, i].astype(np.float64)
        qd = self._evidence.recording.body_qd[frame, i].astype(np.float64)
        arm = rotate(q[3:], samples.position - np.array(self._evidence.world.bodies[i].com))
        place, velocity = q[:3] + rotate(q[3:], samples.position), qd[:3] + np.cross(qd[3:], arm)
        return Carried(place, samples.volume, velocity, rotate(q[3:], self._gradients[i]))

    def _force(
        self, fluid: Particles, place: Floats, velocity: Floats, volume: Floats, solid: Taken, pairs: Any
    ) -> Floats:
        m, b, f = self._method, pairs["i"], pairs["j"]
        way = place[b] - fluid.place[f]
        mirrored = self._mirrored(velocity, solid)
        approach = np.einsum("ij,ij->i", mirrored[b] - fluid.velocity[f], way)
        laminar = m.laminar * fluid.viscosity[f]
        viscous = np.where(approach < 0.0, m.artificial * fluid.density[f] + laminar, laminar)
        viscous = viscous * approach / (pairs["v"] ** 2 + COINCIDENT * m.h**2)
        pressure = solid.pressure[b] + fluid.pressure[f] + 2.0 * m.background
        size = volume[b] * fluid.volume[f] * m.slope(pairs["v"]) * (viscous - pressure)
        return np.asarray(size @ way, dtype=np.float64)

    def _mirrored(self, velocity: Floats, solid: Taken) -> Floats:
        """The velocity (n, 3) that the fluid meets in particles of a body: its own, mirrored."""
        m, past = self._method, solid.velocity - velocity
        slip = past - 2.0 * np.einsum("ij,ij->i", past, solid.facing)[:, None] * solid.facing
        artificial, laminar = m.artificial * solid.density, m.laminar * solid.viscosity
        share = (artificial / np.maximum(artificial + laminar, 1e-300))[:, None]
        return np.asarray(velocity + share * slip - (1.0 - share) * past, dtype=np.float64)


def _in_double(particles: SolidParticles) -> Samples:
    return Samples(particles.position.astype(np.float64), particles.volume.astype(np.float64))


def _filled(evidence: Evidence) -> list[Samples | None]:
    """The particles of each body: as its shapes are filled, or, where that is not known, as a recording says."""
    counts = evidence.recording.metadata["sph"]["body_particles"]
    told = evidence.recording.solids.bodies if evidence.recording.solids else {}
    found: list[Samples | None] = []
    for body in evidence.world.bodies:
        samples = filled(body, evidence.world.fluids[0].spacing, int(counts.get(body.prim, 0)))
        found.append(_in_double(told[body.prim]) if samples is None and body.prim in told else samples)
    return found
