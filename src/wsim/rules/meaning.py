"""Clauses become a cast: which things there are, where they are, and what each is to do."""

from __future__ import annotations

from wsim.errors import UserError
from wsim.rules.actions import MOVES, act, meet
from wsim.rules.cast import Cast, Pour, Thing
from wsim.rules.grammar import NotUnderstood
from wsim.rules.lexicon import lexicon
from wsim.rules.phrases import Action, Clause, Phrase
from wsim.rules.places import stand

MOST_OF_A_KIND = 24
UNCOUNTED = 3  # how many "some" are: a plural without a number
EACH_OTHER = ("each other", "one another")


def understand(clauses: list[Clause]) -> Cast:
    """Who does what, where.

    Raises:
        NotUnderstood: a thing or an action cannot be bound to the scene.
        UserError: the prompt contradicts itself.
    """
    reader = Reader()
    for clause in clauses:
        reader.clause(clause)
    reader.settle()
    return reader.cast


class Reader:
    """Reads clauses one by one; knows what was spoken of before."""

    def __init__(self) -> None:
        self.cast = Cast()
        self.last: list[Thing] = []  # what "it" and "they" mean
        self.named: dict[int, Thing] = {}  # what a phrase was found to name, by identity
        self.tanks: list[Phrase] = []
        self.struck: Thing | None = None  # the stack that was hit last

    # ---- clauses
    def clause(self, clause: Clause) -> None:
        """Take in one clause."""
        subjects: list[Thing] = []
        scenery = []
        pending: list[Phrase] = []
        for phrase in clause.subjects:
            if self.is_scenery(phrase):
                self.scenery(phrase)
                scenery.append(phrase)
                continue
            if phrase.kind == "pronoun":
                subjects += self.pronoun(phrase, clause.actions)
            else:
                subjects.append(self.thing(phrase))
            pending.append(phrase)
            if phrase.places:  # "a cork ball and an iron ball in a tank": both are in it
                for thing in subjects[-len(pending) :]:
                    stand(self, thing, phrase.places)
                pending = []
        for action in clause.actions:
            if self._of_scenery(clause, scenery, subjects, action):
                continue
            if action.verb in ("collide", "hit") and (action.target is None or action.target.part in EACH_OTHER):
                meet(self, subjects, action)
                continue
            for thing in subjects:
                act(self, thing, action)
        if subjects:
            self.last = subjects

    def _of_scenery(self, clause: Clause, scenery: list[Phrase], subjects: list[Thing], action: Action) -> bool:
        """Whether an action is the tank's or the water's, and is done with."""
        if action.verb == "pour":
            if subjects or any(phrase.kind != "water" for phrase in scenery):
                raise NotUnderstood([clause.words], "pours water, but not this")
            self._pour(action)
            return True
        if action.verb == "hold":
            held = action.target
            if subjects or held is None or held.kind != "water" or any(phrase.kind != "tank" for phrase in scenery):
                raise NotUnderstood([clause.words], "knows only of a tank that holds water, not of this")
            self.scenery(held)
            return True
        standing = action.verb == "rest" and all(
            place.phrase is not None and place.phrase.kind == "ground" for place in action.places
        )
        back = any(place.phrase is not None and place.phrase.kind in ("pronoun", "water") for place in action.places)
        if scenery and not (standing and not subjects) and not (subjects and back):
            raise NotUnderstood([clause.words], "lets blocks and balls act, but not a tank, water or the ground")
        return False

    def _pour(self, action: Action) -> None:
        vessel, height = None, None
        into = False
        for place in action.places:
            if place.preposition == "from" and place.length is not None:
                height = place.length
            elif place.preposition in ("into", "in", "inside", "onto") and place.phrase is not None:
                into = True
                if place.phrase.kind == "pronoun":
                    raise NotUnderstood([place.words], "needs to be told into what:")
                vessel = None if self.is_scenery(place.phrase) else self.thing(place.phrase)
                if vessel is None and place.phrase.kind != "tank":
                    raise NotUnderstood([action.words], "pours water into a tank, a bowl or a bucket, not there:")
                if vessel is None:
                    self.scenery(place.phrase)
            else:
                raise NotUnderstood([place.words], "cannot pour water there:")
        if not into or (vessel is not None and (vessel.noun.family != "vessel" or vessel.count > 1)):
            raise NotUnderstood([action.words], "pours water into a tank, a bowl or a bucket:")
        self.cast.pour = Pour(vessel, height)

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
        return self.named[id(phrase)]

    def _find(self, phrase: Phrase) -> Thing:
        if phrase.definite:
            known = [thing for thing in self.cast.things if matches(thing, phrase)]
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
                self.cast.assume(phrase.words, f"{UNCOUNTED} of them", "the prompt gives no number")
                return UNCOUNTED
            return 1
        if not 1 <= phrase.count <= MOST_OF_A_KIND:
            raise UserError(f"{phrase.words!r}: the builtin planner places 1 to {MOST_OF_A_KIND} things of a kind")
        return phrase.count

    # ---- the end
    def settle(self) -> None:
        """Give each thing whose place is open the one that the rest of the scene leaves for it."""
        for thing in self.cast.things:
            _check_used(thing)
            if thing.place is not None:
                continue
            moves = bool({*MOVES, "topple"} & {*thing.does}) or thing.group or thing.noun.family != "solid"
            wet = self.cast.wet and not moves
            thing.place = "water" if wet else "ground"
            if ("drop" in thing.does or not thing.does) and thing.support is None and thing.inside is None:
                where = "in the tank of water" if wet else "on the ground"
                self.cast.assume(thing.words, where, "the prompt does not say where")
        if any(thing.group and thing.place == "water" for thing in self.cast.things):
            raise UserError(
                "the builtin planner stacks things on the ground, not in water; unstack them, or leave the water out"
            )
        if self.cast.wet and any({*MOVES} & {*thing.does} for thing in self.cast.things):
            raise UserError(
                "the builtin planner rolls things in a scene without a tank; leave the tank out, or what rolls"
            )
        if not self.cast.things and not self.cast.wet and self.cast.pour is None:
            raise NotUnderstood(["the prompt"], "found nothing to build in")


