"""Things on the ground and on each other: rows, stacks, tables and what is on them, drops."""

from __future__ import annotations

from dataclasses import replace

from wsim.defaults import WALL
from wsim.errors import UserError
from wsim.plan.layout.bodies import around, extents
from wsim.plan.schema import Objective, PlanObject, Registration, Relation
from wsim.plan.schema.formula_contact import CollidesWith, SupportedBy
from wsim.plan.schema.predicates import OVERLAP
from wsim.rules.cast import Beside, Cast, Thing
from wsim.rules.places import SIDES
from wsim.rules.scenes.bounce import bounce, bounces
from wsim.rules.scenes.hit import hit, meet, struck
from wsim.rules.scenes.lasting import asked
from wsim.rules.scenes.legs import on_legs
from wsim.rules.scenes.motion import ground_object, move, throw_height, top
from wsim.rules.scenes.part import Part, fall_time, tall, tidy
from wsim.rules.scenes.tip import on_side, slender, tipped, upended
from wsim.rules.sizes import bodies, mouth

GAP = 0.15  # between neighbours on the ground [m]
APART = 0.004  # between things in a vessel [m]
GAP_ABOVE = 0.08  # between neighbours on a table [m]
ROW_SHARE = 0.5  # of their height, between things in a row: each then reaches the next as it falls
_UNDER = ("ALIGN-CENTER-LR", "ALIGN-CENTER-FB")  # with what it is under
DROP_HEIGHT, HIGH = 0.5, 1.5  # usually, and of what is to bounce often [m]


def build_ground(cast: Cast, taken: set[str], scene: Part) -> Part:
    """Everything that stands on the ground, in a row along Y beside what is there already, or in front of a tank.

    Args:
        cast: What the prompt speaks of.
        taken: Names in use; grows.
        scene: What is there already.
    """
    things = [thing for thing in cast.things if thing.place == "ground" and id(thing) not in scene.names]
    part = Part(duration=3.0 if any(_waits(thing) for thing in things) else 1.5, names=scene.names)
    _settle_sides(things, cast)
    _part_bridged(things)
    for thing in things:
        for beside in thing.beside:
            if (
                not any(item.name in scene.names.get(id(beside.ref), []) for item in scene.objects)
                and id(beside.ref) in scene.names
            ):
                raise UserError(
                    f"{thing.words!r} beside {beside.ref.words!r}: the builtin planner builds nothing there"
                )
    ends = _Ends(scene, still=not any(_goes(thing) for thing in things))
    catches = [one for thing in things for one in (thing.into, thing.over) if one is not None]
    for thing in catches:
        [part.vessels[id(thing)]] = bodies(thing, cast, taken)
        part.names[id(thing)] = [part.vessels[id(thing)].name]
    # What carries another comes first: its name is needed. What goes along the row has its end of it.
    for thing in sorted(things, key=lambda thing: (_depth(thing, []), _lane(thing))):
        if thing in catches:
            continue
        if thing.target is None and "meet" not in thing.does:
            _place(thing, cast, taken, part, ends)
    for thing in things:
        if "meet" in thing.does:
            meet(thing, cast, taken, part)
        elif thing.target is not None:
            hit(thing, cast, taken, part)
    for thing in cast.things:
        if thing.target is not None and thing.path is not None:
            struck(thing, part, scene)
    return part


def _waits(thing: Thing) -> bool:
    """Whether a thing moves, and nothing has set it in motion: it is seen to stay, or to fall and come to rest."""
    return thing.noun.family == "solid" and not {"roll", "slide", "push", "throw", "meet"} & {*thing.does}


def _goes(thing: Thing) -> bool:
    return bool({"roll", "slide", "push", "throw", "meet", "topple"} & {*thing.does})


def _lane(thing: Thing) -> int:
    """Where in a row something stands, from right to left: with nothing on the side to which it goes."""
    return {"right": -1, "left": 1}.get(thing.direction or "", 0) if _goes(thing) else 0


