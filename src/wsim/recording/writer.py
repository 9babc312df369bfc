"""Writes what happens in a world to a Rerun recording, in chunks of columns."""

from __future__ import annotations

import io
import json
import math
import re
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import rerun as rr
from PIL import Image
from rerun.chunk import RrdReader

from wsim.errors import UserError
from wsim.recording import columns as names
from wsim.recording.blueprint import make_blueprint
from wsim.recording.buffers import BodyBuffer, CordBuffer, FluidBuffer, RowBuffer, send_camera_poses
from wsim.recording.causes import WIDTHS
from wsim.recording.causes import of_bodies as causes_of_bodies
from wsim.recording.causes import of_frame as causes_of_frame
from wsim.recording.contacts import WIDTH as CONTACT_WIDTH
from wsim.recording.frames import Frame
from wsim.recording.sensors import SensorBuffer
from wsim.recording.shapes import is_nested, log_camera, log_scene
from wsim.recording.solids import Solids, send_solids
from wsim.scene.world import World

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from types import TracebackType

    from numpy.typing import NDArray

    from wsim.scene.world import Camera

RESERVED_METADATA = ("complete", "error")
SCALAR_NAME = re.compile(r"[A-Za-z0-9_.\-]+(/[A-Za-z0-9_.\-]+)*")
JPEG_QUALITY = 90
FLUSH_SECONDS = 10.0  # a slow run writes this often, so that one that is killed leaves its evidence


