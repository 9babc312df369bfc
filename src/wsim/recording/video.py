"""Writes frames to an H.264 video that any browser plays."""

from __future__ import annotations

import math
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Iterable

    from numpy.typing import NDArray


def write_video(path: str | Path, frames: Iterable[NDArray[np.uint8]], fps: float, *, quality: int = 20) -> int:
    """Write an MP4: H.264, yuv420p, its index in front so that it plays while it loads.

    It is written to `<path>.partial` and renamed when it is whole. That pixel format halves the colour's size, so odd
    widths and heights get one more column or row, a copy of the last.

    Args:
        path: The video, e.g. "video.mp4".
        frames: Pictures (H, W, 3) uint8 RGB, all of one size; taken one at a time.
        fps: Frames a second.
        quality: x264's constant rate factor: 0 is lossless, 51 the worst.

    Returns:
        The number of frames.

    Raises:
        ValueError: There are no frames, one has another size or type, or `fps` is not a positive number.
    """
    import av

    if not (math.isfinite(fps) and fps > 0):
        raise ValueError(f"write_video: fps is {fps}, it must be a positive number")
    path = Path(path)
    partial = path.with_name(path.name + ".partial")
    path.parent.mkdir(parents=True, exist_ok=True)
    count = 0
    try:
        with av.open(str(partial), "w", format="mp4", options={"movflags": "+faststart"}) as container:
            stream: Any = None
            shape: tuple[int, ...] = ()
            for frame in frames:
                picture = _check(frame, count, shape)
                if stream is None:
                    shape = picture.shape
                    stream = _add_stream(container, shape, fps, quality)
                container.mux(stream.encode(av.VideoFrame.from_ndarray(_even(picture), format="rgb24")))
                count += 1
            if stream is None:
                raise ValueError(f"write_video: there are no frames for {path}")
            container.mux(stream.encode())  # what the encoder still holds
        partial.replace(path)
    finally:
        partial.unlink(missing_ok=True)
    return count


def _add_stream(container: Any, shape: tuple[int, ...], fps: float, quality: int) -> Any:
    rate = Fraction(fps).limit_denominator(1001)
    stream = container.add_stream("libx264", rate=rate, options={"crf": str(quality), "preset": "medium"})
    stream.height, stream.width = shape[0] + shape[0] % 2, shape[1] + shape[1] % 2
    stream.pix_fmt = "yuv420p"
    return stream


def _check(frame: NDArray[np.uint8], index: int, shape: tuple[int, ...]) -> NDArray[np.uint8]:
    if frame.ndim != 3 or frame.shape[2] != 3 or frame.dtype != np.uint8 or 0 in frame.shape:
        raise ValueError(f"write_video: frame {index} is {frame.shape} {frame.dtype}, expected (H, W, 3) uint8")
    if shape and frame.shape != shape:
        raise ValueError(f"write_video: frame {index} is {frame.shape}, the ones before {shape}")
    return frame


def _even(frame: NDArray[np.uint8]) -> NDArray[np.uint8]:
    height, width = frame.shape[:2]
    if height % 2 or width % 2:
        frame = np.pad(frame, ((0, height % 2), (0, width % 2), (0, 0)), mode="edge")
    return np.ascontiguousarray(frame)
