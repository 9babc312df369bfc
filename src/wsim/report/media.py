"""Video and pictures, inlined."""

from __future__ import annotations

import base64
import io
import re
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from PIL import Image, ImageDraw

from wsim.report.locate import camera_then, ring_of, where_is
from wsim.report.numbers import quantity

if TYPE_CHECKING:
    from wsim.judge.verdict import Finding
    from wsim.recording import Recording

MOST_VIDEO_BYTES = 20_000_000  # a larger video is linked, not inlined
MOST_STILLS = 36
STILL_WIDTH = 480  # [px]
STILL_QUALITY = 80
LEAST_RING = 12  # [px]
RING = (220, 38, 38)  # red
FINE = 4  # the ring is drawn this many times as large, then reduced: smooth edges
STILL_NAME = re.compile(r"(?P<camera>.+)_(?P<time>[0-9]+\.?[0-9]*)s")


@dataclass(frozen=True)
class Video:
    """Where the page's video element finds its video."""

    src: str
    inlined: bool
    size: str  # for a person


@dataclass(frozen=True)
class Picture:
    """A small JPEG with what it shows."""

    src: str
    caption: str
    width: int
    height: int


def find_video(folder: Path, root: Path, most_bytes: int) -> Video | None:
    """The video of an iteration: as data if it is small enough, else as a link from the run's folder."""
    path = folder / "video.mp4"
    if not path.is_file() or not (count := path.stat().st_size):
        return None
    size = quantity(count / 1e6, "MB")
    if count > most_bytes:
        return Video(path.relative_to(root).as_posix(), False, size)
    return Video(_data("video/mp4", path.read_bytes()), True, size)


def find_stills(folder: Path) -> list[Picture]:
    """Thumbnails of an iteration's stills, by camera, then by time."""
    paths = sorted((folder / "frames").glob("*.png"), key=_still_order)
    pictures = [_thumbnail(path.read_bytes(), _still_caption(path)) for path in paths[:MOST_STILLS]]
    return [picture for picture in pictures if picture]


def find_reference(root: Path) -> Picture | None:
    """The picture that the world was to look like, if the run was given one."""
    path = root / "reference.jpg"
    return _thumbnail(path.read_bytes(), "the reference picture") if path.is_file() else None


def find_moment(recording: Recording, finding: Finding) -> Picture | None:
    """The picture nearest to a finding's time, its prim ringed, by the first camera that has the prim in view."""
    cameras = [camera for camera in recording.world.cameras if len(recording.images.get(camera.prim, ()))]
    if not cameras or finding.time is None:
        return None
    ball = where_is(recording, finding.prim, finding.time)
    there = [camera_then(recording, camera, finding.time) for camera in cameras]
    rings = [ring_of(camera, *ball) if ball is not None else None for camera in there]
    camera, ring = next(((c, r) for c, r in zip(cameras, rings, strict=True) if r is not None), (cameras[0], None))
    track = recording.images[camera.prim]
    nearest = min(range(len(track)), key=lambda k: abs(float(track.time[k]) - float(finding.time or 0.0)))
    caption = f"{camera.prim.rsplit('/', 1)[-1]} at {quantity(float(track.time[nearest]), 's')}"
    if ball is not None and ring is None:
        caption += ": no camera has it in view"
    return _thumbnail(track.jpeg(nearest), caption, ring)


def _still_order(path: Path) -> tuple[str, float, str]:
    match = STILL_NAME.fullmatch(path.stem)
    return (match["camera"], float(match["time"]), path.stem) if match else ("~", 0.0, path.stem)


def _still_caption(path: Path) -> str:
    match = STILL_NAME.fullmatch(path.stem)
    return f"{match['camera']} at {quantity(float(match['time']), 's')}" if match else path.stem


def _thumbnail(data: bytes, caption: str, ring: tuple[float, float, float] | None = None) -> Picture | None:
    """A picture made small, with a ring (x, y, radius) in widths of the picture; None if it cannot be decoded."""
    try:
        with Image.open(io.BytesIO(data)) as picture:
            image = picture.convert("RGB")
    except (OSError, ValueError, SyntaxError, Image.DecompressionBombError):
        return None
    if image.width > STILL_WIDTH:
        size = STILL_WIDTH, max(1, round(image.height * STILL_WIDTH / image.width))
        image = image.resize(size, Image.Resampling.BOX)
    if ring is not None:
        x, y, radius = (round(part * image.width) for part in ring)
        _draw_ring(image, (x, y), max(LEAST_RING, radius))
    jpeg = io.BytesIO()
    image.save(jpeg, "JPEG", quality=STILL_QUALITY)
    return Picture(_data("image/jpeg", jpeg.getvalue()), caption, image.width, image.height)


def _draw_ring(image: Image.Image, center: tuple[int, int], radius: int) -> None:
    mask = Image.new("L", (image.width * FINE, image.height * FINE))
    middle = ((center[0] + 0.5) * FINE, (center[1] + 0.5) * FINE)
    ImageDraw.Draw(mask).circle(middle, (radius + 1) * FINE, outline=255, width=3 * FINE)
    image.paste(RING, mask=mask.reduce(FINE))


def _data(kind: str, data: bytes) -> str:
    return f"data:{kind};base64,{base64.b64encode(data).decode('ascii')}"
