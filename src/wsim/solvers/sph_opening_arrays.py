"""Taps and drains of an SPH fluid as the arrays that kernels take (`wsim.kernels.sph.openings`)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import warp as wp

from wsim.kernels.schedules import Keys
from wsim.kernels.sph import openings as kernels
from wsim.solvers.sph_config import ConfigSPH
from wsim.solvers.sph_mouths import Drain, Tap, depth_of, layer_of, places_of, pose_of

Array = np.ndarray


def taps_of(own: Sequence[tuple[int, Tap]], config: ConfigSPH, volume: Array, mass: Array) -> Any:
    """A `Taps`.

    Args:
        own: Taps with their worlds, world by world.
        config: For the spacing and the support.
        volume: Of a particle in each world [m^3], (W,).
        mass: Of it [kg], (W,).
    """
    found, spacing = kernels.Taps(), config.spacing
    taps, worlds = [tap for _, tap in own], [w for w, _ in own]
    layers = [layer_of(tap, spacing, volume[w]) for w, tap in own]
    depths = [depth_of(tap, config, volume[w]) for w, tap in own]
    found.pose = wp.array(np.array([pose_of(tap) for tap in taps]).reshape(-1, 7), dtype=wp.transform)
    found.half, found.round = _faces(taps)
    found.area = wp.array([tap.area for tap in taps], dtype=wp.float64)
    found.layer, found.depth = wp.array(layers, dtype=wp.float64), wp.array(depths, dtype=float)
    found.mass, found.speed = wp.array(mass[worlds], dtype=float), wp.array([tap.speed for tap in taps], dtype=float)
    found.keys = _keys(taps)
    places = [places_of(tap, spacing) for tap in taps]
    counts = [len(place) for place, _ in places]
    flat = np.concatenate([np.zeros((0, 2)), *(place for place, _ in places)])
    found.tap = wp.array(np.repeat(np.arange(len(taps)), counts).astype(np.int32), dtype=int)
    found.place = wp.array(np.column_stack([flat, np.zeros(len(flat))]), dtype=wp.vec3)
    found.phase = wp.array(np.concatenate([np.zeros(0), *(phase for _, phase in places)]), dtype=wp.float64)
    homes = np.repeat(np.array(worlds, dtype=np.int32), counts)
    found.world, found.first = wp.array(homes, dtype=int), _first(homes, len(mass))
    found.place_first = wp.array(np.append(0, np.cumsum(counts)), dtype=int)
    found.tap_first = _first(np.array(worlds, dtype=np.int32), len(mass))
    return found


def drains_of(own: Sequence[tuple[int, Drain]], config: ConfigSPH, world_count: int) -> Any:
    """A `Drains`, of drains with their worlds, world by world."""
    found = kernels.Drains()
    drains = [drain for _, drain in own]
    found.pose = wp.array(np.array([pose_of(drain) for drain in drains]).reshape(-1, 7), dtype=wp.transform)
    found.half, found.round = _faces(drains)
    found.depth = wp.array([drain.depth or config.support for drain in drains], dtype=float)
    found.falls = wp.array([int(drain.falls) for drain in drains], dtype=int)
    found.first = _first(np.array([w for w, _ in own], dtype=np.int32), world_count)
    return found


def _faces(openings: Sequence[Tap | Drain]) -> tuple[wp.array, wp.array]:
    """Half of each one's width and height [m], of a round one the radius, twice; and whether it is round."""
    halves = [(each.radius,) * 2 if each.radius else (0.5 * each.size[0], 0.5 * each.size[1]) for each in openings]
    half = wp.array(np.array(halves).reshape(-1, 2), dtype=wp.vec2)
    return half, wp.array([int(each.radius > 0.0) for each in openings], dtype=int)


def _first(homes: Array, world_count: int) -> wp.array:
    return wp.array(np.append(0, np.cumsum(np.bincount(homes, minlength=world_count))), dtype=int)


def _keys(taps: Sequence[Tap]) -> Any:
    """Key frames of the taps' rates, padded to as many; one at infinity where there is none."""
    most = max((len(tap.times) for tap in taps), default=0) or 1
    times, values = np.full((len(taps), 1, most), np.inf), np.zeros((len(taps), 1, most, 3))
    for k, tap in enumerate(taps):
        times[k, 0, : len(tap.times)], values[k, 0, : len(tap.rates), 0] = tap.times, tap.rates
    found = Keys()
    found.times, found.values = wp.array(times, dtype=wp.float64), wp.array(values, dtype=wp.vec3d)
    found.count = wp.array([[len(tap.times)] for tap in taps], dtype=int).reshape((len(taps), 1))
    found.linear = wp.zeros((len(taps), 1), dtype=int)
    found.base = wp.array([[(tap.rate, 0.0, 0.0)] for tap in taps], dtype=wp.vec3d).reshape((len(taps), 1))
    return found
