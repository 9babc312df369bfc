"""Sound worlds, and the faults that are planted in them, for the judge's own error rates."""

from benchmarks.judge_worlds.by_hand import BY_HAND
from benchmarks.judge_worlds.faults import FAULTS
from benchmarks.judge_worlds.from_prompts import PROMPTED

WORLDS = (*PROMPTED, *BY_HAND)

__all__ = ["FAULTS", "WORLDS"]
