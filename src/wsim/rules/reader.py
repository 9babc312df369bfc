"""What the reader of a prompt knows so far: which thing a phrase means, a new one or one spoken of before."""

from __future__ import annotations

from wsim.errors import UserError
from wsim.rules.cast import CARRIERS, Cast, Thing
from wsim.rules.grammar import NotUnderstood
from wsim.rules.lexicon import lexicon
from wsim.rules.phrases import Action, Phrase

MOST_OF_A_KIND = 24
UNCOUNTED = 3  # how many "some" are: a plural without a number
EACH_OTHER = ("each other", "one another")


class Reader:
    """Knows what was spoken of before; places and actions ask it what a phrase means, and note it in its cast."""

    def __init__(self) -> None:
        self.cast = Cast()
        self.last: list[Thing] = []  # what "it" and "they" mean
        self.named: dict[int, Thing] = {}  # what a phrase was found to name, by identity
        self.tanks: list[Phrase] = []
        self.struck: Thing | None = None  # the stack that was hit last

    # ---- the tank, the water, the ground
    def is_scenery(self, phrase: Phrase) -> bool:
        """Whether a phrase names the tank, the water or the ground, which the cast holds once."""
        if phrase.kind in ("water", "ground", "part"):
            return True
        noun = lexicon().nouns.get(phrase.kind)
        return noun is not None and (noun.family == "tank" or (noun.family == "vessel" and phrase.filled))

    def scenery(self, phrase: Phrase) -> None:
        """Take in the tank, the water or the ground."""
        _check_adjectives(phrase)
        if phrase.kind not in ("water", "ground", "part"):
            again = phrase.definite or any(phrase is known for known in self.tanks)
            if self.cast.tank is not None and not again:
                raise UserError(
                    f"the builtin planner builds one tank; the prompt names {self.cast.tank!r} and {phrase.words!r}"
                )
            self.tanks.append(phrase)
            self.cast.tank = self.cast.tank or phrase.words
            if phrase.filled:
                self.cast.water = self.cast.water or phrase.words
        elif phrase.kind == "water":
            self.cast.water = self.cast.water or phrase.words
        for place in phrase.places:
            if place.phrase is not None and self.is_scenery(place.phrase) and place.phrase.kind != "part":
                self.scenery(place.phrase)
            else:
                raise NotUnderstood([phrase.words], "cannot place this there")

    # ---- things
    def pronoun(self, phrase: Phrase, actions: list[Action]) -> list[Thing]:
        """The things that "it" or "they" mean."""
        falls = any(action.verb == "topple" or action.particle in ("over", "down") for action in actions)
        if falls and self.struck is not None and not any(action.target for action in actions):
            return [self.struck]
        if not self.last or phrase.part in EACH_OTHER:
            raise NotUnderstood([phrase.words], "cannot tell what this stands for")
        return self.last

    def thing(self, phrase: Phrase) -> Thing:
        """The thing that a phrase names: one spoken of before, or a new one."""
        if id(phrase) not in self.named:
            self.named[id(phrase)] = self._find(phrase)
            if phrase.runs:
                _let_run(self.named[id(phrase)], phrase)
        return self.named[id(phrase)]

    def _find(self, phrase: Phrase) -> Thing:
        if phrase.definite:
            known = [thing for thing in self.cast.things if _matches(thing, phrase)]
            if len(known) > 1:
                raise NotUnderstood([phrase.words], "cannot tell which of them this is")
            if known:
                return known[0]
        described = phrase
        if phrase.kind == "group":
            _check_adjectives(phrase)
            if phrase.members is None:
                raise NotUnderstood(
                    [phrase.words], "has to be told what this is made of, as in 'a stack of five boxes'"
                )
            described = phrase.members
        thing = Thing(described, self._count(described, phrase.kind == "group"), arrangement=phrase.arrangement)
        thing.phrase.words = phrase.words
        if phrase.kind == "group" and thing.noun.family != "solid":
            raise NotUnderstood([phrase.words], "stacks what moves, but not this")
        self.cast.things.append(thing)
        return thing

    def _count(self, phrase: Phrase, group: bool) -> int:
        if phrase.count is None:
            if phrase.plural or group:
                choice, why = f"{UNCOUNTED} of them", "the prompt gives no number"
                self.cast.assume(phrase.words, choice, why, "count", str(UNCOUNTED))
                return UNCOUNTED
            return 1
        if not 1 <= phrase.count <= MOST_OF_A_KIND:
            raise UserError(f"{phrase.words!r}: the builtin planner places 1 to {MOST_OF_A_KIND} things of a kind")
        return phrase.count


def _let_run(thing: Thing, phrase: Phrase) -> None:
    """Take in what a phrase says of how it runs: "a belt that runs at 1 m/s"."""
    if thing.noun.family not in CARRIERS:
        raise NotUnderstood([phrase.words], "lets a conveyor run and a turntable turn, but not this")
    thing.place = "ground"
    thing.does.append("run")
    thing.speed = thing.speed if phrase.speed is None else phrase.speed
    thing.spin = thing.spin if phrase.spin is None else phrase.spin


def _check_adjectives(phrase: Phrase) -> None:
    """Refuse adjectives that the noun cannot carry, rather than drop them."""
    vessel = phrase.kind not in ("water", "ground", "part", "group")
    carried = [
        word for word in (phrase.material, phrase.color) if word is not None and not (vessel and word == "glass")
    ]
    sized = phrase.scale is not None or phrase.length is not None or bool(phrase.measures)
    counted = phrase.count is not None and phrase.count != 1
    filled = phrase.filled and not vessel
    if phrase.runs or carried or sized or counted or filled or phrase.angle is not None:
        raise NotUnderstood([phrase.words], "can give these words to a block or a ball, but not to this")


def _matches(thing: Thing, phrase: Phrase) -> bool:
    """Whether a definite phrase may mean a thing spoken of before."""
    if phrase.kind == "group":
        return thing.group
    if thing.kind != phrase.kind and {thing.kind, phrase.kind} not in ({"ball", "sphere"},):
        return False
    said = thing.phrase
    materials = lexicon().materials
    if phrase.material is not None and (
        said.material is None or materials[said.material] != materials[phrase.material]
    ):
        return False
    for name in ("color", "scale", "length"):
        if getattr(phrase, name) is not None and getattr(phrase, name) != getattr(said, name):
            return False
    if phrase.count is not None and phrase.count != thing.count:
        return False
    if not phrase.plural and thing.count > 1 and not thing.group:
        raise NotUnderstood([phrase.words], f"cannot tell which of the {thing.count} this is")
    return True
