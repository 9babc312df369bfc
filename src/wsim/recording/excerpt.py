"""A copy of a recording that opens at a moment or on a prim.

Rerun's viewer takes no time cursor from the command line, and a blueprint holds none. It does start where the data
start: so the copy begins at the moment that is asked for, and the viewer is told to stand still there.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import rerun as rr
from rerun.chunk import Chunk, RrdReader

from wsim.errors import UserError
from wsim.recording.blueprint import make_blueprint
from wsim.recording.columns import APPLICATION, FRAME_ENTITY, TIMELINE, nanoseconds
from wsim.recording.reader import read_world

if TYPE_CHECKING:
    from collections.abc import Iterator

    from wsim.scene.world import World


def write_excerpt(path: str | Path, copy: str | Path, time: float | None = None, entity: str | None = None) -> Path:
    """Copy a recording from the last frame at or before `time` on, its 3D view following `entity`.

    Args:
        path: The recording.
        copy: Where the copy is to be.
        time: Where it begins [s]; None keeps all.
        entity: A prim of the recording, or one below it.

    Raises:
        UserError: The recording cannot be read, knows no such prim, or has no frame as early as `time`.
    """
    world = read_world(path)
    _check_entity(world, entity)
    chunks = list(RrdReader(path).stream())
    start = None if time is None else _frame_start(chunks, nanoseconds(time), Path(path))
    stream = rr.RecordingStream(APPLICATION)
    stream.save(copy)
    stream.send_chunks(chunks if start is None else _from(chunks, start))
    stream.send_blueprint(make_blueprint(world, paused=time is not None, entity=entity))
    stream.flush()
    stream.disconnect()
    return Path(copy)


def _check_entity(world: World, entity: str | None) -> None:
    groups = (world.bodies, world.statics, world.fluids, world.cords, world.cameras)
    known = [item.prim for group in groups for item in group]
    if entity is not None and not any(entity == prim or entity.startswith(prim + "/") for prim in known):
        raise UserError(f"the recording has no prim {entity!r}; it has {', '.join(known)}")


def _frame_start(chunks: list[Any], ns: int, path: Path) -> int:
    """The time [ns] of the last frame that does not come after `ns`."""
    frames = [_times(chunk.to_record_batch()) for chunk in chunks if chunk.entity_path == FRAME_ENTITY]
    times = np.concatenate(frames) if frames else np.zeros(0, np.int64)
    before = times[times <= ns]
    if not len(before):
        raise UserError(f"{path} has no frame at or before {ns / 1e9} s")
    return int(before.max())


def _from(chunks: list[Any], start: int) -> Iterator[Any]:
    for chunk in chunks:
        if chunk.is_static:
            yield chunk
            continue
        batch = chunk.to_record_batch()
        keep = _times(batch) >= start
        if keep.all():
            yield chunk
        elif keep.any():
            yield from Chunk.from_record_batch(batch.filter(keep))


def _times(batch: Any) -> Any:
    return batch.column(batch.schema.get_field_index(TIMELINE)).cast("int64").to_numpy()
