"""What the particles of a fluid give to bodies at a frame, worked out anew from where they are.

The simulator's fluid is SPH, and its push on a body is a sum over pairs of the fluid's particles f and particles b that
fill the body (Adami, Hu & Adams 2012; docs/sph.md):

    F = sum_b V_b sum_f V_f ( (A + K mu) v_bf . x_bf / (r^2 + 1e-4 h^2) - p_b - p_f ) grad W

with p_b and v_b taken from the fluid near b, A = alpha h c rho_0 between what approaches each other and K mu between
all. All that it takes is in a recording: places, velocities and densities of the fluid's particles, poses of bodies,
and the settings of the method. How particles fill a body follows from its shape. So the force that a recording says
that a fluid gave can be held against the one that its own particles give, of bodies of any size, anywhere, near the
floor and near each other, without what SPH and real water differ by.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from scipy.spatial import cKDTree

from wsim.geometry.filled import Samples, box_lattice, capsule_layers, cylinder_layers, sphere_layers
from wsim.geometry.rotations import rotate
from wsim.judge.books.fluids import particle_mass

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from wsim.judge.evidence.evidence import Evidence
    from wsim.scene.world import Body, Shape

    Floats = NDArray[np.float64]

TIE = 1e-6  # share of a length: one that is half a spacing more than so many may round either way
AT_ONCE = 2000  # particles of a body, whose pairs fit into memory
COINCIDENT = 1e-4  # of h^2, as the method adds it to r^2


def filled(body: Body, spacing: float, count: int) -> Samples | None:
    """As many particles as the simulator says that it filled a body with, in its frame; None where shapes tell others.

    Args:
        body: Of round shapes and boxes; a mesh's particles are spread by a search, which is not repeated here.
        spacing: Between the fluid's particles [m].
        count: How many there are.
    """
    choices = [_fillings(shape, spacing) for shape in body.shapes if shape.collides]
    for choice in itertools.islice(itertools.product(*choices), 64):
        if choice and sum(len(each.volume) for each in choice) == count:
            return Samples(
                *(np.concatenate(parts) for parts in zip(*((c.position, c.volume) for c in choice), strict=True))
            )
    return None


def _fillings(shape: Shape, spacing: float) -> list[Samples]:
    """Of one shape; several where a length may be rounded up or down to spacings."""
    found: dict[tuple[int, ...], Samples] = {}
    for by in itertools.product((1.0, 1.0 + TIE, 1.0 - TIE), repeat=len(shape.size)):
        size = np.array(shape.size) * by
        cells = tuple(round(2.0 * length / spacing) for length in size), *(round(length / spacing) for length in size)
        if cells not in found and (samples := _filling(shape.kind, size, spacing)) is not None:
            place = rotate(np.array(shape.rotation), samples.position) + np.array(shape.position)
            found[cells] = Samples(place, samples.volume)
    return list(found.values())


def _filling(kind: str, size: Floats, spacing: float) -> Samples | None:
    if kind == "box":
        return box_lattice(size, spacing)
    if kind == "sphere":
        return sphere_layers(float(size[0]), spacing)
    if kind == "cylinder":
        return cylinder_layers(float(size[0]), 0.5 * float(size[1]), spacing)
    return capsule_layers(float(size[0]), 0.5 * float(size[1]), spacing) if kind == "capsule" else None


@dataclass(frozen=True)
class Method:
    """Settings of the SPH that a recording was made with, and its fluids' common numbers."""

    h: float  # smoothing length [m]
    sound: float  # [m/s]
    density: float  # at rest [kg/m^3]
    artificial: float  # alpha h c rho_0 [Pa s]
    laminar: float  # K mu [Pa s]
    background: float  # pressure [Pa]
    gravity: Floats  # (3,) [m/s^2]

    @staticmethod
    def of(evidence: Evidence) -> Method | None:
        """What a recording says; None where it does not."""
        facts: Any = evidence.recording.metadata.get("sph")
        fluid = evidence.world.fluids[0]
        sound = fluid.speed_of_sound or float(evidence.recording.metadata.get("speed_of_sound") or 0.0)
        if not facts or sound <= 0.0:
            return None
        h = float(facts["smoothing_length"])
        return Method(
            h, sound, fluid.density, float(facts["artificial_viscosity"]) * h * sound * fluid.density,
            float(facts["laminar_factor"]) * fluid.viscosity, float(facts["background_pressure"]),
            np.array(evidence.world.gravity),
        )  # fmt: skip


@dataclass(frozen=True)
class Particles:
    """All fluids' at one frame."""

    place: Floats  # (N, 3) [m]
    velocity: Floats  # (N, 3) [m/s]
    pressure: Floats  # (N,) [Pa]
    volume: Floats  # (N,) [m^3]

    def part(self, rows: NDArray[np.intp]) -> Particles:
        """Some of them."""
        return Particles(self.place[rows], self.velocity[rows], self.pressure[rows], self.volume[rows])


