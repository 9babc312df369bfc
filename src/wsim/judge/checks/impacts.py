"""The laws of impact: bodies part as fast as their restitution lets them, and friction acts as much as it may."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, cast

from wsim.judge.books.impacts import Blow, blows, tells
from wsim.judge.books.recorded_blows import recorded_blows
from wsim.judge.checks.check import Check, Checks
from wsim.judge.verdict import RepairTarget

if TYPE_CHECKING:
    from collections.abc import Sequence

    from wsim.judge.books.impacts import Rub
    from wsim.judge.evidence.evidence import Evidence
    from wsim.judge.verdict import Finding


@dataclass
class CheckRestitution(Check):
    """After a blow that stands alone two bodies part at their restitution times the speed at which they met.

    Less what friction gave them that turned their slip round, which the surfaces had stored (Stronge 1990).
    """

    share: float = 0.005  # of the approach: of 104 of wsim's own blows none was off by 0.002 beyond what a step changes

    def evaluate(self, evidence: Evidence) -> list[Finding]:
        """The blow that is farthest off, by its limit. Other engines' contacts are soft and state no restitution."""
        found = _told(evidence)
        if not found:
            return []
        worst = max(found, key=lambda blow: abs(self._off(blow)) / self._limit(blow))
        one, two = worst.prims
        expected, limit = worst.restitution * worst.approach - worst.spent[0], self._limit(worst)
        least = worst.restitution * worst.approach - worst.spent[1]
        time = float(evidence.time[worst.interval + 1])
        return [
            self.between(
                f"{one} and {two} part at {worst.parting:.3g} m/s at {time:.3f} s, after they met at "
                f"{worst.approach:.3g} m/s",
                worst.parting, (least - limit, expected + limit), "m/s", expected, prim=two, time=time,
                limit_from=f"restitution {worst.restitution:g} times the approach, less what friction gave; "
                f"{self.share:g} of it, and what a step changes",
                target=RepairTarget(
                    kind="physical parameter", prim=two, parameter="restitution", why="it is another than stated"
                ),
            )
        ]  # fmt: skip

    def prepare_similar(self, copies: Sequence[Evidence]) -> None:
        """The blows of all copies at once, where no impulses tell them."""
        some = [evidence for evidence in copies if tells(evidence) and evidence.recording.contacts is None]
        for evidence, found in zip(some, blows(some) if some else [], strict=True):
            evidence.kept[Blow] = found

    def _off(self, blow: Blow) -> float:
        full = blow.restitution * blow.approach
        return blow.parting - min(max(blow.parting, full - blow.spent[1]), full - blow.spent[0])

    def _limit(self, blow: Blow) -> float:
        return self.share * blow.approach + blow.unsure


@dataclass
class CheckBlowFriction(Check):
    """In a blow friction takes the slip away, or it is its coefficient times the push, as long as surfaces slip."""

    share: float = 0.005  # of approach and slip: of 60 of wsim's own blows none was off by 0.0013
    edge: float = 0.01  # of the friction of a recorded impulse, where the slip keeps its way

    def evaluate(self, evidence: Evidence) -> list[Finding]:
        """The blow of single points that is farthest off, by its limit."""
        found = [(blow, blow.rub) for blow in _told(evidence) if blow.rub is not None]
        if not found:
            return []
        blow, rub = max(found, key=lambda each: self._off(*each) / self._limit(*each))
        one, two = blow.prims
        limit = self._limit(blow, rub)
        slips = rub.unsure is not None or rub.after > limit
        time = float(evidence.time[blow.interval + 1])
        least = rub.least - limit if slips else -rub.most - limit
        told = "the friction of the pair times the change of speed across it; " + (
            f"{self.edge:g} of it, and how far the slip turns"
            if rub.unsure is not None
            else f"{self.share:g} of approach and slip, and twice what a step changes"
        )
        how = f"though they slip on at {rub.after:.3g} m/s" if slips else "and they slip no more"
        return [
            self.between(
                f"Friction gives {one} and {two} {rub.impulse:.3g} m/s in a blow at {time:.3f} s, {how}; the push "
                f"allows {rub.most:.3g} m/s",
                rub.impulse, (least, rub.most + limit), "m/s", rub.most if slips else min(rub.impulse, rub.most),
                prim=two, time=time,
                limit_from=told,
                target=RepairTarget(
                    kind="physical parameter", prim=two, parameter="friction", why="it is another than stated"
                ),
            )
        ]  # fmt: skip

    def _off(self, blow: Blow, rub: Rub) -> float:
        slips = rub.unsure is not None or rub.after > self._limit(blow, rub)
        return max(rub.impulse - rub.most, rub.least - rub.impulse if slips else 0.0, 0.0)

    def _limit(self, blow: Blow, rub: Rub) -> float:
        if rub.unsure is not None:
            return self.edge * rub.most + rub.unsure
        return self.share * (blow.approach + rub.before) + blow.unsure


def _told(evidence: Evidence) -> list[Blow]:
    """The blows of a recording whose velocities and contacts' laws are known."""
    if not tells(evidence):
        return []
    if Blow not in evidence.kept:
        recorded = evidence.recording.contacts is not None
        evidence.kept[Blow] = recorded_blows(evidence) if recorded else blows([evidence])[0]
    return cast("list[Blow]", evidence.kept[Blow])


CHECKS: Checks = (CheckRestitution, CheckBlowFriction)
