"""A finding about the body and the interval between frames that are farthest off."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from wsim.judge.verdict import RepairTarget

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsim.judge.checks.check import Check
    from wsim.judge.evidence.evidence import Evidence
    from wsim.judge.verdict import Finding

    Floats = NDArray[np.float64]


def strangest(
    check: Check, evidence: Evidence, value: Floats, limit: Floats, unit: str, story: str, fine: str, why: str = "",
    share: Floats | None = None, **details: object
) -> Finding:  # fmt: skip
    """A finding about the body and the interval between frames where a value is largest by its limit, (T - 1, B) both.

    `story` is filled in with prim, time and value; `why` says what is wrong with the program.
    """
    if share is None:
        share = np.divide(value, limit, out=np.zeros_like(value), where=limit > 0.0)
    k, i = np.unravel_index(int(np.argmax(share)), share.shape)
    prim, start, end = evidence.world.bodies[i].prim, float(evidence.time[k]), float(evidence.time[k + 1])
    target = RepairTarget(kind="program", prim=prim, why=why) if why else None
    fields: dict[str, Any] = {"prim": prim, "time": end, "span": (start, end), "expected": 0.0, **details}
    message = story.format(prim=prim, time=end, value=value[k, i])
    return check.measured(message, value[k, i], limit[k, i], unit, fine=fine, target=target, **fields)