def _check_adjectives(phrase: Phrase) -> None:
    """Refuse adjectives that the noun cannot carry, rather than drop them."""
    vessel = phrase.kind not in ("water", "ground", "part", "group")
    carried = [
        word for word in (phrase.material, phrase.color) if word is not None and not (vessel and word == "glass")
    ]
    sized = phrase.scale is not None or phrase.length is not None or bool(phrase.measures)
    counted = phrase.count is not None and phrase.count != 1
    filled = phrase.filled and not vessel
    if carried or sized or counted or filled or phrase.angle is not None:
        raise NotUnderstood([phrase.words], "can give these words to a block or a ball, but not to this")


def _check_used(thing: Thing) -> None:
    """Refuse what no scene would use, rather than drop it."""
    phrase, family = thing.phrase, thing.noun.family
    moving = thing.target is not None or {"roll", "slide", "push", "throw", "meet"} & {*thing.does}
    posed = thing.target or thing.meets or thing.path or thing.rod or thing.inside or thing.place == "water"
    ill = family in ("pendulum", "seesaw") or (thing.support is not None and thing.support.noun.family == "seesaw")
    for given, problem in (
        (phrase.angle is not None and family != "ramp", "inclines a ramp, but not this"),
        (phrase.filled, "fills a tank, a bucket or a bowl with water, but not this"),
        (thing.speed is not None and not moving, "needs to be told how this moves"),
        (bool(thing.beside) and bool(posed or ill), "cannot place this beside something, with what else it does"),
        (
            family == "pendulum" and bool(set(phrase.measures) - {"x", "z", "mass"}),
            "cannot give a pendulum this measure",
        ),
        (phrase.scale is not None and phrase.length is not None, "takes a size or a length, not both"),
        ({"mass", "density"} <= set(phrase.measures), "takes a mass or a density, not both"),
    ):
        if given:
            raise NotUnderstood([thing.words], problem)


def matches(thing: Thing, phrase: Phrase) -> bool:
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
