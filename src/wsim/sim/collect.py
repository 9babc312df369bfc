"""All worlds of a simulation, stepped and kept as arrays."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from wsim.progress import Progress, silent
from wsim.recording.trajectories import Trajectories
from wsim.sim.body_tracks import BodyTracks
from wsim.sim.fluid_tracks import FluidTracks
from wsim.sim.ledger_tracks import LedgerTracks

if TYPE_CHECKING:
    from wsim.sim.simulation import Simulation


def collect(simulation: Simulation, progress: Progress = silent) -> Trajectories:
    """Step every world through the stage's duration, and keep what the judge needs of each recorded frame.

    Args:
        simulation: At its start; left at its end.
        progress: Told after each frame.

    Returns:
        The bodies and fluids of all worlds. A world whose contact buffers overflow, whose state is not finite or whose
        fluid is beyond sense is told of in `problems`; the others are none the worse.
    """
    world, built, rigid = simulation.world, simulation.built, simulation.rigid
    frames = round(world.duration * world.frame_rate) + 1
    worlds, bodies = max(1, simulation.model.world_count), len(world.bodies)
    time = np.zeros(frames)
    scalars: dict[str, np.ndarray] = {}
    moved = BodyTracks(simulation, rigid, frames) if rigid else None
    wet = FluidTracks(simulation, simulation.fluid, time) if simulation.fluid else None
    # What drives alone give is worked out by their law.
    asked = simulation.fluid is not None or simulation.controlled
    pushed = LedgerTracks(built, rigid.ledger, frames) if rigid and rigid.ledger and asked else None
    for frame in range(frames):
        if frame:
            simulation.advance_frame()
        time[frame] = simulation.time
        if rigid and moved:
            moved.take(frame)
            for name, values in rigid.breakage().items():
                scalars.setdefault(name, np.zeros((worlds, frames)))[:, frame] = values
        if wet:
            wet.take(frame)
        if pushed:
            pushed.take(frame)
        progress("simulating", frame, frames - 1)
    q, qd, force, deepest = moved.read() if moved else _nothing(worlds, frames)
    mass = simulation.model.body_mass.numpy().reshape(worlds, -1)[:, built.bodies] if bodies else None
    problems = _problems(simulation, q, qd)
    return Trajectories(
        world=world,
        time=time,
        body_q=q,
        body_qd=qd,
        contact_force=force,
        penetration=deepest,
        mass=mass,
        scalars=scalars | (wet.scalars if wet else {}) | (pushed.scalars if pushed else {}),
        problems=[a + b for a, b in zip(problems, wet.problems, strict=True)] if wet else problems,
        metadata=simulation.facts(),
        worlds=built.worlds if len(built.worlds) > 1 else (),
        applied=({"wall_impulse": wet.wall_impulse} if wet else {}) | (pushed.applied if pushed else {}),
        fluids=wet.tracks if wet else (),
        own_metadata=[{"sph": simulation.method_of_fluid(w)} for w in range(worlds)] if wet else (),
    )


def _nothing(worlds: int, frames: int) -> tuple[np.ndarray, ...]:
    """The tracks of worlds without bodies."""
    of_bodies = (np.zeros((worlds, frames, 0, width), dtype=np.float32) for width in (7, 6, 3))
    return *of_bodies, np.zeros((worlds, frames))


def _problems(simulation: Simulation, q: np.ndarray, qd: np.ndarray) -> list[list[str]]:
    overflowed = simulation.rigid.overflowed() if simulation.rigid else np.zeros(len(q), dtype=bool)
    warned = simulation.rigid.problems() if simulation.rigid and simulation.rigid.on_c else []
    broken = ~(np.isfinite(q).all(axis=(1, 2, 3)) & np.isfinite(qd).all(axis=(1, 2, 3)))
    return [
        warned
        + (["contact buffers overflowed"] if full else [])
        + (["body_q or body_qd is not finite"] if not_finite else [])
        for full, not_finite in zip(overflowed, broken, strict=True)
    ]
