"""When the events of schedules came, by what bodies did."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from wsim.judge.evidence.joints import track_of
from wsim.judge.evidence.scheduled import begin_of
from wsim.recording.contacts import shapes_of
from wsim.scene.contact import within

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsim.judge.evidence.recorded import Recorded
    from wsim.scene.world import Event

    Floats = NDArray[np.float64]
    Span = tuple[float, float]


def came(evidence: Recorded, event: Event) -> Span | None:
    """The earliest and the latest that an event can have come first [s]; None where it did not."""
    if event.kind in ("start", "end"):
        other = next(each for each in evidence.world.schedules if each.prim == event.first)
        begin = begin_of(evidence, other)
        if begin is None:
            return None
        key = begin + other.times[0 if event.kind == "start" else -1]
        return key, key
    if event.kind == "touch":
        return _touched(evidence, event.first, event.second or "")
    if event.kind == "place":
        place = evidence.body_q[:, evidence.index(event.first), "XYZ".index(event.axis or "X")]
        speed = evidence.body_qd[:, evidence.index(event.first), :3]
        return _passed(evidence.time, place, event, np.linalg.norm(speed, axis=1))
    joint = next(each for each in evidence.world.joints if each.prim == event.first)
    track = track_of(evidence, joint)
    return None if track is None else _passed(evidence.time, track.position, event, np.zeros(len(evidence.time)))


def _passed(time: Floats, place: Floats, event: Event, speed: Floats) -> Span | None:
    """Within the interval in which it is beyond first; it may have been so, and back, in one before."""
    beyond = (1.0 if event.above else -1.0) * (place - event.value)
    rounding = 1e-6 * max(1.0, abs(event.value))
    there = np.flatnonzero(beyond >= -rounding)
    if not len(there):
        return None
    k = int(there[0])
    if k == 0:
        return float(time[0]), float(time[0])
    share = float(np.clip(-beyond[k - 1] / max(beyond[k] - beyond[k - 1], 1e-30), 0.0, 1.0))
    h = float(time[k] - time[k - 1])
    at = float(time[k - 1]) + share * h
    # Its speed may change within the interval: by an eighth of h a of the way at most, a by the change of its steps.
    change = np.abs(np.diff(beyond, n=2, prepend=[beyond[0], beyond[0]]))
    bend = 0.25 * float(change[max(k - 1, 0) : k + 2].max()) / max(float(beyond[k] - beyond[k - 1]), 1e-30) * h
    early, late = max(at - bend, float(time[k - 1])), min(at + bend, float(time[k]))
    return early, late


def _touched(evidence: Recorded, one: str, other: str) -> Span | None:
    """Within the interval in which both are first recorded to press on each other."""
    track = evidence.recording.contacts
    if track is None:
        return _may_touch(evidence, one, other)
    shapes = shapes_of(evidence.world)
    is_one, is_other = (np.array([within(shape.prim, prim) for shape in shapes], dtype=bool) for prim in (one, other))
    a, b = track.pair[:, 0], track.pair[:, 1]
    ours = (is_one[a] & is_other[b]) | (is_other[a] & is_one[b])
    if not ours.any():
        return None
    k = int(track.frame[ours].min())
    return float(evidence.time[max(k - 1, 0)]), float(evidence.time[k])


def _may_touch(evidence: Recorded, one: str, other: str) -> Span | None:
    """Where contacts are not recorded: from the first frame to the last at which a body of both is pressed on."""
    rows = [i for i, body in enumerate(evidence.world.bodies) if within(body.prim, one) or within(body.prim, other)]
    pressed = np.flatnonzero((evidence.recording.contact_force[:, rows] != 0.0).any(axis=(1, 2)))
    return (float(evidence.time[0]), float(evidence.time[-1])) if len(pressed) else None
