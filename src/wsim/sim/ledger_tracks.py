"""What fluid, control and drives gave to the bodies of all worlds, frame by frame, as arrays."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from wsim.sim.measure import applied_of, drive_scalars

if TYPE_CHECKING:
    from wsim.sim.ledger import Ledger
    from wsim.sim.model import Built

Array = np.ndarray


class LedgerTracks:
    """The ledger's entries of W worlds over T frames.

    Args:
        built: The model.
        ledger: Its bodies'.
        frames: T.

    Attributes:
        scalars: By the name that a recording has for it, (W, T).
        applied: By a recording's field, (W, T, ...).
    """

    def __init__(self, built: Built, ledger: Ledger, frames: int) -> None:
        self._built, self._ledger, self._frames = built, ledger, frames
        self.scalars: dict[str, Array] = {}
        self.applied: dict[str, Array] = {}

    def take(self, frame: int) -> None:
        """Keep what came in since the last frame."""
        entry = self._ledger.take()
        for name, values in drive_scalars(self._built, self._ledger, entry).items():
            self.scalars.setdefault(name, np.zeros((len(values), self._frames)))[:, frame] = values
        for name, values in applied_of(self._built, self._ledger, entry).items():
            shape = (len(values), self._frames, *values.shape[1:])
            self.applied.setdefault(name, np.zeros(shape, dtype=np.float32))[:, frame] = values
