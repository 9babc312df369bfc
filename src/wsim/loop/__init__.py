"""The loop: a sentence becomes a judged world (`generate`), and a recorded run is made again (`replay`)."""

from __future__ import annotations

from typing import TYPE_CHECKING

from wsim.door import door

if TYPE_CHECKING:
    from wsim.loop.generate import generate as generate_world
    from wsim.loop.replay import replay as replay_run

__all__ = ["generate_world", "replay_run"]

__getattr__ = door(__name__, {"generate_world": "generate.generate", "replay_run": "replay.replay"})
