"""Is a verdict the world's, or the solver's? A run held against the same run with finer numerics."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

from wsim.judge.verdict import Finding, RepairTarget, Verdict

Key = tuple[str, str | None, str | None, int]


@dataclass(frozen=True)
class Rerun:
    """The same world again, and what was changed in how it was computed.

    `share` is how much of the first run's margin a number may move by, and `share_from` says how it was got.
    """

    name: str  # "half the time step", as it follows "with"
    verdict: Verdict
    share: float
    share_from: str
    target: RepairTarget = field(default_factory=lambda: RepairTarget(kind="program"))


class CheckConverged:
    """Every verdict stands when the run is computed more finely, and no objective's number moves far.

    A number's move is the difference of the two measured values against the first run's margin, so that a limit which
    tightens with the resolution does not count as a move. Where the two are of different units, the margins are
    compared as shares of their limits.
    """

    def compare(self, first: Verdict, reruns: Sequence[Rerun]) -> list[Finding]:
        """What did not stand or moved too far; if all is well, one finding about what moved the most.

        Args:
            first: The verdict in question; it was accepted.
            reruns: What to hold it against.
        """
        found = [finding for rerun in reruns for finding in self._compare(first, rerun)]
        failed = [finding for finding in found if not finding.passed]
        if failed or not found:
            names = " and ".join(rerun.name for rerun in reruns)
            return failed or [Finding(check=self.name, passed=True, message=f"Every finding stands with {names}")]
        return [max(found, key=lambda f: (f.value or 0.0) / f.limit if f.limit else 0.0)]

    @property
    def name(self) -> str:
        """The name that findings carry."""
        return type(self).__name__

    def _compare(self, first: Verdict, rerun: Rerun) -> Iterator[Finding]:
        """What fell, what is gone, and how far each objective's number moved."""
        before, after = _by_key(first), _by_key(rerun.verdict)
        # Of what crashed there nothing is known: the verdict keeps it as such.
        judged = {finding.objective for finding in rerun.verdict.findings}
        judged |= {crash.objective for crash in rerun.verdict.crashes}
        for key, other in after.items():
            finding = before.get(key)
            if not other.passed:
                yield self._fell(finding, other, rerun)
            elif finding is not None and finding.objective is not None:
                yield from _moved(finding, other, rerun)
        for finding in before.values():
            if finding.objective not in judged:
                yield self._gone(finding, rerun)

    def _fell(self, finding: Finding | None, other: Finding, rerun: Rerun) -> Finding:
        before = f"; at first: {finding.message}" if finding is not None else ""
        return Finding(
            check=self.name,
            passed=False,
            message=f"Not converged: with {rerun.name}, {other.check} fails: {other.message}{before}",
            objective=other.objective,
            prim=other.prim,
            time=other.time,
            span=other.span,
            value=other.value,
            limit=other.limit,
            expected=finding.value if finding is not None else None,
            unit=other.unit,
            margin=other.margin,
            limit_from=other.limit_from,
            line=other.line,
            target=rerun.target,
        )

    def _gone(self, finding: Finding, rerun: Rerun) -> Finding:
        message = f"Not converged: with {rerun.name}, {finding.check} is not found; at first: {finding.message}"
        return finding.model_copy(
            update={"check": self.name, "passed": False, "message": message, "target": rerun.target}
        )


def _moved(finding: Finding, other: Finding, rerun: Rerun) -> Iterator[Finding]:
    """How far a number moved, against the share of its margin that it may; nothing if it has no number."""
    if finding.value is None or finding.margin is None or other.value is None or other.margin is None:
        return
    move, margin, unit = abs(other.value - finding.value), finding.margin, finding.unit
    if unit != other.unit:
        if not finding.limit or not other.limit:
            return
        margin, unit = margin / abs(finding.limit), "of the limit"
        move = abs(other.margin / abs(other.limit) - margin)
    room = _room(finding, other, margin)
    limit = rerun.share * room
    passed = move <= limit
    away = room > margin
    what = f'"{finding.objective}" ({finding.check})'
    values = f"{finding.value:.4g} {finding.unit} at first, {other.value:.4g} {other.unit} with {rerun.name}"
    yield Finding(
        check=CheckConverged.__name__,
        passed=passed,
        message=f"{'' if passed else 'Not converged: '}{what}: {values}; its margin was {finding.margin:.4g}",
        objective=finding.objective,
        prim=finding.prim,
        time=other.time,
        value=move,
        limit=limit if math.isfinite(limit) else None,
        expected=0.0,
        unit=unit,
        margin=limit - move if math.isfinite(limit) else None,
        limit_from=f"{rerun.share:.3g} of {'the way to the limit on the other side' if away else 'the margin'}: "
        f"{rerun.share_from}",
        line=finding.line,
        target=None if passed else rerun.target,
    )


def _room(finding: Finding, other: Finding, margin: float) -> float:
    """How far a number may go before its margin's sign could change, as it goes.

    Towards its limit that is the margin. Away from it the limit on the other side of what is expected, as far from that
    as its own; where nothing is expected, there is none.
    """
    if finding.limit is None or finding.value is None or other.value is None or finding.unit != other.unit:
        return margin
    if (other.value - finding.value) * (finding.limit - finding.value) >= 0.0:
        return margin
    return math.inf if finding.expected is None else margin + 2.0 * abs(finding.value - finding.expected)


def _by_key(verdict: Verdict) -> dict[Key, Finding]:
    """Findings by what they are about: check, objective, prim, and which of several."""
    seen: Counter[tuple[str, str | None, str | None]] = Counter()
    found: dict[Key, Finding] = {}
    for finding in verdict.findings:
        # Which pair is deepest in one another, or which body is fastest, may differ where nothing is wrong.
        about = (finding.check, finding.objective, finding.prim if finding.objective is not None else None)
        found[(*about, seen[about])] = finding
        seen[about] += 1
    return found
