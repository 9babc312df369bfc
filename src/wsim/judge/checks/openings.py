"""Checks of taps and drains: what came is held or went, and taps let out what they are said to."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from wsim.judge.books.fluids import particle_mass
from wsim.judge.checks.check import Check, Checks
from wsim.judge.evidence.recorded import MissingError
from wsim.judge.verdict import RepairTarget

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsim.judge.evidence.evidence import Evidence
    from wsim.judge.verdict import Finding

    Floats = NDArray[np.float64]


@dataclass
class CheckPassedMass(Check):
    """What a fluid had at the start and what came in is what it holds and what went out, at every frame."""

    share: float = 1e-4  # of what there was and came

    def evaluate(self, evidence: Evidence) -> list[Finding]:
        """One finding, where the world has taps or drains: where most is missing or too much [kg]."""
        world = evidence.world
        if not world.taps and not world.drains:
            return []
        time, held = _held(evidence)
        come, gone = (_at(evidence, time, name) for name in ("fluid/mass_in", "fluid/mass_out"))
        off, whole = np.abs(held[0] + come - gone - held), held[0] + come
        k = int(np.argmax(off / np.maximum(whole, 1e-300)))
        end = (f"{held[0]:.4g} kg at the start and {come[-1]:.4g} kg that came in are {held[-1]:.4g} kg held and "
               f"{gone[-1]:.4g} kg gone at the end")  # fmt: skip
        prim = world.fluids[0].prim
        return [
            self.measured(
                f"{prim}: {off[k]:.4g} kg are unaccounted for at {time[k]:.3f} s; {end}",
                float(off[k]), self.share * float(whole[k]), "kg", prim=prim, time=float(time[k]), expected=0.0,
                fine=f"{prim}: {end}", limit_from=f"{self.share:g} of what there was and came in",
                target=RepairTarget(
                    kind="program", prim=prim, direction="change", why="its particles come or go by no tap or drain"
                ),
            )
        ]  # fmt: skip


@dataclass
class CheckPoured(Check):
    """Taps let out as much as their rates say."""

    layers: float = 1.0  # over each mouth: what comes out comes by layers of particles

    def evaluate(self, evidence: Evidence) -> list[Finding]:
        """One finding for all taps together: where they are farthest off [kg]."""
        world = evidence.world
        if not world.taps:
            return []
        fluid = world.fluids[0]
        time, _ = _held(evidence)
        come = _at(evidence, time, "fluid/mass_in")
        asked = np.array([fluid.density * sum(tap.poured(float(t)) for tap in world.taps) for t in time])
        k = int(np.argmax(np.abs(come - asked)))
        # Drops of rain come one by one.
        cells = [0.0 if tap.drop_speed else tap.area / fluid.spacing**2 for tap in world.taps]
        layer = sum(each + 1.0 for each in cells) * particle_mass(fluid)
        prim = world.taps[0].prim
        return [
            self.measured(
                f"{prim}: {come[k]:.4g} kg came out by {time[k]:.3f} s, where the rates give {asked[k]:.4g} kg",
                float(abs(come[k] - asked[k])), self.layers * layer, "kg", prim=prim, time=float(time[k]), expected=0.0,
                fine=f"{prim}: {come[-1]:.4g} kg came out by the end; the rates give {asked[-1]:.4g} kg",
                limit_from=f"{self.layers:g} layer of particles over each mouth, or one drop",
                target=RepairTarget(
                    kind="program", prim=prim, parameter="rate", direction="change", why="it does not keep to its rate"
                ),
            )
        ]  # fmt: skip


def _held(evidence: Evidence) -> tuple[Floats, Floats]:
    """Times at which particles are recorded, and what all fluids hold then [kg]."""
    tracks = [(fluid, evidence.track(fluid)) for fluid in evidence.world.fluids]
    if not tracks or not len(tracks[0][1].time):
        raise MissingError("no fluid is recorded")
    return tracks[0][1].time, np.sum([particle_mass(f) * track.count for f, track in tracks], axis=0, dtype=np.float64)


def _at(evidence: Evidence, time: Floats, name: str) -> Floats:
    """A recorded number at some times."""
    values = evidence.recording.scalars.get(name)
    if values is None:
        raise MissingError(f"{name} is not in the recording of a world with taps or drains")
    return np.asarray(values[np.minimum(np.searchsorted(evidence.time, time), len(values) - 1)], dtype=np.float64)


CHECKS: Checks = (CheckPassedMass, CheckPoured)
