"""Taps and drains of an SPH fluid: where they are, and the particles that they need."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import warp as wp

from wsim.geometry.filled import GOLDEN, lattice_axis
from wsim.geometry.rotations import conjugate, rotate
from wsim.solvers.sph_config import ConfigSPH

Array = np.ndarray
Vec3 = tuple[float, float, float]
STRAY = 0.25  # of a spacing: drops of rain fall no farther from their lattice


@dataclass(frozen=True)
class Tap:
    """A mouth that water comes out of, at a rate.

    Its rate is `rate` until the first of `times`, then that key's of `rates` to the next key. Water leaves at rate /
    area, as if a pipe led there; with `speed` it falls as drops, spread over the mouth and over time, each that fast.
    """

    position: Vec3
    """Centre of the mouth [m]."""
    direction: Vec3
    """Where water goes, of any length."""
    rate: float
    """[m^3/s]"""
    radius: float = 0.0
    """Of a round mouth [m]; 0 where it is a rectangle."""
    size: tuple[float, float] = (0.0, 0.0)
    """Width and height of a rectangular mouth [m]; the height is upright, or along Y if water flows along Z."""
    times: tuple[float, ...] = ()
    rates: tuple[float, ...] = ()
    speed: float = 0.0
    """Of drops [m/s]; 0 where the mouth has a pipe behind it."""
    world: int = -1
    """The world that it is in; -1 is every world."""

    @property
    def area(self) -> float:
        """Of the mouth [m^2]."""
        return math.pi * self.radius**2 if self.radius else self.size[0] * self.size[1]


@dataclass(frozen=True)
class Drain:
    """A face that water leaves through, and the hole behind it: what is fixed there is cut away."""

    position: Vec3
    """Centre of the face [m]."""
    direction: Vec3
    """Where water goes, of any length."""
    radius: float = 0.0
    size: tuple[float, float] = (0.0, 0.0)
    """As of a tap."""
    depth: float = 0.0
    """How far behind the face water is taken away [m]; 0 takes what a kernel reaches."""
    falls: bool = True
    """Whether water falls freely behind it, as below a hole, or goes on as it came, as where a channel goes on."""
    world: int = -1
    """The world that it is in; -1 is every world."""


def pose_of(opening: Tap | Drain) -> Array:
    """Position and orientation (7,), xyzw: z is where the water goes, y as upright as it can be."""
    z = np.array(opening.direction, dtype=float)
    z = z / np.linalg.norm(z)
    x = np.array([1.0, 0.0, 0.0]) if abs(z[2]) > 1.0 - 1e-9 else np.cross([0.0, 0.0, 1.0], z)
    x = x / np.linalg.norm(x)
    turn = wp.quat_from_matrix(wp.mat33(np.stack([x, np.cross(z, x), z], axis=1)))
    return np.array([*opening.position, *np.array(turn)])


def places_of(tap: Tap, spacing: float) -> tuple[Array, Array]:
    """Where particles come from in a mouth: places (n, 2) [m], and how far each one's first has come [layers], (n,).

    In a disc they are the points of a sunflower, each of the same area.
    """
    if tap.radius:
        count = max(1, round(tap.area / spacing**2))
        k = np.arange(count)
        ring = tap.radius * np.sqrt((k + 0.5) / count) if count > 1 else np.zeros(1)
        place = np.stack([ring * np.cos(GOLDEN * k), ring * np.sin(GOLDEN * k)], axis=1)
        place -= place.mean(axis=0)
    else:
        (wide, edge), (high, rise) = (lattice_axis(length, spacing) for length in tap.size)
        x, y = (np.arange(wide) + 0.5) * edge, (np.arange(high) + 0.5) * rise
        place = np.stack(np.meshgrid(x, y, indexing="ij"), axis=-1).reshape(-1, 2) - 0.5 * np.array(tap.size)
    phase = np.zeros(len(place))
    if tap.speed:
        some = np.random.default_rng(0)
        phase = some.permutation((np.arange(len(place)) + 0.5) / len(place))
        place = place + STRAY * spacing * some.uniform(-1.0, 1.0, place.shape)
    return place, phase


def layer_of(tap: Tap, spacing: float, volume: float) -> float:
    """From one layer of a tap's particles to the next [m], each of which stands for a volume [m^3]."""
    return len(places_of(tap, spacing)[0]) * volume / tap.area


def layers_of(tap: Tap, config: ConfigSPH, volume: float) -> int:
    """Of particles in a tap's pipe, which is as long as a kernel reaches."""
    return 0 if tap.speed else math.ceil(config.support / layer_of(tap, config.spacing, volume))


def depth_of(tap: Tap, config: ConfigSPH, volume: float) -> float:
    """How long a tap's pipe is [m]; 0 where it has none."""
    return layers_of(tap, config, volume) * layer_of(tap, config.spacing, volume)


def in_pipe(tap: Tap, config: ConfigSPH, volume: float, position: Array, margin: float = 0.0) -> Array:
    """Which positions (n, 3) [m] are in a tap's pipe, or within a margin [m] of it."""
    depth, own = depth_of(tap, config, volume), local(tap, position)
    along = (own[:, 2] > -depth - margin) & (own[:, 2] < margin)
    return along & beside(tap, own, margin) if depth else np.zeros(len(position), dtype=bool)


def beside(opening: Tap | Drain, own: Array, margin: float = 0.0) -> Array:
    """Which positions (n, 3), in the frame of an opening, are before or behind it, or within a margin of that [m]."""
    if opening.radius:
        return np.asarray(np.hypot(own[:, 0], own[:, 1]) <= opening.radius + margin)
    return np.asarray((np.abs(own[:, :2]) <= 0.5 * np.array(opening.size) + margin).all(axis=1))


def poured_by(tap: Tap, time: float) -> float:
    """Volume that has come out of a tap by a time [m^3]."""
    spans = itertools.pairwise([0.0, *(min(key, time) for key in tap.times), time])
    return sum(rate * (end - start) for rate, (start, end) in zip((tap.rate, *tap.rates), spans, strict=True))


def pool_for(taps: Sequence[Tap], config: ConfigSPH, volume: float, time: float) -> int:
    """Particles of a volume [m^3] that taps of one world need for a time [s], if no drain gives any back."""
    need = 0
    for tap in taps:
        layer = len(places_of(tap, config.spacing)[0])
        need += layer * (layers_of(tap, config, volume) + 1) + math.ceil(poured_by(tap, time) / volume)
    return need


def local(opening: Tap | Drain, position: Array) -> Array:
    """Positions (n, 3) [m] in the frame of an opening, where water flows along z."""
    pose = pose_of(opening)
    return rotate(conjugate(pose[3:]), position - pose[:3])


def placed(opening: Tap | Drain, position: Array) -> Array:
    """Positions (n, 3) [m] in the frame of an opening, in the world's."""
    pose = pose_of(opening)
    return rotate(pose[3:], position) + pose[:3]
