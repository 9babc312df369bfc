"""Reads a recording back as arrays, bit for bit.

Rerun 0.41 offers two ways into a recording from Python: its catalog server with a dataframe query, and
`rerun.chunk.RrdReader`, which hands out the file's chunks as Arrow record batches. This is the second: no server, no
port, no thread, no query engine, 20 ms for a 40 MB file against 0.8 s, and it reads a file whose writer was killed.
"""

from __future__ import annotations

import json
import warnings
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from pydantic import ValidationError
from rerun.chunk import RrdReader

from wsim.errors import UserError
from wsim.recording import columns as names
from wsim.recording.causes import read_bodies, read_frames
from wsim.recording.contacts import read_contacts
from wsim.recording.frames import LogLine
from wsim.recording.recording import FluidTrack, ImageTrack, Recording, SeenTrack
from wsim.recording.sensors import read_sensors
from wsim.recording.solids import read_solids
from wsim.recording.table import Clock, Table
from wsim.recording.ties import read_ties
from wsim.scene.world import Camera, World

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Floats = NDArray[np.float32]
    Times = NDArray[np.float64]


def read(path: str | Path) -> Recording:
    """Read a recording that `RecordingWriter` wrote, or the `.partial` file of a run that was killed.

    Raises:
        UserError: There is no such file, it is no Rerun recording, it is cut off, or wsim did not write it.
    """
    path = Path(path)
    table = _load(path)
    world, views, metadata = _setup(table, path)
    frame_ns, frame_time = table.get(names.FRAME_ENTITY, names.FRAME_TIME, (), np.float64)
    clock = Clock(frame_ns, frame_time)
    body_q, body_qd, force = _bodies(table, world, frame_ns, path)
    applied, turn, control, scheduled, lead = (
        read_bodies(table, world, frame_ns, name)
        for name in (names.APPLIED, names.APPLIED_TURN, names.CONTROLLED, names.SCHEDULED, names.LEAD)
    )
    return Recording(
        path=path,
        world=world,
        metadata=metadata,
        time=frame_time,
        body_q=body_q,
        body_qd=body_qd,
        contact_force=force,
        fluids=_fluids(table, world, clock),
        scalars=_scalars(table, clock),
        log=_log(table, clock),
        views=views,
        images=_images(table, views, clock),
        seen=_seen(table, clock),
        applied_impulse=None if applied is None else applied[:, :, :3],
        applied_work=None if applied is None else applied[:, :, 3],
        applied_turn=turn,
        control_impulse=control,
        scheduled=scheduled,
        lead=lead,
        wall_impulse=read_frames(table, frame_ns, names.WALL_IMPULSE),
        contacts=read_contacts(table, frame_ns),
        solids=read_solids(table, world),
        ties=read_ties(table, world, frame_ns),
        sensors=read_sensors(table, world, clock),
    )


def read_world(path: str | Path) -> World:
    """The world of a recording; raises as `read` does."""
    return _setup(_load(Path(path)), Path(path))[0]


def _load(path: Path) -> Table:
    if not path.is_file():
        raise UserError(f"no recording at {path}")
    table = Table()
    try:
        with warnings.catch_warnings():
            # A partial file has no footer, which Rerun warns of; it is read from start to end all the same.
            warnings.simplefilter("ignore")
            for chunk in RrdReader(path).stream():
                table.add(chunk.entity_path, chunk.to_record_batch())
    except (RuntimeError, ValueError) as error:
        mend = ""
        if path.suffix == ".partial":
            mend = f"; save what is in it with: rerun rrd optimize --continue-on-error {path} -o {path.with_suffix('')}"
        raise UserError(f"{path} is not a whole Rerun recording: {error}{mend}") from error
    return table


def _setup(table: Table, path: Path) -> tuple[World, list[Camera], dict[str, Any]]:
    def text(column: str) -> str:
        _, cells = table.cells(names.PROPERTY_ENTITY, column)
        return str(cells[-1][0].as_py()) if cells else ""

    world, version = text(names.WORLD), text(names.VERSION)
    if not world:
        raise UserError(f"{path} holds no world: wsim did not record it; record one with `wsim run program.py`")
    if version != str(names.FORMAT_VERSION):
        raise UserError(f"{path} has format {version}, this wsim reads {names.FORMAT_VERSION}; record it anew")
    try:
        found = World.model_validate_json(world)
        views = [Camera.model_validate(each) for each in json.loads(text(names.VIEWS) or "[]")]
        if found.cameras and views:  # a world's cameras are those that its pictures were taken with
            found = found.model_copy(update={"cameras": views})
        return found, views or found.cameras, json.loads(text(names.METADATA) or "{}")
    except (ValidationError, json.JSONDecodeError) as error:
        raise UserError(f"{path}: its world or metadata cannot be read; record it anew: {error}") from error


