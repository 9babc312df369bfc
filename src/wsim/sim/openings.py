"""Taps and drains of a world → those of the fluid's solver, and the particles that wait for them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from newton import ParticleFlags

from wsim.errors import UserError
from wsim.limits import MAX_COUNT
from wsim.scene.world import Fluid, World
from wsim.scene.world_openings import Opening
from wsim.solvers.sph_config import ConfigSPH
from wsim.solvers.sph_mouths import Drain, Tap, pool_for

Array = np.ndarray


def taps_of(world: World, k: int = -1) -> list[Tap]:
    """Of world k, or of all."""
    found = []
    for tap in world.taps:
        keys = [(tap.start, tap.rate)] if tap.start > 0.0 else []
        keys += [(tap.stop, 0.0)] if tap.stop is not None else []
        at_once = 0.0 if tap.start > 0.0 else tap.rate
        times, rates = tuple(time for time, _ in keys), tuple(rate for _, rate in keys)
        found.append(
            Tap(**_mouth(tap), rate=at_once, times=times, rates=rates, speed=tap.drop_speed, world=k)
        )  # fmt: skip
    return found


def drains_of(world: World, k: int = -1) -> list[Drain]:
    """Of world k, or of all."""
    return [Drain(**_mouth(drain), falls=drain.falls, world=k) for drain in world.drains]


def _mouth(opening: Opening) -> dict[str, Any]:
    return {name: getattr(opening, name) for name in ("position", "direction", "radius", "size")}


def waiting(fluid: Fluid, world: World, config: ConfigSPH, volume: float) -> int:
    """Particles of a volume [m^3] each that wait for the taps of a fluid at the start.

    Raises:
        UserError: If they are more than can be simulated.
    """
    count = pool_for(taps_of(world), config, volume, world.duration) if world.taps else 0
    if count > MAX_COUNT:
        raise UserError(
            f"{world.taps[0].prim}: {count:.3g} particles in {world.duration:g} s, of {fluid.prim}, every "
            f"{fluid.spacing:g} m; at most {MAX_COUNT:.3g}: pour less, for less long, or coarser"
        )
    return count


def fastest_poured(world: World, gravity: float) -> float:
    """That fluid gets by leaving taps and falling from them to the lowest fluid, tank or drain [m/s]."""
    low = [f.center[2] - 0.5 * f.size[2] for f in world.fluids] + [d.position[2] for d in world.drains]
    falls = ((tap.speed, max(tap.position[2] - min(low), 0.0)) for tap in world.taps)
    return max((math.sqrt(speed**2 + 2.0 * gravity * fall) for speed, fall in falls), default=0.0)


def seen_particles(model: Any, state: Any) -> Array:
    """Positions of all particles, (n, 3) [m]: NaN where one waits, is in a pipe or has drained away."""
    place: Array = state.particle_q.numpy()
    hidden = (model.particle_flags.numpy() & int(ParticleFlags.ACTIVE)) == 0
    if hidden.any():
        place = np.where(hidden[:, None], np.float32(np.nan), place)
    return place


def opening_scalars(come: float, gone: float, held: float, impulse: Sequence[float]) -> dict[str, float]:
    """What a recording says of a world with taps or drains, by name [kg], [N s]."""
    told = {"fluid/mass_in": come, "fluid/mass_out": gone, "fluid/mass_held": held}
    return told | {f"fluid/opening_impulse_{axis}": float(x) for axis, x in zip("xyz", impulse, strict=True)}
