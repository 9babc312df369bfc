"""Clauses become a cast: which things there are, where they are, and what each is to do."""

from __future__ import annotations

from wsim.errors import UserError
from wsim.plan.cast import Cast, Thing
from wsim.plan.grammar import Action, Clause, NotUnderstood, Phrase, Place
from wsim.plan.materials import MATERIALS

MOST_OF_A_KIND = 24
UNCOUNTED = 3  # how many "some" are: a plural without a number


def understand(clauses: list[Clause]) -> Cast:
    """Who does what, where.

    Raises:
        NotUnderstood: a thing or an action cannot be bound to the scene.
        UserError: the prompt contradicts itself.
    """
    reader = _Reader()
    for clause in clauses:
        reader.clause(clause)
    reader.settle()
    return reader.cast


class _Reader:
    def __init__(self) -> None:
        self.cast = Cast()
        self.last: list[Thing] = []  # what "it" and "they" mean
        self.named: dict[int, Thing] = {}  # what a phrase was found to name, by identity
        self.tanks: list[Phrase] = []
        self.struck: Thing | None = None  # the stack that was hit last

    # ---- clauses
    def clause(self, clause: Clause) -> None:
        subjects: list[Thing] = []
        scenery = []
        pending: list[Phrase] = []
        for phrase in clause.subjects:
            if phrase.kind in ("tank", "water", "ground", "part"):
                self._scenery(phrase)
                scenery.append(phrase)
                continue
            if phrase.kind == "pronoun":
                subjects += self._pronoun(phrase, clause.actions)
            else:
                subjects.append(self._thing(phrase))
            pending.append(phrase)
            if phrase.places:  # "a cork ball and an iron ball in a tank": both are in it
                for thing in subjects[-len(pending) :]:
                    self._stand(thing, phrase.places)
                pending = []
        for action in clause.actions:
            self._check_scenery(clause, scenery, subjects, action)
            for thing in subjects:
                self._act(thing, action)
        if subjects:
            self.last = subjects

    def _check_scenery(self, clause: Clause, scenery: list[Phrase], subjects: list[Thing], action: Action) -> None:
        if action.verb == "hold":
            held = action.target
            if subjects or held is None or held.kind != "water" or any(phrase.kind != "tank" for phrase in scenery):
                raise NotUnderstood([clause.words], "knows only of a tank that holds water, not of this")
            self._scenery(held)
            return
        standing = action.verb == "rest" and all(
            place.phrase is not None and place.phrase.kind == "ground" for place in action.places
        )
        back = any(place.phrase is not None and place.phrase.kind in ("pronoun", "water") for place in action.places)
        if scenery and not (standing and not subjects) and not (subjects and back):
            raise NotUnderstood([clause.words], "lets blocks and balls act, but not a tank, water or the ground")

    def _scenery(self, phrase: Phrase) -> None:
        if phrase.kind == "tank":
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
            if place.phrase is not None and place.phrase.kind in ("tank", "water", "ground"):
                self._scenery(place.phrase)
            else:
                raise NotUnderstood([phrase.words], "cannot place this there")

    # ---- things
    def _pronoun(self, phrase: Phrase, actions: list[Action]) -> list[Thing]:
        falls = any(action.verb == "topple" or action.particle in ("over", "down") for action in actions)
        if falls and self.struck is not None and not any(action.target for action in actions):
            return [self.struck]
        if not self.last:
            raise NotUnderstood([phrase.words], "cannot tell what this stands for")
        return self.last

    def _thing(self, phrase: Phrase) -> Thing:
        """The thing that a phrase names: one spoken of before, or a new one."""
        if id(phrase) not in self.named:
            self.named[id(phrase)] = self._find(phrase)
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
            if phrase.members is None:
                raise NotUnderstood(
                    [phrase.words], "has to be told what this is made of, as in 'a stack of five boxes'"
                )
            described = phrase.members
        thing = Thing(described, self._count(described, phrase.kind == "group"), group=phrase.kind == "group")
        thing.phrase.words = phrase.words
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

    # ---- places
    def _stand(self, thing: Thing, places: list[Place]) -> None:
        """Where a thing is, when nothing says what it does there."""
        for place in places:
            at = place.phrase
            if place.length is not None or place.preposition not in ("in", "inside", "on", "at") or at is None:
                raise NotUnderstood([f"{thing.words} {place.preposition}"], "knows these words, but cannot place them")
            if at.kind == "group" and at.members is None and place.preposition == "in":
                self._stack(thing)
                continue
            where = self._where(at)
            if isinstance(where, Thing):
                self._support(thing, where)
                self._do(thing, "rest")
            elif where == "water":
                self._put(thing, "water")
                if place.preposition == "on" or _part(at) in ("surface", "top"):
                    self._do(thing, "float")
                elif _part(at) == "bottom":
                    self._do(thing, "sink")
            else:
                self._put(thing, "ground")
                self._do(thing, "rest")

    def _where(self, phrase: Phrase) -> str | Thing:
        """The water, the ground, or a thing."""
        if phrase.kind in ("tank", "water"):
            self._scenery(phrase)
            return "water"
        if phrase.kind == "ground":
            return "ground"
        if phrase.kind == "part":
            if phrase.owner is not None:
                return self._where(phrase.owner)
            if phrase.part in ("surface", "bottom"):
                return "water"
            raise NotUnderstood([phrase.words], "cannot tell of what this is a part")
        if phrase.kind == "pronoun":
            if self.cast.wet and all(thing.place == "water" for thing in self.last):
                return "water"
            return self._pronoun(phrase, [])[0]
        return self._thing(phrase)

    def _put(self, thing: Thing, place: str) -> None:
        if thing.place is not None and thing.place != place:
            raise UserError(f"{thing.words!r} cannot be in the water and on the ground")
        thing.place = place

    def _support(self, thing: Thing, other: Thing) -> None:
        if other is thing:
            raise NotUnderstood([thing.words], "cannot place a thing on itself:")
        if other.place == "water":
            raise UserError(
                f"{thing.words!r} on {other.words!r}: the builtin planner stacks things on the ground, not in water"
            )
        if other.count > 1 and not other.group:
            raise NotUnderstood([other.words], "cannot tell which of them this is")
        if any(one is not thing and one.support is other for one in self.cast.things):
            raise UserError(f"{other.words!r}: the builtin planner puts one thing, or a stack, on another, not two")
        thing.support = other
        self._put(thing, "ground")
        self._put(other, "ground")

    def _stack(self, thing: Thing) -> None:
        if thing.count < 2:
            raise UserError(f"{thing.words!r}: a stack has at least two things; give a number")
        thing.group = True
        self._put(thing, "ground")
        self._do(thing, "rest")

    def _do(self, thing: Thing, what: str) -> None:
        if what not in thing.does:
            thing.does.append(what)
        for a, b in (("float", "sink"), ("float", "submerge")):
            if a in thing.does and b in thing.does:
                raise UserError(f"{thing.words!r} cannot both {a} and {b}; the prompt asks for both")

    # ---- actions
    def _act(self, thing: Thing, action: Action) -> None:
        if action.verb in ("float", "sink", "submerge"):
            self._in_water(thing, action)
        elif action.verb == "topple" or (action.verb == "fall" and action.particle in ("over", "down") and thing.group):
            self._topple(thing, action)
        elif action.verb == "fall" and action.particle == "over":
            raise NotUnderstood([action.words], "lets a stack fall over, but not this")
        elif action.verb in ("drop", "fall"):
            self._drop(thing, action)
        elif action.verb in ("hit", "knock", "roll"):
            self._roll(thing, action)
        elif action.verb == "stack":
            if any(place.phrase is None or self._where(place.phrase) != "ground" for place in action.places):
                raise NotUnderstood([action.words], "stacks things on the ground, not there:")
            self._stack(thing)
        else:
            self._stand(thing, action.places)
            self._do(thing, "rest")

    def _in_water(self, thing: Thing, action: Action) -> None:
        if thing.group:
            raise UserError(f"{thing.words!r}: the builtin planner stacks things on the ground, not in water")
        self._put(thing, "water")
        self._do(thing, action.verb)
        for place in action.places:
            if place.phrase is None or place.preposition in ("from", "above", "against", "towards", "toward"):
                raise NotUnderstood([action.words], "knows these words, but not in this order")
            if self._where(place.phrase) != "water" and place.phrase.kind != "ground":
                raise NotUnderstood([action.words], f"cannot let a thing {action.verb} there:")
            if action.verb == "float" and _part(place.phrase) == "bottom":
                raise UserError(f"{action.words!r}: what floats is not at the bottom")

    def _topple(self, thing: Thing, action: Action) -> None:
        if action.target is not None:
            self._roll(thing, action)
            return
        if not thing.group or action.places:
            raise NotUnderstood([action.words], "lets a stack topple, but not this:")
        self._do(thing, "topple")

    def _drop(self, thing: Thing, action: Action) -> None:
        self._do(thing, "drop")
        if action.particle == "in":
            self._put(thing, "water")
        for place in action.places:
            if place.preposition == "from":
                if place.length is None:
                    raise NotUnderstood([action.words], "needs a height after 'from', as in 'from 0.5 m':")
                thing.drop_height = place.length
                continue
            where = None if place.phrase is None else self._where(place.phrase)
            if where is None:
                raise NotUnderstood([action.words], "knows these words, but not in this order")
            if place.preposition == "above" and thing.drop_height is None:
                raise NotUnderstood([action.words], "needs a height, as in 'from 0.5 m above the water':")
            if isinstance(where, Thing):
                self._support(thing, where)
            else:
                self._put(thing, where)

    def _roll(self, thing: Thing, action: Action) -> None:
        if thing.count > 1:
            raise UserError(f"{thing.words!r}: the builtin planner lets one thing roll or hit; give one")
        targets = [action.target] if action.target is not None else []
        for place in action.places:
            if place.phrase is None or place.preposition in ("from", "above", "inside"):
                raise NotUnderstood([action.words], "knows these words, but not in this order")
            if place.phrase.kind == "ground" and place.preposition in ("on", "onto"):
                self._put(thing, "ground")
            elif action.verb == "roll" and place.preposition in ("into", "to", "against", "towards", "toward"):
                targets.append(place.phrase)
            else:
                raise NotUnderstood([action.words], "cannot let a thing roll there:")
        if action.verb in ("hit", "knock") and not targets:
            raise NotUnderstood([action.words], "needs to be told what is hit:")
        if action.verb == "roll" and not targets:
            self._put(thing, "ground")
            self._do(thing, "roll")
        for phrase in targets:
            self._aim(thing, phrase, action)

    def _aim(self, thing: Thing, phrase: Phrase, action: Action) -> None:
        if phrase.kind == "pronoun" and thing.target is None and thing.support is None:
            raise NotUnderstood([action.words], "cannot tell what 'it' stands for in")
        target = (thing.target or thing.support) if phrase.kind == "pronoun" else self._where(phrase)
        if not isinstance(target, Thing) or target is thing:
            raise NotUnderstood([action.words], "lets a thing hit a block, a ball or a stack, not this:")
        if target.count > 1 and not target.group:
            raise NotUnderstood([phrase.words], "cannot tell which of them this is")
        self._put(target, "ground")
        self._put(thing, "ground")
        if action.verb in ("knock", "topple"):
            self._do(target, "topple")
        if "drop" in thing.does:
            thing.support = target
        else:
            thing.target = target
            self._do(thing, "roll")
        if target.group:
            self.struck = target

    # ---- the end
    def settle(self) -> None:
        """Give each thing whose place is open the one that the rest of the scene leaves for it."""
        for thing in self.cast.things:
            if thing.place is not None:
                continue
            rolls = "roll" in thing.does or "topple" in thing.does or thing.group
            wet = self.cast.wet and not rolls
            thing.place = "water" if wet else "ground"
            if "drop" in thing.does or not thing.does:
                where = "in the tank of water" if wet else "on the ground"
                self.cast.assume(thing.words, where, "the prompt does not say where")
        if any(thing.group and thing.place == "water" for thing in self.cast.things):
            raise UserError(
                "the builtin planner stacks things on the ground, not in water; unstack them, or leave the water out"
            )
        if self.cast.wet and any("roll" in thing.does for thing in self.cast.things):
            raise UserError(
                "the builtin planner rolls things in a scene without a tank; leave the tank out, or what rolls"
            )
        if not self.cast.things and not self.cast.wet:
            raise NotUnderstood(["the prompt"], "found nothing to build in")


def _part(phrase: Phrase) -> str | None:
    return phrase.part if phrase.kind == "part" else None


def _matches(thing: Thing, phrase: Phrase) -> bool:
    """Whether a definite phrase may mean a thing spoken of before."""
    if phrase.kind == "group":
        return thing.group
    if thing.kind != phrase.kind and {thing.kind, phrase.kind} not in ({"ball", "sphere"},):
        return False
    said = thing.phrase
    if phrase.material is not None and (
        said.material is None or MATERIALS[said.material] != MATERIALS[phrase.material]
    ):
        return False
    if phrase.color is not None and said.color != phrase.color:
        return False
    if phrase.scale is not None and said.scale != phrase.scale:
        return False
    if phrase.length is not None and said.length != phrase.length:
        return False
    if phrase.count is not None and phrase.count != thing.count:
        return False
    if not phrase.plural and thing.count > 1 and not thing.group:
        raise NotUnderstood([phrase.words], f"cannot tell which of the {thing.count} this is")
    return True
