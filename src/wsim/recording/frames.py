"""What one recorded moment holds, as plain arrays: the shared words of writer and reader."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from wsim.recording.contacts import Pushes
    from wsim.recording.ties import Ties

    Floats = NDArray[np.float32]
    Bools = NDArray[np.bool_]
else:
    Floats = Bools = object


@dataclass
class FluidFrame:
    """The particles of one fluid at one moment."""

    position: Floats  # (N, 3) [m], world
    velocity: Floats  # (N, 3) [m/s]
    density: Floats  # (N,) [kg/m^3]
    present: Bools | None = None  # (N,) which are in the world: not those that wait for a tap, or have drained away


@dataclass
class Frame:
    """The state of a world at one moment; rows follow `World.bodies`.

    Values are stored as float32 (scalars as float64); NaN and infinity are kept.
    """

    body_q: Floats  # (B, 7) [x y z qx qy qz qw], world
    body_qd: Floats  # (B, 6) [vx vy vz wx wy wz], of the centre of mass [m/s, rad/s]
    contact_force: Floats  # (B, 3) net contact force on each body [N]
    fluids: Mapping[str, FluidFrame] = field(default_factory=dict)  # by the fluid's prim
    scalars: Mapping[str, float] = field(default_factory=dict)  # by name, e.g. "energy/kinetic" [SI]
    # What fluid and control did to each body since the last frame; in all frames of a recording, or in none.
    applied_impulse: Floats | None = None  # (B, 3) [N s]
    applied_work: Floats | None = None  # (B,) [J]
    applied_turn: Floats | None = None  # (B, 3) [N m s], about the centre of mass
    control_impulse: Floats | None = None  # (B, 3) [N s], what of the applied one is control's
    scheduled: Floats | None = None  # (B, 6) [N s, N m s], what of the applied one is schedules'
    wall_impulse: Floats | None = None  # (3,) [N s], of fluid on all that stands still
    lead: Floats | None = None  # (B, 6) [N s, N m s], what velocities gained that steps had not given yet
    contacts: Pushes | None = None  # what pairs of shapes gave each other
    ties: Ties | None = None  # what joints, springs and ropes gave


@dataclass(frozen=True)
class LogLine:
    """One line of the recording's log."""

    time: float  # [s]
    level: str  # TRACE, DEBUG, INFO, WARN, ERROR or CRITICAL
    text: str
    prim: str | None = None
