"""What sensors told, in a recording: a line for each number of a channel, at the times of the samples."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import rerun as rr

from wsim.recording import columns as names
from wsim.recording.sensor_pictures import PictureBuffer, read_pictures
from wsim.scene.labels import labels_of
from wsim.scene.world_sensors import SensorCamera

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsim.recording.table import Clock, Table
    from wsim.scene.world import World
    from wsim.scene.world_sensors import Sensor

    Times = NDArray[np.float64]

ROWS = 1024  # of a channel that wait in memory
CHUNK_BYTES = 4 * 1024 * 1024
MOST_LINES = 32  # of a channel, in a plot


@dataclass(frozen=True, eq=False)
class SensorTrack:
    """One sensor through time, S samples at its own rate."""

    time: Times  # (S,) [s]
    channels: Mapping[str, NDArray[Any]]  # by name, (S, ...) of the shape that `World.sensors` says
    labels: Sequence[str] = ()  # of a camera: prims of the objects by the number that its segmentation has for them

    def __getitem__(self, channel: str) -> NDArray[Any]:
        """One of its channels; KeyError naming those there are."""
        if channel not in self.channels:
            raise KeyError(f"no channel {channel!r}; the sensor tells {list(self.channels)}")
        return self.channels[channel]


class SensorBuffer:
    """The samples of all sensors, until there are enough of them to write."""

    def __init__(self, stream: Any, world: World) -> None:
        self._stream = stream
        self._shapes = {sensor.prim: sensor.channels for sensor in world.sensors}
        self._times: dict[str, list[int]] = {prim: [] for prim in self._shapes}
        self._rows: dict[tuple[str, str], list[Times]] = {}
        self._points: dict[str, list[NDArray[np.float32]]] = {}
        self._pictures = {
            sensor.prim: PictureBuffer(stream, sensor, world, _entities(sensor))
            for sensor in world.sensors
            if isinstance(sensor, SensorCamera)
        }

    def add(self, ns: int, prim: str, sample: Mapping[str, NDArray[Any]], points: NDArray[Any] | None = None) -> None:
        """Keep one sample [ns], and points in the world [m] that are drawn for it, (n, 3).

        Raises:
            ValueError: If the world has no such sensor, or it tells something else.
        """
        if prim not in self._shapes:
            raise ValueError(f"sample: no sensor {prim!r}; the world has {sorted(self._shapes)}")
        told = {name: np.shape(part) for name, part in sample.items()}
        if told != self._shapes[prim]:
            raise ValueError(f"sample of {prim}: it has {told}, the world says {self._shapes[prim]}")
        if prim in self._pictures:
            self._pictures[prim].add(ns, sample)
            return
        given = {name: np.array(part, dtype=np.float64) for name, part in sample.items()}
        self._times[prim].append(ns)
        for name, part in given.items():
            self._rows.setdefault((prim, name), []).append(part.reshape(-1))
        if points is not None:
            self._points.setdefault(prim, []).append(np.array(points, dtype=np.float32))
        size = sum(part.nbytes for part in given.values())
        if len(self._times[prim]) >= min(ROWS, 1 + CHUNK_BYTES // size):
            self._flush(prim)

    def flush(self) -> None:
        """Write the samples that wait."""
        for prim in self._shapes:
            self._flush(prim)
        for pictures in self._pictures.values():
            pictures.flush()

    def _flush(self, prim: str) -> None:
        if not self._times[prim]:
            return
        index = names.time_column(self._times[prim])
        if drawn := self._points.pop(prim, None):
            cloud = rr.Points3D.columns(positions=np.concatenate(drawn)).partition([len(each) for each in drawn])
            self._stream.send_columns(names.entity_path(prim), [index], [*cloud], strict=True)
        for name, shape in self._shapes[prim].items():
            rows = self._rows.pop((prim, name))
            column = names.column(column_of(shape), np.concatenate(rows), [len(row) for row in rows])
            self._stream.send_columns(entity_of(prim, name), [index], [column], strict=True)
        self._times[prim] = []


def column_of(shape: tuple[int, ...]) -> str:
    """The column of a channel of this shape: what would be too many lines for a plot is none."""
    return names.SCALARS if math.prod(shape) <= MOST_LINES else names.SENSED


def entity_of(prim: str, channel: str) -> str:
    """The entity of a sensor's channel."""
    return names.entity_path(f"{names.SENSOR_ROOT}{prim}/{channel}")


def _entities(sensor: Sensor) -> dict[str, str]:
    return {channel: entity_of(sensor.prim, channel) for channel in sensor.channels}


def read_sensors(table: Table, world: World, clock: Clock) -> dict[str, SensorTrack]:
    """The tracks of a world's sensors, by prim."""
    found = {}
    for sensor in world.sensors:
        if isinstance(sensor, SensorCamera):
            ns, pictures = read_pictures(table, sensor, _entities(sensor))
            found[sensor.prim] = SensorTrack(clock.seconds(ns), pictures, labels_of(world))
            continue
        columns = {
            name: table.get(entity_of(sensor.prim, name), column_of(shape), shape, np.float64)
            for name, shape in sensor.channels.items()
        }
        # Of a run that was killed a channel may lack the last samples.
        count = min(len(ns) for ns, _ in columns.values())
        ns = next(iter(columns.values()))[0][:count]
        found[sensor.prim] = SensorTrack(
            clock.seconds(ns), {name: value[:count] for name, (_, value) in columns.items()}
        )
    return found
