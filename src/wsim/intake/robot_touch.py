"""Which parts of a robot never touch: by MuJoCo's collision masks and exclusions, or as they overlap from the start."""

from __future__ import annotations

from collections import defaultdict
from itertools import combinations
from typing import Any

import mujoco
import numpy as np

from wsim.importers.mujoco_names import clean, element
from wsim.importers.mujoco_shapes import collides
from wsim.importers.mujoco_tree import Tree


def apart_of(model: Any, tree: Tree, owner: dict[int, str], notes: list[str]) -> list[tuple[str, str]]:
    """Pairs of links, or of shapes as "link/shape", that pass through each other.

    Args:
        model: MuJoCo's.
        tree: Of its bodies.
        owner: The link that each body is part of.
        notes: Told of what overlaps.
    """
    of_link: dict[str, list[int]] = defaultdict(list)
    for g in range(model.ngeom):
        if collides(model, g) and int(model.geom_bodyid[g]) in owner:
            of_link[owner[int(model.geom_bodyid[g])]].append(g)
    overlapping = _overlapping(model, owner)
    found: list[tuple[str, str]] = []
    for one, two in combinations(of_link, 2):
        pairs = [(a, b) for a in of_link[one] for b in of_link[two]]
        barred = [pair for pair in pairs if not _may_touch(model, tree, *pair)]
        if len(barred) == len(pairs):
            found.append((one, two))
        elif frozenset((one, two)) in overlapping:
            notes.append(f"{one} and {two} overlap in the file's pose, and pass through each other")
            found.append((one, two))
        else:
            found += [(_named(model, one, a), _named(model, two, b)) for a, b in barred]
    return found


def _named(model: Any, link: str, g: int) -> str:
    return f"{link}/{clean(element(model, 'geom', g))}"


def _overlapping(model: Any, owner: dict[int, str]) -> set[frozenset[str]]:
    """Links that touch in the reference pose, of those that may."""
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    found = set()
    for k in range(data.ncon):
        bodies = [int(model.geom_bodyid[g]) for g in data.contact[k].geom]
        if data.contact[k].dist < 0.0 and all(b in owner for b in bodies):
            found.add(frozenset(owner[b] for b in bodies))
    return found


def _may_touch(model: Any, tree: Tree, a: int, b: int) -> bool:
    """Whether MuJoCo looks for contacts of two geometries (Computation: Collision detection: Selection)."""
    met = (model.geom_contype[a] & model.geom_conaffinity[b]) | (model.geom_contype[b] & model.geom_conaffinity[a])
    one, two = (int(model.geom_bodyid[g]) for g in (a, b))
    for k in range(model.npair):
        if {int(model.pair_geom1[k]), int(model.pair_geom2[k])} == {a, b}:
            return True
    low, high = sorted((one, two))
    if not met or np.any(model.exclude_signature == (low << 16) + high):
        return False
    roots = tree.root(one), tree.root(two)
    # What hangs on what: also from the base that stands still, as a joint's ends never touch here.
    tied = any(tree.parent(x) == y for x, y in (roots, roots[::-1]) if x)
    return not tied