class _Ends:
    """Where rows end: what the next thing without a place of its own stands beside."""

    def __init__(self, scene: Part, *, still: bool) -> None:
        tank = any(item.name == "tank" for item in scene.objects)
        fixed = [item for item in scene.objects if item.pose is not None]
        self.side = "FRONT-OF" if tank and still and not fixed else "LEFT-OF"
        first = max(fixed, key=lambda item: around(item).high[1]).name if fixed else "tank" if tank else None
        self.last: dict[int | None, str] = {} if first is None else {None: first}
        edge = max((around(item).high[1] for item in fixed), default=0.0)
        self.inside: dict[int, list[str]] = {}  # what is in a vessel
        self.goes: dict[int | None, str] = {}  # what goes to the left, as the last of its row
        self.juts: dict[int | None, float] = {}  # by which what the last of a row carries is wider than that [m]
        self.clear = tidy(scene.span[1] - edge) if fixed else 0.0  # by which what it carries juts out [m]

    def among(self, thing: Thing, name: str) -> list[str]:
        """What is in the same vessel before an object."""
        found = self.inside.setdefault(id(thing.inside), [])
        found.append(name)
        return found[:-1]

    def row(self, thing: Thing, juts: float) -> Relation | None:
        """The row that puts a thing, over which what it carries juts out, beside the last one on the same support."""
        on = None if thing.support is None else id(thing.support)
        if on not in self.last:
            return None
        side, gap = (self.side, GAP + self.clear) if on is None else ("LEFT-OF", GAP_ABOVE)
        if _lane(thing) < 0 or (_lane(thing) > 0 and on in self.goes):
            side = "BACK-OF"  # on a line of its own: it would run into what is there, or be run into
        self.clear = 0.0 if on is None else self.clear
        return Relation(predicate=side, ref=self.last[on], gap=tidy(gap + juts + self.juts.get(on, 0.0)))

    def grow(self, thing: Thing, name: str, juts: float = 0.0) -> None:
        """Note a new end."""
        self.juts[None if thing.support is None else id(thing.support)] = juts
        if _lane(thing) > 0:
            self.goes[None if thing.support is None else id(thing.support)] = name
        self.last[None if thing.support is None else id(thing.support)] = name


def _settle_sides(things: list[Thing], cast: Cast) -> None:
    """Turn "between" into two sides, and let what is beside a thing on a table stand on that table, too."""
    for thing in things:
        for beside in [b for b in thing.beside if b.predicate == "between"]:
            thing.beside.remove(beside)
            assert beside.other is not None
            thing.beside.append(Beside("LEFT-OF", beside.ref, gap=beside.gap))
            if not _sides(beside.other):
                beside.other.beside.append(Beside("LEFT-OF", thing, gap=beside.gap))
            cast.assume(thing.words, "in a row from right to left", "the prompt says between, not along which line")
    for _ in things:
        for thing in things:
            for beside in _sides(thing):
                on, own = beside.ref.support, thing.support
                if own is not None and own.noun.family == "furniture" and on is None and not beside.ref.does:
                    on = beside.ref.support = own
                    cast.assume(beside.ref.words, f"on {own.words}", f"{thing.words} is there")
                falls = "drop" in thing.does and (on is None or on.noun.family != "furniture")
                if on is not None and thing.support is None and on is not thing and not falls:
                    thing.support = on
                    cast.assume(thing.words, f"on {on.words}", f"{beside.ref.words} is there")


def _part_bridged(things: list[Thing]) -> None:
    """Set what carries a bridge's ends so far apart that it is as long as it is to be."""
    for thing in [one for one in things if one.bridges is not None]:
        assert thing.bridges is not None and thing.support is not None
        length = thing.phrase.length or thing.phrase.measures.get("x") or thing.noun.size[0]
        if not _sides(thing.bridges):
            thing.bridges.beside.append(Beside("LEFT-OF", thing.support, gap=round(length - 2 * OVERLAP, 3)))


