"""Clauses that follow each other: what a list names, what is said once of two, and what waits."""

from __future__ import annotations

from wsim.rules.phrases import Action, Clause, Place
from wsim.rules.tokens import NotUnderstood

_GOALS = ("into", "onto", "down", "off", "towards", "against", "via")  # where one goes, and nothing stands


def list_of(clause: Clause, named: Clause) -> bool:
    """Put in the place of "five things" what they are, after a colon; whether the clause names such."""
    ones = all(phrase.kind == "one" for phrase in named.subjects)  # "three crates: a small one, …"
    at = next((i for i, p in enumerate(clause.subjects) if p.kind == "things" or (ones and p.plural)), None)
    if at is None or named.actions:
        return False
    for phrase in named.subjects if ones else []:
        phrase.kind = clause.subjects[at].kind
        phrase.material = phrase.material or clause.subjects[at].material
        phrase.color = phrase.color or clause.subjects[at].color
    things = clause.subjects[at]
    count = sum(phrase.count or 1 for phrase in named.subjects)
    if things.count not in (None, count):
        raise NotUnderstood([things.words], f"is told of {count} things after the colon, not of")
    named.subjects[-1].places += things.places
    clause.subjects[at : at + 1] = named.subjects
    return True


def delayed(clause: Clause, later: Place | None) -> Clause:
    """What happens after a time: "after two seconds a ball and a box fall"."""
    if later is not None and not clause.actions:
        raise NotUnderstood([later.words], "needs to be told what happens")
    if later is not None:
        for action in clause.actions:
            action.places.append(later)
    return clause


def names_only(clause: Clause) -> bool:
    """Whether a clause names things and says no more of them; "one at each end" does, of those before."""
    return not clause.actions and all(phrase.kind != "choice" for phrase in clause.subjects)


def gapped(clause: Clause, named: Clause, has: bool) -> None:
    """ "Drop a ball into a tank and a box onto a table": the verb is said once.

    Args:
        clause: With the verb.
        named: What may be without.
        has: Whether more is said of it: "and a conveyor with two crates runs".
    """
    places = named.subjects[-1].places if named.subjects else []
    goes = bool(places) and all(place.preposition in _GOALS for place in places)
    last = clause.actions[-1] if clause.actions else None
    ends = last is not None and (last.target or (last.places and last.places[-1].phrase))
    if (
        not has
        and not places
        and names_only(named)
        and last is not None
        and (ends or named.then or not clause.inverted)
    ):
        # "rolls into a box and a brick", "rolls and a brick"
        raise NotUnderstood([f"{last.words} and {named.words}"], "cannot tell what is said of the last of these")
    if named.actions or not goes or len(clause.actions) != 1 or clause.actions[0].target is not None:
        return
    words = " ".join(place.words for place in places)
    named.actions = [Action(clause.actions[0].verb, f"{clause.actions[0].verb} {words}", places=places)]
    named.subjects[-1].places = []


def beside_it(clause: Clause, named: Clause) -> None:
    """Refuse "drop a ball with a brick", which is of both; "a ball is dropped on a table with a mug on it" is not."""
    last = clause.actions[-1]
    if last.target is None and not last.places and last.verb not in ("rest", "float", "run", "tilt", "stack", "swing"):
        raise NotUnderstood([f"{last.words} with {named.words}"], "cannot tell what is said of the last of these")


def parted(clauses: list[Clause]) -> None:
    """ "One with a cube and the other with a ball": the other is no thing that the first has."""
    last = clauses[-1]
    if last.given and not last.actions and len(last.subjects) > 1 and last.subjects[-1].kind == "choice":
        clauses.append(Clause([last.subjects.pop()]))


def had(clause: Clause, has: Clause, text: str) -> list[Clause]:
    """ "A cube with a ball on it slides": the cube does; "a table with a lamp, and a ball rolls off it": the ball does.

    Args:
        clause: What is named before "with".
        has: What is named after it, and what is done.
        text: The prompt.
    """
    if clause.actions or not has.actions or not text[: has.subjects[0].at].endswith("with "):
        return [has]
    places = [place for action in has.actions for place in action.places]
    back = any(place.phrase is not None and place.phrase.part in ("it", "them") for place in places)
    last = has.subjects[-1]
    apart = len(has.subjects) > 1 and (back or text[: last.at].endswith((", and ", ", while ")))
    if apart or last.kind in ("pronoun", "choice"):
        named = [Clause(has.subjects[:-1], given=True, within=has.within)] if has.subjects[:-1] else []
        return [*named, Clause([last], has.actions, given=not named, within=has.within)]
    if back:
        return [has]
    return [
        Clause(has.subjects, given=True, within=has.within),
        Clause(clause.subjects, has.actions, again=True, within=has.within),
    ]
