"""Of whom a verb is said: whether its objectives are about any of those, and about each of as many as it says."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from wsim.plan.asked import vocabulary as words
from wsim.plan.asked.demands import demands
from wsim.plan.asked.numbers import numbers
from wsim.plan.asked.parties import Mentions, Names, before, involved, mentions, said_of, whole_of
from wsim.plan.asked.shown import BY_ITSELF
from wsim.plan.asked.tokens import Words, text_at
from wsim.plan.schema.formula import VOCABULARY

if TYPE_CHECKING:
    from wsim.plan.asked.demands import Demand
    from wsim.plan.schema import Objective, Plan

_ALL = words.as_set("all both each every neither none")
_LINKS = words.as_set(
    "also and both but can did do does each is are be being been has have had not never or still then was were will"
)
_IT = words.as_set("it them itself themselves each one another him her")
_FEW = 3  # words between what counts and the noun: "three of the small red balls"


def outsiders(plan: Plan, demand: Demand, objectives: Sequence[Objective], some: bool = False) -> str:
    """Why a verb's objectives are not about those that it is said of, or about some of them alone; else empty.

    Where it is not known of whom it is said, or an objective is about many at a time, nothing is.

    Args:
        plan: The plan.
        demand: The verb.
        objectives: Those that clauses name for it.
        some: Whether they may be about some of those alone.
    """
    read = Words.of(plan.prompt)
    named = mentions(read, plan)
    verbs = {each.first for each in demands(plan.prompt) if each.kind in ("verb", "state", "beyond")}
    does = doers(plan, demand)
    about = [involved(each, plan) for each in objectives]
    known = [names for names in about if names is not None]
    if not does or not known or len(known) < len(about) or _is_object_unknown(read, named, demand.first + 1):
        return ""
    party = frozenset().union(*does, *_around(read, named, verbs, demand))
    if not any(names & whole_of(plan, party) for names in known):
        asked = "; ".join(" and ".join(sorted(names)) for names in known)
        return f"it is said of {said_of(does[0])}, and the objectives that are named for it are about {asked}"
    for names in () if some else does:
        left = [one for one in sorted(names) if not any(each & whole_of(plan, frozenset((one,))) for each in known)]
        if left and _is_of_all(read, named, names, demand):
            return f"it is said of all of {', '.join(sorted(names))}, and nothing that is named for it is of {left[0]}"
    return ""


def doers(plan: Plan, demand: Demand) -> tuple[Names, ...]:
    """Of whom a verb is said, each of several as the names of the things that it may be; empty where it is not known.

    Args:
        plan: The plan.
        demand: The verb.
    """
    read = Words.of(plan.prompt)
    named = mentions(read, plan)
    verbs = {each.first for each in demands(plan.prompt) if each.kind in ("verb", "state", "beyond")}
    if not _is_subject_known(read, named, demand.first):
        return ()
    return tuple(names for names in before(read, named, verbs, demand.first) if _are_named_so(read, names))


def is_of(plan: Plan, number: Demand, name: str) -> bool:
    """Whether a number may be a thing's: "a box of 3 kg", "a 3 kg box", "the box weighs 3 kg" is of no other.

    Args:
        plan: The plan.
        number: Of its prompt.
        name: Of a thing, a joint or a schedule.
    """
    read = Words.of(plan.prompt)
    named = mentions(read, plan)
    k = number.first
    of = [names for end, (begin, names) in named.items() if (end == k - 2 and read.said[k - 1].text in ("of", "weighs"))
          or (begin == number.last + 1 and begin not in read.breaks)]  # fmt: skip
    meant = of[0] if len(of) == 1 and _are_named_so(read, of[0]) else frozenset()
    return not meant or name not in {item.name for item in plan.objects} or name in whole_of(plan, meant)


def counted_short(plan: Plan, demand: Demand, objectives: Sequence[Objective]) -> str:
    """Why objectives that count things ask for another number than is said of the verb; empty where they do not."""
    read = Words.of(plan.prompt)
    asked = [node for each in objectives if each.formula is not None for node in each.formula.walk()
             if isinstance(node, VOCABULARY["counts"])]  # fmt: skip
    found = _number_before(read, mentions(read, plan), demand)
    if not asked or found is None or any(dict(node)["least"] == found for node in asked):
        return ""
    return f"it is said of {found:g}, and counts asks for {dict(asked[0])['least']:g}"


def _is_subject_known(read: Words, named: Mentions, k: int) -> bool:
    """Whether what stands before a verb is a thing of the plan, or ties it to a verb before it: "and falls"."""
    j = k - 1
    while j >= 0 and (read.said[j].text in _LINKS or read.said[j].text.endswith(("ly", "n't"))):
        j -= 1
    return j in named


def _are_named_so(read: Words, names: Names) -> bool:
    """Whether things have the name that is said, and are no parts of what has it: winch_left of a winch."""
    said = {token.text for token in read.said}
    said |= {text.removesuffix("s") for text in said} | {text.removesuffix("es") for text in said}
    return all(part.isdigit() or part in said for name in names for part in name.lower().split("_"))


def _is_object_unknown(read: Words, named: Mentions, k: int) -> bool:
    """Whether a verb is done to what is no thing of the plan by its name: "leaves the lower one", "carries it"."""
    if text_at(read.said, k) in _IT:
        return True
    begins = {begin for begin, _ in named.values()}
    behind = next((i for i in range(k, k + _FEW + 1) if i in begins or i in read.breaks), k + _FEW + 1)
    return text_at(read.said, k) in words.DETERMINERS and behind not in begins


def _around(read: Words, named: Mentions, verbs: set[int], demand: Demand) -> list[Names]:
    """The things right before a verb, and those behind it up to the next one; of what one does by itself the first.

    A ball that drops on a box drops itself; a crane that drops a box drops that.
    """
    k = demand.first
    found = [names for end, (_, names) in named.items() if end == k - 1]
    for i in range(k + 1, len(read.said)):
        by_itself = demand.base in BY_ITSELF and read.said[i].text in words.PREPOSITIONS
        if i in read.breaks or i in verbs or by_itself:
            break
        found += [named[i][1]] if i in named else []
    return found


def _is_of_all(read: Words, named: Mentions, names: Names, demand: Demand) -> bool:
    """Whether a verb is said of each of some things: "both balls", "three balls" where there are three, "no box"."""
    begin = next((b for end, (b, of) in reversed(named.items()) if of == names and end < demand.first), None)
    if begin is None or len(names) < 2 or named.get(demand.first - 1, (0, names))[1] != names:  # "in a tank filled"
        return False
    here = range(max(0, begin - _FEW), begin)
    told = {read.said[k].text for k in here if not {*range(k + 1, begin)} & read.breaks}
    if told & _ALL or (demand.denied and "no" in told):
        return True
    if "of" in told:  # "two of three balls"
        return False
    counts = [n.value for n in numbers(read.said) if n.last in here and not n.unit]
    return counts[-1:] == [len(names)]


def _number_before(read: Words, named: Mentions, demand: Demand) -> float | None:
    """How many the verb is said of: "two of the three balls land" is of two."""
    ends = [end for end in named if end < demand.first]
    if not ends or any(k in read.breaks for k in range(ends[-1] + 1, demand.first + 1)):
        return None
    begin = named[ends[-1]][0]
    found = [n for n in numbers(read.said) if begin - _FEW - 1 <= n.first < begin and not n.unit]
    if not found or any(k in read.breaks for k in range(found[0].first + 1, begin)):
        return None
    if len(found) > 1 and text_at(read.said, found[0].last + 1) != "of":
        return found[-1].value
    return found[0].value
