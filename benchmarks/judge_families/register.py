"""All mechanisms and families: a new module of either is named here."""

from __future__ import annotations

from benchmarks.judge_families import by_hand, heaps, in_stage, joined, loose, of_fluids, of_plans, pushed, rocking, wet
from benchmarks.judge_families.drawn import MECHANISMS
from benchmarks.judge_families.family import FAMILIES

MODULES = (loose, heaps, joined, wet, of_plans, in_stage, pushed, by_hand, of_fluids, rocking)

__all__ = ["FAMILIES", "MECHANISMS"]
