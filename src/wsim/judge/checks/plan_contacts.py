"""The check of a world's pairs against the plan's: how what touches rubs, bounces and rolls."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from wsim.judge.checks.check import Check, Checks
from wsim.judge.verdict import RepairTarget
from wsim.scene.contact import pair_law, within

if TYPE_CHECKING:
    from collections.abc import Iterator

    from wsim.judge.evidence.evidence import Evidence
    from wsim.judge.verdict import Finding
    from wsim.plan.schema import Contact, Plan
    from wsim.scene.world import Body, Shape, Static


@dataclass
class CheckPlanContacts(Check):
    """Each pair has the friction, restitution and rolling resistance that the plan states, and no other of its own."""

    of_world = True

    share: float = 0.05  # of a coefficient
    least: float = 1e-3  # what it may be off of nothing

    def evaluate(self, evidence: Evidence) -> list[Finding]:
        """One finding for each coefficient of a pair that is another, or one for none."""
        plan = evidence.plan
        if plan is None or not (plan.contacts or evidence.world.contacts):
            return []
        found = [finding for contact in plan.contacts for finding in self._pair(evidence, contact)]
        found += self._unplanned(evidence, plan)
        return found or [self.passed("Pairs touch by the plan's coefficients")]

    def _unplanned(self, evidence: Evidence, plan: Plan) -> Iterator[Finding]:
        """Coefficients that the world states of a pair, and the plan leaves to the two surfaces."""
        planned = {frozenset((evidence.prim(c.object), evidence.prim(c.ref))): c for c in plan.contacts}
        for made in evidence.world.contacts:
            pair = planned.get(frozenset("/".join(prim.split("/")[:3]) for prim in (made.first, made.second)))
            for name in ("friction", "restitution", "rolling"):
                value = getattr(made, name)
                if value is not None and (pair is None or getattr(pair, name) is None):
                    target = RepairTarget(kind="physical parameter", prim=made.prim, parameter=name, direction="remove")
                    message = f"{made.prim} states a {name} of {value:g} for {made.first} and {made.second} alone; the "
                    yield self.failed(
                        message + "plan leaves it to their materials",
                        prim=made.prim, time=0.0, limit_from="the plan's contacts", target=target,
                    )  # fmt: skip

    def _pair(self, evidence: Evidence, contact: Contact) -> Iterator[Finding]:
        one, other = (evidence.prim(name) for name in (contact.object, contact.ref))
        laws = [pair_law(evidence.world, a, b) for a in _shapes(evidence, one) for b in _shapes(evidence, other)]
        for name in ("friction", "restitution", "rolling"):
            planned = getattr(contact, name)
            if planned is None or not laws:
                continue  # what is missing is told elsewhere
            value = max((getattr(law, name) for law in laws), key=lambda each: abs(each - planned))
            limit = max(self.share * planned, self.least)
            if abs(value - planned) > limit:
                target = RepairTarget(
                    kind="physical parameter", prim=one, parameter=name, suggested=planned,
                    why=f"scene.contact states it for {contact.object} and {contact.ref} alone",
                )  # fmt: skip
                yield self.between(
                    f"{one} and {other} have a {name} of {value:g}; the plan's contact has {planned:g}",
                    value, (planned - limit, planned + limit), "1", expected=planned, prim=one, time=0.0,
                    limit_from=f"the plan's contact, to {self.share:.0%}", target=target,
                )  # fmt: skip


def _shapes(evidence: Evidence, prim: str) -> list[Shape]:
    """The surfaces of a body or a static object that take part in contacts."""
    solids: list[Body | Static] = [*evidence.world.bodies, *evidence.world.statics]
    return [shape for solid in solids if within(solid.prim, prim) for shape in solid.shapes if shape.collides]


CHECKS: Checks = (CheckPlanContacts,)
