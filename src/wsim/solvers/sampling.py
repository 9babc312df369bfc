"""Particles that stand for the walls of a container."""

from __future__ import annotations

import math

import numpy as np

from wsim.geometry.filled import Samples, lattice_axis

Array = np.ndarray


def layers_within(support: float, spacing: float) -> int:
    """How many layers of wall a particle half a spacing off it sees, each a spacing behind the last, at least one.

    The last is left out where it is within the support by less than a tenth of a spacing: of four layers at a support
    of 4.1 spacings, its pull is 1e-4 of that of the first.

    Args:
        support: Radius of the kernel's support [m].
        spacing: Between layers [m].
    """
    return max(1, math.ceil(support / spacing - 0.1) - 1)


def container_walls(inner_size: Array, spacing: float, support: float, sides: Array, plane: bool = False) -> Samples:
    """Layers of particles behind the walls of a box, as deep as a kernel's support reaches.

    The layers carry on the lattice of a fluid that fills the box, whose first particles stand half a cell off the
    wall, and end at the rim of an open side. Positions [m] are relative to the centre of the hollow.

    Args:
        inner_size: Inner edge lengths [m].
        spacing: Particle spacing [m].
        support: Radius of the kernel's support [m].
        sides: Which walls there are, shape (3, 2): lower and upper of each axis.
        plane: One layer at y = 0 that stands for one metre of depth.
    """
    axes = [lattice_axis(float(length), spacing) for length in inner_size]
    if plane:
        axes[1] = (1, 1.0)
    ticks, outside = [], []
    for (count, edge), (lower, upper) in zip(axes, sides, strict=True):
        layers = layers_within(support, edge)
        index = np.arange(-layers if lower else 0, count + (layers if upper else 0))
        ticks.append((index + 0.5) * edge - 0.5 * count * edge)
        outside.append((index < 0) | (index >= count))
    position = np.stack(np.meshgrid(*ticks, indexing="ij"), axis=-1).reshape(-1, 3)
    keep = np.stack(np.meshgrid(*outside, indexing="ij"), axis=-1).reshape(-1, 3).any(axis=1)
    position = position[keep]
    return Samples(position, np.full(len(position), np.prod([edge for _, edge in axes])))
