"""What all worlds of a simulation do, kept while they are stepped; any of them are read when all is done."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from wsim.recording.trajectories import Trajectories
from wsim.sim.body_tracks import BodyTracks
from wsim.sim.fluid_method import method_of, solids_of
from wsim.sim.fluid_tracks import FluidTracks
from wsim.sim.ledger_tracks import LedgerTracks

if TYPE_CHECKING:
    from wsim.scene.world import World
    from wsim.sim.simulation import Simulation

Array = np.ndarray


class Tracks:
    """W worlds of B bodies over T frames. Bodies' are on the device, 64 bytes each; all else is on the host.

    Args:
        simulation: At its start.

    Attributes:
        time: (T,) [s], as far as it was taken.
        bodies: What they do; None where there are none.
    """

    def __init__(self, simulation: Simulation) -> None:
        world, rigid = simulation.world, simulation.rigid
        self.simulation = simulation
        self.time = np.zeros(round(world.duration * world.frame_rate) + 1)
        self.count = max(1, simulation.model.world_count)
        frames = len(self.time)
        self.bodies = BodyTracks(simulation, rigid, frames) if rigid else None
        self._scalars: dict[str, Array] = {}
        self._wet = FluidTracks(simulation, simulation.fluid, self.time) if simulation.fluid else None
        # What drives alone give is worked out by their law.
        asked = simulation.fluid is not None or simulation.controlled
        self._pushed = (
            LedgerTracks(simulation.built, rigid.ledger, frames) if rigid and rigid.ledger and asked else None
        )

    def take(self, frame: int) -> None:
        """Keep the present state as a frame."""
        self.time[frame] = self.simulation.time
        if self.bodies:
            self.bodies.take(frame)
        for name, values in (
            (self.simulation.rigid.breakage() | self.simulation.rigid.began()).items() if self.simulation.rigid else ()
        ):
            self._scalars.setdefault(name, np.zeros((self.count, len(self.time))))[:, frame] = values
        for tracks in (self._wet, self._pushed):
            if tracks:
                tracks.take(frame)

    def read(self, worlds: Sequence[int] | None = None) -> Trajectories:
        """What some worlds did, or all: what the judge asks for.

        A world whose contact buffers overflow, whose state is not finite or whose fluid is beyond sense is told of in
        `problems`; the others are none the worse.
        """
        chosen = list(range(self.count)) if worlds is None else list(worlds)
        simulation, wet, pushed = self.simulation, self._wet, self._pushed
        fluid = simulation.fluid
        q, qd, force, deepest = self.bodies.read(chosen) if self.bodies else self._none(len(chosen))
        mass = self._masses()
        scalars = self._scalars | (wet.scalars if wet else {}) | (pushed.scalars if pushed else {})
        applied = ({"wall_impulse": wet.wall_impulse} if wet else {}) | (pushed.applied if pushed else {})
        return Trajectories(
            world=simulation.world,
            time=self.time,
            body_q=q,
            body_qd=qd,
            contact_force=force,
            penetration=deepest,
            mass=None if mass is None else mass[chosen],
            scalars={name: values[chosen] for name, values in scalars.items()},
            problems=self._problems(chosen, q, qd),
            metadata=simulation.facts(),
            worlds=self._worlds(chosen),
            applied={name: values[chosen] for name, values in applied.items()},
            fluids=[wet.tracks[w] for w in chosen] if wet else (),
            solids=[solids_of(simulation.built, fluid, w) for w in chosen] if fluid else (),
            own_metadata=[{"sph": method_of(simulation.built, fluid, w)} for w in chosen] if fluid else (),
        )

    def read_starts(self) -> Trajectories:
        """The bodies of all worlds at their first frame alone."""
        q, qd, force = self.bodies.read_first() if self.bodies else self._none(self.count)[:3]
        starts = q[:, :1], qd[:, :1], force[:, :1]
        return Trajectories(
            self.simulation.world, self.time[:1], *starts, mass=self._masses(), worlds=self._worlds(range(self.count))
        )

    def _masses(self) -> Array | None:
        """Of all bodies, (W, B) [kg]."""
        if not self.simulation.world.bodies:
            return None
        mass: Array = self.simulation.model.body_mass.numpy().reshape(self.count, -1)[:, self.simulation.built.bodies]
        return mass

    def _worlds(self, chosen: Sequence[int]) -> list[World]:
        """What each of some states; none where all state the same."""
        stated = self.simulation.built.worlds
        return [stated[w] for w in chosen] if len(stated) > 1 else []

    def _none(self, worlds: int) -> tuple[Array, ...]:
        """The tracks of no bodies."""
        shape = worlds, len(self.time)
        return *(np.zeros((*shape, 0, width), dtype=np.float32) for width in (7, 6, 3)), np.zeros(shape)

    def _problems(self, chosen: list[int], q: Array, qd: Array) -> list[list[str]]:
        rigid = self.simulation.rigid
        overflowed = rigid.overflowed()[chosen] if rigid else np.zeros(len(chosen), dtype=bool)
        warned = rigid.problems() if rigid and rigid.on_c else []
        broken = ~(np.isfinite(q).all(axis=(1, 2, 3)) & np.isfinite(qd).all(axis=(1, 2, 3)))
        wet = [self._wet.problems[w] if self._wet else [] for w in chosen]
        return [
            warned
            + (["contact buffers overflowed"] if full else [])
            + (["body_q or body_qd is not finite"] if not_finite else [])
            + in_fluid
            for full, not_finite, in_fluid in zip(overflowed, broken, wet, strict=True)
        ]
