"""Writes frames to an H.264 video that any browser plays, and reads them back."""

from __future__ import annotations

import math
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING, Any

import av
import numpy as np

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator
    from types import TracebackType

    from numpy.typing import NDArray


class VideoWriter:
    """Writes an MP4 a frame at a time: H.264, yuv420p, its index in front so that it plays while it loads.

    It is written to `<path>.partial` and renamed when it is closed. Used as a context manager it closes itself; after
    an exception nothing is left of it. That pixel format halves the colour's size, so odd widths and heights get one
    more column or row, a copy of the last.

    Args:
        path: The video, e.g. "video.mp4". Its folder is made.
        fps: Frames a second.
        quality: x264's constant rate factor: 0 is lossless, 51 the worst.

    Raises:
        ValueError: `fps` is not a positive number.
    """

    def __init__(self, path: str | Path, fps: float, *, quality: int = 20) -> None:
        if not (math.isfinite(fps) and fps > 0):
            raise ValueError(f"video: fps is {fps}, it must be a positive number")
        self.path = Path(path)
        self.partial_path = self.path.with_name(self.path.name + ".partial")
        self.fps = fps
        self.quality = quality
        self.frame_count = 0
        self._shape: tuple[int, ...] = ()
        self._container: Any = None
        self._stream: Any = None
        self._closed = False

    def write(self, frame: NDArray[np.uint8]) -> None:
        """Add a picture (H, W, 3) uint8 RGB; all have the size of the first.

        Raises:
            ValueError: It has another size or type, or the video is closed.
        """
        if self._closed:
            raise ValueError(f"{self.path} is closed; nothing more can be written")
        if frame.ndim != 3 or frame.shape[2] != 3 or frame.dtype != np.uint8 or 0 in frame.shape:
            raise ValueError(
                f"video: frame {self.frame_count} is {frame.shape} {frame.dtype}, expected (H, W, 3) uint8"
            )
        if self._shape and frame.shape != self._shape:
            raise ValueError(f"video: frame {self.frame_count} is {frame.shape}, the ones before {self._shape}")
        if self._stream is None:
            self._open(frame.shape)
        self._container.mux(self._stream.encode(av.VideoFrame.from_ndarray(_even(frame), format="rgb24")))
        self.frame_count += 1

    def close(self) -> int:
        """Finish the video and give it its name; one without frames leaves no file. Closing twice is fine.

        Returns:
            The number of frames.
        """
        if not self._closed:
            self._closed = True
            if self._container is not None:
                try:
                    self._container.mux(self._stream.encode())  # what the encoder still holds
                finally:
                    self._container.close()
                self.partial_path.replace(self.path)
        return self.frame_count

    def discard(self) -> None:
        """Give up: remove what was written."""
        self._closed = True
        if self._container is not None:
            self._container.close()
        self.partial_path.unlink(missing_ok=True)

    def __enter__(self) -> VideoWriter:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if error is None:
            self.close()
        else:
            self.discard()

    def _open(self, shape: tuple[int, ...]) -> None:
        self.path.parent.mkdir(parents=True, exist_ok=True)
        self._shape = shape
        self._container = av.open(str(self.partial_path), "w", format="mp4", options={"movflags": "+faststart"})
        rate = Fraction(self.fps).limit_denominator(1001)
        options = {"crf": str(self.quality), "preset": "medium"}
        self._stream = self._container.add_stream("libx264", rate=rate, options=options)
        self._stream.height, self._stream.width = shape[0] + shape[0] % 2, shape[1] + shape[1] % 2
        self._stream.pix_fmt = "yuv420p"


def write_video(path: str | Path, frames: Iterable[NDArray[np.uint8]], fps: float, *, quality: int = 20) -> int:
    """Write a whole video, as `VideoWriter` does, taking its frames one at a time.

    Returns:
        The number of frames.

    Raises:
        ValueError: There are no frames, one has another size or type, or `fps` is not a positive number.
    """
    with VideoWriter(path, fps, quality=quality) as video:
        for frame in frames:
            video.write(frame)
        if not video.frame_count:
            raise ValueError(f"video: there are no frames for {path}")
    return video.frame_count


def read_video(path: str | Path, most: int) -> Iterator[tuple[float, NDArray[np.uint8]]]:
    """Frames of a video, evenly over it, the first and the last among them.

    Args:
        path: The video.
        most: How many at the most; 2 or more.

    Yields:
        Time [s] and picture (H, W, 3) uint8 RGB.
    """
    with av.open(str(path)) as container:
        stream = container.streams.video[0]
        last = stream.frames - 1
        wanted = {round(k * last / (most - 1)) for k in range(most)}
        for k, frame in enumerate(container.decode(stream)):
            if k in wanted:
                yield float(k / stream.average_rate), frame.to_ndarray(format="rgb24")


def _even(frame: NDArray[np.uint8]) -> NDArray[np.uint8]:
    height, width = frame.shape[:2]
    if height % 2 or width % 2:
        frame = np.pad(frame, ((0, height % 2), (0, width % 2), (0, 0)), mode="edge")
    return np.ascontiguousarray(frame)