class FluidPush:
    """What the fluids' particles give to each body."""

    def __init__(self, evidence: Evidence, method: Method) -> None:
        self._evidence, self._method = evidence, method
        self._tracks = [evidence.track(fluid) for fluid in evidence.world.fluids]
        self._mass = np.concatenate(
            [
                np.full(t.position.shape[1], particle_mass(f))
                for f, t in zip(evidence.world.fluids, self._tracks, strict=True)
            ]
        )
        counts = evidence.recording.metadata["sph"]["body_particles"]
        spacing = evidence.world.fluids[0].spacing
        self.filled = [filled(body, spacing, int(counts.get(body.prim, 0))) for body in evidence.world.bodies]

    def at(self, k: int, frame: int, bodies: Sequence[int]) -> Floats:
        """Force on each of some bodies [N], (len(bodies), 3), at the fluids' frame k, the recording's `frame`."""
        fluid = self._particles(k)
        return np.array([self._on(i, frame, fluid) for i in bodies]).reshape(-1, 3)

    def _particles(self, k: int) -> Particles:
        place, velocity, density = (
            np.concatenate([getattr(track, name)[k] for track in self._tracks]).astype(np.float64)
            for name in ("position", "velocity", "density")
        )
        pressure = self._method.sound**2 * (density - self._method.density)
        return Particles(place, velocity, pressure, self._mass / density)

    def _on(self, i: int, frame: int, fluid: Particles) -> Floats:
        samples = self.filled[i]
        if samples is None:
            return np.full(3, math.nan)
        q = self._evidence.body_q[frame, i].astype(np.float64)
        qd = self._evidence.recording.body_qd[frame, i].astype(np.float64)
        place = q[:3] + rotate(q[3:], samples.position)
        arm = rotate(q[3:], samples.position - np.array(self._evidence.world.bodies[i].com))
        velocity = qd[:3] + np.cross(qd[3:], arm)
        reach = 2.0 * self._method.h
        about = (fluid.place >= place.min(axis=0) - reach) & (fluid.place <= place.max(axis=0) + reach)
        fluid = fluid.part(np.flatnonzero(about.all(axis=1)))
        tree, total = cKDTree(fluid.place), np.zeros(3)
        for start in range(0, len(place), AT_ONCE):
            part = slice(start, start + AT_ONCE)
            pairs = cKDTree(place[part]).sparse_distance_matrix(tree, reach, output_type="ndarray")
            if len(pairs):
                total += self._force(fluid, place[part], velocity[part], samples.volume[part], pairs)
        return total

    def _force(self, fluid: Particles, place: Floats, velocity: Floats, volume: Floats, pairs: Any) -> Floats:
        m, b, f = self._method, pairs["i"], pairs["j"]
        way = place[b] - fluid.place[f]
        r2 = pairs["v"] ** 2
        u = np.minimum(pairs["v"] / (2.0 * m.h), 1.0)
        pressure, mirrored = self._taken(fluid, velocity, b, f, way, (1.0 - u) ** 4 * (1.0 + 4.0 * u))
        approach = np.einsum("ij,ij->i", mirrored[b] - fluid.velocity[f], way)
        viscous = np.where(approach < 0.0, m.artificial + m.laminar, m.laminar) * approach / (r2 + COINCIDENT * m.h**2)
        slope = -5.0 * 21.0 / (16.0 * math.pi * m.h**5) * (1.0 - u) ** 3  # of Wendland's (1995) C2 kernel, over r
        size = volume[b] * fluid.volume[f] * slope * (viscous - pressure[b] - fluid.pressure[f] - 2.0 * m.background)
        return np.asarray(size @ way, dtype=np.float64)

    def _taken(
        self, fluid: Particles, velocity: Floats, b: NDArray[np.intp], f: NDArray[np.intp], way: Floats, weight: Floats
    ) -> tuple[Floats, Floats]:
        """Pressure (n,) and mirrored velocity (n, 3) that particles of a body take from the fluid near them."""
        m, n = self._method, len(velocity)

        def summed(values: Floats) -> Floats:
            columns = values.reshape(len(b), -1).T
            return np.stack([np.bincount(b, weight * column, n) for column in columns], axis=1)

        total = np.maximum(summed(np.ones(len(b))), 1e-300)
        pressure = (summed(fluid.pressure[f] + m.density * (way @ m.gravity)) / total)[:, 0]
        past = summed(fluid.velocity[f]) / total - velocity
        outward = -summed(way)
        outward /= np.maximum(np.linalg.norm(outward, axis=1), 1e-300)[:, None]
        slip = past - 2.0 * np.einsum("ij,ij->i", past, outward)[:, None] * outward
        share = m.artificial / max(m.artificial + m.laminar, 1e-300)
        return np.maximum(pressure, -m.background), velocity + share * slip - (1.0 - share) * past
