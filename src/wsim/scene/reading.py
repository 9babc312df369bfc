"""A stage as it was read by whoever checked it, for others to take over without USD."""

from __future__ import annotations

import json
from pathlib import Path

from pxr import Usd
from pydantic import BaseModel, ConfigDict

from wsim.scene.describe import describe
from wsim.scene.skeleton import skeleton
from wsim.scene.world import World


class Reading(BaseModel):
    """What a stage states.

    Attributes:
        world: As `wsim.scene.describe` has it.
        skeleton: As `wsim.scene.skeleton` has it.
    """

    model_config = ConfigDict(extra="forbid", frozen=True)

    world: World
    skeleton: str

    def to_json(self) -> bytes:
        """All of it, each number to its last bit.

        Raises:
            ValueError: If a number is not finite, which JSON has no word for.
        """
        return json.dumps(self.model_dump(), allow_nan=False, separators=(",", ":")).encode()


def read(path: Path, stage: Usd.Stage | None = None, known: str | None = None) -> Reading:
    """Read a stage.

    Args:
        path: Its file.
        stage: It, where it is open.
        known: Its skeleton, where that is known.
    """
    return Reading(world=describe(stage or path), skeleton=skeleton(path) if known is None else known)
