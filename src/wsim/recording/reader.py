"""Reads a recording back as arrays, bit for bit.

Rerun 0.41 offers two ways into a recording from Python: its catalog server with a dataframe query, and
`rerun.chunk.RrdReader`, which hands out the file's chunks as Arrow record batches. This is the second: no server, no
port, no thread, no query engine, 20 ms for a 40 MB file against 0.8 s, and it reads a file whose writer was killed.
"""

from __future__ import annotations

import json
import warnings
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from pydantic import ValidationError

from wsim.errors import UserError
from wsim.recording import columns as names
from wsim.recording.frames import FluidFrame, Frame, LogLine
from wsim.recording.table import Clock, Table
from wsim.scene.world import World

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Floats = NDArray[np.float32]
    Times = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class FluidTrack:
    """One fluid through time; its frames may be fewer than the recording's."""

    time: Times  # (T,) [s]
    position: Floats  # (T, N, 3) [m]
    velocity: Floats  # (T, N, 3) [m/s]
    density: Floats  # (T, N) [kg/m^3]


@dataclass(frozen=True, eq=False)
class ImageTrack(Sequence["NDArray[np.uint8]"]):
    """One camera's pictures through time, decoded when they are asked for."""

    time: Times  # (T,) [s]
    jpegs: list[Any]  # Arrow scalars of bytes

    def __len__(self) -> int:
        return len(self.jpegs)

    def __getitem__(self, index: Any) -> Any:
        """The picture (H, W, 3) uint8 RGB at an index; a list of them for a slice."""
        if isinstance(index, slice):
            return [self[i] for i in range(*index.indices(len(self)))]
        import cv2

        bgr: Any = cv2.imdecode(np.frombuffer(self.jpeg(index), np.uint8), cv2.IMREAD_COLOR)
        return np.ascontiguousarray(bgr[:, :, ::-1])

    def __iter__(self) -> Iterator[NDArray[np.uint8]]:
        return (self[i] for i in range(len(self)))

    def jpeg(self, index: int) -> bytes:
        """The picture's file as it was stored."""
        return bytes(self.jpegs[index])

    def at(self, t: float) -> NDArray[np.uint8]:
        """The picture nearest to time `t` [s], (H, W, 3) uint8 RGB."""
        image: NDArray[np.uint8] = self[_nearest(self.time, t)]
        return image


@dataclass(frozen=True, eq=False)
class SeenTrack:
    """How much of a camera's picture each object takes up, through time."""

    time: Times  # (T,) [s]
    objects: list[str]  # prims
    share: Floats  # (T, objects)


@dataclass(frozen=True, eq=False)
class Recording:
    """What happened in a world. T frames, B bodies in the order of `world.bodies`."""

    path: Path
    world: World
    metadata: dict[str, Any]
    time: Times  # (T,) [s], as it was given to the writer
    body_q: Floats  # (T, B, 7) [x y z qx qy qz qw], world
    body_qd: Floats  # (T, B, 6) [vx vy vz wx wy wz]
    contact_force: Floats  # (T, B, 3) [N]
    fluids: dict[str, FluidTrack]  # by prim
    scalars: dict[str, Times]  # by name, (T,); NaN where a frame had none
    log: list[LogLine]  # in order of time, then of writing
    images: Mapping[str, ImageTrack]  # by camera prim
    seen: Mapping[str, SeenTrack] = field(default_factory=dict)  # by camera prim; empty where nothing was drawn
    applied_impulse: Floats | None = None  # (T, B, 3) [N s], of fluid and control since the frame before
    applied_work: Floats | None = None  # (T, B) [J], likewise

    @property
    def complete(self) -> bool:
        """Whether the run got to its end; if not, `metadata["error"]` may say why."""
        return bool(self.metadata.get("complete", False))

    def body_index(self, prim: str) -> int:
        """The row of a body; KeyError naming the known ones."""
        for i, body in enumerate(self.world.bodies):
            if body.prim == prim:
                return i
        raise KeyError(f"no body {prim!r}; the recording has {[b.prim for b in self.world.bodies]}")

    def position(self, prim: str) -> Floats:
        """A body's positions (T, 3) [m]."""
        return self.body_q[:, self.body_index(prim), :3]

    def rotation(self, prim: str) -> Floats:
        """A body's rotations (T, 4), xyzw."""
        return self.body_q[:, self.body_index(prim), 3:]

    def velocity(self, prim: str) -> Floats:
        """Velocities (T, 3) of a body's centre of mass [m/s]."""
        return self.body_qd[:, self.body_index(prim), :3]

    def angular_velocity(self, prim: str) -> Floats:
        """A body's angular velocities (T, 3) [rad/s]."""
        return self.body_qd[:, self.body_index(prim), 3:]

    def force(self, prim: str) -> Floats:
        """Net contact forces (T, 3) on a body [N]."""
        return self.contact_force[:, self.body_index(prim)]

    def frame_index(self, t: float) -> int:
        """The index of the frame nearest to time `t` [s]; ValueError when there is no frame."""
        return _nearest(self.time, t)

    def frame_at(self, t: float) -> Frame:
        """The frame nearest to time `t` [s]; fluids that have no particles recorded then are left out."""
        i = self.frame_index(t)
        fluids = {}
        for prim, track in self.fluids.items():
            for j in np.flatnonzero(track.time == self.time[i]):
                fluids[prim] = FluidFrame(track.position[j], track.velocity[j], track.density[j])
        scalars = {name: float(values[i]) for name, values in self.scalars.items()}
        return Frame(self.body_q[i], self.body_qd[i], self.contact_force[i], fluids, scalars)


