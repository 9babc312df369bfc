"""The same world, set up again by another hand: what a seed changes in a simulation."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import newton
import numpy as np

from wsim.sim.model import Built
from wsim.sim.time_step import thickness

PLACE = 1e-4  # of a body's thinnest extent: nobody sets things down as exactly
TURN = 1e-4  # [rad], of a hinge
LATTICE = 1e-2  # of the particle spacing: a lattice without it keeps symmetries that no fluid has


def perturb(built: Built, state: Any, seeds: Sequence[int]) -> None:
    """Move what each world starts from by amounts that no outcome may hang on.

    Loose bodies are moved by up to `PLACE` of their thinnest extent, sideways and up (never into what carries them);
    hinges are turned by up to `TURN`, sliders moved by up to `PLACE`; particles leave their lattice by up to `LATTICE`
    of the spacing. Numbers are uniform, from NumPy's PCG64 of the seed.

    Args:
        built: The model and its world.
        state: Its `joint_q` and `particle_q` are changed; the bodies follow with `newton.eval_fk`.
        seeds: One for each world; 0 leaves a world as the stage states it.
    """
    if not any(seeds):
        return
    _perturb_joints(built, state, seeds)
    if built.sph is not None:
        position = state.particle_q.numpy()
        for fluids, seed in zip(built.fluids, seeds, strict=True):
            if seed:
                particles = position[min(part.start for part in fluids.values()) : max(p.stop for p in fluids.values())]
                noise = np.random.default_rng([seed, 1]).uniform(-1.0, 1.0, particles.shape)
                particles += (LATTICE * built.sph.spacing * noise).astype(np.float32)
        state.particle_q.assign(position)


def _perturb_joints(built: Built, state: Any, seeds: Sequence[int]) -> None:
    model = built.model
    if model.joint_count == 0:
        return
    coordinates = state.joint_q.numpy()
    kinds, starts, children = (a.numpy() for a in (model.joint_type, model.joint_q_start, model.joint_child))
    per_world, bodies = model.joint_count // len(seeds), model.body_count // len(seeds)
    for w, seed in enumerate(seeds):
        world = built.worlds[w % len(built.worlds)]
        size = {int(index): thickness(body) for index, body in zip(built.bodies, world.bodies, strict=True)}
        draw = np.random.default_rng([seed, 0])
        for joint in range(w * per_world, (w + 1) * per_world) if seed else ():
            first, place = starts[joint], PLACE * size.get(int(children[joint]) - w * bodies, 0.0)
            if kinds[joint] == int(newton.JointType.FREE):
                coordinates[first : first + 3] += place * draw.uniform((-1.0, -1.0, 0.0), 1.0)
            elif kinds[joint] == int(newton.JointType.REVOLUTE):
                coordinates[first] += TURN * draw.uniform(-1.0, 1.0)
            elif kinds[joint] == int(newton.JointType.PRISMATIC):
                coordinates[first] += place * draw.uniform(-1.0, 1.0)
    state.joint_q.assign(coordinates)
