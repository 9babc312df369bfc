"""Frames wait here until there are enough of them to write a chunk of columns.

A chunk costs the same whether it holds one row or a thousand, in the file, in the viewer and when it is read.
"""

from __future__ import annotations

from collections import defaultdict
from typing import TYPE_CHECKING, Any

import numpy as np
import rerun as rr

from wsim.recording import columns as names
from wsim.recording.contacts import columns_of
from wsim.recording.shapes import ROOT_FRAME, camera_poses, is_nested, rgba
from wsim.recording.ties import columns_of_ties
from wsim.scene.cord_lines import cord_lines

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsim.recording.contacts import Pushes
    from wsim.recording.frames import FluidFrame
    from wsim.recording.ties import Ties
    from wsim.scene.world import Camera, Fluid, World

    Floats = NDArray[np.float32]
    Particles = tuple[Floats, Floats, Floats, NDArray[np.int32] | None]

CHUNK_BYTES = 4 * 1024 * 1024  # of particles or bodies that wait in memory
CHUNK_ROWS = 256
MAX_HEIGHT_PLOTS = 16  # more lines than this say nothing in a plot
COLOR_STEPS = 32  # few colours compress well
ZIGZAG, SLACK_PIECES = 2, 40  # points on a coil's turn, pieces of a slack rope: a video's many would fill the file
FAR = 1e9  # [m]
FOAM = (0.92, 0.97, 1.0)  # what the fastest particles tend to


class BodyBuffer:
    """The frames' times; poses, velocities and forces of all bodies."""

    def __init__(self, stream: Any, world: World) -> None:
        self._stream, self._world = stream, world
        self._entities = [names.entity_path(body.prim) for body in world.bodies]
        self._nested = [is_nested(body.prim, world) for body in world.bodies]
        rows = {body.prim: i for i, body in enumerate(world.bodies)}
        self._followers = [(camera, rows[camera.follows]) for camera in world.cameras if camera.follows in rows]
        self._heights = [names.entity_path(names.HEIGHT_ROOT + _short(b.prim)) for b in world.bodies[:MAX_HEIGHT_PLOTS]]
        self._times: list[int] = []
        self._seconds: list[float] = []
        self._rows: list[tuple[Floats, ...]] = []
        self._causes: list[dict[str, Floats]] = []
        self._whole: list[dict[str, Floats]] = []
        self._contacts: list[Pushes] = []
        self._ties: list[Ties] = []
        self._bytes = 0

    def add(
        self,
        ns: int,
        t: float,
        rows: tuple[Floats, ...],
        causes: dict[str, Floats],
        whole: dict[str, Floats],
        contacts: Pushes | None,
        ties: Ties | None,
    ) -> None:
        """Keep one frame.

        Args:
            ns: Its time [ns],
            t: and as given [s].
            rows: (B, 7), (B, 6), (B, 3).
            causes: Columns of what pushed the bodies, (B, width).
            whole: Columns that a frame has once, (width,).
            contacts: What pairs of shapes gave each other.
            ties: What joints and cords gave.
        """
        self._times.append(ns)
        self._seconds.append(t)
        self._rows.append(rows)
        self._causes.append(causes)
        self._whole.append(whole)
        if contacts is not None:
            self._contacts.append(contacts)
            self._bytes += contacts.sums.nbytes
        if ties is not None:
            self._ties.append(ties)
        self._bytes += sum(row.nbytes for row in [*rows, *causes.values()])
        if len(self._times) >= CHUNK_ROWS or self._bytes >= CHUNK_BYTES:
            self.flush()

    def flush(self) -> None:
        """Write the frames that wait."""
        if not self._times:
            return
        # Bodies first, so that each body's rows are one contiguous block.
        q, qd, force = (np.stack(arrays, axis=1) for arrays in zip(*self._rows, strict=True))
        causes = {name: np.stack([each[name] for each in self._causes], axis=1) for name in self._causes[0]}
        index = names.time_column(self._times)
        for i, entity in enumerate(self._entities):
            own = [*_motion(qd[i], force[i]), *(names.column(name, array[i]) for name, array in causes.items())]
            self._stream.send_columns(entity, [index], [*_pose(q[i], self._nested[i]), *own], strict=True)
        for camera, i in self._followers:
            send_camera_poses(self._stream, camera, self._world, index, q[i])
        for i, entity in enumerate(self._heights):
            height = names.column(names.SCALARS, q[i, :, 2].astype(np.float64))
            self._stream.send_columns(entity, [index], [height], strict=True)
        if self._contacts:
            self._stream.send_columns(names.CONTACT_ENTITY, [index], columns_of(self._contacts), strict=True)
        # Last, so that a frame that the file knows of has all its bodies, even if the process is killed here.
        seconds = names.column(names.FRAME_TIME, np.array(self._seconds))
        whole = [names.column(name, np.stack([each[name] for each in self._whole])) for name in self._whole[0]]
        whole += columns_of_ties(self._ties, self._world) if self._ties else []
        self._stream.send_columns(names.FRAME_ENTITY, [index], [seconds, *whole], strict=True)
        self._times, self._seconds, self._rows, self._bytes = [], [], [], 0
        self._causes, self._whole, self._contacts, self._ties = [], [], [], []


