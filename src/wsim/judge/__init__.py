"""The judge: a recording is held against physics and against its plan."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from wsim.judge.verdict import Verdict
    from wsim.plan.schema import Plan
    from wsim.recording.reader import Recording

__all__ = ["judge"]


def judge(recording: Recording, plan: Plan | None = None) -> Verdict:
    """Judge what happened.

    Args:
        recording: The evidence; nothing else is looked at.
        plan: What was asked for. Without one, only the checks that hold for any world are made.

    Returns:
        Accepted if every finding passed, rejected if one did not, blocked if there is nothing to judge.
    """
    from wsim.judge.decide import decide

    return decide(recording, plan)
