"""Candidates of one topology, simulated as one batch of worlds and judged from its arrays."""

from __future__ import annotations

import contextlib
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeVar

from pydantic import ValidationError

from wsim.forks import shared_out, uncollected
from wsim.judge.worlds import Take, take_verdicts
from wsim.memory import free_memory
from wsim.runs.simulation import is_controlled, open_controller
from wsim.scene.reading import Reading, read
from wsim.scene.usd_threads import forks
from wsim.sim import Simulation
from wsim.sim.alike import together, topology
from wsim.sim.collect import follow
from wsim.sweep.screen import rejected
from wsim.sweep.turns import turn

if TYPE_CHECKING:
    from pathlib import Path

    from wsim.plan.schema import Plan
    from wsim.runs.iteration import Iteration
    from wsim.scene.world import World
    from wsim.sim.tracks import Tracks
    from wsim.sweep.candidate import Candidate

Value = TypeVar("Value")

BYTES_OF_A_PARTICLE = 28  # seven numbers in single precision
A_CALL = 32  # stages that a helper is asked about at once: sending one and its answer takes longer than reading it
NO_ROOM = ("out of memory", "failed to allocate", "memory allocation")


@dataclass(frozen=True)
class Member:
    """A candidate whose stage is built, and what that states."""

    candidate: Candidate
    iteration: Iteration
    world: World
    topology: str  # as `wsim.sim.alike` tells it
    skeleton: str  # as `wsim.scene.skeleton` does


def batches(built: Sequence[tuple[Candidate, Iteration, bytes]], most: int, processes: int = 1) -> list[list[Member]]:
    """Those that can be simulated together, at most so many at a time; who must go alone is in none.

    A program with a `control` goes with its own kind: that may be another for each program, and knows no parameters. Of
    worlds with fluid there are no more to a batch than fit, with all that their particles do, into half of the memory
    that is free.

    Args:
        built: Candidates that have a stage, each with what is told of that (`BuildResult.told`), if anything is.
        most: Worlds of a batch.
        processes: That stages are read in, side by side.
    """
    given = [(iteration.stage, told) for _, iteration, told in built]
    with uncollected():
        some = [given[first : first + A_CALL] for first in range(0, len(given), A_CALL)]
        said = [each for found in shared_out(_all_described, some, forks(processes)) for each in found]
    members = [
        Member(candidate, iteration, *of) for (candidate, iteration, _), of in zip(built, said, strict=True) if of
    ]
    moving = [member for member in members if member.world.fluids or member.world.bodies]
    found, room = [], free_memory() / 2
    for kind in _by_control(moving):
        for group in together([member.topology for member in kind]):
            own = [kind[k] for k in group]
            size = max(1, min(most, int(room / max(1, *(bytes_of_particles(member.world) for member in own)))))
            found += [own[first : first + size] for first in range(0, len(own), size)]
    return [batch for batch in found if len(batch) > 1]


def _all_described(given: Sequence[tuple[Path, bytes]]) -> list[tuple[World, str, str] | None]:
    return [_described(each) for each in given]


def _described(given: tuple[Path, bytes]) -> tuple[World, str, str] | None:
    """A world, its topology and its skeleton, from what is told or, where that is nothing, from the stage.

    None of a stage that cannot be described: alone it says why.
    """
    stage, told = given
    found = None
    with contextlib.suppress(ValidationError):  # the sandbox's word
        found = Reading.model_validate_json(told) if told else None
    try:
        found = found or read(stage)
    except Exception:  # noqa: BLE001 - it is told where it goes alone, and the others of the shard go on
        return None
    return found.world, topology(found.world), found.skeleton


def _by_control(members: Sequence[Member]) -> list[list[Member]]:
    """Those that nothing controls, and those of each program that has a `control`."""
    controlled = {program: is_controlled(program) for program in {member.iteration.program for member in members}}
    kinds: dict[Path | None, list[Member]] = {}
    for member in members:
        kinds.setdefault(member.iteration.program if controlled[member.iteration.program] else None, []).append(member)
    return list(kinds.values())


def bytes_of_particles(world: World) -> float:
    """What the places, velocities and densities of a world's fluids take through all of its frames."""
    count = sum(fluid.amount / fluid.spacing**3 for fluid in world.fluids)
    return count * (world.duration * world.frame_rate + 1.0) * BYTES_OF_A_PARTICLE


def run(batch: Sequence[Member], plan: Plan | None, take: Take[Value], processes: int = 1) -> list[tuple[Value, str]]:
    """What is made of each member's verdict, and what is to be said of how it was set up.

    What does not fit into memory goes in halves.

    Args:
        batch: One of `batches`.
        plan: What its worlds are held against.
        take: Called with a verdict and its candidate, by the process that judges; a function of a module.
        processes: That it is set up and judged in; it is simulated in this one.

    Raises:
        UserError, ValueError, RuntimeError: If a member cannot be simulated with the others.
    """
    settings = batch[0].iteration.settings
    try:
        with open_controller(batch[0].iteration.program, batch[0].world, settings, len(batch)) as controller:
            simulation = Simulation(
                [member.iteration.stage for member in batch],
                device=settings.device,
                time_step=settings.time_step,
                controller=controller,
                seeds=[member.candidate.seed for member in batch],
                worlds=[member.world for member in batch],
                skeletons=[member.skeleton for member in batch],
                processes=processes,
            )
            with turn():
                tracks = follow(simulation)
    except (MemoryError, RuntimeError) as error:
        if len(batch) < 2 or not _is_no_room(error):
            raise
        half = len(batch) // 2
        return run(batch[:half], plan, take, processes) + run(batch[half:], plan, take, processes)
    singly = simulation.built.singly
    note = f"stages were read one by one, which takes longer, as {singly}" if singly else ""
    candidates = [member.candidate for member in batch]
    return [(taken, note) for taken in judged(tracks, plan, take, candidates, processes)]


def judged(
    tracks: Tracks, plan: Plan | None, take: Take[Value], given: Sequence[object], processes: int = 1
) -> list[Value]:
    """What is made of the verdict on each world: where an objective is known to fail on that alone, else on all."""
    found = {w: take(verdict, given[w]) for w, verdict in rejected(tracks, plan).items()}
    left = [w for w in range(tracks.count) if w not in found]
    if left:
        full = take_verdicts(tracks.read(left), plan, take, [given[w] for w in left], processes)
        found |= dict(zip(left, full, strict=True))
    return [found[w] for w in range(tracks.count)]


def _is_no_room(error: Exception) -> bool:
    return isinstance(error, MemoryError) or any(text in str(error).lower() for text in NO_ROOM)
