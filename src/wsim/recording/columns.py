"""The names of a recording's entities and columns, and numpy arrays as Rerun columns.

Writer and reader meet here: what one writes under a name, the other looks up by it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import pyarrow as pa
import rerun as rr

if TYPE_CHECKING:
    from collections.abc import Iterable

    from numpy.typing import NDArray

APPLICATION = "wsim"
TIMELINE = "sim_time"
FORMAT_VERSION = 1

PROPERTY = "wsim"  # the recording property that holds the world and the metadata
PROPERTY_ENTITY = "/__properties/wsim"
FRAME_ENTITY = "/frames"
SCALAR_ROOT = "/plots/"
HEIGHT_ROOT = "/heights/"
SENSOR_ROOT = "/sensors"  # before a sensor's prim; its channels below
LOG_ENTITY = "/log"

WORLD = "wsim.Recording:world"
METADATA = "wsim.Recording:metadata"
VIEWS = "wsim.Recording:views"
VERSION = "wsim.Recording:version"
FRAME_TIME = "wsim.Frame:time"
WALL_IMPULSE = "wsim.Frame:wall_impulse"
CONTACT_ENTITY = "/contacts"
WALL_ENTITY = "/walls"
CONTACT_PAIR = "wsim.Contact:pair"
CONTACT_SUMS = "wsim.Contact:sums"
JOINT_SUMS = "wsim.Frame:joints"
CORD_SUMS = "wsim.Frame:cords"
LINEAR_VELOCITY = "wsim.Body:linear_velocity"
ANGULAR_VELOCITY = "wsim.Body:angular_velocity"
CONTACT_FORCE = "wsim.Body:contact_force"
APPLIED = "wsim.Body:applied"  # impulse and work
APPLIED_TURN = "wsim.Body:applied_turn"  # angular impulse
LEAD = "wsim.Body:lead"  # momentum and angular momentum that velocities gained beside all impulses
CONTROLLED = "wsim.Body:controlled"  # impulse of control, which is part of the applied one
SCHEDULED = "wsim.Body:scheduled"  # impulse and angular impulse of schedules, which are part of the applied ones
SENSED = "wsim.Sensor:values"
SEGMENTATION = "wsim.Sensor:segmentation"  # a PNG
SEEN = "wsim.Camera:seen"
SEEN_OBJECTS = "wsim.Camera:objects"
PARTICLE_VELOCITY = "wsim.Fluid:velocity"
PARTICLE_DENSITY = "wsim.Fluid:density"
PARTICLE_NUMBER = "wsim.Fluid:number"
SOLID_PARTICLES = "wsim.Solid:particles"  # x, y, z, V
LOG_INDEX = "wsim.Log:index"
LOG_PRIM = "wsim.Log:prim"
# Rerun's own.
TRANSLATION = "Transform3D:translation"
QUATERNION = "Transform3D:quaternion"
POSITIONS = "Points3D:positions"
SCALARS = "Scalars:scalars"
LOG_TEXT = "TextLog:text"
LOG_LEVEL = "TextLog:level"
IMAGE = "EncodedImage:blob"
DEPTH_IMAGE = "EncodedDepthImage:blob"

# What the viewer knows Rerun's own columns by.
_BUILTIN = {
    SCALARS: ("rerun.archetypes.Scalars", "rerun.components.Scalar"),
    LOG_TEXT: ("rerun.archetypes.TextLog", "rerun.components.Text"),
    LOG_LEVEL: ("rerun.archetypes.TextLog", "rerun.components.TextLogLevel"),
}
LEVELS = ("TRACE", "DEBUG", "INFO", "WARN", "ERROR", "CRITICAL")


def nanoseconds(seconds: float) -> int:
    """A time as Rerun keeps it: whole nanoseconds, rounded (Rerun's own conversion truncates)."""
    return round(seconds * 1e9)


def entity_path(path: str) -> str:
    """A prim path or a slash-separated name as a Rerun entity path, its parts escaped."""
    return "/" + str(rr.new_entity_path([part for part in path.split("/") if part])).lstrip("/")


def time_column(times_ns: Iterable[int]) -> Any:
    """Times [ns] as an index column."""
    return rr.TimeColumn(TIMELINE, duration=np.asarray(list(times_ns), dtype="timedelta64[ns]"))


class _ArrowBatch:
    """An Arrow array as Rerun's component batch; its generic one takes no arrays of vectors."""

    def __init__(self, array: Any) -> None:
        self.array = array

    def as_arrow_array(self) -> Any:
        return self.array


def column(name: str, values: NDArray[Any] | list[str], lengths: list[int] | None = None) -> Any:
    """Values as a column called `name` ("archetype:field"), one value a row, or `lengths[i]` values in row i.

    Args:
        name: The column's name as the reader sees it.
        values: Array (n,) or (n, k), or strings. Bits are kept: no cast, no null for NaN.
        lengths: Values in each row; sums to n.
    """
    if isinstance(values, list):
        array = pa.array(values, pa.string())
    elif values.ndim == 2:
        array = pa.FixedSizeListArray.from_arrays(pa.array(np.ascontiguousarray(values).reshape(-1)), values.shape[1])
    else:
        array = pa.array(values)
    archetype, kind = _BUILTIN.get(name, (name.split(":")[0], None))
    descriptor = rr.ComponentDescriptor(name, archetype=archetype, component_type=kind)
    if lengths is None:
        return rr.ComponentColumn(descriptor, _ArrowBatch(array))
    return rr.ComponentColumn(descriptor, _ArrowBatch(array), lengths=lengths)


def log_level(level: str) -> str:
    """A log level in Rerun's words; any case, and Python's "warning".

    Raises:
        ValueError: The level is unknown.
    """
    name = {"WARNING": "WARN", "FATAL": "CRITICAL"}.get(level.upper(), level.upper())
    if name not in LEVELS:
        raise ValueError(f"log level {level!r} is unknown; use one of {', '.join(LEVELS)}")
    return name
