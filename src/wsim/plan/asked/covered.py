"""Which demands of a prompt a plan answers for by its clauses, which it leaves out, and which it says it cannot."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING

from wsim.plan.asked.demands import REQUIRED, SHOWN, Demand, demands
from wsim.plan.asked.doers import counted_short, is_of, outsiders
from wsim.plan.asked.nodes import speaks_of
from wsim.plan.asked.often import asks_again, asks_exactly, asks_often
from wsim.plan.asked.order import turned_round, unordered
from wsim.plan.asked.parties import strangers
from wsim.plan.asked.shown import denies, for_a_while, is_blow_shown, is_idle, shows_not
from wsim.plan.asked.stated import asks, asks_by_then, ends_by, states
from wsim.plan.asked.tokens import tokens
from wsim.plan.asked.vocabulary import CAUSES, GOES, LETS_GO, OPENED, SCHEDULED, SPRINGY, TURNS
from wsim.plan.asked.ways import stays_there, wrong_way

if TYPE_CHECKING:
    from wsim.plan.schema import Clause, Objective, Plan

UNTIED = "no clause has it"
BLOW = "it is a blow, and no objective that is named for it asks for one: collides_with, touches"
NOT_SHOWN = "it is not to happen, and no objective that is named for it says so: not (...), never_touches, upright"
IDLE = "what is named for it holds of what stands still, too; ask for more"
NOT_ALL = "it is never to happen, and what is named for it is of a part of the run: always (not ...)"
OFTEN = "no objective that is named for it has as many events: a then b then a"
EXACTLY = "nothing asks that it comes no more often: not (a then b then a)"
AGAIN = "no objective that is named for it asks for what comes after something else: a then b, finally"
BY_THEN = "no objective that is named for it ends by then: eventually[0, {:g}] (...)"
STARTS = ("velocity", "spin", "surface_velocity", "drive", "actuation")  # what sets a thing going


@dataclass(frozen=True)
class Gap:
    """A demand that nothing answers for.

    Attributes:
        demand: What the prompt asks for.
        why: What is missing, or the plan's own reason.
        said: Whether the plan itself says that nothing answers for it.
    """

    demand: Demand
    why: str
    said: bool = False

    @property
    def line(self) -> str:
        """For people."""
        return f"{self.demand.quoted}: {self.why}"


def gaps(plan: Plan) -> list[Gap]:
    """Every demand of the prompt that no clause of the plan answers for, in the prompt's order.

    A plan without clauses was written by hand, or by an older planner: nothing is demanded of it.
    """
    if not plan.clauses:
        return []
    placed = spans(plan)
    found = []
    for demand in demands(plan.prompt):
        here = [clause for clause, where in placed if _within(demand, where)]
        gap = _gap(demand, here, plan) if demand.kind in SHOWN else None
        if gap is not None:
            found.append(gap)
    return found


def missing(plan: Plan) -> list[Gap]:
    """What happens, is so or is a number in the prompt, and the plan passes over without a word."""
    return [gap for gap in gaps(plan) if gap.demand.kind in REQUIRED and not gap.said]


def not_checked(plan: Plan) -> list[str]:
    """A line for each demand that no run of the plan will show, and for each clause that the plan says so of."""
    if not plan.clauses:
        return []
    found = gaps(plan)
    told = {gap.why for gap in found if gap.said}
    lines = [gap.line for gap in found] + _unordered(plan)
    return lines + [f"'{c.words}': {c.unchecked}" for c in plan.clauses if c.unchecked and c.unchecked not in told]


def _unordered(plan: Plan) -> list[str]:
    placed = spans(plan)
    return unordered(plan, lambda verb: _asked([clause for clause, where in placed if _within(verb, where)], plan))


@dataclass(frozen=True)
class Told:
    """What a verdict on a world of a plan has to say of the prompt.

    Attributes:
        unasked: Why an accepted world would not be what was asked for; empty where nothing speaks against it.
        not_checked: A line for each demand that nothing shows.
        stands_in_for: What cannot be simulated, and this world is in place of.
    """

    unasked: str = ""
    not_checked: tuple[str, ...] = ()
    stands_in_for: str = ""


def told(plan: Plan | None) -> Told:
    """What a verdict on a world of a plan has to say of the prompt; nothing without a plan."""
    if plan is None:
        return Told()
    return Told(unasked(plan), tuple(not_checked(plan)), plan.stands_in_for or "")


def unasked(plan: Plan) -> str:
    """Why an accepted world of this plan would not be what was asked for; empty where nothing speaks against it."""
    silent = missing(plan)
    if silent:
        return f"nothing asks for {_listed(silent)}"
    open_ = gaps(plan)
    happens = [each for each in demands(plan.prompt) if each.kind in ("verb", "beyond")]
    if plan.stands_in_for is None and happens and {gap.demand for gap in open_} >= set(happens):
        return f"nothing asks for what happens in it, {_listed([g for g in open_ if g.demand in happens])}"
    return ""


def _listed(found: Sequence[Gap]) -> str:
    return ", ".join(dict.fromkeys(gap.demand.quoted for gap in found))


def spans(plan: Plan) -> list[tuple[Clause, set[int]]]:
    """Each clause with the numbers of the prompt's tokens that are its words; none where they are not in the prompt."""
    said = _words(plan.prompt)
    placed, used = [], dict[tuple[str, ...], int]()
    for clause in plan.clauses:
        words = _words(clause.words)
        start = _find(said, words, used.get(words, 0))
        if start < 0:
            start = _find(said, words, 0)
        placed.append((clause, set(range(start, start + len(words))) if start >= 0 else set()))
        used[words] = start + 1
    return placed


