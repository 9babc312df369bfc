"""What cameras that are sensors told, in a recording: compressed pictures, as many as a file can bear.

Colour is JPEG. Depth is a PNG of 16 bits in steps of `farthest` / 65534, 0 where it is infinite; segmentation is a PNG
of 16 bits of the labels' numbers. Of all pictures the recording has those that are far enough apart.
"""

from __future__ import annotations

import io
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
import rerun as rr
from PIL import Image

from wsim.recording import columns as names
from wsim.scene.labels import labels_of
from wsim.scene.world_sensors import SensorCamera

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsim.recording.table import Table
    from wsim.scene.world import World

MOST_PICTURES = 600  # of a sensor in a file
JPEG_QUALITY = 90
DEPTHS = 65534  # steps of depth: with 0 for what is infinite they fill 16 bits
MOST_OBJECTS = 65535  # of segmentation: 0 is nothing
CHUNK_BYTES = 4 * 1024 * 1024
COLUMNS = {"color": names.IMAGE, "depth": names.DEPTH_IMAGE, "segmentation": names.SEGMENTATION}
_TYPES = {"color": np.uint8, "depth": np.float32, "segmentation": np.int32}


class Pictures(Mapping[str, "NDArray[Any]"]):
    """The channels of one sensor's S pictures, each decoded when it is asked for.

    `color` (S, H, W, 3) uint8, `depth` (S, H, W) float32 [m], `segmentation` (S, H, W) int32.
    """

    def __init__(self, sensor: SensorCamera, blobs: Mapping[str, list[NDArray[np.uint8]]]) -> None:
        self._sensor, self._blobs = sensor, blobs

    def __getitem__(self, channel: str) -> NDArray[Any]:
        shape = self._sensor.channels[channel]
        pictures = [_decoded(self._sensor, channel, blob) for blob in self._blobs[channel]]
        return np.stack(pictures) if pictures else np.zeros((0, *shape), _TYPES[channel])

    def __iter__(self) -> Iterator[str]:
        return iter(self._sensor.channels)

    def __len__(self) -> int:
        return len(self._sensor.channels)


class PictureBuffer:
    """The pictures of one sensor that a file can bear, until there are enough of them to write.

    Args:
        stream: Rerun's.
        sensor: Which one.
        world: That it is in: no more pictures are kept than it has frames, nor than `MOST_PICTURES`.
        entities: Of each channel.

    Raises:
        ValueError: Of more objects than 16 bits number.
    """

    def __init__(self, stream: Any, sensor: SensorCamera, world: World, entities: Mapping[str, str]) -> None:
        self._stream, self._sensor, self._entities = stream, sensor, entities
        frames = max(1.0, world.frame_rate * world.duration)
        self._apart = round(1e9 * world.duration / min(MOST_PICTURES, frames)) - 1000  # [ns], to the clock's rounding
        self._next = self._bytes = 0
        self._times: list[int] = []
        self._blobs: dict[str, list[NDArray[np.uint8]]] = {channel: [] for channel in sensor.channels}
        objects = len(labels_of(world)) - 1
        if "segmentation" in entities and objects > MOST_OBJECTS:
            raise ValueError(f"{sensor.prim}: segmentation of {objects} objects; at most {MOST_OBJECTS} have numbers")
        if "depth" in entities:
            scale = rr.EncodedDepthImage.from_fields(media_type="image/png", meter=DEPTHS / sensor.farthest)
            stream.log(entities["depth"], scale, static=True, strict=True)

    def add(self, ns: int, sample: Mapping[str, NDArray[Any]]) -> None:
        """Take one sample [ns], of checked shapes."""
        if ns >= self._next:
            self._next = ns + self._apart
            self._times.append(ns)
            for channel, picture in sample.items():
                blob = np.frombuffer(_encoded(self._sensor, channel, picture), np.uint8)
                self._blobs[channel].append(blob)
                self._bytes += len(blob)
        if self._bytes >= CHUNK_BYTES:
            self.flush()

    def flush(self) -> None:
        """Write the pictures that wait."""
        if not self._times:
            return
        index = names.time_column(self._times)
        for channel, blobs in self._blobs.items():
            self._stream.send_columns(self._entities[channel], [index], _columns(channel, blobs), strict=True)
        self._times, self._bytes, self._blobs = [], 0, {channel: [] for channel in self._blobs}


def _columns(channel: str, blobs: list[NDArray[np.uint8]]) -> list[Any]:
    if channel == "color":
        return list(rr.EncodedImage.columns(blob=blobs, media_type=["image/jpeg"] * len(blobs)))
    if channel == "depth":
        return list(rr.EncodedDepthImage.columns(blob=blobs))
    return [names.column(names.SEGMENTATION, np.concatenate(blobs), [len(blob) for blob in blobs])]


def read_pictures(
    table: Table, sensor: SensorCamera, entities: Mapping[str, str]
) -> tuple[NDArray[np.int64], Pictures]:
    """Times [ns] and pictures of a sensor."""
    cells = {channel: table.cells(entities[channel], COLUMNS[channel]) for channel in sensor.channels}
    count = min(len(ns) for ns, _ in cells.values())  # of a run that was killed a channel may lack the last ones
    blobs = {
        channel: [(cell if channel == "segmentation" else cell[0].values).to_numpy() for cell in found[:count]]
        for channel, (_, found) in cells.items()
    }
    return next(iter(cells.values()))[0][:count], Pictures(sensor, blobs)


def _encoded(sensor: SensorCamera, channel: str, picture: NDArray[Any]) -> bytes:
    out = io.BytesIO()
    if channel == "color":
        Image.fromarray(picture.astype(np.uint8)).save(out, "JPEG", quality=JPEG_QUALITY)
        return out.getvalue()
    steps = picture
    if channel == "depth":
        met = np.isfinite(picture)
        steps = np.where(met, np.maximum(np.rint(np.where(met, picture, 0.0) / sensor.farthest * DEPTHS), 1.0), 0.0)
    Image.fromarray(steps.astype(np.uint16)).save(out, "PNG", compress_level=1)
    return out.getvalue()


def _decoded(sensor: SensorCamera, channel: str, blob: NDArray[np.uint8]) -> NDArray[Any]:
    picture = np.asarray(Image.open(io.BytesIO(blob.tobytes())))
    if channel == "depth":
        return np.where(picture > 0, picture * np.float32(sensor.farthest / DEPTHS), np.float32(np.inf)).astype(
            np.float32
        )
    return picture.astype(_TYPES[channel])
