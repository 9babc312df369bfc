"""What taps and drains do to an SPH fluid, step by step."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import warp as wp

from wsim.kernels.sph import openings as kernels
from wsim.kernels.sph.grid import PARKED
from wsim.kernels.sph.pipes import keep_out_of_pipes, press_walls
from wsim.solvers.sph_config import ConfigSPH
from wsim.solvers.sph_mouths import Drain, Tap, beside, in_pipe, layer_of, layers_of, local, placed, places_of
from wsim.solvers.sph_opening_arrays import drains_of, taps_of
from wsim.solvers.sph_wall_impulse import WallImpulse

Array = np.ndarray
ROOM = 3.0  # supports beyond all that is known of a world: where parked particles are sorted to, nothing comes near


class Openings:
    """The taps and drains of all worlds.

    Args:
        model: The `newton.Model`; its particles that are not `ParticleFlags.ACTIVE` wait to be poured, those of a world
            with the same mass. Those that fill pipes at the start are put there, so make states afterwards.
        config: Settings of the method.
        world: Of each particle, in order, (n,).
        rest_density: Of each world [kg/m^3], (W,).
        taps: Of all worlds.
        drains: Of all worlds.

    Attributes:
        stage: Of each particle (`wsim.kernels.sph.openings`), (n,).
        pipes: Whether any tap has one.

    Raises:
        ValueError: If the fluid is in a plane, or fewer particles wait than pipes hold.
    """

    def __init__(
        self,
        model: Any,
        config: ConfigSPH,
        world: Array,
        rest_density: Array,
        taps: Sequence[Tap],
        drains: Sequence[Drain],
    ) -> None:
        if config.dimensions != 3 or all(config.periodic):
            raise ValueError("SolverSPH: taps and drains are for flows in space that some axis leaves open")
        self._model, self._config, self._world_count = model, config, len(rest_density)
        each = range(self._world_count)
        self._own_taps = [(w, tap) for w in each for tap in taps if tap.world in (-1, w)]
        self._own_drains = [(w, drain) for w in each for drain in drains if drain.world in (-1, w)]
        self._own: list[tuple[int, Tap | Drain]] = [*self._own_taps, *self._own_drains]
        first = np.append(0, np.cumsum(np.bincount(world, minlength=self._world_count)))
        self._world_first = wp.array(first, dtype=int)
        self._mass = self._masses(world)
        self._volume = self._mass / rest_density
        self.pipes = any(not tap.speed for _, tap in self._own_taps)
        self.taps = taps_of(self._own_taps, config, self._volume, self._mass)
        self.drains = drains_of(self._own_drains, config, self._world_count)
        self.tally: Any = kernels.Tally()
        for name in ("released", "drained", "missing"):
            setattr(self.tally, name, wp.zeros(self._world_count, dtype=int))
        self.tally.drained_mass = wp.zeros(self._world_count, dtype=wp.int64)
        self.tally.unit = wp.array(self._mass, dtype=wp.float64)
        self.stage = wp.array(self._fill_pipes(world), dtype=int)
        self._start = wp.clone(self.stage), wp.clone(model.particle_flags), wp.clone(model.particle_mass)
        self._allocate(len(world), first.tolist())

    def _allocate(self, count: int, first: list[int]) -> None:
        places = len(self.taps.tap)
        self._clock, self._poured, self._travel, self._before = (
            wp.zeros(len(self._own_taps), dtype=wp.float64) for _ in range(4)
        )
        self._due, self._rank = wp.zeros(places + 1, dtype=int), wp.zeros(places + 1, dtype=int)
        self._parked, self._parked_rank = wp.zeros(count + 1, dtype=int), wp.zeros(count + 1, dtype=int)
        self._listed = wp.zeros(places, dtype=int)
        self._parking = wp.vec3(0.0, 0.0, 0.0)
        self._given, self._impulse = wp.zeros(count, dtype=wp.vec3), WallImpulse(first)

    # ---- what is where
    def _masses(self, world: Array) -> Array:
        """Of what waits in each world, or else of its first particle [kg], (W,)."""
        mass = self._model.particle_mass.numpy().astype(np.float64)
        waits = (self._model.particle_flags.numpy() & int(kernels.ACTIVE)) == 0
        return np.array([_first_of(mass, world == w, waits) for w in range(self._world_count)])

    def _fill_pipes(self, world: Array) -> Array:
        """Stages (n,) at the start; puts the particles that fill pipes there."""
        model, config = self._model, self._config
        parked = (model.particle_flags.numpy() & int(kernels.ACTIVE)) == 0
        stage = np.where(parked, int(PARKED), int(kernels.FREE)).astype(np.int32)
        q, qd, first = model.particle_q.numpy(), model.particle_qd.numpy(), 0
        qd[parked] = 0.0
        free = [np.flatnonzero(parked & (world == w)).tolist() for w in range(self._world_count)]
        for w, tap in self._own_taps:
            place = places_of(tap, config.spacing)[0]
            layers = layers_of(tap, config, self._volume[w])
            layer = layer_of(tap, config.spacing, self._volume[w])
            if len(free[w]) < layers * len(place):
                raise ValueError(
                    f"SolverSPH: a tap of world {w} needs {layers * len(place)} particles to fill its pipe and "
                    f"{len(free[w])} wait; add particles that are not ParticleFlags.ACTIVE"
                )
            for k in range(layers):
                own, free[w] = free[w][: len(place)], free[w][len(place) :]
                q[own] = placed(tap, np.column_stack([place, np.full(len(place), -(k + 0.5) * layer)]))
                stage[own] = 1 + first + np.arange(len(place))
            first += len(place)
        model.particle_q.assign(q)
        model.particle_qd.assign(qd)
        return stage

    def known(self, position: Array, world: Array) -> tuple[Array, Array]:
        """Places that water is at or comes to, (k, 3) [m], and their worlds (k,).

        Args:
            position: Of all particles (n, 3), those that are parked too.
            world: Of each.
        """
        there = self.stage.numpy() != int(PARKED)
        spots = [(opening.position, w) for w, opening in self._own]
        place = np.concatenate([position[there], np.array([at for at, _ in spots], dtype=position.dtype)])
        return place, np.append(world[there], [w for _, w in spots]).astype(world.dtype)

    def outside(self, walls: Array, world: Array) -> Array:
        """Which walls' particles, (n, 3) [m] of worlds (n,), are not where water comes or goes: in pipes and holes."""
        keep = np.ones(len(walls), dtype=bool)
        hole = self._config.support + 2.0 * self._config.spacing
        for w, opening in self._own:
            if isinstance(opening, Tap):
                inside = in_pipe(opening, self._config, self._volume[w], walls)
            else:
                own = local(opening, walls)
                inside = beside(opening, own) & (own[:, 2] > 0.0) & (own[:, 2] < hole)
            keep &= ~(inside & (world == w))
        return keep

    def park_below(self, low: Array) -> None:
        """Park particles beyond all others, given the domain's lower corner [m]."""
        self._parking = wp.vec3(*(np.asarray(low) - 2.0 * ROOM * self._config.support).tolist())
        q = self._model.particle_q.numpy()
        q[self.stage.numpy() == int(PARKED)] = np.array(self._parking)
        self._model.particle_q.assign(q)

    # ---- what has come and gone
    def free(self) -> Array:
        """Which particles are in their world, outside of pipes, (n,)."""
        there: Array = self.stage.numpy() == int(kernels.FREE)
        return there

    def come(self) -> Array:
        """Mass that taps have let out so far, (W,) [kg]."""
        come: Array = self.tally.released.numpy() * self._mass
        return come

    def gone(self) -> Array:
        """Mass that drains have taken so far, (W,) [kg]."""
        gone: Array = self.tally.drained_mass.numpy() / float(kernels.SHARES) * self._mass
        return gone

    def take_impulse(self) -> Array:
        """Impulse that openings gave to each world's free water since the last call, (W, 3) [N s]."""
        return self._impulse.take()

    # ---- a run
    def restart(self) -> None:
        """Back to the start: what waits, waits again."""
        for array, start in zip(
            (self.stage, self._model.particle_flags, self._model.particle_mass), self._start, strict=True
        ):
            wp.copy(array, start)
        for array in (self._clock, self._poured, self.tally.released, self.tally.drained, self.tally.missing):
            array.zero_()
        self.tally.drained_mass.zero_()
        self.take_impulse()

    def take_in(self, particle_world: wp.array, position: wp.array) -> None:
        """Let what has come through a drain's face leave, before faces of walls put it back."""
        if self._own_drains:
            wp.launch(
                kernels.take_in,
                dim=len(position),
                inputs=[particle_world, self._model.particle_mass, position, self.drains],
                outputs=[self.stage, self.tally],
            )

    def press_walls(self, method: Any, walls: Any, dt: float) -> None:
        """Count layers that begin in pipes into what sorted walls give back; arguments as of `lead`."""
        if self.pipes and walls.count:
            wp.launch(
                press_walls,
                dim=walls.count,
                inputs=[method, self.taps, self._travel, dt, walls.species],
                outputs=[walls.motion],
            )

    def lead(self, method: Any, fluid: Any, state: Any, on_walls: wp.array, dt: float) -> None:
        """Move what is in pipes, keep other water out of them, and pour what is due.

        Args:
            method: `wsim.kernels.sph.density.Method`.
            fluid: The sorted particles, as they were when the step began.
            state: Gets positions, velocities and pressures at its end.
            on_walls: Forces on walls by particle [N]; water in pipes gives none.
            dt: Length of the step [s].
        """
        model, moved = self._model, [state.particle_q, state.particle_qd, state.sph.pressure]
        if self._own_taps:
            wp.launch(
                kernels.run_taps,
                dim=len(self._own_taps),
                inputs=[self.taps, wp.float64(dt)],
                outputs=[self._clock, self._poured, self._travel, self._before],
            )
        wp.launch(
            kernels.lead_water,
            dim=fluid.count,
            inputs=[
                fluid.species, model.gravity, model.particle_mass, self._parking, self.taps, self._travel, self.drains,
                dt,
            ],
            outputs=[self.stage, model.particle_flags, self.tally, *moved, on_walls, self._given],
        )  # fmt: skip
        if self.pipes:
            wp.launch(
                keep_out_of_pipes,
                dim=fluid.count,
                inputs=[fluid.world, model.particle_mass, self.stage, method, self.taps, self._travel, dt],
                outputs=[*moved, self._given],
            )
        if self._own_taps:
            self._pour(fluid, moved, dt)
        self._impulse.add(self._given, dt)

    def _pour(self, fluid: Any, moved: list[wp.array], dt: float) -> None:
        model, places = self._model, len(self._listed)
        wp.launch(kernels.find_due, dim=places, inputs=[self.taps, self._poured, self._before], outputs=[self._due])
        wp.launch(kernels.find_parked, dim=fluid.count, inputs=[self.stage], outputs=[self._parked])
        wp.utils.array_scan(self._due, self._rank, inclusive=False)
        wp.utils.array_scan(self._parked, self._parked_rank, inclusive=False)
        wp.launch(kernels.list_due, dim=places, inputs=[self.taps, self._due, self._rank], outputs=[self._listed])
        wp.launch(
            kernels.find_missing,
            dim=self._world_count,
            inputs=[self.taps, self._world_first, self._rank, self._parked_rank],
            outputs=[self.tally.missing],
        )
        wp.launch(
            kernels.release,
            dim=fluid.count,
            inputs=[
                self.taps, self._poured, self._travel, fluid.world, self._world_first, self._listed, self._rank,
                self._parked, self._parked_rank, dt,
            ],
            outputs=[self.stage, model.particle_flags, self.tally, model.particle_mass, *moved, self._given],
        )  # fmt: skip


def _first_of(mass: Array, own: Array, waits: Array) -> float:
    """Mass of the first of a world's that waits, or of its first one, or 0 where it has none."""
    for wanted in (own & waits, own):
        if wanted.any():
            return float(mass[np.argmax(wanted)])
    return 0.0
