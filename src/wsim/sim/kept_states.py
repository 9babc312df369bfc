"""The states of a run's frames, kept until pictures are drawn of them."""

from __future__ import annotations

import tempfile
import threading
from types import TracebackType
from typing import TYPE_CHECKING

import numpy as np

from wsim.sim.openings import seen_particles

if TYPE_CHECKING:
    from newton import Model, State


class KeptStates:
    """Poses in memory, particles in a file of no name: there may be millions of them a frame."""

    def __init__(self) -> None:
        self.times: list[float] = []
        self._poses: list[np.ndarray] = []
        self._particles = tempfile.TemporaryFile()  # noqa: SIM115 - this is the context manager
        self._reading = threading.Lock()
        self._count = 0

    def __enter__(self) -> KeptStates:
        """Nothing more is to be opened."""
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Give the file up."""
        self._particles.close()

    def __len__(self) -> int:
        """Frames."""
        return len(self.times)

    def add(self, time: float, model: Model, state: State) -> None:
        """Keep a frame's state of a model, of a time [s]."""
        self.times.append(time)
        self._poses.append(state.body_q.numpy().copy() if state.body_q is not None else np.zeros((0, 7), np.float32))
        if state.particle_q is not None:
            particles = np.ascontiguousarray(seen_particles(model, state), dtype=np.float32)
            self._count = len(particles)
            self._particles.write(particles.tobytes())

    def restore(self, frame: int, state: State) -> np.ndarray:
        """Bring a state's bodies to where they were at a frame.

        Returns:
            (N, 3) the particles then [m]; NaN of one that was not in the world.
        """
        if len(self._poses[frame]):
            state.body_q.assign(self._poses[frame])
        with self._reading:
            self._particles.seek(12 * self._count * frame)
            found = self._particles.read(12 * self._count)
        return np.frombuffer(found, dtype=np.float32).reshape(-1, 3)