def _bodies(table: Table, world: World, frame_ns: NDArray[np.int64], path: Path) -> tuple[Floats, Floats, Floats]:
    """Poses (T, B, 7), velocities (T, B, 6) and forces (T, B, 3)."""
    count, bodies = len(frame_ns), len(world.bodies)
    q = np.full((count, bodies, 7), np.nan, np.float32)
    qd = np.full((count, bodies, 6), np.nan, np.float32)
    force = np.full((count, bodies, 3), np.nan, np.float32)
    for i, body in enumerate(world.bodies):
        entity = names.entity_path(body.prim)
        for name, target in (
            (names.TRANSLATION, q[:, i, :3]),
            (names.QUATERNION, q[:, i, 3:]),
            (names.LINEAR_VELOCITY, qd[:, i, :3]),
            (names.ANGULAR_VELOCITY, qd[:, i, 3:]),
            (names.CONTACT_FORCE, force[:, i]),
        ):
            ns, values = table.get(entity, name, (target.shape[-1],), np.float32)
            # A killed run may have rows beyond its last whole frame, never fewer.
            rows = np.searchsorted(ns, frame_ns)
            if count > len(ns) or not np.array_equal(ns[rows], frame_ns):
                raise UserError(f"{path}: {body.prim} has {len(ns)} rows of {name}, the recording {count} frames")
            target[:] = values[rows]
    return q, qd, force


def _seen(table: Table, clock: Clock) -> dict[str, SeenTrack]:
    tracks = {}
    for entity in table.entities(names.SEEN_OBJECTS):
        objects = json.loads(table.cells(entity, names.SEEN_OBJECTS)[1][-1][0].as_py())
        ns, share = table.get(entity, names.SEEN, (len(objects),), np.float32)
        tracks[entity] = SeenTrack(clock.seconds(ns), objects, share)
    return tracks


def _fluids(table: Table, world: World, clock: Clock) -> dict[str, FluidTrack]:
    tracks = {}
    for fluid in world.fluids:
        entity = names.entity_path(fluid.prim)
        if entity in table.entities(names.PARTICLE_NUMBER):
            tracks[fluid.prim] = _coming_and_going(table, entity, clock)
            continue
        ns, position = table.get(entity, names.POSITIONS, (3,), np.float32, ragged=True)
        _, velocity = table.get(entity, names.PARTICLE_VELOCITY, (3,), np.float32, ragged=True)
        _, density = table.get(entity, names.PARTICLE_DENSITY, (), np.float32, ragged=True)
        tracks[fluid.prim] = FluidTrack(clock.seconds(ns), position, velocity, density)
    return tracks


def _coming_and_going(table: Table, entity: str, clock: Clock) -> FluidTrack:
    """A fluid's of which each frame has the particles that are in the world then, by number."""
    ns, numbers = table.cells(entity, names.PARTICLE_NUMBER)
    rows = [np.asarray(each) for each in numbers]
    shape = len(rows), max((int(row.max()) + 1 for row in rows if len(row)), default=0)
    present = np.zeros(shape, dtype=bool)
    for k, row in enumerate(rows):
        present[k, row] = True
    found = []
    for name, width in ((names.POSITIONS, (3,)), (names.PARTICLE_VELOCITY, (3,)), (names.PARTICLE_DENSITY, ())):
        values = np.full((*shape, *width), np.nan, dtype=np.float32)
        for k, cell in enumerate(table.cells(entity, name)[1]):
            flat = cell.flatten() if width else cell
            values[k, rows[k]] = flat.to_numpy(zero_copy_only=False).reshape(-1, *width)
        found.append(values)
    return FluidTrack(clock.seconds(ns), found[0], found[1], found[2], present)


def _scalars(table: Table, clock: Clock) -> dict[str, Times]:
    scalars = {}
    for entity in table.entities(names.SCALARS):
        if entity.startswith(names.SCALAR_ROOT):
            ns, values = table.get(entity, names.SCALARS, (), np.float64)
            column = np.full(len(clock.ns), np.nan)
            known = np.isin(ns, clock.ns)
            column[np.searchsorted(clock.ns, ns[known])] = values[known]
            scalars[entity.removeprefix(names.SCALAR_ROOT)] = column
    return scalars


def _log(table: Table, clock: Clock) -> list[LogLine]:
    lines = []
    for entity in table.entities(names.LOG_INDEX):
        ns, texts = table.cells(entity, names.LOG_TEXT)
        columns = [table.cells(entity, name)[1] for name in (names.LOG_LEVEL, names.LOG_PRIM, names.LOG_INDEX)]
        seconds = clock.seconds(ns)
        for i, text in enumerate(texts):
            level, prim, index = (column[i][0].as_py() for column in columns)
            lines.append((float(seconds[i]), index, LogLine(float(seconds[i]), level, text[0].as_py(), prim or None)))
    return [line for _, _, line in sorted(lines, key=lambda entry: entry[:2])]


def _images(table: Table, views: list[Camera], clock: Clock) -> dict[str, ImageTrack]:
    tracks = {}
    for camera in views:
        ns, cells = table.cells(names.entity_path(camera.prim), names.IMAGE)
        tracks[camera.prim] = ImageTrack(clock.seconds(ns), [cell[0].values.to_numpy() for cell in cells])
    return tracks
