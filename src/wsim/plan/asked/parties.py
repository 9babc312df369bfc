"""Who does it to whom: the things of the plan that stand before and behind a verb, by their names."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from wsim.plan.asked import vocabulary as words
from wsim.plan.asked.demands import demands
from wsim.plan.asked.shown import BLOWS, shows
from wsim.plan.asked.tokens import Words, text_at

if TYPE_CHECKING:
    from wsim.plan.asked.demands import Demand
    from wsim.plan.schema import Objective, Plan

MEETS = BLOWS | {"touch", "push", "knock", "land", "meet"}  # what one thing does to another
_EACH_OTHER = frozenset(("collide", "meet", "touch", "crash"))  # what two do to each other
_TO = frozenset(("into", "against", "with", "on", "onto", "upon", "over", "down"))  # between a verb and whom it is of
_INTO = frozenset(("roll", "slide", "fly", "swing", "drive", "run", "move", "go", "glide", "fall", "drop", "plunge"))
_CONTACT = frozenset(("collides_with", "touches"))
_MEETINGS = frozenset(("collides_with", "touches", "pushes", "never_touches", "not_touches", "not_collides_with"))
_ORDINALS = "first second third fourth fifth last next other another same"
_ONE_OF = frozenset(_ORDINALS.split())  # of some of one name
_SOME = words.as_set("all both each either many most neither none one several some") | frozenset(words.WORDS)
_FLOOR = frozenset(("ground", "floor"))
_ELSE = ("touches_only", "stays_within", "follows_path", "conserves", "ordered")  # says something of other kinds
Names = frozenset[str]
Mentions = dict[int, tuple[int, Names]]  # of the plan's things, by their last tokens: where each begins, and what it is


@dataclass(frozen=True)
class Parties:
    """Who takes part in what a verb says, each as the names of the things that it may be; unknown ones are left out.

    Attributes:
        does: Who does it, each of several.
        bears: Whom it is done to.
    """

    does: tuple[Names, ...]
    bears: Names | None


def strangers(plan: Plan, demand: Demand, objectives: Sequence[Objective]) -> str:
    """Why none of a verb's objectives is about those that it is said of; empty where one is, or it is not known.

    Args:
        plan: The plan.
        demand: The verb.
        objectives: Those that clauses name for it.
    """
    into = demand.base in _INTO
    if into:  # it is said of the motion as well: what is asked of a blow alone is compared
        objectives = [each for each in objectives if shows(each, _CONTACT)]
    if not objectives or not (into or demand.base in MEETS):
        return ""
    found = takes_part(plan, demand)
    if found.bears is None:
        return ""
    bears = whole_of(plan, found.bears)
    if why := _other_way_round(plan, demand, found, objectives):
        return why
    asked = [(involved(each, plan), shows(each, _MEETINGS)) for each in objectives]
    known = [(names, meets) for names, meets in asked if names is not None]
    if len(known) < len(asked):
        return ""
    for doer in found.does or (None,):
        alike = doer == found.bears and len(found.bears) == 1  # "a ball hits a ball": which is which is not told
        whole = doer and whole_of(plan, doer)
        if not alike and not any(_is_about(names, meets, whole, bears) for names, meets in known):
            who = f"{said_of(doer)} and {said_of(found.bears)}" if doer else said_of(found.bears)
            about = "; ".join(" and ".join(sorted(names)) for names, _ in known)
            return f"it is said of {who}, and the objectives that are named for it are about {about}"
    return ""


def _other_way_round(plan: Plan, demand: Demand, found: Parties, objectives: Sequence[Objective]) -> str:
    """Why a push is that of the thing pushed; empty where it is not, or it is not known who pushes."""
    passive = text_at(Words.of(plan.prompt).said, demand.first + 1) == "by"
    if demand.base != "push" or demand.denied or passive or not found.does or found.bears is None:
        return ""
    for each in objectives:
        if getattr(each.formula, "op", "") == "pushes" and each.object in found.bears - found.does[0]:
            return f"it is said of {said_of(found.does[0])}, and pushes has {each.object} do it"
    return ""


def whole_of(plan: Plan, names: Names) -> Names:
    """Things with all that is tied to them: what hits a lever's paddle hits the lever, and a scale is its pan.

    Not what hangs on the same frame as they do: two pendulums are two.
    """
    ties = [{joint.child, joint.parent} for joint in plan.joints] + [{cord.a, cord.b} for cord in plan.cords]
    able = {item.name for item in plan.objects if item.state == "dynamic"} | names
    found = names
    while more := {name for tie in ties if found & able & tie for name in tie if name is not None} - found:
        found |= more
    return found


def said_of(names: Names) -> str:
    """Things that one word names, for people."""
    return " or ".join(sorted(names))


def _is_about(names: Names, meets: bool, doer: Names | None, bears: Names) -> bool:
    """Whether an objective about some things is about those: of a meeting both, else what it does to one of them."""
    if len(names) == 1:
        return bool(names & (bears | (doer or frozenset())))
    if not meets:
        return bool(names & bears)
    return any(one in bears and (doer is None or other in doer) for one in names for other in names - {one})


def involved(objective: Objective, plan: Plan) -> Names | None:
    """The plan's things that an objective names; None where it names others, or many at a time."""
    if objective.formula is None:
        found = {name for name in (objective.object, objective.ref) if name is not None}
    else:
        if any(str(getattr(node, "op", "")) in _ELSE for node in objective.formula.walk()):
            return None
        found = objective.formula.names()
    known = {item.name for item in plan.objects}
    return frozenset(found) if found and found <= known else None