def send_camera_poses(stream: Any, camera: Camera, world: World, index: Any, poses: Floats) -> None:
    """Send where a camera that follows is, by the poses of its body (F, 7) at an index of times."""
    seen_from = _pose(camera_poses(camera, world, poses), is_nested(camera.prim, world))
    stream.send_columns(names.entity_path(camera.prim), [index], seen_from, strict=True)


def _pose(q: Floats, nested: bool) -> list[Any]:
    # Poses are the world's: for a body below another, say so, or Rerun stacks the two.
    frame = {"parent_frame": [ROOT_FRAME] * len(q)} if nested else {}
    return list(rr.Transform3D.columns(translation=q[:, :3], quaternion=q[:, 3:], **frame))


class FluidBuffer:
    """The particles of one fluid."""

    def __init__(self, stream: Any, fluid: Fluid, world: World) -> None:
        self._stream = stream
        self._prim = fluid.prim
        self._count: int | None = None
        self._comes = False  # and goes: of some frames some particles are not in the world
        # Falling from the fluid's own height is fast: particles are drawn from its colour to foam over that range.
        gravity = float(np.linalg.norm(world.gravity))
        self._fast = max(float(np.sqrt(2.0 * gravity * fluid.size[2])), 0.1)
        self._palette = _palette(fluid.color)
        self._times: list[int] = []
        self._rows: list[Particles] = []
        self._bytes = 0

    def check(self, frame: FluidFrame) -> Particles:
        """Copies of a frame's arrays, and the numbers of its particles if some are not in the world.

        Raises:
            ValueError: If they do not fit together, their count changed, or some may be gone in some frames alone.
        """
        position = np.array(frame.position, dtype=np.float32)
        velocity = np.array(frame.velocity, dtype=np.float32)
        density = np.array(frame.density, dtype=np.float32)
        count = len(density) if density.ndim else 0
        for name, array, shape in (
            ("position", position, (count, 3)),
            ("velocity", velocity, (count, 3)),
            ("density", density, (count,)),
        ):
            if array.shape != shape:
                raise ValueError(f"frame: fluid {self._prim}: {name} has shape {array.shape}, expected {shape}")
        if self._count is not None and count != self._count:
            raise ValueError(
                f"frame: fluid {self._prim} has {count} particles, {self._count} before: "
                "their number must not change; park lost ones outside the scene"
            )
        if self._count is not None and self._comes != (frame.present is not None):
            raise ValueError(f"frame: fluid {self._prim}: `present` must be given in all frames, or in none")
        if frame.present is None:
            return position, velocity, density, None
        there = np.flatnonzero(frame.present)
        return position[there], velocity[there], density[there], there.astype(np.int32)

    def add(self, ns: int, frame: FluidFrame, checked: Particles) -> None:
        """Keep one frame of checked arrays."""
        self._count, self._comes = len(frame.density), frame.present is not None
        self._times.append(ns)
        self._rows.append(checked)
        self._bytes += sum(each.nbytes for each in checked if each is not None)
        if len(self._times) >= CHUNK_ROWS or self._bytes >= CHUNK_BYTES:
            self.flush()

    def flush(self) -> None:
        """Write the frames that wait."""
        if not self._times:
            return
        position, velocity, density = (np.concatenate([row[k] for row in self._rows]) for k in range(3))
        lengths = [len(row[2]) for row in self._rows]
        points = rr.Points3D.columns(positions=position, colors=self._colors(velocity)).partition(lengths)
        own = [
            names.column(names.PARTICLE_VELOCITY, velocity, lengths),
            names.column(names.PARTICLE_DENSITY, density, lengths),
        ]
        if self._comes:
            numbers = np.concatenate([row[3] for row in self._rows if row[3] is not None])
            own.append(names.column(names.PARTICLE_NUMBER, numbers, lengths))
        index = names.time_column(self._times)
        self._stream.send_columns(names.entity_path(self._prim), [index], [*points, *own], strict=True)
        self._times, self._rows, self._bytes = [], [], 0

    def _colors(self, velocity: Floats) -> NDArray[np.uint32]:
        speed = np.sqrt(np.einsum("ij,ij->i", velocity, velocity))
        level = np.nan_to_num(speed * ((COLOR_STEPS - 1) / self._fast), nan=COLOR_STEPS - 1, posinf=COLOR_STEPS - 1)
        return self._palette[np.minimum(level, COLOR_STEPS - 1).astype(np.intp)]


