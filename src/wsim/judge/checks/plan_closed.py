"""The check that nothing acts in a world that its plan has not: no part, path, spring, rope or gear beside it."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import TYPE_CHECKING

from wsim.judge.checks.check import Check, Checks
from wsim.judge.verdict import RepairTarget
from wsim.scene.world import Gear

if TYPE_CHECKING:
    from collections.abc import Iterator

    from wsim.judge.evidence.evidence import Evidence
    from wsim.judge.verdict import Finding
    from wsim.plan.schema import Plan, PlanObject
    from wsim.scene.world import Body

# What a plan has no field for it may ask for in its words: each begins one of them.
WORDS = {
    "spring": ("spring", "elastic", "bungee", "rubber", "suspension", "trampoline", "catapult"),
    "rope": ("rope", "string", "cable", "cord", "chain", "thread", "wire", "pulley", "tether", "hoist", "winch"),
    "gear": ("gear", "cog", "rack", "pinion", "screw", "transmission", "sprocket"),
    "friction": ("friction", "brak", "stiff", "rub"),
    "breaks": ("break", "broke", "snap", "tear", "burst", "rip", "fracture"),
    "terrain": ("terrain", "hill", "bump", "uneven", "rough", "dune", "valley", "landscape", "slope", "track"),
}


def named(plan: Plan, what: str) -> bool:
    """Whether a plan speaks of a kind of thing (a key of WORDS): in its prompt, its steps, or of an object."""
    said = [plan.title, plan.prompt, *(text for item in plan.objects for text in (item.name, item.words))]
    said += [text for step in plan.steps for text in (step.title, step.shows)]
    said += [objective.sentence for objective in plan.objectives]
    begins = "|".join(WORDS[what])
    return re.search(rf"(?:\b|_)(?:{begins})", " ".join(said), re.IGNORECASE) is not None


def owner(evidence: Evidence, prim: str) -> PlanObject | None:
    """The plan's object that a prim is, or is a part of."""
    return evidence.planned("/".join(prim.split("/")[:3]))


def assembled(item: PlanObject | None) -> bool:
    """Whether what stands for an object may have parts and joints of its own: an asset of the catalogue, or a robot."""
    return item is not None and item.assembled


def within(evidence: Evidence, *prims: str) -> bool:
    """Whether all of these are of one object that is assembled, as a robot's own joints and gears are."""
    item = owner(evidence, prims[0])
    return assembled(item) and all(owner(evidence, prim) is item for prim in prims)


@dataclass
class CheckPlanClosed(Check):
    """Nothing in the world acts that the plan has not: no body within an object, path, gear, spring or rope."""

    of_world = True

    def evaluate(self, evidence: Evidence) -> list[Finding]:
        """One finding for each thing too many, or one for none."""
        plan = evidence.plan
        if plan is None:
            return []
        found = [*self._bodies(evidence), *self._couplings(evidence, plan)]
        return found or [self.passed("Nothing acts in the world but what the plan has")]

    def _bodies(self, evidence: Evidence) -> Iterator[Finding]:
        """Bodies within objects, bodies that are led, and tanks that move."""
        for body in evidence.world.bodies:
            item = owner(evidence, body.prim)
            if item is None:
                continue  # an object that the plan has not: CheckPlanObjects says so
            within = body.prim != evidence.prim(item.name)
            if not assembled(item) and within:
                yield self._extra(body.prim, f"a body within the plan's {item.name}, which is one piece", "geometry")
            elif item.state not in ("dynamic", "kinematic") and (within or item.role == "container"):
                yield self._extra(body.prim, f"a body that moves; the plan's {item.name} is {item.state}", "geometry")
            elif body.kinematic != (item.state == "kinematic") and (within or item.role == "container"):
                is_ = "kinematic" if body.kinematic else "not kinematic"
                yield self._extra(body.prim, f"{is_}; the plan's {item.name} is {item.state}", "geometry", "kinematic")
            yield from self._led(body, item)

    def _led(self, body: Body, item: PlanObject) -> Iterator[Finding]:
        if body.path is not None and not any(each.kind == "path" for each in item.registration.actuation):
            yield self._extra(body.prim, f"led along a path; the plan gives {item.name} none", "controller", "path")

    def _couplings(self, evidence: Evidence, plan: Plan) -> Iterator[Finding]:
        """What pulls or couples, and is no joint: a cord of the plan, or what its words name."""
        world = evidence.world
        for what, things in (("gear", world.gears), ("spring", world.springs), ("rope", world.ropes)):
            for thing in things:
                own = isinstance(thing, Gear) and within(evidence, thing.prim, thing.first, thing.second)
                planned = any(thing.prim == evidence.prim(cord.name) for cord in plan.cords)
                if not (own or planned) and (plan.cords or not named(plan, what)):
                    yield self._extra(thing.prim, f"a {what}; nothing in the plan speaks of one", "joint", what)

    def _extra(self, prim: str, what: str, kind: str, parameter: str = "") -> Finding:
        target = RepairTarget.model_validate(
            {"kind": kind, "prim": prim, "parameter": parameter, "direction": "remove", "why": "the plan has it not"}
        )
        return self.failed(
            f"{prim} is {what}", prim=prim, time=0.0, limit_from="the plan, which is all that there is", target=target
        )


CHECKS: Checks = (CheckPlanClosed,)
