"""What the reader of a prompt knows so far: which thing a phrase means, a new one or one spoken of before."""

from __future__ import annotations

from copy import copy
from dataclasses import replace

from wsim.errors import UserError
from wsim.rules import contents
from wsim.rules.cast import Cast, Flow, Thing
from wsim.rules.lexicon import lexicon
from wsim.rules.phrases import Action, Phrase
from wsim.rules.tokens import NotUnderstood

MOST_OF_A_KIND = 24
UNCOUNTED = 3  # how many "some" are: a plural without a number
EACH_OTHER = ("each other", "one another")


class Reader:
    """Knows what was spoken of before; places and actions ask it what a phrase means, and note it in its cast."""

    def __init__(self) -> None:
        self.cast = Cast()
        self.last: list[Thing] = []  # what "it" and "they" mean
        self.spoken: list[Thing] = []  # among which "the first" or "the other" chooses
        self.chosen: list[Thing] = []  # by the choices so far
        self.earlier: list[tuple[list[Thing], list[Thing]]] = []  # those two, before what "with" has named
        self.told: set[str] = set()  # the kinds of which all were spoken of, before any was named
        self.partly: list[tuple[list[Thing], list[Thing]]] = []  # some of several, and the others
        self.named: dict[int, Thing] = {}  # what a phrase was found to name, by identity
        self.singles: dict[int, list[Thing]] = {}  # what a thing that was several has become, by identity
        self.kept: list[Phrase] = []  # made on the way: their identity must stay theirs
        self.tanks: list[Phrase] = []
        self.alone = False  # whether nothing is in what holds a liquid: then a bowl of water is that bowl, and no tank
        self.flowing: dict[int, Flow] = {}  # the taps, rain and holes that phrases name, by identity
        self.struck: Thing | None = None  # the stack that was hit last

    # ---- the tank, the water, the ground
    def is_scenery(self, phrase: Phrase) -> bool:
        """Whether a phrase names the tank, the water or the ground, which the cast holds once."""
        if phrase.kind in ("water", "ground"):
            return True
        if phrase.kind == "part":
            return self.part_of(phrase) is None
        noun = lexicon().nouns.get(phrase.kind)
        if noun is None:
            return False
        held = noun.family == "vessel" and bool(phrase.filled) and not self.alone
        return held or noun.family in ("tank", "tap", "rain", "drain")

    def scenery(self, phrase: Phrase) -> None:
        """Take in the tank, the water or the ground."""
        if phrase.kind == "ground":
            self._ground(phrase)
            return
        if phrase.kind in lexicon().nouns and lexicon().nouns[phrase.kind].family in ("tap", "rain", "drain"):
            raise NotUnderstood([phrase.words], "lets fluid in or out by this, and puts nothing there:")
        _check_adjectives(contents.bare(phrase))
        if phrase.kind not in ("water", "part"):
            again = phrase.definite or any(phrase is known for known in self.tanks)
            if self.cast.tank is not None and not again:
                raise UserError(
                    f"the builtin planner builds one tank; the prompt names {self.cast.tank!r} and {phrase.words!r}"
                )
            self.tanks.append(phrase)
            self.cast.tank = self.cast.tank or phrase.words
            contents.full(self.cast, phrase)
        elif phrase.kind == "water":
            contents.named(self.cast, phrase)
        for place in phrase.places:
            if place.phrase is not None and self.is_scenery(place.phrase) and place.phrase.kind != "part":
                self.scenery(place.phrase)
            else:
                raise NotUnderstood([phrase.words], "cannot place this there")

    def _ground(self, phrase: Phrase) -> None:
        """The ground, which may be of a material: "a wooden floor", "ice"."""
        _check_adjectives(replace(phrase, material=None))
        if phrase.material is not None:
            if self.cast.ground not in (None, phrase.material):
                raise UserError(f"{phrase.words!r}: the ground is of {self.cast.ground} already; it is one")
            self.cast.ground = phrase.material

    # ---- things
    def pronoun(self, phrase: Phrase, actions: list[Action]) -> list[Thing]:
        """The things that "it" or "they" mean."""
        falls = any(action.verb == "topple" or action.particle in ("over", "down") for action in actions)
        if falls and self.struck is not None and not any(action.target for action in actions):
            return [self.struck]
        if not self.last or phrase.part in EACH_OTHER:
            raise NotUnderstood([phrase.words], "cannot tell what this stands for")
        several = [one for one in self.cast.things if one.count > 1]
        if phrase.part == "they" and several and sum(one.count for one in self.last) == 1:
            return several[-1:]  # "a conveyor carries two boxes and they fall off"
        return self.last

    def it(self, phrase: Phrase, besides: Thing | None) -> Thing:
        """The one thing, other than the one that is spoken of, that "it" means."""
        single = phrase.part in ("it", "itself")
        for group in (self.last, self.cast.things[::-1]):
            for one in group:
                if one is not besides and (one.count == 1 or one.group or not single):
                    return one
        raise NotUnderstood([phrase.words], "cannot tell what this stands for")

    def subjects(self, phrase: Phrase, actions: list[Action]) -> list[Thing]:
        """The things that a clause is about."""
        found = self._subjects(phrase, actions)
        owner = self.named.get(id(phrase.owner)) if phrase.choice == "all" else None
        if owner is not None and owner.phrase is phrase.owner and owner.phrase.definite:  # named by this alone
            self.told.add(owner.kind)
        self.cast.named += [(thing, phrase) for thing in found]
        return found

    def _subjects(self, phrase: Phrase, actions: list[Action]) -> list[Thing]:
        if phrase.kind == "pronoun":
            return self.pronoun(phrase, actions)
        if phrase.kind == "choice":
            return self._choose(phrase)
        if phrase.kind == "part":
            owner = self.part_of(phrase)
            if owner is None:
                raise NotUnderstood([phrase.words], "cannot tell of what this is a part")
            other = {"left": "right", "right": "left"}
            owner.side = (
                other.get(self._end_of(owner), "other") if phrase.choice == "other" else phrase.choice or owner.side
            )
            return [owner]
        if phrase.nth is not None and phrase.definite:
            return self._choose(replace(phrase, choice="nth", kind="choice", owner=None), phrase)
        if phrase.masses:
            return self._weighed(phrase)
        return [self.thing(phrase)]

    def _end_of(self, owner: Thing) -> str:
        """The end of a thing that was spoken of before: that at which something is."""
        sides = [one.side for one in self.cast.things if one.support is owner and one.side in ("left", "right", "one")]
        if not sides:
            return owner.side or ""
        for one in self.cast.things:
            if one.support is owner and one.side == "one":
                one.side = "right"
        return "right" if sides[0] == "one" else sides[0] or ""

    def _weighed(self, phrase: Phrase) -> list[Thing]:
        """ "Two weights of 3 kg and 2 kg": as many things as masses."""
        if phrase.count not in (None, len(phrase.masses)):
            raise NotUnderstood([phrase.words], "needs a mass for each of them")
        made = [replace(phrase, count=1, masses=(), measures={"mass": mass}) for mass in phrase.masses]
        return [self.thing(each) for each in made]

    def part_of(self, phrase: Phrase) -> Thing | None:
        """The thing of which a phrase names a part: its owner's, else the last that has ends; None for the water's."""
        if phrase.owner is not None:
            return None if self.is_scenery(phrase.owner) else self.thing(phrase.owner)
        if phrase.part in ("surface", "bottom") or (phrase.part == "top" and self.cast.wet):
            return None
        ends = [thing for thing in self.cast.things if thing.noun.family in _ENDED]
        return ends[-1] if ends else None

    def thing(self, phrase: Phrase) -> Thing:
        """The thing that a phrase names: one spoken of before, or a new one."""
        if phrase.kind == "choice" or (phrase.nth is not None and phrase.definite):
            found = self.subjects(phrase, [])
            if len(found) != 1 or (found[0].group and phrase.nth not in (None, 1)):
                raise NotUnderstood([phrase.words], "cannot tell which of them this is")
            return found[0]
        if id(phrase) not in self.named:
            self.named[id(phrase)] = self._find(phrase)
        return self.named[id(phrase)]

    def _find(self, phrase: Phrase) -> Thing:
        if phrase.kind == "bob":
            return self._bob(phrase)
        if phrase.definite:
            known = [thing for thing in self.cast.things if _matches(thing, phrase)]
            if len(known) > 1:
                raise NotUnderstood([phrase.words], "cannot tell which of them this is")
            if known:
                return known[0]
        if phrase.kind in self.told:
            raise NotUnderstood([phrase.words], "takes what all do for what was named before, and so not for this:")
        if phrase.kind == "pronoun":
            raise NotUnderstood([phrase.words], "cannot tell what this stands for")
        if phrase.kind in ("things", "one"):
            raise NotUnderstood([phrase.words], "needs to be told, after a colon, what this is")
        described = phrase
        if phrase.kind == "group":
            _check_adjectives(replace(phrase, shape=None, clauses=[]))
            if phrase.members is None:
                raise NotUnderstood(
                    [phrase.words], "has to be told what this is made of, as in 'a stack of five boxes'"
                )
            described = phrase.members
        stacked = [said for said in described.clauses if said.verb == "stack" and not said.places]
        described.clauses = [said for said in described.clauses if said not in stacked]  # "two stacked crates"
        thing = Thing(described, self._count(described, phrase.kind == "group"), arrangement=phrase.arrangement)
        thing.phrase.words = phrase.words
        if stacked and thing.count > 1:
            thing.arrangement = "stack"
        if thing.kind == "domino" and thing.count > 1:
            thing.arrangement = thing.arrangement or "row"
        if phrase.kind == "group" and thing.noun.family != "solid":
            raise NotUnderstood([phrase.words], "stacks what moves, but not this")
        self.cast.things.append(thing)
        return thing

    def _bob(self, phrase: Phrase) -> Thing:
        """A pendulum's bob is the pendulum, of which it says mass, size and material."""
        pendulums = self.cast.family("pendulum")
        if not pendulums or phrase.length or phrase.edges or (phrase.count or 1) > 1:
            raise NotUnderstood([phrase.words], "knows the bob of a pendulum, but not this")
        thing = pendulums[-1]
        for name in ("material", "color", "scale", "weight"):
            if getattr(phrase, name) is not None:
                setattr(thing.phrase, name, getattr(phrase, name))
        thing.phrase.measures |= phrase.measures
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

    # ---- some of what was spoken of
    def _choose(self, phrase: Phrase, kind: Phrase | None = None) -> list[Thing]:
        """Which of the things that were spoken of a choice means: "the first", "the other", "all", "the steel one"."""
        among = self._among(phrase, kind)
        if phrase.choice == "other" and phrase.owner is None and self.earlier and not self.chosen:
            self.spoken, self.chosen = self.earlier.pop()
            among = self._among(phrase, kind)
        rest = [thing for thing in among if thing not in self.chosen]
        count = phrase.count or 1
        if phrase.choice == "all":
            found = among
        elif phrase.choice == "other":
            found = rest or [thing for thing in among if thing.group]
        elif phrase.choice == "nth":
            start = (phrase.nth or 1) - 1 if (phrase.nth or 1) > 0 else len(among) - count
            found = among if len(among) == 1 and among[0].group else among[start : start + count]
        elif phrase.choice == "some":
            found = rest[:count]
        else:
            found = _described(among, phrase)
        if not found or (phrase.choice in ("nth", "some") and len(found) < count and not found[0].group):
            raise NotUnderstood([phrase.words], "cannot tell which of what was spoken of this is")
        if phrase.choice == "some" and found[0].group:
            raise NotUnderstood([phrase.words], "cannot part a stack or a row, of which some would do this:")
        self.chosen += found
        if phrase.choice == "some":
            self.partly.append((found, [thing for thing in among if thing not in found]))
        return found

    def _among(self, phrase: Phrase, kind: Phrase | None) -> list[Thing]:
        """What a choice chooses from; several that are alike become single things."""
        if phrase.owner is not None and phrase.owner.kind != "pronoun":
            among = self.subjects(phrase.owner, [])
        elif kind is not None:
            among = [thing for thing in self.cast.things if thing.kind == kind.kind]
        else:
            among = self.spoken
        if phrase.members is not None:
            among = [one for one in self.cast.things if one.kind == phrase.members.kind]
            if not among:
                among = [self.thing(phrase.members)]
                self.told.add(phrase.members.kind)
        among = [now for one in among for now in self.now(one)]
        whole = phrase.choice == "all"
        found: list[Thing] = []
        for thing in among:
            found += [thing] if whole or thing.count == 1 or thing.group else self.split(thing)
        return found

    def now(self, thing: Thing) -> list[Thing]:
        """What a thing that was named is by now: itself, or the single things that it was split into."""
        return self.singles.get(id(thing), [thing])

    def split(self, thing: Thing) -> list[Thing]:
        """Single things in place of one that is several."""
        singles = []
        for _ in range(thing.count):
            one = copy(thing)
            one.phrase = replace(thing.phrase, count=1, plural=False)
            one.count, one.does, one.beside = 1, [*thing.does], [*thing.beside]
            one.surface, one.pairs, one.of = dict(thing.surface), [*thing.pairs], thing.count
            singles.append(one)
        at = self.cast.things.index(thing)
        self.cast.things[at : at + 1] = singles
        self.singles[id(thing)] = singles
        for known in (self.spoken, self.last):
            if thing in known:
                known[:] = [new for old in known for new in (singles if old is thing else [old])]
        return singles