class CordBuffer:
    """The lines that draw a world's springs and ropes, in the world's frame; nothing reads them back but the viewer."""

    def __init__(self, stream: Any, world: World) -> None:
        self._stream = stream
        self._cords = world.cords
        self._bodies = {body.prim: i for i, body in enumerate(world.bodies)}
        self._times: list[int] = []
        self._lines: dict[str, list[list[Floats]]] = {cord.prim: [] for cord in self._cords}

    def add(self, ns: int, body_q: Floats) -> None:
        """Keep the lines of one frame [ns], from the poses of its bodies, (B, 7)."""
        if not self._cords:
            return
        self._times.append(ns)
        for cord in self._cords:
            held = {g.body: body_q[self._bodies[g.body]][None] for g in cord.path if g.body is not None}
            # Where a body of a run that went wrong is nowhere, as NaN is, its cords have no line.
            known = all(np.abs(pose).max() < FAR for pose in held.values())
            lines = cord_lines(cord, held, ZIGZAG, SLACK_PIECES) if known else []
            self._lines[cord.prim].append([line.points.astype(np.float32) for line in lines])
        if len(self._times) >= CHUNK_ROWS:
            self.flush()

    def flush(self) -> None:
        """Write the frames that wait."""
        if not self._times:
            return
        index = names.time_column(self._times)
        for prim, rows in self._lines.items():
            strips = rr.LineStrips3D.columns(strips=[points for row in rows for points in row])
            own = strips.partition([len(row) for row in rows])
            self._stream.send_columns(names.entity_path(prim), [index], [*own], strict=True)
            rows.clear()
        self._times = []


class RowBuffer:
    """Small rows of any entity: scalars, log lines, pictures. All rows of an entity have the same columns."""

    def __init__(self, stream: Any) -> None:
        self._stream = stream
        self._times: dict[tuple[str, str], list[int]] = defaultdict(list)
        self._values: dict[tuple[str, str], list[dict[str, Any]]] = defaultdict(list)
        self._bytes: dict[tuple[str, str], int] = defaultdict(int)

    def add(self, entity: str, ns: int, row: dict[str, Any]) -> None:
        """Keep one row: values by column."""
        # One prim may have both log lines and pictures: they go to chunks of their own.
        key = (entity, next(iter(row)))
        self._times[key].append(ns)
        self._values[key].append(row)
        self._bytes[key] += sum(value.nbytes for value in row.values() if isinstance(value, np.ndarray))
        if len(self._times[key]) >= CHUNK_ROWS or self._bytes[key] >= CHUNK_BYTES:
            self._flush(key)

    def flush(self) -> None:
        """Write the rows that wait."""
        for key in list(self._times):
            self._flush(key)

    def _flush(self, key: tuple[str, str]) -> None:
        times, rows = self._times.pop(key), self._values.pop(key)
        self._bytes.pop(key)
        if key[1] == names.IMAGE:
            columns = _jpeg_columns([row[names.IMAGE] for row in rows])
        elif key[1] == names.SEEN:
            columns = [names.column(names.SEEN, np.stack([row[names.SEEN] for row in rows]))]
        else:
            columns = [_row_column(name, [row[name] for row in rows]) for name in rows[0]]
        self._stream.send_columns(key[0], [names.time_column(times)], columns, strict=True)


def _motion(qd: Floats, force: Floats) -> list[Any]:
    return [
        names.column(names.LINEAR_VELOCITY, qd[:, :3]),
        names.column(names.ANGULAR_VELOCITY, qd[:, 3:]),
        names.column(names.CONTACT_FORCE, force),
    ]


def _palette(color: tuple[float, float, float]) -> NDArray[np.uint32]:
    """Colours from the fluid's own to foam, as Rerun packs them: 0xRRGGBBAA."""
    packed = []
    for mix in np.linspace(0.0, 0.85, COLOR_STEPS):
        blended = (1.0 - mix) * np.asarray(color) + mix * np.asarray(FOAM)
        r, g, b, a = rgba((blended[0], blended[1], blended[2]))
        packed.append((r << 24) | (g << 16) | (b << 8) | a)
    return np.array(packed, dtype=np.uint32)


def _jpeg_columns(blobs: list[NDArray[np.uint8]]) -> list[Any]:
    return list(rr.EncodedImage.columns(blob=blobs, media_type=["image/jpeg"] * len(blobs)))


def _row_column(name: str, values: list[Any]) -> Any:
    return names.column(name, values if isinstance(values[0], str) else np.asarray(values))


def _short(prim: str) -> str:
    """A prim's path without the stage's root, for the legend of a plot."""
    return prim.removeprefix("/World/")
