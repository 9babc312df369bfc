"""What the water in gaps too narrow for a particle gives to bodies at a frame, worked out anew.

Particles s of walls and of other bodies push a particle b of a body across a gap (docs/sph.md):

    F = -sum_b V_b sum_s k_bs V_s (p_b + p_s) grad W

where none of the two has its fluid behind it, seen across the gap. An open gap that no particle fits into has water
that is missing in the sum: k makes up for it, so that sum V grad W over all around b is nothing. Particles take their
pressure from the fluid near them; those of a body that no fluid is near take it from others of that body at a gap that
have it, as water seeps in from the rim. Here that is the state that the run's steps tend to. All pressures are taken
from the fluid's particles that a recording has; those of solids stand where it says: on walls, and in bodies.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy.spatial import cKDTree

from wsim.judge.books.sph import Method, Taken, pairs_within

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]
    Rows = NDArray[np.intp]
    Flags = NDArray[np.bool_]

BEYOND = 0.5  # of the way across a gap: fluid that lies farther off behind a particle is not in there
WALL = -1  # in place of a body's number
FAR_ACROSS = 0.02  # of the own sum of V grad W: that over others across a gap that water gets into is as small
FILLED = 0.25  # of the own sum: held against it by fluid in a gap that its particles fit into
MOST_HOPS = 64  # that pressure seeps on from the water that it came from
STILL = 1e-4  # of the largest pressure: one that changes by less is what it tends to
ROUNDS = 500


@dataclass(frozen=True)
class Solid:
    """Particles of all solids, and what they take from the fluid."""

    place: Floats  # (n, 3) [m]
    volume: Floats  # (n,) [m^3]
    owner: Rows  # (n,) the body's number, or WALL
    gradient: Floats  # (n, 3) of a body's: sum of V grad W over the others of it [1/m]
    taken: Taken
    vessels: frozenset[int] = frozenset()  # bodies at whose walls no gap is: their particles lie in what is beside them


@dataclass(frozen=True)
class Across:
    """Pairs of particles b of bodies and s of other solids within reach of each other, each from either side."""

    b: Rows
    s: Rows
    distance: Floats  # [m]
    way: Floats  # (pairs, 3) x_b - x_s [m]
    between: Flags  # whether water between the two pushes them


def forces_in_gaps(method: Method, solid: Solid, count: int) -> Floats:
    """What the water in gaps gives each of a number of bodies, (count, 3) [N]."""
    pairs = _across(method, solid)
    if not pairs.between.any():
        return np.zeros((count, 3))
    pressure, has = _seeped(method, solid, pairs)
    of_wall = solid.owner[pairs.s] == WALL
    still = pressure[pairs.b] - solid.taken.density[pairs.b] * (pairs.way @ method.gravity)
    mirrored = of_wall & ~has[pairs.s]
    its = np.where(mirrored, np.maximum(still, -method.background), pressure[pairs.s])
    push = pairs.between & has[pairs.b] & (has[pairs.s] | of_wall)
    widening = _widening(method, solid, pairs)
    longer = np.where(of_wall, widening[pairs.b], 0.5 * (widening[pairs.b] + widening[pairs.s]))
    size = longer * solid.volume[pairs.b] * solid.volume[pairs.s] * method.slope(pairs.distance)
    force = np.where(push, -size * (pressure[pairs.b] + its + 2.0 * method.background), 0.0)[:, None] * pairs.way
    return np.stack([np.bincount(solid.owner[pairs.b], column, count) for column in force.T], axis=1)


def _widening(method: Method, solid: Solid, pairs: Across) -> Floats:
    """What the sum over others across a gap is to be times, so that V grad W over all around is nothing, (n,)."""
    slopes = np.where(pairs.between, method.slope(pairs.distance) * solid.volume[pairs.s], 0.0)
    others = np.stack([np.bincount(pairs.b, slopes * c, len(solid.volume)) for c in pairs.way.T], axis=1)
    own, fluid = solid.gradient, solid.taken.gradient
    own2, others2 = (np.einsum("ij,ij->i", each, each) for each in (own, others))
    missing = -np.einsum("ij,ij->i", own + fluid, others)
    needed = missing / np.maximum(others2 + FAR_ACROSS**2 * own2, 1e-300)
    held = -np.einsum("ij,ij->i", fluid, own) / np.maximum(own2, 1e-300)
    share = np.clip(1.0 - held / FILLED, 0.0, 1.0)
    return np.where(others2 > 0.0, np.maximum(1.0 + share * (needed - 1.0), 0.0), 1.0)


def _across(method: Method, solid: Solid) -> Across:
    """Who is across whose gap."""
    parts = [part for i in np.unique(solid.owner[solid.owner != WALL]) for part in _pairs(method, solid, i)]
    b: Rows = np.concatenate([part[0] for part in parts] + [np.zeros(0, np.intp)])
    s: Rows = np.concatenate([part[1] for part in parts] + [np.zeros(0, np.intp)])
    distance = np.concatenate([part[2] for part in parts] + [np.zeros(0)])
    way = solid.place[b] - solid.place[s]
    weight = method.weight(distance)
    across = np.stack([np.bincount(b, -weight * column, len(solid.place)) for column in way.T], axis=1)
    across = across / np.maximum(np.linalg.norm(across, axis=1), 1e-300)[:, None]
    spared = np.isin(solid.owner, sorted(solid.vessels))
    across[spared] = 0.0
    over = across[b] - across[s]  # nothing for walls, which take b's
    length = np.where(solid.owner[s] == WALL, 1.0, np.linalg.norm(over, axis=1))
    facing = np.where(solid.taken.wet[:, None], solid.taken.facing, 0.0)
    own, its = (np.einsum("ij,ij->i", facing[rows], over) for rows in (b, s))
    return Across(b, s, distance, way, (own > -BEYOND * length) & (its < BEYOND * length) & ~spared[b])


def _pairs(method: Method, solid: Solid, i: int) -> list[tuple[Rows, Rows, Floats]]:
    """Particles of body i, those of others within their reach, and how far off, part by part."""
    own = np.flatnonzero(solid.owner == i)
    low, high = solid.place[own].min(axis=0) - method.reach, solid.place[own].max(axis=0) + method.reach
    about = ((solid.place >= low) & (solid.place <= high)).all(axis=1)
    others = np.flatnonzero((solid.owner != i) & about)
    if not len(others):
        return []
    tree = cKDTree(solid.place[others])
    found = pairs_within(tree, solid.place[own], method.reach)
    return [(own[part][pairs["i"]], others[pairs["j"]], pairs["v"]) for part, pairs in found]


def _seeped(method: Method, solid: Solid, pairs: Across) -> tuple[Floats, Flags]:
    """Pressures of all particles (n,) [Pa], and which have any: those near fluid, and those that water seeps to."""
    pressure, has = solid.taken.pressure.copy(), solid.taken.wet.copy()
    open_ = np.zeros(len(has), dtype=bool)
    open_[pairs.b[pairs.between]] = True
    dry = open_ & ~has
    to, of, distance = _neighbors(method, solid, np.flatnonzero(open_), dry)
    weight = method.weight(distance)
    deeper = method.density * ((solid.place[to] - solid.place[of]) @ method.gravity)
    for k in range(ROUNDS):
        some = np.where(has[of], weight, 0.0)
        total = np.bincount(to, some, len(has))
        mean = np.bincount(to, some * (pressure[of] + deeper), len(has)) / np.maximum(total, 1e-300)
        reached = dry & (total > 0.0)
        new = np.where(reached, np.maximum(mean, -method.background), pressure)
        change, grown = np.abs(new - pressure).max(initial=0.0), (reached & ~has).any() and k < MOST_HOPS
        if k < MOST_HOPS:
            has |= reached
        pressure = np.where(has, new, 0.0)
        if not grown and change <= STILL * np.abs(pressure).max(initial=0.0):
            break
    return pressure, has


def _neighbors(method: Method, solid: Solid, rows: Rows, wanting: Flags) -> tuple[Rows, Rows, Floats]:
    """Of some particles, those that want pressure, others of the same body within reach, and how far off."""
    to = rows[wanting[rows]]
    if not len(to):
        return to, to, np.zeros(0)
    tree = cKDTree(solid.place[rows])
    found = [(to[part][p["i"]], rows[p["j"]], p["v"]) for part, p in pairs_within(tree, solid.place[to], method.reach)]
    one, other = (np.concatenate([each[k] for each in found]).astype(np.intp) for k in (0, 1))
    distance = np.concatenate([each[2] for each in found])
    same = (solid.owner[one] == solid.owner[other]) & (one != other)
    return one[same], other[same], distance[same]
