"""Trains of gears: by which ratio two joints are coupled, over others or not."""

from __future__ import annotations

import math
from collections.abc import Iterable

from pxr import Usd

from wsim.scene import schema

Mesh = tuple[str, str, float]  # two joints, and how far the second goes for the first
SAME = 1e-6  # of a ratio: it may be rounded by that


def meshes_of(stage: Usd.Stage) -> list[Mesh]:
    """The gears of a stage that name two joints."""
    found = []
    for prim in stage.Traverse():
        if schema.has(prim, schema.GEAR):
            ends = [prim.GetRelationship(key).GetTargets() for key in ("wsim:joint0", "wsim:joint1")]
            ratio = prim.GetAttribute("wsim:ratio").Get()
            if all(ends):
                found.append((str(ends[0][0]), str(ends[1][0]), 1.0 if ratio is None else float(ratio)))
    return found


def geared_by(meshes: Iterable[Mesh], first: str, second: str) -> float | None:
    """How far `second` goes for `first` over gears, or None where none couple them."""
    near: dict[str, list[tuple[str, float]]] = {}
    for one, other, ratio in meshes:
        if ratio != 0.0:
            near.setdefault(one, []).append((other, ratio))
            near.setdefault(other, []).append((one, 1.0 / ratio))
    reached, todo = {first: 1.0}, [first]
    while todo:
        at = todo.pop()
        for joint, ratio in near.get(at, ()):
            if joint not in reached:
                reached[joint] = reached[at] * ratio
                todo.append(joint)
    return reached.get(second)


def contradicts(meshes: Iterable[Mesh], mesh: Mesh) -> float | None:
    """The ratio that gears give already, where a further one has another, or None."""
    there = geared_by(meshes, mesh[0], mesh[1])
    return None if there is None or math.isclose(there, mesh[2], rel_tol=SAME) else there
