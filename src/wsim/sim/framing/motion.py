"""How a world moved, as far as pictures need it."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from wsim.recording.recording import with_company

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from wsim.recording import Recording
    from wsim.recording.frames import Frame

Array = np.ndarray
SOME = 100  # particles of a fluid that stand for all of it


@dataclass(frozen=True)
class Motion:
    """Frames at which every number is finite: those from the first that has one which is not are left out.

    Attributes:
        time: (F,) [s].
        body_q: (F, B, 7) [x y z qx qy qz qw], world, in the order of the world's bodies.
        speed: (F, B) of the centres of mass [m/s].
        force: (F, B) that contacts push with [N].
        fluids: Some of each fluid's particles, (F, n, 3) [m], by prim.
        push: (F, B, 3) impulse that control gave each body since the frame before [N s]; None: there was none.
    """

    time: Array
    body_q: Array
    speed: Array
    force: Array
    fluids: Mapping[str, Array] = field(default_factory=dict)
    push: Array | None = None

    @classmethod
    def of(cls, recording: Recording) -> Motion:
        """A recording's; of a fluid, at each frame, the particles of the nearest time at which they were recorded."""
        time = np.asarray(recording.time)
        fluids = {}
        for prim, track in recording.fluids.items():
            if len(track.time):
                at = np.abs(track.time[None] - time[:, None]).argmin(axis=1)
                some = _some(track.position.shape[1])
                there = None if track.present is None else track.present[at, some]
                fluids[prim] = with_company(np.asarray(track.position[:, some])[at], there)
        return _finite(
            time, recording.body_q, recording.body_qd, recording.contact_force, fluids, recording.control_impulse
        )


class MotionLog:
    """Takes a run's frames, and gives its motion when it has ended."""

    def __init__(self) -> None:
        self._times: list[float] = []
        self._frames: list[tuple[Array, Array, Array]] = []
        self._fluids: dict[str, list[Array]] = {}
        self._present: dict[str, list[Array]] = {}
        self._pushes: list[Array] = []

    def add(self, time: float, frame: Frame) -> None:
        """Keep what was measured at a time [s]."""
        self._times.append(time)
        self._frames.append((frame.body_q, frame.body_qd, frame.contact_force))
        if frame.control_impulse is not None:
            self._pushes.append(frame.control_impulse)
        for prim, fluid in frame.fluids.items():
            some = fluid.position[_some(len(fluid.position))]
            self._fluids.setdefault(prim, []).append(np.array(some, dtype=np.float32))
            if fluid.present is not None:
                self._present.setdefault(prim, []).append(fluid.present[_some(len(fluid.position))])

    def motion(self) -> Motion:
        """All that was added."""
        q, qd, force = (np.array(each) for each in zip(*self._frames, strict=True)) if self._frames else _nothing()
        push = np.array(self._pushes) if self._pushes else None
        there = {prim: np.array(rows) for prim, rows in self._present.items()}
        fluids = {prim: with_company(np.array(x), there.get(prim)) for prim, x in self._fluids.items()}
        return _finite(np.array(self._times), q, qd, force, fluids, push)


def _some(count: int) -> slice:
    return slice(None, None, max(1, count // SOME))


def _nothing() -> Sequence[Array]:
    return np.zeros((0, 0, 7)), np.zeros((0, 0, 6)), np.zeros((0, 0, 3))


def _finite(
    time: Array, body_q: Array, body_qd: Array, force: Array, fluids: Mapping[str, Array], push: Array | None
) -> Motion:
    good = np.isfinite(time)
    for each in (body_q, body_qd, force, *fluids.values()):
        good &= np.isfinite(each).all(axis=(1, 2))
    end = len(good) if good.all() else int(np.argmin(good))
    return Motion(
        time=time[:end],
        body_q=np.asarray(body_q[:end], dtype=np.float64),
        speed=np.linalg.norm(body_qd[:end, :, :3], axis=2),
        force=np.linalg.norm(force[:end], axis=2),
        fluids={prim: np.asarray(each[:end], dtype=np.float64) for prim, each in fluids.items()},
        push=None if push is None else np.asarray(push[:end], dtype=np.float64),
    )
