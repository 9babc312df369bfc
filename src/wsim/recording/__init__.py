"""What happened in a world: written with the Rerun SDK, which takes a second to load, and read back as arrays."""

from __future__ import annotations

from typing import TYPE_CHECKING

from wsim.door import door

if TYPE_CHECKING:
    from wsim.recording.display import has_display
    from wsim.recording.frames import FluidFrame, Frame, LogLine
    from wsim.recording.kept import keeping, read_and_keep, read_kept
    from wsim.recording.reader import read, read_world
    from wsim.recording.recording import FluidTrack, ImageTrack, Recording
    from wsim.recording.view import open_native, serve_web
    from wsim.recording.writer import RecordingWriter

__all__ = [
    "FluidFrame",
    "FluidTrack",
    "Frame",
    "ImageTrack",
    "LogLine",
    "Recording",
    "RecordingWriter",
    "has_display",
    "keeping",
    "open_native",
    "read",
    "read_and_keep",
    "read_kept",
    "read_world",
    "serve_web",
]

__getattr__ = door(
    __name__,
    {
        "FluidFrame": "frames",
        "Frame": "frames",
        "LogLine": "frames",
        "FluidTrack": "recording",
        "ImageTrack": "recording",
        "Recording": "recording",
        "has_display": "display",
        "open_native": "view",
        "keeping": "kept",
        "read_and_keep": "kept",
        "read_kept": "kept",
        "read": "reader",
        "read_world": "reader",
        "serve_web": "view",
        "RecordingWriter": "writer",
    },
)
