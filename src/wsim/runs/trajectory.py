"""Where the bodies of a world went, to hold two runs of one program against each other."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from wsim import recording


@dataclass(frozen=True)
class Trajectory:
    """Where the bodies of a world went.

    Attributes:
        time: Of each frame [s], shape (T,).
        body_q: Position [m] and rotation (xyzw) of each body, shape (T, B, 7).
        particles: Where each fluid's particles are at the end [m], shape (N, 3), by prim.
    """

    time: np.ndarray
    body_q: np.ndarray
    particles: dict[str, np.ndarray]

    @classmethod
    def of(cls, path: Path) -> Trajectory:
        """A recording's."""
        found = recording.read_kept(path)
        ends = {
            prim: np.asarray(track.position[-1])[track.there(-1)]
            for prim, track in found.fluids.items()
            if len(track.time)
        }
        return cls(np.asarray(found.time), np.asarray(found.body_q), ends)

    def distance(self, other: Trajectory) -> float:
        """Largest distance [m]; infinite if not comparable, and not a number where one is none.

        Of a body at one frame, or of a point on it 1 m from its centre, which also turns; of a particle at the end.
        """
        pairs = [(self.body_q[..., :3], other.body_q[..., :3])]
        pairs += [(2.0 * self.body_q[..., 3:], 2.0 * other.body_q[..., 3:])]  # small angles are 2 |q - q'|
        pairs += [(end, other.particles.get(prim, end[:0])) for prim, end in self.particles.items()]
        if self.particles.keys() != other.particles.keys() or any(a.shape != b.shape for a, b in pairs):
            return float("inf")
        return float(np.max([np.linalg.norm(a - b, axis=-1).max(initial=0.0) for a, b in pairs]))