@lru_cache(maxsize=256)
def _words(text: str) -> tuple[str, ...]:
    return tuple(token.text for token in tokens(text) if not token.stops)


def _find(said: tuple[str, ...], words: tuple[str, ...], begin: int) -> int:
    ends = range(begin, len(said) - len(words) + 1)
    return next((k for k in ends if words and said[k : k + len(words)] == words), -1)


def _within(demand: Demand, where: set[int]) -> bool:
    return set(range(demand.first, demand.last + 1)) <= where


def _gap(demand: Demand, clauses: Sequence[Clause], plan: Plan) -> Gap | None:
    """What is missing of a demand, given the clauses whose words hold it."""
    tied = [clause for clause in clauses if clause.by]
    reasons = [clause.unchecked for clause in clauses if clause.unchecked]
    springs = demand.base in SPRINGY and any(_of_spring(each, plan) for each in _asked(tied, plan))
    if demand.kind == "beyond" and not demand.denied and not springs:  # whatever it is tied to shows something else
        if plan.stands_in_for is not None or reasons:
            return Gap(demand, next(iter(reasons), "the world stands in for it"), said=True)
        return Gap(demand, f"wsim has rigid bodies and water, and nothing in it can {demand.base}")
    if demand.kind == "manner":
        alone = [clause for clause in tied if not _more_than(demand, clause)]
        return None if alone else Gap(demand, next(iter(reasons), "nothing measures it"), said=bool(reasons))
    if any(_shows(clause, demand, plan) for clause in tied):
        why = _unlike(demand, tied, plan)
        return Gap(demand, next(iter(reasons), why), said=bool(reasons)) if why else None
    if reasons:
        return Gap(demand, reasons[0], said=True)
    return Gap(demand, _lacks(demand) if clauses else UNTIED)


def _unlike(demand: Demand, tied: Sequence[Clause], plan: Plan) -> str:
    """Why what is named for something that happens shows something else; empty where it shows it."""
    asked = _asked(tied, plan)
    if demand.kind not in ("verb", "state", "beyond"):
        return ""
    if not asked:
        return wrong_way(plan, demand, (), tied)
    if demand.denied and demand.kind != "beyond":
        denials = [each for each in asked if shows_not(each, demand.base)]
        if not denials:
            return NOT_SHOWN
        if not demand.timed and all(for_a_while(each, plan.simulation.duration) for each in denials):
            return NOT_ALL
    if not demand.denied and demand.kind == "verb":  # what denies one thing does not show another
        asked = [each for each in asked if not denies(each)] or asked
        if demand.base in (GOES | TURNS) - {"go"} and all(is_idle(each) for each in asked):
            return IDLE
    if not demand.denied and not is_blow_shown(demand.base, asked):
        return BLOW
    if why := strangers(plan, demand, asked):
        return why
    if demand.kind == "state":
        return counted_short(plan, demand, asked)
    started = demand.base in CAUSES and any(field in STARTS for clause in tied for _, field in clause.things)
    return (
        ("" if started else outsiders(plan, demand, asked))
        or counted_short(plan, demand, asked)
        or wrong_way(plan, demand, asked, tied)
        or stays_there(plan, demand)
        or turned_round(plan, demand, asked)
    )