class RecordingWriter:
    """Writes one world's recording to `<path>.partial`, and renames it to `path` when closed.

    Entities are the prims of the world, the time line is `sim_time`. Used as a context manager it closes itself; after
    an exception the recording of what happened so far is kept and marked as incomplete in its metadata.

    Args:
        path: Where the recording is to be, e.g. "recording.rrd". Its folder is made.
        world: What the stage states. Rows of a frame's arrays follow `world.bodies`.
        metadata: Anything that JSON can hold; the keys "complete" and "error" are the writer's own.
        blueprint: Whether to store how the viewer lays it out.

    Raises:
        UserError: Rerun is switched off in the environment, or the file cannot be written.
        ValueError: The metadata is not JSON, or uses a reserved key.
    """

    def __init__(
        self, path: str | Path, world: World, metadata: Mapping[str, Any] | None = None, *, blueprint: bool = True
    ) -> None:
        self.path = Path(path)
        self.partial_path = self.path.with_name(self.path.name + ".partial")
        self.world = world
        self.frame_count = 0
        self._metadata = _check_metadata(metadata or {})
        self._last_ns: int | None = None
        self._log_count = 0
        self._image_sizes: dict[str, tuple[int, int]] = {}
        self._views = {camera.prim: camera for camera in world.cameras}
        self._seen_objects: dict[str, list[str]] = {}
        self._causes: set[str] = set()
        self._closed = False
        self._flushed_at = time.monotonic()
        self._stream = _open_stream(self.partial_path, world.name)
        self._bodies = BodyBuffer(self._stream, world)
        self._fluids = {fluid.prim: FluidBuffer(self._stream, fluid, world) for fluid in world.fluids}
        self._cords = CordBuffer(self._stream, world)
        self._rows = RowBuffer(self._stream)
        self._sensors = SensorBuffer(self._stream, world)
        self._write_setup(blueprint)

    def frame(self, t: float, frame: Frame) -> None:
        """Record the state at time `t` [s]; times must increase.

        Raises:
            ValueError: A shape does not match the world, a prim or a name is unknown, or time stands still.
        """
        ns = self._frame_time(t)
        rows = self._check_bodies(frame)
        causes = self._check_causes(frame)
        fluids = {prim: self._fluid(prim).check(value) for prim, value in frame.fluids.items()}
        for name in frame.scalars:
            if not SCALAR_NAME.fullmatch(name):
                raise ValueError(f"scalar {name!r}: a name is letters, digits and _.-, its parts separated by /")
        self._last_ns = ns
        self.frame_count += 1
        self._bodies.add(ns, float(t), rows, causes, causes_of_frame(frame), frame.contacts, frame.ties)
        self._cords.add(ns, rows[0])
        for prim, checked in fluids.items():
            self._fluids[prim].add(ns, frame.fluids[prim], checked)
        for name, value in frame.scalars.items():
            self._rows.add(names.SCALAR_ROOT + name, ns, {names.SCALARS: float(value)})
        if time.monotonic() - self._flushed_at > FLUSH_SECONDS:
            self._flush()

    def solids(self, solids: Solids) -> None:
        """Record the particles that stand for what the fluids meet: once, as they stay on walls and in bodies.

        Raises:
            ValueError: A body is none of the world's.
        """
        self._check_open()
        if unknown := solids.bodies.keys() - {body.prim for body in self.world.bodies}:
            raise ValueError(f"solids: no bodies {sorted(unknown)} in the world")
        send_solids(self._stream, solids)

    def log(self, t: float, level: str, text: str, prim: str | None = None) -> None:
        """Record a line of the log.

        Args:
            t: When [s].
            level: TRACE, DEBUG, INFO, WARN, ERROR or CRITICAL, in any case; "warning" is WARN.
            text: What happened.
            prim: The prim that it is about; the line is kept on that prim's entity.
        """
        self._check_open()
        if prim is not None and not re.fullmatch(r"(/[^/\s]+)+", prim):
            raise ValueError(f"log: prim {prim!r} is not an absolute prim path such as /World/block")
        row = {
            names.LOG_TEXT: text,
            names.LOG_LEVEL: names.log_level(level),
            names.LOG_INDEX: self._log_count,
            names.LOG_PRIM: prim or "",
        }
        entity = names.entity_path(prim) if prim is not None else names.LOG_ENTITY
        self._rows.add(entity, _time_ns(t), row)
        self._log_count += 1

    def sample(
        self, t: float, prim: str, sample: Mapping[str, NDArray[Any]], points: NDArray[Any] | None = None
    ) -> None:
        """Record what one of `world.sensors` told at time `t` [s], by channel, and draw points [m] that it met, (n, 3).

        Raises:
            ValueError: If the world has no such sensor, or it tells something else.
        """
        self._check_open()
        self._sensors.add(_time_ns(t), prim, sample, points)

    def views(self, cameras: Sequence[Camera], times: NDArray[np.float64], body_q: NDArray[Any]) -> None:
        """Say which cameras the pictures are taken with, where those are not the world's: what is read has them.

        Args:
            cameras: In the place of the world's, of the same prims, and then those beside them.
            times: Of all frames (F,) [s].
            body_q: Poses at them (F, B, 7).

        Raises:
            ValueError: One of the world's is not among them, or one comes twice.
        """
        self._check_open()
        prims, own = [c.prim for c in cameras], [c.prim for c in self.world.cameras]
        if prims[: len(own)] != own or len(set(prims)) < len(prims):
            raise ValueError(f"views: {prims}; the world has {own}, which come first, each once")
        rows = {body.prim: i for i, body in enumerate(self.world.bodies)}
        for camera in cameras:
            if camera == self._views.get(camera.prim):
                continue
            self._views[camera.prim] = camera
            if camera.follows is not None and len(times):
                index = names.time_column([_time_ns(t) for t in times])
                poses = np.asarray(body_q[:, rows[camera.follows]], dtype=np.float32)
                send_camera_poses(self._stream, camera, self.world, index, poses)
        if list(self._views.values()) != self.world.cameras:
            told = json.dumps([camera.model_dump() for camera in self._views.values()])
            self._send_property({names.VIEWS: [told]})

    def image(self, t: float, camera_prim: str, rgb: NDArray[np.uint8]) -> None:
        """Record a camera's picture as JPEG.

        Args:
            t: When [s].
            camera_prim: One of `world.cameras`, or of `views`.
            rgb: (H, W, 3) uint8.
        """
        self._check_open()
        if camera_prim not in self._views:
            raise ValueError(f"image: no camera {camera_prim!r}; the world has {sorted(self._views)}")
        if rgb.ndim != 3 or rgb.shape[2] != 3 or rgb.dtype != np.uint8 or 0 in rgb.shape:
            raise ValueError(f"image of {camera_prim}: expected (H, W, 3) uint8, got {rgb.shape} {rgb.dtype}")
        height, width = rgb.shape[:2]
        self._image_sizes[camera_prim] = (width, height)  # which the frustum must fit
        jpeg = io.BytesIO()
        Image.fromarray(rgb).save(jpeg, "JPEG", quality=JPEG_QUALITY)
        blob = np.frombuffer(jpeg.getvalue(), np.uint8)
        self._rows.add(names.entity_path(camera_prim), _time_ns(t), {names.IMAGE: blob})

    def seen(self, t: float, camera_prim: str, shares: Mapping[str, float]) -> None:
        """Record the share of a camera's picture that each object takes up.

        Args:
            t: When [s].
            camera_prim: The camera.
            shares: By the object's prim, 0 for one that is not to be seen; the same objects each time.
        """
        self._check_open()
        entity = names.entity_path(camera_prim)
        if camera_prim not in self._seen_objects:
            self._seen_objects[camera_prim] = list(shares)
            objects = names.column(names.SEEN_OBJECTS, [json.dumps(list(shares))])
            self._stream.send_columns(entity, [], [objects], strict=True)
        elif self._seen_objects[camera_prim] != list(shares):
            raise ValueError(f"seen by {camera_prim}: objects {list(shares)} were {self._seen_objects[camera_prim]}")
        if shares:
            row = np.array(list(shares.values()), dtype=np.float32)
            self._rows.add(entity, _time_ns(t), {names.SEEN: row})

    def close(self, complete: bool = True, error: str | None = None) -> Path:
        """Write what is left, check the file and give it its name. Closing twice is fine.

        Args:
            complete: False notes in the metadata that the run ended early.
            error: Why it did.

        Returns:
            The recording's path.

        Raises:
            UserError: The file was not written whole, e.g. the disk is full; `<path>.partial` stays.
        """
        if self._closed:
            return self.path
        self._closed = True
        self._flush()
        for camera in self._views.values():
            size = self._image_sizes.get(camera.prim, (camera.width, camera.height))
            log_camera(self._stream, camera, *size, nested=is_nested(camera.prim, self.world))
        state: dict[str, Any] = {"complete": complete} | ({"error": error} if error is not None else {})
        self._write_metadata(state)
        self._stream.flush()
        self._stream.disconnect()
        del self._stream
        _check_whole(self.partial_path, self.frame_count)
        self.partial_path.replace(self.path)
        return self.path

    def __enter__(self) -> RecordingWriter:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close(complete=error is None, error=None if error is None else f"{type(error).__name__}: {error}")

    def _flush(self) -> None:
        for fluid in self._fluids.values():
            fluid.flush()
        self._cords.flush()
        self._rows.flush()
        self._sensors.flush()
        self._bodies.flush()
        self._flushed_at = time.monotonic()

    def _write_setup(self, blueprint: bool) -> None:
        self._stream.send_recording_name(self.world.name)
        self._send_property(
            {names.WORLD: [self.world.model_dump_json()], names.VERSION: np.array([names.FORMAT_VERSION])}
        )
        # A killed run never gets to close: until then its recording says that it is incomplete.
        self._write_metadata({"complete": False, "error": "the recording was never closed"})
        log_scene(self._stream, self.world)
        if blueprint:
            self._stream.send_blueprint(make_blueprint(self.world))

    def _write_metadata(self, state: dict[str, Any]) -> None:
        self._send_property({names.METADATA: [json.dumps(self._metadata | state)]})

    def _send_property(self, values: dict[str, Any]) -> None:
        # Static, on the entity that Rerun keeps for properties: the viewer lists them with the recording.
        batch = [names.column(name, value) for name, value in values.items()]
        self._stream.send_columns(names.PROPERTY_ENTITY, [], batch, strict=True)

    def _frame_time(self, t: float) -> int:
        self._check_open()
        ns = _time_ns(t)
        if self._last_ns is not None and ns <= self._last_ns:
            raise ValueError(f"frame: time {t} s does not follow {self._last_ns / 1e9} s, the last frame's")
        return ns

    def _check_bodies(self, frame: Frame) -> tuple[NDArray[np.float32], ...]:
        count = len(self.world.bodies)
        arrays = []
        fields = {"body_q": (frame.body_q, 7), "body_qd": (frame.body_qd, 6), "contact_force": (frame.contact_force, 3)}
        for name, (given, width) in fields.items():
            # A copy: a simulator may hand out the same array each frame.
            array = np.array(given, dtype=np.float32)
            if array.shape != (count, width):
                raise ValueError(
                    f"frame: {name} has shape {array.shape}, the world has {count} bodies: ({count}, {width})"
                )
            arrays.append(array)
        return tuple(arrays)

    def _check_causes(self, frame: Frame) -> dict[str, NDArray[np.float32]]:
        """What pushed the bodies, by column."""
        arrays = {name: np.array(given, dtype=np.float32) for name, given in causes_of_bodies(frame).items()}
        given = {"contacts": frame.contacts, "ties": frame.ties}
        known = {*arrays, *causes_of_frame(frame), *(name for name, each in given.items() if each is not None)}
        if self.frame_count and known != self._causes:
            raise ValueError(f"frame: {sorted(known ^ self._causes)} come in all frames or in none")
        self._causes = known
        for name, array in arrays.items():
            if array.shape != (expected := (len(self.world.bodies), WIDTHS[name])):
                raise ValueError(f"frame: {name} has shape {array.shape}, expected {expected}")
        if frame.contacts is not None:
            pair, sums = frame.contacts.pair, frame.contacts.sums
            if pair.shape != (len(sums), 2) or sums.shape != (len(pair), CONTACT_WIDTH):
                raise ValueError(
                    f"frame: contacts have shapes {pair.shape} and {sums.shape}; (n, 2), (n, {CONTACT_WIDTH})"
                )
        return arrays

    def _fluid(self, prim: str) -> FluidBuffer:
        if prim not in self._fluids:
            raise ValueError(f"frame: no fluid {prim!r}; the world has {sorted(self._fluids)}")
        return self._fluids[prim]

    def _check_open(self) -> None:
        if self._closed:
            raise ValueError(f"{self.path} is closed; nothing more can be recorded")


