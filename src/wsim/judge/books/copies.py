"""The books of worlds that differ in numbers alone, worked out at once and kept with the evidence of each."""

from __future__ import annotations

from typing import TYPE_CHECKING, cast

import numpy as np

from wsim.judge.books.balance import Balance, Books
from wsim.judge.books.creep import Lacking, creeps
from wsim.judge.books.gliding import gliding
from wsim.judge.books.standing import standing
from wsim.judge.books.touching import Touching
from wsim.judge.evidence.alike import alike

if TYPE_CHECKING:
    from collections.abc import Sequence

    from wsim.judge.evidence.evidence import Evidence
    from wsim.scene.world import World

SAME = ("gravity", "stepped", "cone", "give", "fluids", "combine", "apart")


def told(evidence: Evidence) -> bool:
    """Whether a recording has what the books are about: bodies, and what fluid and control gave."""
    recording, world = evidence.recording, evidence.world
    if len(evidence.time) < 2 or not world.bodies:
        return False
    return recording.applied_impulse is not None or not (world.fluids or recording.metadata.get("controlled"))


def similar(one: Evidence, other: Evidence) -> bool:
    """Whether the books of both can be worked out at once: their worlds differ in sizes, places and coefficients."""
    if one.world is other.world:
        return True
    (a, b), (here, there) = (one.world, other.world), (one.motion, other.motion)
    if not all(getattr(a, name) == getattr(b, name) for name in SAME) or _ties(a) != _ties(b):
        return False
    if not all(np.array_equal(getattr(here, name), getattr(there, name)) for name in ("kinematic", "unit", "jointed")):
        return False
    return alike(a, b) or Touching.of(one).like(Touching.of(other))


def _ties(world: World) -> list[object]:
    """What ties which bodies, and how many springs and ropes there are."""
    joints = [(joint.kind, joint.parent, joint.child, joint.may_break) for joint in world.joints]
    return [joints, len(world.gears), len(world.springs), len(world.ropes)]


def work_out(copies: Sequence[Evidence]) -> None:
    """Keep with each copy what its checks will ask for. They are of similar worlds, over the same times."""
    if not copies or not told(copies[0]):
        return
    for evidence in copies[1:]:
        if alike(copies[0].world, evidence.world):
            evidence.kept[Touching] = Touching.of(copies[0])
    for evidence, books in zip(copies, Balance(*copies).every(), strict=True):
        evidence.kept[Books] = books
    for evidence, lacking in zip(copies, _lacking(copies), strict=True):
        evidence.kept[Lacking] = lacking


def lasting(evidence: Evidence) -> list[Lacking]:
    """What bodies lack to creep, to stand or to go on as they do."""
    if Lacking not in evidence.kept:
        evidence.kept[Lacking] = _lacking([evidence])[0]
    return cast("list[Lacking]", evidence.kept[Lacking])


def _lacking(copies: Sequence[Evidence]) -> list[list[Lacking]]:
    """Of each copy."""
    kinds = creeps(copies), standing(copies), gliding(copies)
    return [[each for part in parts for each in part] for parts in zip(*kinds, strict=True)]
