"""A check that divides by zero, as one did of what rubs without friction in a blow."""

from __future__ import annotations

import pytest

from wsim.judge.checks.check import Check
from wsim.judge.evidence.evidence import Evidence
from wsim.judge.verdict import Crash, Finding

CRASH = Crash(check="CheckEnergy", error="ZeroDivisionError: division by zero", traceback="at line 3")


def crashing(patch: pytest.MonkeyPatch, check: type[Check]) -> None:
    """Let a check crash, in this process and those that are forked from it."""

    def evaluate(self: Check, evidence: Evidence) -> list[Finding]:
        return [self.measured("so", 1.0 / len(evidence.world.bodies[:0]), 1.0, "1")]

    patch.setattr(check, "evaluate", evaluate)
