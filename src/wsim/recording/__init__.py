"""What happened in a world: written with the Rerun SDK, which takes a second to load, and read back as arrays."""

from __future__ import annotations

from typing import TYPE_CHECKING

from wsim.door import door

if TYPE_CHECKING:
    from wsim.recording.frames import FluidFrame, Frame, LogLine
    from wsim.recording.reader import read
    from wsim.recording.recording import FluidTrack, ImageTrack, Recording
    from wsim.recording.writer import RecordingWriter

__all__ = ["FluidFrame", "FluidTrack", "Frame", "ImageTrack", "LogLine", "Recording", "RecordingWriter", "read"]

__getattr__ = door(
    __name__,
    {
        "FluidFrame": "frames",
        "Frame": "frames",
        "LogLine": "frames",
        "FluidTrack": "recording",
        "ImageTrack": "recording",
        "Recording": "recording",
        "read": "reader",
        "RecordingWriter": "writer",
    },
)
