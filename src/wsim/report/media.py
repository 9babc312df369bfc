"""Video and pictures, inlined."""

from __future__ import annotations

import base64
import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from wsim.report.numbers import quantity

if TYPE_CHECKING:
    from wsim.judge.verdict import Finding
    from wsim.recording import Recording

MOST_VIDEO_BYTES = 20_000_000  # a larger video is linked, not inlined
MOST_STILLS = 36
MOST_MOMENTS = 6
STILL_WIDTH = 480  # [px]
STILL_QUALITY = 80
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


def find_moments(recording: Recording, findings: Sequence[Finding]) -> list[Picture | None]:
    """For each finding what the recording's first camera saw at its time, if it saw anything; for the first few."""
    tracks = [(camera, track) for camera, track in recording.images.items() if len(track)]
    if not tracks:
        return [None] * len(findings)
    camera, track = tracks[0]
    moments: list[Picture | None] = []
    for i, finding in enumerate(findings):
        if i >= MOST_MOMENTS or finding.time is None:
            moments.append(None)
            continue
        nearest = min(range(len(track)), key=lambda k: abs(float(track.time[k]) - float(finding.time or 0.0)))
        caption = f"{camera.rsplit('/', 1)[-1]} at {quantity(float(track.time[nearest]), 's')}"
        moments.append(_thumbnail(track.jpeg(nearest), caption))
    return moments


def _still_order(path: Path) -> tuple[str, float, str]:
    match = STILL_NAME.fullmatch(path.stem)
    return (match["camera"], float(match["time"]), path.stem) if match else ("~", 0.0, path.stem)


def _still_caption(path: Path) -> str:
    match = STILL_NAME.fullmatch(path.stem)
    return f"{match['camera']} at {quantity(float(match['time']), 's')}" if match else path.stem


def _thumbnail(data: bytes, caption: str) -> Picture | None:
    """A picture made small; None if it cannot be decoded."""
    import cv2
    import numpy as np

    image: Any = cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_COLOR) if data else None
    if image is None:
        return None
    height, width = image.shape[:2]
    if width > STILL_WIDTH:
        width, height = STILL_WIDTH, max(1, round(height * STILL_WIDTH / width))
        image = cv2.resize(image, (width, height), interpolation=cv2.INTER_AREA)
    _, jpeg = cv2.imencode(".jpg", image, [cv2.IMWRITE_JPEG_QUALITY, STILL_QUALITY])
    return Picture(_data("image/jpeg", jpeg.tobytes()), caption, width, height)


def _data(kind: str, data: bytes) -> str:
    return f"data:{kind};base64,{base64.b64encode(data).decode('ascii')}"