def _asked(clauses: Sequence[Clause], plan: Plan) -> list[Objective]:
    """The objectives that clauses name, of those that are there: the judge may be asked for some of a plan's."""
    return [plan.objectives[n] for clause in clauses for n in clause.objectives if n < len(plan.objectives)]


def _more_than(manner: Demand, clause: Clause) -> bool:
    """Whether a clause speaks of more than a manner: then what answers for it need not show that."""
    return any(each.kind in REQUIRED for each in demands(clause.words) if each.text != manner.text)


def _shows(clause: Clause, demand: Demand, plan: Plan) -> bool:
    asked = _asked([clause], plan)
    if demand.kind == "often":
        shown = asks_again if demand.text.lower() == "again" else asks_exactly
        return any(shown(each) for each in asked)
    if demand.often:
        return any(asks_often(each, demand.value or 0.0) for each in asked)
    if demand.kind == "number" and not demand.unit:
        return _counted(clause, demand)
    if demand.bound:
        short = plan.simulation.duration
        return any(asks_by_then(each, demand) for each in asked) or (bool(asked) and ends_by(short, demand))
    if demand.kind == "number":
        return any(asks(each, demand) for each in asked) or any(
            states(plan, name, field, demand)
            for name, field in clause.things
            if not (demand.gone and field == "place") and is_of(plan, demand, name)
        )
    if demand.denied:
        return bool(asked)
    if asked or demand.kind == "state":
        return True
    loose = {item.name for item in plan.objects if item.state == "dynamic"}
    if demand.base in LETS_GO and any(name in loose for name, _ in clause.things):
        return True
    scheduled = {each.name for each in plan.schedules}
    openings = {each.name for each in plan.openings}
    if demand.base in OPENED and any(name in openings for name, _ in clause.things):
        return True
    if demand.base in SCHEDULED and any(name in scheduled for name, _ in clause.things):
        return True
    return demand.base in CAUSES and any(field in STARTS for _, field in clause.things)


def _of_spring(objective: Objective, plan: Plan) -> bool:
    """Whether an objective is about what a spring, or a joint whose drive is one, ties."""
    ends = {name for cord in plan.cords if cord.kind == "spring" for name in (cord.a, cord.b)}
    for joint in plan.joints:
        if joint.drive is not None and joint.drive.stiffness > 0.0:
            ends |= {joint.child, joint.parent}
    return bool(speaks_of(objective) & ends)


def _counted(clause: Clause, demand: Demand) -> bool:
    """Of a count the things themselves answer, as many as it says; one may be many (a scatter, a robot's legs)."""
    whole = [name for name, field in clause.things if not field]
    several = len(whole) > 1 and len(whole) == len(clause.by or [])
    return not several or demand.value is None or len(whole) >= demand.value


def _lacks(demand: Demand) -> str:
    """What a demand lacks that clauses hold, and no objective or thing of theirs shows."""
    if demand.kind == "often":
        return AGAIN if demand.text.lower() == "again" else EXACTLY
    if demand.often:
        return OFTEN
    if demand.bound:
        return BY_THEN.format(demand.value)
    if demand.kind == "number" and not demand.unit:
        return "fewer things are named for it"
    if demand.kind == "number":
        return "no objective that is named for it has this value, nor a property, such as puck.velocity, nor a schedule"
    return NOT_SHOWN if demand.denied else "it happens, and no objective is named for it"
