"""Particles at rest in the hollow of a vessel."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
from scipy.spatial import cKDTree

from wsim.geometry.hollows import Filling

Array = np.ndarray
SWEEPS = 20
STEP = 3.0  # [deg] that the lattice is turned by, to fit between the walls
FINE = 4  # cells along a spacing, at least


def spread(filling: Filling, spacing: float, count: int) -> Array:
    """Places of particles in the room, (count, 3), each with as much of it.

    They stand in level layers, as many in each as its room is worth: what is packed unevenly sinks together, and holds
    its own weight up by less than its pressure. In a layer they are spread evenly (Lloyd 1982).

    Args:
        filling: The room.
        spacing: Between particles, about [m].
        count: Of particles.
    """
    turn = _square_on(filling.cells[:, :2])
    cells = filling.cells.copy()
    cells[:, :2] = cells[:, :2] @ turn
    filling = _finer(replace(filling, cells=cells), spacing)
    layers = max(1, round((filling.level - filling.floor) / spacing))
    which, layer, room = _in_layers(filling, layers)
    share = np.cumsum(np.bincount(layer, room, layers))
    many = np.diff(np.rint(share / share[-1] * count), prepend=0.0).astype(int)
    thick, found = (filling.level - filling.floor) / layers, []
    for k in np.flatnonzero(many).tolist():
        own = layer == k
        cells, low, half = filling.cells[which[own]], filling.level - (k + 1) * thick, 0.5 * filling.edge
        bottom, top = np.maximum(cells[:, 2] - half, low), np.minimum(cells[:, 2] + half, low + thick)
        cells[:, 2] = 0.5 * (bottom + top)
        found.append(_layer(cells, room[own], spacing, int(many[k])))
    places = np.concatenate(found)
    places[:, :2] = places[:, :2] @ turn.T
    return places


def _square_on(cells: Array) -> Array:
    """The rotation (2, 2) that lays points (n, 2) into the smallest upright rectangle: along straight walls."""
    best, least = np.eye(2), np.inf
    for angle in np.radians(np.arange(0.0, 90.0, STEP)):
        turn = np.array([[math.cos(angle), -math.sin(angle)], [math.sin(angle), math.cos(angle)]])
        area = float(np.ptp(cells @ turn, axis=0).prod())
        if area < least * (1.0 - 1e-3):
            best, least = turn, area
    return best


def _in_layers(filling: Filling, layers: int) -> tuple[Array, Array, Array]:
    """Cells, the layers from the level down that they are in, one or two, and the room of each there."""
    thick = (filling.level - filling.floor) / layers
    top = np.minimum(filling.cells[:, 2] + 0.5 * filling.edge, filling.level)
    low = np.maximum(filling.cells[:, 2] - 0.5 * filling.edge, filling.floor)
    upper = np.clip((filling.level - top) / thick + 1e-9, 0, layers - 1).astype(int)
    lower = np.clip((filling.level - low) / thick - 1e-9, 0, layers - 1).astype(int)
    edge = filling.level - (upper + 1) * thick
    above = np.where(lower > upper, np.clip((top - edge) / np.maximum(top - low, 1e-12), 0.0, 1.0), 1.0)
    which = np.concatenate([np.arange(len(top)), np.flatnonzero(above < 1.0)])
    layer = np.concatenate([upper, (upper + 1)[above < 1.0]])
    return which, layer, np.concatenate([filling.room * above, (filling.room * (1.0 - above))[above < 1.0]])


def _finer(filling: Filling, spacing: float) -> Filling:
    """The same room in cells that are small against a spacing."""
    parts = math.ceil(FINE * filling.edge / spacing * (1.0 - 1e-9))
    if parts == 1:
        return filling
    edge = filling.edge / parts
    ticks = (np.arange(parts) - 0.5 * (parts - 1)) * edge
    offsets = np.stack(np.meshgrid(ticks, ticks, ticks, indexing="ij"), axis=-1).reshape(-1, 1, 3)
    cells = (filling.cells + offsets).reshape(-1, 3)
    return Filling(cells, np.tile(filling.room / parts**3, parts**3), edge, filling.floor, filling.level)


def _layer(cells: Array, room: Array, spacing: float, count: int) -> Array:
    """Places of particles in one layer's cells, at the height of what is around each."""
    seeds = _lattice(cells[:, :2], spacing, count)
    for _ in range(SWEEPS + 1):
        nearest = cKDTree(seeds).query(cells[:, :2], workers=-1)[1]
        share = np.bincount(nearest, room, len(seeds))
        held = share > 0.0
        middle = np.stack([np.bincount(nearest, room * cells[:, k], len(seeds)) for k in range(3)], axis=1)
        middle[held] = middle[held] / share[held, None]
        seeds[held] = middle[held, :2]
    height = np.where(held, middle[:, 2], np.average(cells[:, 2], weights=room))
    return np.column_stack([seeds, height])


def _lattice(cells: Array, spacing: float, count: int) -> Array:
    """As many places in a layer, of a lattice as far as it goes: too many are thinned out, too few made up for."""
    low, high = cells.min(axis=0), cells.max(axis=0)
    ticks = [_ticks(low[k], high[k], spacing) for k in range(2)]
    points = np.stack(np.meshgrid(*ticks, indexing="ij"), axis=-1).reshape(-1, 2)
    away = cKDTree(cells).query(points, workers=-1)[0]
    points = points[np.argsort(away, kind="stable")[: min(count, int((away < 0.5 * spacing).sum()))]]
    while len(points) < count:
        far = cKDTree(points).query(cells, workers=-1)[0] if len(points) else np.ones(len(cells))
        points = np.concatenate([points, cells[[int(far.argmax())]]])
    return points + 1e-9 * spacing * np.arange(len(points))[:, None]


def _ticks(low: float, high: float, spacing: float) -> Array:
    """Middles of about a spacing's length each between two cells' middles."""
    count = max(1, round((high - low) / spacing))
    return low + (np.arange(count) + 0.5) * (high - low) / count
