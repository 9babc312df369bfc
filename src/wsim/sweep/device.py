"""Which device a sweep takes where none is named: what each needs for so many candidates, by what was measured.

Where the figures come from:

- a core: `wsim.plan.cost`; and half a second a candidate, to build and to judge a ball that falls for 0.1 s.
- a GPU, in the README and docs/: a step of one world takes 0.6 ms, of five boxes one microsecond more a world
  (docs/rigid.md, "What batches cost"), of a fluid as long as its particles at 1,100 million a second (docs/sph.md,
  "Speed"). Half of a tank's particles are walls, as in the demo.
- starting it: a stack of four blocks and a ball took 79 s with a GPU and 34 s without, as kernels are compiled.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from wsim.plan.cost import BODY_STEP, PARTICLE_STEPS
from wsim.sim.devices import cuda_devices
from wsim.sim.fluids import largest_step, sph_config
from wsim.sim.time_step import choose_time_step

if TYPE_CHECKING:
    from wsim.scene.world import World
    from wsim.sweep.spec import Spec

ALONE = 0.5  # of a core, for a candidate beside its steps [s]
START = 45.0  # of a GPU [s]
GPU_STEP = 0.6e-3  # of one world [s]
GPU_WORLD_STEP = 1.0e-6  # of five bodies in a batch [s]
GPU_PARTICLE_STEPS = 1.1e9  # [1/s]
FIVE = 5.0  # bodies, to which the times of a step belong


def pick_device(spec: Spec, world: World, cores: int) -> tuple[str, str]:
    """The device of a sweep that names none, and why, in a line; nothing where there is no choice.

    Args:
        spec: The sweep's.
        world: Of its first program, as it stands.
        cores: Of the CPU.
    """
    cuda = cuda_devices()
    if not cuda:
        return "cpu", ""
    on_gpu = spec.model_copy(update={"device": cuda[0]})
    return choose(cuda[0], world, spec.count, on_gpu.together, cores, spec.time_step)


def choose(
    cuda: str, world: World, count: int, together: int, cores: int, time_step: float | None = None
) -> tuple[str, str]:
    """The device on which so many candidates are done sooner, and why, in a line.

    Args:
        cuda: The GPU.
        world: A candidate as the program states it.
        count: Candidates.
        together: Worlds that the GPU simulates at once.
        cores: Of the CPU, each of which takes one candidate after another.
        time_step: Upper bound of the step [s].
    """
    particles = 2.0 * sum(fluid.amount / fluid.spacing**3 for fluid in world.fluids)
    fives, steps = max(1.0, len(world.bodies) / FIVE), _steps(world, time_step)
    one = ALONE + steps * (particles / PARTICLE_STEPS + BODY_STEP * fives)
    on_cpu = math.ceil(count / cores) * one
    batches = math.ceil(count / together)
    worlds = count * (particles / GPU_PARTICLE_STEPS + GPU_WORLD_STEP * fives)
    on_gpu = START + count * ALONE / cores + steps * (batches * GPU_STEP + worlds)
    name, best, other = (cuda, on_gpu, on_cpu) if on_gpu < on_cpu else ("cpu", on_cpu, on_gpu)
    there = f"{cores} CPU cores" if name == cuda else cuda
    return name, f"{name}: {count:,} candidates take about {best:,.0f} s there, {other:,.0f} s on {there}"


def _steps(world: World, time_step: float | None) -> float:
    config = sph_config([world])
    limit = largest_step(world, config) if config else None
    return world.duration / choose_time_step(world, limit, time_step or world.time_step or None).dt
