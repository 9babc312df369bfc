"""What happened in a world: written with the Rerun SDK, read back as arrays."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from wsim.recording.frames import FluidFrame, Frame, LogLine
    from wsim.recording.reader import FluidTrack, ImageTrack, Recording, read
    from wsim.recording.writer import RecordingWriter

__all__ = ["FluidFrame", "FluidTrack", "Frame", "ImageTrack", "LogLine", "Recording", "RecordingWriter", "read"]

_HOMES = {
    "FluidFrame": "frames",
    "Frame": "frames",
    "LogLine": "frames",
    "FluidTrack": "reader",
    "ImageTrack": "reader",
    "Recording": "reader",
    "read": "reader",
    "RecordingWriter": "writer",
}


def __getattr__(name: str) -> object:
    """Load the names above when they are first used, so that importing the package costs nothing."""
    if name in _HOMES:
        from importlib import import_module

        return getattr(import_module(f"wsim.recording.{_HOMES[name]}"), name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