def _sides(thing: Thing) -> list[Beside]:
    return [beside for beside in thing.beside if beside.predicate in SIDES]


def _depth(thing: Thing, seen: list[Thing]) -> int:
    if thing in seen:
        names = " and ".join(repr(one.words) for one in seen[:2])
        raise UserError(f"{names} cannot stand on each other, or beside each other in a circle")
    needs = [thing.support, thing.inside, thing.bridges, *(beside.ref for beside in thing.beside)]
    below = [one for one in needs if one is not None and one.target is None]
    return 1 + max((_depth(one, [*seen, thing]) for one in below), default=-1)


def _place(thing: Thing, cast: Cast, taken: set[str], part: Part, ends: _Ends) -> None:
    """Add a thing's objects."""
    if thing.support is not None and thing.count > 1 and not thing.group and thing.support.noun.family != "furniture":
        raise UserError(
            f"{thing.words!r} on {thing.support.words!r}: the builtin planner puts one thing, or a stack, on another"
        )
    below = part.names[id(thing.support)][-1] if thing.support is not None else None
    height = _drop_height(thing, cast, part)
    made = bodies(thing, cast, taken)
    part.names[id(thing)] = [item.name for item in made]
    if not thing.does and thing.support is None and any(one.support is thing and bounces(one) for one in cast.things):
        # A loose one would go down into the ground and take the blow's energy along.
        made = [item.model_copy(update={"state": "static", "registration": Registration()}) for item in made]
        cast.assume(thing.words, "fixed to the ground", "so that what falls on it bounces off it alone")
    if "upright" in thing.manners:
        made = [upended(item) for item in made]
    if "on_side" in thing.manners:
        made = [on_side(item, thing) for item in made]
    if "topple" in thing.does and thing.arrangement != "stack":
        made = [slender(thing, item, cast) for item in made]
    if "topple" in thing.does and not _hit(thing, cast):
        made = tipped(thing, made, part, cast)
    for index, item in enumerate(made):
        stacked = thing.arrangement == "stack" and index > 0
        lower = made[index - 1].name if stacked else below
        start = _start(thing, lower, height, part, stacked)
        rows = [start, *(_in_plane(thing, made, index, part, ends, cast) if not stacked else [])]
        rows += [] if stacked else _facing(thing, part)
        item = move(thing, item, cast, part, below)
        if height is not None and "drop" in thing.does:
            part.goes[item.name] = [(0.0, 0.0, -height)]
        item = item.related(rows + item.relations)
        part.objects += on_legs(thing, item, cast, taken)
        part.objects += part.caught
        part.caught = []
        at = part.names[id(thing.inside)][0] if thing.inside is not None else lower
        if bounces(thing):
            surface = next(o for o in [*part.objects, ground_object()] if o.name == (below or "ground"))
            part.objectives += bounce(thing, item, surface, part, cast)
            continue
        if thing.off and "bounce" in thing.does:
            part.objectives += bounce(thing, item, ground_object(cast.ground), part, cast)
        part.objectives += _objectives(thing, item, at, last=index == len(made) - 1, cast=cast)
        part.objectives += _on_both(thing, item.name, part)


def _start(thing: Thing, lower: str | None, height: float | None, part: Part, stacked: bool) -> Relation:
    if stacked:
        return Relation(predicate="PLACE-ON", ref=lower)
    if thing.inside is not None:
        vessel = part.names[id(thing.inside)][0]
        if height is not None:
            rim = WALL + next(item.size[2] for item in part.objects if item.name == vessel)
            rim += top(part.names[id(thing.inside.support)][-1], part) if thing.inside.support is not None else 0.0
            return Relation(predicate="SPAWNED-ABOVE", value=round(rim + height, 6))
        return Relation(predicate="PLACE-IN", ref=vessel)
    if height is not None:
        return Relation(predicate="SPAWNED-ABOVE", ref=lower, value=height)
    if thing.bridges is not None:
        other = part.names[id(thing.bridges)][-1]
        return Relation(predicate="bridge_between_a_and_b", ref=lower, other=other)
    if lower is not None:
        return Relation(predicate="PLACE-ON", ref=lower)
    return Relation(predicate="PLACE-ON-BASE")


