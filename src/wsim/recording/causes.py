"""Columns of what pushed bodies between frames: in all frames of a recording, or in none."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from wsim.recording import columns as names
from wsim.recording.ties import CORD_WIDTH, JOINT_WIDTH, TieTrack, cord_ends

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsim.recording.frames import Frame
    from wsim.recording.table import Table
    from wsim.scene.world import World

    Floats = NDArray[np.float32]

WIDTHS = {names.APPLIED: 4, names.APPLIED_TURN: 3, names.CONTROLLED: 3, names.LEAD: 6}  # of a body's


def of_bodies(frame: Frame) -> dict[str, Floats]:
    """A frame's, by column, (B, width)."""
    found = {
        names.APPLIED_TURN: frame.applied_turn,
        names.CONTROLLED: frame.control_impulse,
        names.LEAD: frame.lead,
    }
    if frame.applied_impulse is not None and frame.applied_work is not None:
        found[names.APPLIED] = np.c_[frame.applied_impulse, frame.applied_work]
    return {name: array for name, array in found.items() if array is not None}


def of_frame(frame: Frame) -> dict[str, Floats]:
    """What a frame has once, by column, each a row."""
    found = {} if frame.wall_impulse is None else {names.WALL_IMPULSE: frame.wall_impulse}
    if frame.ties is not None:
        found |= {names.JOINT_SUMS: frame.ties.joints.ravel(), names.CORD_SUMS: frame.ties.cords.ravel()}
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


def check_ties(frame: Frame, world: World) -> None:
    """ValueError where the sums of joints and cords are not those of the world's."""
    if frame.ties is None:
        return
    expected = (len(world.joints), JOINT_WIDTH), (len(cord_ends(world)), CORD_WIDTH)
    if (given := (frame.ties.joints.shape, frame.ties.cords.shape)) != expected:
        raise ValueError(f"frame: ties have shapes {given[0]} and {given[1]}, the world's {expected[0]}, {expected[1]}")


def read_ties(table: Table, world: World, frame_ns: NDArray[np.int64]) -> TieTrack | None:
    """What joints and cords gave, where it was recorded: recordings of before have none, and of them none is asked."""
    counts = (len(world.joints), JOINT_WIDTH), (len(cord_ends(world)), CORD_WIDTH)
    found = [np.zeros((len(frame_ns), *count), np.float32) for count in counts]
    for k, (name, count) in enumerate(zip((names.JOINT_SUMS, names.CORD_SUMS), counts, strict=True)):
        ns, values = table.get(names.FRAME_ENTITY, name, count, np.float32)
        if count[0] and not len(ns):
            return None
        if count[0]:
            found[k] = values[np.searchsorted(ns, frame_ns)]
    return TieTrack(*found) if any(count[0] for count in counts) else None


def read_frames(table: Table, frame_ns: NDArray[np.int64], column: str) -> Floats | None:
    """A column that a frame has once, (T, 3), where it was recorded."""
    ns, values = table.get(names.FRAME_ENTITY, column, (3,), np.float32)
    return values[np.searchsorted(ns, frame_ns)] if len(ns) else None
