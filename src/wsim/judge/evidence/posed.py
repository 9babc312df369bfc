"""Bodies of a world put to any poses, as evidence of nothing but where they are."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from wsim.judge.evidence.evidence import Evidence
from wsim.recording.recording import Recording

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsim.scene.world import World


def posed(world: World, rows: list[int], time: NDArray[np.float64], q: NDArray[Any]) -> Evidence:
    """Some of a world's bodies at poses (N, len(rows), 7), at times (N,)."""
    # Nothing here is asked of velocities and forces; whatever was would come out as not known.
    qd, force = (np.broadcast_to(np.nan, (len(q), len(rows), width)) for width in (6, 3))
    recording = Recording(
        path=Path(), world=world.model_copy(update={"bodies": [world.bodies[i] for i in rows]}), metadata={},
        time=time, body_q=q, body_qd=qd, contact_force=force, fluids={}, scalars={}, log=[], images={},
    )  # fmt: skip
    return Evidence(recording)
