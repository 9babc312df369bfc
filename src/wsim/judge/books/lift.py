"""What the fluid around a body says that it gave it: the balance of momentum in a column of the pool, and in the rest.

Of a weight f(x) that is 1 at a body and 0 at all else that is solid, the momentum of the fluid changes by

    d/dt sum m f v = sum m f g + sum m v (v . grad f) + integral p grad f dV - F

with F what the body got: the equation of motion in its weak form, without viscosity. As upright walls give nothing
upwards, f may be anything there, and has to vanish over the floor alone: f = a(z) b(x, y). Here a rises from 0 to 1
below the body, and falls again above it where fluid stands over it; b is 1 at the body and falls to 0 about it. The
rest of the pool, 1 - b, where no body is, has F = 0. It tells what the particles' pressure stands for, which carries
the weight over it to some percent alone, but by the same percents here and there. None of it knows what the recording
says that walls got.

Slopes are quadratic B-splines three spacings wide. Summed over a lattice of the spacing they leave nothing of a
constant, a straight line or a parabola, wherever the lattice lies (Schoenberg 1946), so that the ramps do not read
layers of particles as forces.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from wsim.judge.books.fluids import particle_mass

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from wsim.judge.evidence.evidence import Evidence
    from wsim.scene.world import Container, Fluid

    Floats = NDArray[np.float64]

RAMP = 3.0  # spacings that a weight rises in
LEAST = 2.0  # spacings between a body and the floor, into which a ramp may be pressed
FILLED = 0.8  # share of a ramp that particles fill at least: what splashes has no pressure to speak of
REST = 0.2  # share of the pool that no body is near, at least
AXES = np.eye(3)[:2]


def rising(t: Floats) -> tuple[Floats, Floats]:
    """From 0 at t = 0 to 1 at t = 1, and its slope: a quadratic B-spline on equal knots, by truncated powers."""
    s = 3.0 * np.clip(t, 0.0, 1.0)
    late, later = np.maximum(s - 1.0, 0.0), np.maximum(s - 2.0, 0.0)
    return (s**3 - 3.0 * late**3 + 3.0 * later**3) / 6.0, 1.5 * (s**2 - 3.0 * late**2 + 3.0 * later**2)


@dataclass(frozen=True)
class Ramp:
    """A layer in which a weight goes from 0, at the height `zero`, to 1, at `one` [m]."""

    zero: float
    one: float

    def at(self, z: Floats) -> tuple[Floats, Floats]:
        """Its weight and slope [1/m], down where it is upside down, at heights z."""
        weight, slope = rising((z - self.zero) / (self.one - self.zero))
        return weight, slope / (self.one - self.zero)

    def pressure(self, weight: Floats, z: Floats, pressure: Floats, area: float) -> float | None:
        """In its middle, straight through that of particles of some weight; None where they do not fill the area."""
        total = float(weight.sum())
        if total < FILLED * area:
            return None
        middle, mean = float(weight @ z) / total, float(weight @ pressure) / total
        slope = float((weight * (z - middle)) @ pressure) / max(float(weight @ (z - middle) ** 2), 1e-300)
        return mean + slope * ((self.zero + self.one) / 2.0 - middle)


@dataclass(frozen=True)
class Column:
    """About a body, seen from above: 1 within `half` of `middle`, 0 from `side` farther out on [m]."""

    middle: Floats  # (2,)
    half: Floats  # (2,)
    side: float

    def at(self, points: Floats) -> tuple[Floats, Floats]:
        """Its weight (N,) and gradient (N, 2) [1/m] at points (N, 2)."""
        off = points - self.middle
        near = np.flatnonzero((np.abs(off) < self.half + self.side).all(axis=1))
        weight, slope = rising((self.half + self.side - np.abs(off[near])) / self.side)
        found, gradient = np.zeros(len(points)), np.zeros((len(points), 2))
        found[near] = weight.prod(axis=1)
        gradient[near] = -np.sign(off[near]) * slope / self.side * weight[:, ::-1]
        return found, gradient

    def area(self, low: Floats, high: Floats) -> float:
        """The integral of its weight between walls [m^2]."""
        lines = np.linspace(low, high, 400)
        weight = rising((self.half + self.side - np.abs(lines - self.middle)) / self.side)[0]
        return float(np.prod([np.trapezoid(weight[:, k], lines[:, k]) for k in range(2)]))

    def meets(self, other: Column) -> bool:
        """Whether there are points at which both weigh something."""
        reach = self.half + self.side + other.half + other.side
        return bool((np.abs(self.middle - other.middle) < reach).all())


class Surroundings:
    """A fluid in an upright tank, about its bodies, at K frames.

    Attributes:
        frames: Which they are, (K,).
    """

    def __init__(self, evidence: Evidence, fluid: Fluid, container: Container, frames: NDArray[np.intp]) -> None:
        """`frames` are those of the evidence that the fluid was recorded at."""
        self._evidence, self._fluid, self._track = evidence, fluid, evidence.track(fluid)
        self.frames = frames
        self._q = evidence.body_q[frames]
        self._heights = np.array([evidence.ends(i) for i in range(len(evidence.world.bodies))])[
            :, :, frames
        ]  # (B, 2, K)
        half = np.array(container.inner_size) / 2.0
        self._low, self._high = np.array(container.inner_center) - half, np.array(container.inner_center) + half
        self._sound = evidence.sound(fluid) or math.nan
        self._mass = particle_mass(fluid)

    @cached_property
    def _widths(self) -> Floats:
        """How far each body reaches along x and y from its origin, both ways, (B, 2, 2, K) [m]."""
        bodies = range(self._q.shape[1])
        return np.array([[self._evidence.solid(i).reach(self._q[:, i, 3:], axis) for axis in AXES] for i in bodies])

    def column(self, i: int, k: int) -> Column:
        """About body i, from frame k to the next."""
        at = self._q[k : k + 2, i, :2].T
        low = (at + self._widths[i, :, 0, k : k + 2]).min(axis=1)
        high = (at + self._widths[i, :, 1, k : k + 2]).max(axis=1)
        return Column((low + high) / 2.0, (high - low) / 2.0, RAMP * self._fluid.spacing)

    def near(self, i: int, k: int) -> bool:
        """Whether body i may be in the fluid, and far enough from the floor."""
        top = self._fluid.center[2] + self._fluid.size[2]
        return bool(self._low[2] + LEAST * self._fluid.spacing <= self._heights[i, 0, k : k + 2].min() < top)

    def lift(self, i: int, k: int) -> float | None:
        """The mean force upwards on body i from frame k to the next [N]; None where the fluid does not tell."""
        surface = 2.0 * float(self._track.position[k, :, 2].mean(dtype=np.float64)) - self._low[2]
        wet = [j for j in range(len(self._heights)) if self._heights[j, 0, k : k + 2].min() < surface]
        if i not in wet or (ramps := self._ramps(i, k, surface)) is None:
            return None
        columns = [self.column(j, k) for j in [i, *(j for j in wet if j != i)]]
        areas = [column.area(self._low[:2], self._high[:2]) for column in columns]
        whole = float(np.prod((self._high - self._low)[:2]))
        meet = any(a.meets(b) for n, a in enumerate(columns) for b in columns[:n])
        out = (columns[0].middle < self._low[:2]) | (columns[0].middle > self._high[:2])
        if meet or out.any() or whole - sum(areas) < REST * whole:
            return None
        return self._between(k, columns, ramps, (areas[0], whole - sum(areas)))

    def _ramps(self, i: int, k: int, surface: float) -> list[Ramp] | None:
        """Below body i, and above it where there is fluid; None where it is too near to the floor."""
        spacing = self._fluid.spacing
        bottom, top = float(self._heights[i, 0, k : k + 2].min()), float(self._heights[i, 1, k : k + 2].max())
        one, floor = min(bottom, surface - spacing), float(self._low[2])  # particles end half a spacing below it
        if one - floor < LEAST * spacing:
            return None
        below = Ramp(max(floor, one - RAMP * spacing), one)
        above = Ramp(top + RAMP * spacing, top)
        return [below, above] if above.zero + spacing < surface else [below]

    def _between(
        self, k: int, columns: Sequence[Column], ramps: Sequence[Ramp], areas: tuple[float, float]
    ) -> float | None:
        first, last = (self._parts(frame, columns, ramps, areas) for frame in (k, k + 1))
        if first is None or last is None:
            return None
        h = float(self._track.time[k + 1] - self._track.time[k])
        momentum, brought, pressed = np.moveaxis(np.array([first, last]), 2, 0)  # (both frames, column and rest) each
        bare, push = brought.mean(axis=0) - (momentum[1] - momentum[0]) / h, pressed.mean(axis=0)
        return float(bare[0] - bare[1] * push[0] / push[1]) if push[1] > 0.0 else None

    def _parts(
        self, frame: int, columns: Sequence[Column], ramps: Sequence[Ramp], areas: tuple[float, float]
    ) -> list[tuple[float, float, float]] | None:
        """Of the first column and the rest, upwards: momentum [N s], what gravity and flow bring, and pressure [N]."""
        over = self._track.position[frame, :, 2] > ramps[0].zero  # elsewhere the weights are 0
        points = self._track.position[frame, over].astype(np.float64)
        v = self._track.velocity[frame, over].astype(np.float64)
        density = self._track.density[frame, over].astype(np.float64)
        pressure = self._sound**2 * (density - self._fluid.density)
        weighed, layers = [each.at(points[:, :2]) for each in columns], [ramp.at(points[:, 2]) for ramp in ramps]
        up, rise = np.prod([a for a, _ in layers], axis=0), np.sum([slope for _, slope in layers], axis=0)
        rest = 1.0 - np.sum([b for b, _ in weighed], axis=0), -np.sum([gradient for _, gradient in weighed], axis=0)
        found = []
        for (b, gradient), area in zip((weighed[0], rest), areas, strict=True):
            flow = v[:, 2] * (v[:, 2] * rise * b + up * np.einsum("ni,ni->n", gradient, v[:, :2]))
            brought = self._mass * float((flow - self._evidence.gravity * up * b).sum())
            pressed = 0.0
            for ramp, (_, slope) in zip(ramps, layers, strict=True):
                weight = np.abs(slope) * b * self._mass / density
                mean = ramp.pressure(weight, points[:, 2], pressure, area)
                if mean is None:
                    return None
                pressed += math.copysign(area * mean, ramp.one - ramp.zero)
            found.append((self._mass * float((up * b) @ v[:, 2]), brought, pressed))
        return found