def takes_part(plan: Plan, demand: Demand) -> Parties:
    """Who takes part in what a verb says.

    Args:
        plan: The plan, whose things are meant.
        demand: The verb.
    """
    read = Words.of(plan.prompt)
    verbs = {each.first for each in demands(plan.prompt) if each.kind in ("verb", "state", "beyond")}
    named = mentions(read, plan)
    k = demand.first
    passive = text_at(read.said, k + 1) == "by"
    if demand.base in _INTO:
        return Parties(before(read, named, verbs, k), _met(read, named, verbs, k + 1))
    bears = _behind(read, named, verbs, k + 1 + passive)
    does = before(read, named, verbs, k)
    if bears is None and demand.base in _EACH_OTHER and not passive:  # "two balls collide", "a ball and a box meet"
        bears = does[1] if len(does) == 2 else does[0] if len(does) == 1 and len(does[0]) > 1 else None
        return Parties(does[:1], bears)
    return Parties(does, bears)


def mentions(read: Words, plan: Plan) -> Mentions:
    """What of the plan the prompt's nouns name."""
    own = {item.name: set(item.name.lower().split("_")) | (_FLOOR if item.primitive == "ground" else set())
           for item in plan.objects}  # fmt: skip
    found: Mentions = {}
    k = 0
    while k < len(read.said):
        end, names = k, _named_by(read, k, own) if _may_name(read, k) else frozenset()
        while names and (more := _named_by(read, end + 1, own) & names) and end + 1 not in read.breaks:
            end, names = end + 1, more
        if names:
            found[end] = k, _narrowed(read, k, end, names, own)
        k = end + 1
    return found


def _may_name(read: Words, k: int) -> bool:
    """Whether a name may begin with a word: a number stands behind one."""
    text = read.said[k].text
    return text.isalpha() and text not in words.NO_NOUN and text not in words.WORDS


def _named_by(read: Words, k: int, own: dict[str, set[str]]) -> Names:
    """The things that have a word in their names."""
    text = text_at(read.said, k)
    forms = {text, text.removesuffix("s"), text.removesuffix("es")}
    return frozenset(name for name, parts in own.items() if forms & parts)


def _narrowed(read: Words, begin: int, end: int, names: Names, own: dict[str, set[str]]) -> Names:
    """Those whose whole name is said, where some are: "the red ball" is not the ball, "the second ball" may be any."""
    if _ONE_OF & {read.said[k].text for k in range(max(0, begin - 3), begin)}:
        return names
    said = {read.said[k].text for k in range(max(0, begin - 3), end + 1)}
    said |= {text.removesuffix("s") for text in said}
    # What numbers tell apart has one name: "a 3 kg box and a 2 kg box" are box and box_1.
    called = {name: {part for part in own[name] - _FLOOR if not part.isdigit()} for name in names}
    whole = [name for name in names if called[name] <= said]
    longest = max((len(called[name]) for name in whole), default=0)
    return frozenset(name for name in whole if len(called[name]) == longest) or names


def _behind(read: Words, named: Mentions, verbs: set[int], k: int) -> Names | None:
    """What a verb is done to: the noun right behind it, with no preposition between but those of `_TO`."""
    starts = {begin: (end, names) for end, (begin, names) in named.items()}
    for i in range(k, min(k + 6, len(read.said))):
        text = read.said[i].text
        if i in read.breaks or i in verbs:
            return None
        if i in starts:
            end, names = starts[i]
            return names if _is_a_noun(read, end) else None
        if text in words.NO_NOUN and text not in words.DETERMINERS and not (text in _TO and i <= k + 1):
            return None
    return None


def _met(read: Words, named: Mentions, verbs: set[int], k: int) -> Names | None:
    """What something goes into or against, behind all else that is said of its way."""
    for i in range(k, len(read.said)):
        if i in read.breaks or i in verbs:
            return None
        if read.said[i].text in ("into", "against"):
            return _behind(read, named, verbs, i)
    return None


def _is_a_noun(read: Words, end: int) -> bool:
    """Whether nothing follows that is a noun: "the box lid" is no box."""
    after = text_at(read.said, end + 1)
    plain = not after.isalpha() or after in words.NO_NOUN or after.endswith("ly") or words.stem(after) is not None
    return plain or end + 1 in read.breaks or end + 1 == len(read.said)


def before(read: Words, named: Mentions, verbs: set[int], k: int) -> tuple[Names, ...]:
    """Who does it: the noun before a verb that no preposition and no other verb governs, and those tied to it."""
    found: list[Names] = []
    i = k - 1
    while i >= 0 and i + 1 not in read.opens:
        if found and i + 1 in read.breaks:
            break
        if i not in named:
            if text_at(read.said, i) in ("it", "they", "he", "she") and not found:
                return ()
            if found and text_at(read.said, i) != "and":
                break
            i -= 1
            continue
        begin, names = named[i]
        free = begin
        while free > 0 and _describes(read, free - 1, verbs):
            free -= 1
            if read.said[free].text in words.DETERMINERS:  # with it a noun begins: "hits the box the crate falls"
                break
        governed = text_at(read.said, free - 1)
        if governed == "of" and text_at(read.said, free - 2) in _SOME:  # "neither of the balls", "two of the balls"
            governed = ""
        is_object = free - 1 in verbs and governed not in ("let", "lets", "make", "makes", "watch", "see")
        if governed in words.PREPOSITIONS - {"after", "before", "until"} or is_object:
            if found:
                break
            i = free - 2
            continue
        found.append(names)
        i = free - 1
    return tuple(found)


def _describes(read: Words, i: int, verbs: set[int]) -> bool:
    """Whether a word belongs to the noun behind it: an article, a number, an adjective."""
    text = read.said[i].text
    if i + 1 in read.breaks or i in verbs:
        return False
    return text in words.DETERMINERS - {"that"} or text in words.WORDS or text not in words.NO_NOUN