_ENDED = ("seesaw", "belt", "turntable", "furniture", "ramp")  # what has ends, edges and a top


def _described(among: list[Thing], phrase: Phrase) -> list[Thing]:
    """Those with the attributes of a choice: "the steel one", "the heavier one"."""
    if phrase.part is None:
        kind = among[0].phrase.kind if among else ""
        return [one for one in among if _matches(one, replace(phrase, kind=one.kind if kind else ""))]
    key = {"heavier": ("mass", 1), "lighter": ("mass", -1)}.get(phrase.part, ("length", 0))
    if key[1] == 0 or any("mass" not in one.phrase.measures for one in among) or len(among) < 2:
        raise NotUnderstood([phrase.words], "needs the mass of each, to know which this is")
    ordered = sorted(among, key=lambda one: -key[1] * one.phrase.measures["mass"])
    return ordered[:1]


def _check_adjectives(phrase: Phrase) -> None:
    """Refuse adjectives that the noun cannot carry, rather than drop them."""
    vessel = phrase.kind not in ("water", "ground", "part", "group")
    carried = [
        word for word in (phrase.material, phrase.color) if word is not None and not (vessel and word == "glass")
    ]
    sized = phrase.scale is not None or phrase.length is not None or bool(phrase.measures)
    counted = phrase.count is not None and phrase.count != 1
    filled = phrase.filled and not vessel
    other = phrase.weight or phrase.shape or phrase.masses or phrase.clauses or phrase.edges
    if other or carried or sized or counted or filled or phrase.angle is not None:
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
    for name in ("color", "scale", "length", "weight", "shape"):
        if getattr(phrase, name) is not None and getattr(phrase, name) != getattr(said, name):
            return False
    if any(said.measures.get(name) != value for name, value in phrase.measures.items()):
        return False
    if phrase.count is not None and phrase.count != thing.count:
        return False
    if not phrase.plural and thing.count > 1 and not thing.group:
        raise NotUnderstood([phrase.words], f"cannot tell which of the {thing.count} this is")
    return True