def _in_plane(thing: Thing, made: list[PlanObject], index: int, part: Part, ends: _Ends, cast: Cast) -> list[Relation]:
    """The rows that say where in the plane an object is."""
    item = made[index]
    if thing.inside is not None:
        vessel = part.names[id(thing.inside)][0]
        held = sum(one.count for one in cast.things if one.inside is thing.inside)
        return _in_vessel(thing, item, vessel, held, ends.among(thing, item.name))
    if thing.arrangement == "row" and index > 0:
        gap = round(ROW_SHARE * tall(item), 3)
        return [Relation(predicate="FRONT-OF", ref=made[index - 1].name, gap=gap)]
    if thing.bridges is not None:
        return []
    if any(beside.predicate == "under" for beside in thing.beside):
        return []
    sides = _sides(thing) if index == 0 else []
    if _sides(thing) and index:  # several behind a thing: next to each other
        across = {"FRONT-OF": "LEFT-OF", "BACK-OF": "LEFT-OF"}.get(_sides(thing)[0].predicate, "FRONT-OF")
        return [Relation(predicate=across, ref=made[index - 1].name, gap=GAP if thing.support is None else GAP_ABOVE)]
    if not sides:
        # On the middle of what carries it, unless something is there already.
        juts = _juts(thing, item, cast)
        row = ends.row(thing, juts)
        ends.grow(thing, item.name, juts)
        return [] if row is None else [row]
    gap = GAP if thing.support is None else GAP_ABOVE
    rows = []
    for beside in sides:
        ref = part.names[id(beside.ref)][-1 if beside.ref.arrangement != "stack" else 0]
        rows.append(Relation(predicate=beside.predicate, ref=ref, gap=gap if beside.gap is None else beside.gap))
        on = None if thing.support is None else id(thing.support)
        if beside.predicate == "LEFT-OF" and ends.last.get(on) == ref:
            ends.grow(thing, item.name)
    return rows


def _juts(thing: Thing, item: PlanObject, cast: Cast) -> float:
    """By how much what a thing carries reaches over it, on each side [m]: neighbours then have room as well."""
    if thing.noun.family != "solid":
        return 0.0
    carried = [one for one in cast.things if one.support is thing and one.bridges is None]
    made = [one for each in carried for one in bodies(each, replace(cast, assumptions=[]), set())]
    return max([0.0, *((extents(one)[1] - extents(item)[1]) / 2 for one in made)])


def _in_vessel(thing: Thing, item: PlanObject, vessel: str, held: int, before: list[str]) -> list[Relation]:
    """One in the middle, and the others around it; alone, only what drops comes down in the middle."""
    if held == 1 and "drop" not in thing.does:
        return []
    if not before:
        return [Relation(predicate=predicate, ref=vessel) for predicate in ("ALIGN-CENTER-LR", "ALIGN-CENTER-FB")]
    assert thing.inside is not None
    wide = 2 * item.size[0] if len(item.size) < len("xyz") else max(item.size[:2])
    if wide > min(mouth(thing.inside.noun)[:2]) / 3:
        raise UserError(f"{thing.words!r}: {held} of them do not fit side by side into {thing.inside.words!r}")
    side, of = _AROUND[len(before) - 1]
    return [Relation(predicate=side, ref=before[of], gap=APART)]


_AROUND = (("FRONT-OF", 0), ("BACK-OF", 0), ("LEFT-OF", 0), ("RIGHT-OF", 0), ("LEFT-OF", 1), ("RIGHT-OF", 1),
           ("LEFT-OF", 2), ("RIGHT-OF", 2))  # fmt: skip  # in a vessel: of which of those before


