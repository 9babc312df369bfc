"""The books of the copies of a world, worked out at once and kept with the evidence of each."""

from __future__ import annotations

from typing import TYPE_CHECKING, cast

from wsim.judge.books.balance import Balance, Books
from wsim.judge.books.creep import Lacking, creeps
from wsim.judge.books.standing import standing
from wsim.judge.books.touching import Touching

if TYPE_CHECKING:
    from collections.abc import Sequence

    from wsim.judge.evidence.evidence import Evidence


def told(evidence: Evidence) -> bool:
    """Whether a recording has what the books are about: bodies, and what fluid and control gave."""
    recording, world = evidence.recording, evidence.world
    if len(evidence.time) < 2 or not world.bodies:
        return False
    return recording.applied_impulse is not None or not (world.fluids or recording.metadata.get("controlled"))


def work_out(copies: Sequence[Evidence]) -> None:
    """Keep with each copy what its checks will ask for. They are one world's, over the same times."""
    if not copies or not told(copies[0]):
        return
    touching = Touching.of(copies[0])
    for evidence, books in zip(copies, Balance(*copies).every(), strict=True):
        evidence.kept |= {Touching: touching, Books: books}
    for evidence, lacking in zip(copies, standing(copies), strict=True):
        evidence.kept[Lacking] = creeps(evidence) + lacking


def lasting(evidence: Evidence) -> list[Lacking]:
    """What bodies lack to creep, or to stand, as they do."""
    if Lacking not in evidence.kept:
        evidence.kept[Lacking] = creeps(evidence) + standing([evidence])[0]
    return cast("list[Lacking]", evidence.kept[Lacking])
