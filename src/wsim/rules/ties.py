"""What answers for each verb and each count of a prompt: what the plan has of the things that it is said of."""

from __future__ import annotations

import re

from wsim.plan.asked.demands import REQUIRED, Demand, demands
from wsim.plan.asked.nodes import speaks_of
from wsim.plan.asked.tokens import tokens
from wsim.plan.schema import Clause, Objective, Plan
from wsim.rules.cast import CARRIERS, Cast, Thing
from wsim.rules.phrases import Action
from wsim.rules.tokens import as_read

Names = dict[int, list[str]]
OF_OTHERS = "no objective of the plan asks for it of what it is said of"
_MOTIONS = ("drop", "fall", "bounce", "roll", "slide", "throw", "fly", "swing", "push", "hit", "collide", "topple")
_OF_WATER = ("fill", "hold", "contain")  # what a tank is said to be amid what others do
# Behind what is done, and before whom it is done to.
_AT = ("into", "against", "with", "at", "to", "towards", "onto", "on", "by", "in", "over", "before")


def tied_to(plan: Plan, cast: Cast, names: Names) -> Plan:
    """The plan with each of its clauses tied to the things that its words are about.

    Args:
        plan: With a clause for each demand of its prompt, in their order.
        cast: What the prompt speaks of.
        names: Of each thing's objects, by its identity.
    """
    wanted = [each for each in demands(plan.prompt) if each.kind in REQUIRED]
    if len(wanted) != len(plan.clauses):
        return plan
    made = [_own(clause, demand, plan, cast, names) for clause, demand in zip(plan.clauses, wanted, strict=True)]
    return plan.model_copy(update={"clauses": made})


def _own(clause: Clause, demand: Demand, plan: Plan, cast: Cast, names: Names) -> Clause:
    at = _place(plan.prompt, demand)
    if clause.by is None or at is None or demand.base in _OF_WATER:
        return clause
    if demand.kind == "number":
        counted = [] if demand.unit or demand.often else _counted(at, cast, names)
        whole = bool(counted) and len(counted) == demand.value
        return Clause(words=clause.words, by=list(counted)) if whole else clause
    who = _parties(at, plan.prompt, cast, names)
    if not who:
        return clause
    known = {item.name for item in plan.objects}
    kept: list[int | str] = [each for each in clause.by if _is_of(each, who, known, plan)]
    ends = demand.kind == "state" and _comes_to_be(at, cast)
    if any(isinstance(each, int) for each in kept) or (kept and not ends):
        return Clause(words=clause.words, by=_of_each(kept, who, plan))
    if demand.kind == "state" and not ends:
        return Clause(words=clause.words, by=sorted(who))
    return Clause(words=clause.words, unchecked=OF_OTHERS)


def _of_each(kept: list[int | str], who: set[str], plan: Plan) -> list[int | str]:
    """Of several who do the same, what is asked of each."""
    alike = {_what(plan.objectives[each]) for each in kept if isinstance(each, int)}
    every = [k for k, one in enumerate(plan.objectives) if one.object in who and _what(one) in alike]
    return [
        *sorted({*every, *(each for each in kept if isinstance(each, int))}),
        *(e for e in kept if isinstance(e, str)),
    ]


def _what(objective: Objective) -> tuple[str, str]:
    return objective.kind, str(getattr(objective.formula, "op", ""))


def _comes_to_be(at: int, cast: Cast) -> bool:
    """Whether what is said at a place of the prompt is what comes of a motion that was spoken of before."""
    here = [thing for thing, action in cast.said if action.at[0] <= at < action.at[1] and not action.relative]
    before = [(thing, action) for thing, action in cast.said if action.at[1] <= at and action.verb in _MOTIONS]
    return any(thing is one for thing in here for one, _ in before)


def _is_of(each: int | str, who: set[str], known: set[str], plan: Plan) -> bool:
    if isinstance(each, int):
        return bool(speaks_of(plan.objectives[each]) & who)
    name = each.partition(".")[0]
    return name in who or name not in known  # a joint, a cord, a schedule, the run


def _place(prompt: str, demand: Demand) -> int | None:
    """Where a demand's first word is in the prompt as it is read."""
    said = [token.text for token in tokens(prompt) if not token.stops]
    word = said[demand.first]
    number = said[: demand.first].count(word)
    found = [match.start() for match in re.finditer(rf"(?<!\w){re.escape(word)}(?!\w)", as_read(prompt))]
    return found[number] if number < len(found) else None


def _parties(at: int, prompt: str, cast: Cast, names: Names) -> set[str]:
    """Who takes part in what is said at a place of the prompt: of the closest words, with whom it is done to."""
    here = [(thing, action) for thing, action in cast.said if action.at[0] <= at < action.at[1]]
    if not here:
        return set()
    closest = min(action.at[1] - action.at[0] for _, action in here)
    found: set[str] = set()
    for thing, action in here:
        if action.at[1] - action.at[0] == closest:
            for one in _with(thing, action, cast):
                found |= {*names.get(id(one), [])}
    return found


def _with(thing: Thing, action: Action, cast: Cast) -> list[Thing]:
    """A thing, and what takes part in what it does: what it hits, and where it is what carries it that moves."""
    found = [thing]
    aimed = action.target is not None or any(place.preposition in _AT for place in action.places)
    found += [one for one in (thing.target, thing.meets) if one is not None and aimed]
    if thing.noun.family in (*CARRIERS, "seesaw"):
        found += [one for one in cast.things if one.support is thing]
    elif action.verb in ("tilt", "balance", "run") and thing.support is not None:
        found.append(thing.support)
    return found


def _counted(at: int, cast: Cast, names: Names) -> list[str]:
    """The objects of what is named, with a count, by the closest words round a place of the prompt."""
    here = [(thing, phrase) for thing, phrase in cast.named if phrase.at <= at < phrase.at + len(phrase.words)]
    if not here:
        return []
    closest = min(len(phrase.words) for _, phrase in here)
    return list(dict.fromkeys(
        name for thing, phrase in here if len(phrase.words) == closest for name in names.get(id(thing), [])
    ))  # fmt: skip
