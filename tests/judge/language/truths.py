"""What is true of a motion to a few percent: claims to either side of the truth, and how a recording shows it."""

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from tests.judge.theory import ground, record
from wsim.importers.differences import velocities
from wsim.judge.evidence.evidence import Evidence
from wsim.judge.language import Signals
from wsim.recording.contacts import ContactTrack

NONE = (0.0, 0.0, 0.0)
Claims = Iterator[tuple[str, bool]]


@dataclass
class Motion:
    """Bodies whose places, velocities, rotations and rates at times (T,) are known, and claims about them."""

    bodies: list[Any]
    at: Callable[[np.ndarray], tuple[np.ndarray, ...]]  # (T, B, 3) place and velocity, (T, B, 4) and (T, B, 3)
    seconds: float
    claims: list[tuple[str, bool]]
    statics: list[Any] = field(default_factory=lambda: [ground()])
    gravity: bool = True
    joints: list[Any] = field(default_factory=list)
    blows: list[tuple[float, int, int, float]] = field(default_factory=list)  # time, two shapes, impulse on the second

    def seen(self, rate: float, own: bool, contacts: bool) -> Signals:
        """As a recording shows it: with velocities of its own, or poses alone; with contacts or without."""
        t = np.arange(math.floor(self.seconds * rate + 1e-9) + 1) / rate
        place, v, q, w = self.at(t)
        case = record(self.bodies, place, v, t, rotation=q, spin=w, statics=self.statics, joints=self.joints)
        if not self.gravity:
            case = replace(case, world=case.world.model_copy(update={"gravity": NONE}))
        if not own:
            moved = velocities(t, case.body_q.astype(np.float64), case.world)
            case = replace(case, body_qd=moved.astype(np.float32))
        if contacts and self.blows:
            seen = [blow for blow in self.blows if blow[0] < t[-1]]
            sums = np.zeros((len(seen), 16), np.float32)
            sums[:, 3] = [abs(blow[3]) for blow in seen]
            frames = np.searchsorted(t, [blow[0] for blow in seen]).astype(np.int32)
            pairs = np.array([blow[1:3] for blow in seen], np.int32).reshape(-1, 2)
            case = replace(case, contacts=ContactTrack(frames, pairs, sums))
        return Signals.of(Evidence(case))


def least(text: str, truth: float, unit: str = "", by: float = 0.03) -> Claims:
    """What is at least a number: `text` has a place {} for it."""
    yield text.format(f"{truth - by * abs(truth)} {unit}"), True
    yield text.format(f"{truth + by * abs(truth)} {unit}"), False


def most(text: str, truth: float, unit: str = "", by: float = 0.03) -> Claims:
    """What is at most a number."""
    return ((said, not holds) for said, holds in least(text, truth, unit, by))


def about(text: str, truth: float, unit: str = "", by: float = 0.03) -> Claims:
    """What is about a number, within as much: {} and {within}."""
    for off in (-1.0, 1.0):
        for room, holds in ((0.7, False), (1.3, True)):
            asked, within = truth + off * by * abs(truth), room * by * abs(truth)
            yield text.format(f"{asked} {unit}", within=f"{within} {unit}"), holds


def between(text: str, truth: float, unit: str = "", by: float = 0.03, size: float | None = None) -> Claims:
    """What is in a range: {} for both of its ends."""
    step = by * (abs(truth) if size is None else size)
    for low, high, holds in ((-1, 1, True), (1, 3, False), (-3, -1, False)):
        yield text.format(f"{truth + low * step} {unit}, {truth + high * step} {unit}"), holds


def still(t: np.ndarray, *places: Any) -> tuple[np.ndarray, ...]:
    """Bodies that neither move nor turn, and arrays to change."""
    place = np.tile(np.array(places, dtype=float), (len(t), 1, 1))
    q = np.zeros((*place.shape[:2], 4))
    q[..., 3] = 1.0
    return place, np.zeros_like(place), q, np.zeros_like(place)


def turn(axis: int, angle: np.ndarray) -> np.ndarray:
    q = np.zeros((*np.shape(angle), 4))
    q[..., axis], q[..., 3] = np.sin(np.asarray(angle) / 2), np.cos(np.asarray(angle) / 2)
    return q
