"""Acceptance: what only served the review goes, the bare program runs again, and must go the same way."""

from __future__ import annotations

import numpy as np

from wsim import sim
from wsim.judge.verdict import Finding, RepairTarget, Verdict, status_of, unjudged
from wsim.runs.bare_run import BareRun
from wsim.runs.folder import RunFolder
from wsim.runs.iteration import Iteration
from wsim.runs.trajectory import Trajectory
from wsim.scene.describe import describe


def accept(
    run: RunFolder, iteration: Iteration, earlier: Trajectory | None = None, bare_run: BareRun | None = None
) -> Verdict:
    """Strip an accepted iteration's program, run it again without pictures, and stamp it if it goes the same way.

    Args:
        run: The run; accepted/ gets program.py, stage.usda, acceptance.json and SHA256SUMS.
        iteration: The accepted one; the bare world is judged by its plan, and run by its settings.
        earlier: Another run of this very program; where nothing is stripped, it is the second run.
        bare_run: The second run, where it was started ahead.

    Returns:
        The bare world's verdict; with the finding `CheckReproduced` where that, or another, is not accepted.
    """
    if bare_run is not None:
        return _confirmed(run, iteration, bare_run, earlier)
    with BareRun(run.path / "bare.partial", iteration) as bare_run:
        return _confirmed(run, iteration, bare_run, earlier)


def _confirmed(run: RunFolder, iteration: Iteration, bare_run: BareRun, earlier: Trajectory | None) -> Verdict:
    """The verdict on the bare program; stamped if it goes the same way."""
    first, verdict, again = Trajectory.of(iteration.recording), iteration.verdict, iteration
    if earlier is not None and bare_run.as_it_was:
        second = earlier
    else:
        again = bare_run.iteration
        verdict = bare_run.verdict()
        if not again.recording.is_file():
            return verdict
        second = Trajectory.of(again.recording)
    apart = first.distance(second)
    found = _reproduced(apart, exact=_on_cpu(iteration))
    if verdict.status != "accepted" or not found.passed:
        findings = [*verdict.findings, found]
        failed = sum(not finding.passed for finding in findings)
        said = "; ".join(filter(None, (f"{failed} findings fail" if failed else "", unjudged(verdict.crashes))))
        return Verdict(
            status=status_of(findings, verdict.crashes), summary=f"The bare program: {said}.", findings=findings,
            crashes=verdict.crashes,
        )  # fmt: skip
    run.stamp(again.folder, {"stripped": not bare_run.as_it_was, "largest_distance_m": apart})
    return verdict


def _reproduced(apart: float, exact: bool) -> Finding:
    """Whether two runs of one program went the same way; on a GPU, which rounds anew each time, it is only noted."""
    limit = 0.0 if exact else None
    passed = np.isfinite(apart) and (limit is None or apart <= limit)
    return Finding(
        check="CheckReproduced",
        passed=bool(passed),
        message=f"two runs of the program are {apart:.3g} m apart at most",
        value=apart if np.isfinite(apart) else None,
        limit=limit,
        unit="m",
        limit_from="a CPU repeats a run bit for bit" if exact else "none: a GPU rounds in another order each time",
        target=None if passed else RepairTarget(kind="program", why="it does not do the same each time"),
    )


def _on_cpu(iteration: Iteration) -> bool:
    return sim.pick_device(iteration.settings.device, describe(iteration.stage)) == "cpu"