def _open_stream(path: Path, name: str) -> Any:
    stream = rr.RecordingStream(names.APPLICATION)
    if not rr.is_enabled(stream):
        raise UserError("Rerun is switched off by the environment variable RERUN; unset it to record")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.unlink(missing_ok=True)
        stream.save(path)
    except (OSError, RuntimeError) as error:
        raise UserError(f"cannot write the recording of {name!r} to {path}: {error}") from error
    return stream


def _check_whole(path: Path, frames: int) -> None:
    """Rerun's file writer works in the background and only prints its errors: look at what it left."""
    try:
        RrdReader(path).store()  # reads the footer, which is written last
    except (RuntimeError, ValueError) as error:
        raise UserError(
            f"{path} was not written whole ({frames} frames were recorded); is the disk full? {error}"
        ) from error


def _check_metadata(metadata: Mapping[str, Any]) -> dict[str, Any]:
    for key in RESERVED_METADATA:
        if key in metadata:
            raise ValueError(f"metadata: {key!r} is the writer's own key; give yours another name")
    try:
        return dict(json.loads(json.dumps(dict(metadata))))
    except TypeError as error:
        raise ValueError(f"metadata must be plain JSON: {error}") from error


def _time_ns(t: float) -> int:
    if not math.isfinite(t):
        raise ValueError(f"time {t} is not finite")
    return names.nanoseconds(t)
