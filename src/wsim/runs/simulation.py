"""A stage's simulation, stepped with the program's own `control` where it has one."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from wsim import sim
from wsim.program.control import ControlLayout, ControlProcess, has_control
from wsim.progress import Progress, silent
from wsim.runs.settings import Settings
from wsim.scene.describe import describe
from wsim.scene.labels import labels_of
from wsim.scene.world_sensors import channels
from wsim.sim.control import ArrayController, driven_joints

if TYPE_CHECKING:
    from wsim.scene.world import World
    from wsim.sim import Simulation


@contextlib.contextmanager
def open_simulation(
    stage: Path, program: Path, settings: Settings, progress: Progress = silent, seeds: Sequence[int] = (0,)
) -> Iterator[Simulation]:
    """A simulation of a checked stage, a copy of it for each seed, with the program's own `control` if it has one."""
    world = describe(stage)
    with open_controller(program, world, settings, len(seeds)) as controller:
        yield sim.Simulation(
            stage,
            device=settings.device,
            world_count=len(seeds),
            time_step=settings.time_step,
            controller=controller,
            progress=progress,
            seeds=seeds,
            worlds=[world],
            draws=settings.pictures,
        )


def is_controlled(program: Path) -> bool:
    """Whether a program has a `control`."""
    return has_control(program.read_text(encoding="utf-8", errors="replace"))


@contextlib.contextmanager
def open_controller(
    program: Path, world: World, settings: Settings, world_count: int = 1
) -> Iterator[ArrayController | None]:
    """The program's `control`, if it has one, running in the sandbox; each world has it to itself."""
    if not is_controlled(program):
        yield None
        return
    bodies, joints = [body.prim for body in world.bodies], driven_joints(world)
    layout = ControlLayout(
        bodies, joints, world_count, apart=True, channels=channels(world.sensors), labels=labels_of(world)
    )
    with ControlProcess(program, layout, settings.limits(), settings.isolation) as process:
        yield ArrayController(process.step)
