"""All worlds of a simulation, stepped and kept as arrays."""

from __future__ import annotations

from typing import TYPE_CHECKING

from wsim.progress import Progress, silent
from wsim.sim.tracks import Tracks

if TYPE_CHECKING:
    from wsim.recording.trajectories import Trajectories
    from wsim.sim.simulation import Simulation


def follow(simulation: Simulation, progress: Progress = silent) -> Tracks:
    """Step every world through the stage's duration, and keep what the judge needs of each recorded frame.

    Args:
        simulation: At its start; left at its end.
        progress: Told after each frame.
    """
    tracks = Tracks(simulation)
    for frame in range(len(tracks.time)):
        if frame:
            simulation.advance_frame()
        tracks.take(frame)
        progress("simulating", frame, len(tracks.time) - 1)
    return tracks


def collect(simulation: Simulation, progress: Progress = silent) -> Trajectories:
    """The same, and all of it read (`Tracks.read`)."""
    return follow(simulation, progress).read()