def _facing(thing: Thing, part: Part) -> list[Relation]:
    return [
        Relation(predicate=predicate, ref=part.names[id(beside.ref)][0])
        for beside in thing.beside
        if beside.predicate not in (*SIDES, "beside")
        for predicate in (_UNDER if beside.predicate == "under" else (beside.predicate,))
    ]


def _drop_height(thing: Thing, cast: Cast, part: Part) -> float | None:
    if "throw" in thing.does:
        return throw_height(thing, cast) if thing.support is None else thing.drop_height
    if "drop" not in thing.does:
        return None
    usual = DROP_HEIGHT if (thing.times or 0) <= 2 else HIGH
    height = cast.drop_height(thing, usual, "what it lands on")
    part.duration = max(part.duration, round(2.0 + 2 * fall_time(height), 1))
    return height


def _objectives(thing: Thing, item: PlanObject, lower: str | None, last: bool, cast: Cast) -> list[Objective]:
    name = item.name
    if "topple" in thing.does:
        wanted = last or thing.arrangement == "row"
        what = "stack falls" if thing.arrangement == "stack" else f"{thing.kind} falls"
        return [Objective(kind="topples", object=name, sentence=f"The {what}: {name} comes down.")] if wanted else []
    if item.state != "dynamic" or {"slide", "push", "throw"} & {*thing.does} or thing.off:
        return []  # those of what moves come with its motion
    if "roll" in thing.does:
        on = lower or "ground"
        return [Objective(kind="stays_on", object=name, ref=on, sentence=f"{name} stays on the {on}.")]
    if _hit(thing, cast):
        if last:
            why = "the prompt says that it is hit, not what comes of that"
            cast.assume(thing.words, "nothing is asked of it but to be hit", why)
        return []
    if thing.inside is not None:
        return [Objective(kind="stays_inside", object=name, ref=lower, sentence=f"{name} stays inside {lower}.")]
    if lower is None:
        return [Objective(kind="rests_on", object=name, ref="ground", sentence=f"{name} comes to rest on the ground.")]
    if item.primitive == "sphere" or thing.noun.lies or "drop" in thing.does:
        onto = thing.support
        if item.primitive in ("box", "cylinder") and not thing.noun.lies and not (onto is not None and onto.round):
            return [Objective(kind="rests_on", object=name, ref=lower, sentence=f"{name} comes to rest on {lower}.")]
        if onto is not None and onto.noun.family == "solid" and "drop" in thing.does and lower is not None:
            # The kind compares level speeds where both are free; the formula all three parts.
            falls = CollidesWith(object=name, ref=lower)
            sentence = f"{name} falls on {lower}."
            return [Objective(kind="formula", object=name, sentence=sentence, formula=falls)]
        if onto is not None and onto.noun.family == "furniture" and "drop" in thing.does:
            return [Objective(kind="collides_with", object=name, ref=lower, sentence=f"{name} falls on {lower}.")]
        cast.assume(thing.words, "nothing is asked of it", f"what is round may stay on {lower} or roll off")
        return []
    if thing.bridges is not None:
        return []
    return [Objective(kind="stays_on", object=name, ref=lower, sentence=f"{name} stays on {lower}.")]


def _on_both(thing: Thing, name: str, part: Part) -> list[Objective]:
    """Of a bridge, whose middle is over neither of what carries its ends: that both bear it."""
    if thing.bridges is None or thing.support is None:
        return []
    ends = [part.names[id(end)][-1] for end in (thing.support, thing.bridges)]
    return [asked(name, f"{name} is borne by {end}.", SupportedBy(object=name, ref=end)) for end in ends]


def _hit(thing: Thing, cast: Cast) -> bool:
    """Whether something goes into it, or drops on the stack that it is."""
    return any(
        other.target is thing or (thing.group and "drop" in other.does and other.support is thing)
        for other in cast.things
    )
