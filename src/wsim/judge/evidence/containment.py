"""Which of a fluid's particles a container holds, frame by frame."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from wsim.geometry.rotations import conjugate, rotate
from wsim.geometry.shapes import kind_of
from wsim.scene.contact import within

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from wsim.scene.world import Container, Fluid, World
    from wsim.scene.world_openings import Tap

    Floats = NDArray[np.float64]
    Bools = NDArray[np.bool_]


UPRIGHT = 0.7  # of the vertical that the way out of a mouth has, whose width and height are then along X and Y


@dataclass(frozen=True)
class Containment:
    """Where particles are, seen from a container."""

    strayed: Bools  # (T, N): more than `slack` beyond its walls or under its floor; over the open rim is not
    above: Bools  # (T, N): more than `slack` over its rim
    beside: Bools  # (T, N): where it would have strayed, but has never been in it: rain that fell beside
    count: Floats  # (T,): particles in the world, 1 at least

    @classmethod
    def of(
        cls,
        container: Container,
        position: NDArray[np.float32],
        slack: float,
        poured: bool = False,
        beside: bool = False,
    ) -> Containment:
        """Of particles at positions (T, N, 3), `slack` beside the container's inner faces [m].

        One that is not in the world has no position: it is NaN, and neither strayed nor above. With `poured` it may
        come from a tap anywhere over the rim, and has strayed when it is below that. With `beside` it may also fall
        beside the container, as rain does, and has strayed only if it was in there before.
        """
        strayed = np.empty(position.shape[:2], dtype=bool)
        above, missed = np.empty_like(strayed), np.zeros_like(strayed)
        half = np.array(container.inner_size) / 2 + slack
        been = np.zeros(position.shape[1], dtype=bool)
        for t, points in enumerate(position):  # one frame at a time: a recording may be larger than a cache
            x, y, z = np.moveaxis(local(container, points), -1, 0)
            strayed[t] = (np.abs(x) > half[0]) | (np.abs(y) > half[1]) | (z < -half[2])
            above[t] = z > half[2]
            if poured:
                strayed[t] &= ~above[t]
            if beside:
                there = np.isfinite(x)
                been = (been & there) | (there & ~strayed[t] & ~above[t])
                missed[t] = strayed[t] & ~been
                strayed[t] &= been
        return cls(strayed, above, missed, np.maximum(np.isfinite(position[..., 0]).sum(axis=1), 1).astype(np.float64))

    @property
    def outside(self) -> Floats:
        """Share that strayed, (T,)."""
        share: Floats = self.strayed.sum(axis=1) / self.count
        return share

    @property
    def elsewhere(self) -> Floats:
        """Share that strayed, or fell beside it, (T,)."""
        return self.outside + self.beside.sum(axis=1) / self.count

    def inside(self) -> Floats:
        """Share that is inside, below the rim, at each frame (T,)."""
        return 1.0 - (self.strayed | self.above | self.beside).sum(axis=1) / self.count


def falls_beside(container: Container, taps: Sequence[Tap]) -> bool:
    """Whether the mouth of some tap is not wholly over a container: what it pours need not be the container's."""
    half = np.array(container.inner_size[:2]) / 2
    for tap in taps:
        wide = max(tap.size) / 2 if abs(tap.direction[2]) < UPRIGHT else np.array(tap.size) / 2
        reach = np.abs(local(container, np.array(tap.position))[:2]) + (tap.radius or wide)
        if (reach > half + 1e-6).any():
            return True
    return False


def local(container: Container, points: Floats) -> Floats:
    """Points (..., 3) in a container's frame, its inner box centred on the origin [m]."""
    q = np.array(container.rotation, dtype=np.float64)
    shifted = points - np.array(container.inner_center)
    if np.array_equal(q, [0.0, 0.0, 0.0, 1.0]):
        return shifted
    return rotate(conjugate(q), shifted)


def alike(one: Fluid, other: Fluid) -> bool:
    """Whether two fluids are the same liquid to what floats in them."""
    return math.isclose(one.density, other.density)


def lone_pool(world: World, container: Container, up: Floats) -> bool:
    """Whether a container is upright and nothing that stands still is in it."""
    if rotate(np.array(container.rotation), np.array([0.0, 0.0, 1.0])) @ up < 1.0 - 1e-6:
        return False
    half = np.array(container.inner_size) / 2
    shapes = [shape for static in world.statics for shape in static.shapes]
    return not any(
        (np.abs(local(container, np.array(shape.position))) < half + kind_of(shape).radius_about).all()
        for shape in shapes
        if shape.kind != "plane" and not within(shape.prim, container.prim)
    )


def pools_of(dry: Bools) -> NDArray[np.intp]:
    """Which connected part of what is not dry each cell (m, n) is in, counted from 0; -1 where it is dry."""
    pools = np.full(dry.shape, -1, dtype=np.intp)
    found = 0
    for start in np.argwhere(~dry):
        if pools[tuple(start)] >= 0:
            continue
        edge = [tuple(int(x) for x in start)]
        pools[edge[0]] = found
        while edge:
            x, y = edge.pop()
            for cell in ((x - 1, y), (x + 1, y), (x, y - 1), (x, y + 1)):
                inside = 0 <= cell[0] < dry.shape[0] and 0 <= cell[1] < dry.shape[1]
                if inside and not dry[cell] and pools[cell] < 0:
                    pools[cell] = found
                    edge.append(cell)
        found += 1
    return pools
