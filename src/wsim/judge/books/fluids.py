"""The books of the fluids as a whole: what their momentum changes by, and what they say that they gave and got.

All particles together gain what gravity gives them, less what they gave to bodies and to what stands still. A
simulator that takes its own sums keeps them to rounding, so what is left tells a push on a body that no particle felt.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from wsim.judge.evidence.motion import FLOAT32

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsim.judge.evidence.evidence import Evidence
    from wsim.recording.recording import Recording
    from wsim.scene.world import Fluid

    Floats = NDArray[np.float64]


@dataclass(frozen=True)
class FluidBooks:
    """K intervals between frames that have particles."""

    time: Floats  # (K + 1,) [s]
    left: Floats  # (K, 3) impulse that is not accounted for [N s]
    turnover: Floats  # (K,) the sizes of all impulses that are in it [N s]
    rounding: Floats  # (K,) what single precision leaves of the momenta [N s]
    given: Floats  # (K, 3) what bodies got [N s]


def fluid_impulse(recording: Recording) -> Floats | None:
    """What the fluid gave to each body since the frame before, (T, B, 3) [N s]; None where it is not recorded."""
    if recording.applied_impulse is None:
        return None
    impulse: Floats = np.asarray(recording.applied_impulse, dtype=np.float64)
    if recording.scheduled is not None:
        impulse = impulse - recording.scheduled[..., :3]
    if recording.control_impulse is not None:
        return impulse - recording.control_impulse
    return None if recording.metadata.get("controlled") else impulse


def particle_mass(fluid: Fluid) -> float:
    """Of each of a fluid's particles, which stand for a cell of the lattice that fills it [kg]."""
    return fluid.density * fluid.cell


def fluid_books(evidence: Evidence) -> FluidBooks | None:
    """The books of all fluids together; None where a recording does not have what they take."""
    recording, fluids = evidence.recording, evidence.world.fluids
    if not fluids or recording.wall_impulse is None:
        return None
    tracks = [evidence.track(fluid) for fluid in fluids]
    frames = np.flatnonzero(np.isin(evidence.time, tracks[0].time))
    if len(frames) < 2 or any(not np.array_equal(track.time, evidence.time[frames]) for track in tracks):
        return None
    given = np.zeros((len(frames) - 1, 3))
    sizes = np.zeros(len(given))
    parts = [np.asarray(recording.wall_impulse, dtype=np.float64)]
    if evidence.world.bodies:
        impulse = fluid_impulse(recording)
        if impulse is None:
            return None
        parts += list(np.moveaxis(impulse, 1, 0))
    for n, part in enumerate(parts):
        gained = np.diff(np.cumsum(part, axis=0)[frames], axis=0)
        sizes += np.linalg.norm(gained, axis=1)
        given += gained if n else 0.0
    walls = np.diff(np.cumsum(parts[0], axis=0)[frames], axis=0)
    openings = _of_openings(evidence, frames)
    if openings is None:
        return None
    momentum, amount, mass = np.zeros((len(frames), 3)), np.zeros(len(frames)), np.zeros(len(frames))
    for fluid, track in zip(fluids, tracks, strict=True):
        own = particle_mass(fluid)
        velocity = track.velocity.astype(np.float64)
        momentum += own * np.nansum(velocity, axis=1)
        amount += own * np.nansum(np.abs(velocity), axis=(1, 2))
        mass += own * track.count
    h = np.diff(evidence.time[frames])
    weight = (mass[1:] + mass[:-1])[:, None] / 2.0 * evidence.motion.gravity * h[:, None]
    # When within an interval particles came or went is not told: how long gravity had them is not known better.
    between = (openings.moved + np.abs(np.diff(mass))) * evidence.gravity * h
    return FluidBooks(
        evidence.time[frames],
        np.diff(momentum, axis=0) - weight + given + walls - openings.impulse,
        sizes + np.linalg.norm(weight, axis=1) + np.linalg.norm(openings.impulse, axis=1),
        FLOAT32 * (amount[1:] + amount[:-1]) + between,
        given,
    )


@dataclass(frozen=True)
class _Opened:
    """What taps and drains did in K intervals."""

    impulse: Floats  # (K, 3) that they gave to the fluids [N s]
    moved: Floats  # (K,) mass that came and went [kg]


def _of_openings(evidence: Evidence, frames: NDArray[np.intp]) -> _Opened | None:
    """What taps and drains did between frames, nothing where there are none; None where it is not recorded."""
    world, scalars = evidence.world, evidence.recording.scalars
    if not world.taps and not world.drains:
        return _Opened(np.zeros((len(frames) - 1, 3)), np.zeros(len(frames) - 1))
    names = [f"fluid/opening_impulse_{axis}" for axis in "xyz"] + ["fluid/mass_in", "fluid/mass_out"]
    if any(name not in scalars for name in names):
        return None
    given = np.cumsum(np.stack([scalars[name] for name in names[:3]], axis=1), axis=0)
    moved = scalars["fluid/mass_in"] + scalars["fluid/mass_out"]
    return _Opened(np.diff(given[frames], axis=0), np.diff(moved[frames]))