def read(path: str | Path) -> Recording:
    """Read a recording that `RecordingWriter` wrote, or the `.partial` file of a run that was killed.

    Raises:
        UserError: There is no such file, it is no Rerun recording, it is cut off, or wsim did not write it.
    """
    path = Path(path)
    table = _load(path)
    world, metadata = _setup(table, path)
    frame_ns, frame_time = table.get(names.FRAME_ENTITY, names.FRAME_TIME, (), np.float64)
    clock = Clock(frame_ns, frame_time)
    body_q, body_qd, force = _bodies(table, world, frame_ns, path)
    applied = _applied(table, world, frame_ns)
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
        images=_images(table, world, clock),
        seen=_seen(table, clock),
        applied_impulse=None if applied is None else applied[:, :, :3],
        applied_work=None if applied is None else applied[:, :, 3],
    )


def read_world(path: str | Path) -> World:
    """The world of a recording; raises as `read` does."""
    return _setup(_load(Path(path)), Path(path))[0]


def _load(path: Path) -> Table:
    from rerun.chunk import RrdReader

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


def _setup(table: Table, path: Path) -> tuple[World, dict[str, Any]]:
    def text(column: str) -> str:
        _, cells = table.cells(names.PROPERTY_ENTITY, column)
        return str(cells[-1][0].as_py()) if cells else ""

    world, version = text(names.WORLD), text(names.VERSION)
    if not world:
        raise UserError(f"{path} holds no world: wsim did not record it; record one with `wsim run program.py`")
    if version != str(names.FORMAT_VERSION):
        raise UserError(f"{path} has format {version}, this wsim reads {names.FORMAT_VERSION}; record it anew")
    try:
        return World.model_validate_json(world), json.loads(text(names.METADATA) or "{}")
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


def _applied(table: Table, world: World, frame_ns: NDArray[np.int64]) -> Floats | None:
    """Impulse and work of what is applied to bodies (T, B, 4), where they were recorded."""
    found = np.full((len(frame_ns), len(world.bodies), 4), np.nan, np.float32)
    for i, body in enumerate(world.bodies):
        ns, values = table.get(names.entity_path(body.prim), names.APPLIED, (4,), np.float32)
        if not len(ns):
            return None
        found[:, i] = values[np.searchsorted(ns, frame_ns)]
    return found if world.bodies else None


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
        ns, position = table.get(entity, names.POSITIONS, (3,), np.float32, ragged=True)
        _, velocity = table.get(entity, names.PARTICLE_VELOCITY, (3,), np.float32, ragged=True)
        _, density = table.get(entity, names.PARTICLE_DENSITY, (), np.float32, ragged=True)
        tracks[fluid.prim] = FluidTrack(clock.seconds(ns), position, velocity, density)
    return tracks


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


def _images(table: Table, world: World, clock: Clock) -> dict[str, ImageTrack]:
    tracks = {}
    for camera in world.cameras:
        ns, cells = table.cells(names.entity_path(camera.prim), names.IMAGE)
        tracks[camera.prim] = ImageTrack(clock.seconds(ns), [cell[0].values.to_numpy() for cell in cells])
    return tracks


def _nearest(times: Times, t: float) -> int:
    if not len(times):
        raise ValueError("the recording has no frames")
    return int(np.argmin(np.abs(times - t)))
