"""Columns of what pushed bodies between frames: in all frames of a recording, or in none."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from wsim.recording import columns as names

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsim.recording.frames import Frame
    from wsim.recording.table import Table
    from wsim.scene.world import World

    Floats = NDArray[np.float32]

WIDTHS = {
    names.APPLIED: 4,
    names.APPLIED_TURN: 3,
    names.CONTROLLED: 3,
    names.SCHEDULED: 6,
    names.LEAD: 6,
}  # of a body's


def of_bodies(frame: Frame) -> dict[str, Floats]:
    """A frame's, by column, (B, width)."""
    found = {
        names.APPLIED_TURN: frame.applied_turn,
        names.CONTROLLED: frame.control_impulse,
        names.SCHEDULED: frame.scheduled,
        names.LEAD: frame.lead,
    }
    if frame.applied_impulse is not None and frame.applied_work is not None:
        found[names.APPLIED] = np.c_[frame.applied_impulse, frame.applied_work]
    return {name: array for name, array in found.items() if array is not None}


def of_frame(frame: Frame) -> dict[str, Floats]:
    """What a frame has once, by column, each a row."""
    found = {} if frame.wall_impulse is None else {names.WALL_IMPULSE: frame.wall_impulse}
    return {name: np.array(row, dtype=np.float32) for name, row in found.items() if len(row)}


def read_bodies(table: Table, world: World, frame_ns: NDArray[np.int64], column: str) -> Floats | None:
    """A column of all bodies, (T, B, width), where it was recorded."""
    found = np.full((len(frame_ns), len(world.bodies), WIDTHS[column]), np.nan, np.float32)
    for i, body in enumerate(world.bodies):
        ns, values = table.get(names.entity_path(body.prim), column, (WIDTHS[column],), np.float32)
        if not len(ns):
            return None
        found[:, i] = values[np.searchsorted(ns, frame_ns)]
    return found if world.bodies else None


def read_frames(table: Table, frame_ns: NDArray[np.int64], column: str) -> Floats | None:
    """A column that a frame has once, (T, 3), where it was recorded."""
    ns, values = table.get(names.FRAME_ENTITY, column, (3,), np.float32)
    return values[np.searchsorted(ns, frame_ns)] if len(ns) else None
