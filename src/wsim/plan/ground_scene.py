"""Things on the ground: rows, stacks, drops, and what rolls into them."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from wsim.errors import UserError
from wsim.plan.materials import WATER_DENSITY
from wsim.plan.schema import Material, Objective, PlanObject, Relation, Vec3
from wsim.plan.sizes import PRIMITIVES, material_of, names, size_of

if TYPE_CHECKING:
    from wsim.plan.cast import Cast, Thing

GROUND_LOOK = Material(name="ground", density=2000.0, friction=0.7, color=(0.32, 0.32, 0.32))
GAP = 0.15  # between neighbours [m]
DROP_HEIGHT = 0.5  # [m]
ROLL_DISTANCE = 0.6  # from what rolls to what it hits [m]
HIT_SPEED = 3.0  # [m/s]
ROLL_SPEED = 1.0  # [m/s]


@dataclass
class Ground:
    """The part of a plan that stands on the ground."""

    objects: list[PlanObject] = field(default_factory=list)
    objectives: list[Objective] = field(default_factory=list)
    duration: float = 3.0  # [s]
    names: dict[int, list[str]] = field(default_factory=dict)  # of each thing's objects, lowest first, by identity


def ground_object() -> PlanObject:
    """The ground itself."""
    return PlanObject(name="ground", role="terrain", primitive="ground", material=GROUND_LOOK, state="static")


def build_ground(cast: Cast, taken: set[str], behind: str | None = None) -> Ground:
    """Everything on the ground, in a row along Y, or in front of a tank.

    Args:
        cast: What the prompt speaks of.
        taken: Names in use; grows.
        behind: Name of the tank that the row stands in front of.
    """
    ground = Ground()
    previous = behind
    side = "FRONT-OF" if behind is not None else "LEFT-OF"
    things = [thing for thing in cast.things if thing.place == "ground"]
    # What carries another comes first: its name is needed.
    for thing in sorted(things, key=_depth):
        if thing.target is not None:
            continue
        previous = _place(thing, cast, taken, ground, previous, side)
    for thing in things:
        if thing.target is not None:
            _roll(thing, cast, taken, ground)
    return ground


def _depth(thing: Thing) -> int:
    depth = 0
    seen = [thing]
    while thing.support is not None:
        if thing.support in seen:
            raise UserError(f"{thing.words!r} and {thing.support.words!r} cannot stand on each other")
        thing = thing.support
        seen.append(thing)
        depth += 1
    return depth


def _place(thing: Thing, cast: Cast, taken: set[str], ground: Ground, previous: str | None, side: str) -> str | None:
    """Add a thing's objects; the new end of the row."""
    if thing.support is not None and thing.count > 1 and not thing.group:
        raise UserError(
            f"{thing.words!r} on {thing.support.words!r}: the builtin planner puts one thing, or a stack, on another"
        )
    below = ground.names[id(thing.support)][-1] if thing.support is not None else None
    height = _drop_height(thing, cast, ground)
    made = _objects(thing, cast, taken)
    for index, item in enumerate(made):
        lower = made[index - 1].name if thing.group and index > 0 else below
        if thing.group and index > 0:
            start = Relation(predicate="PLACE-ON", ref=lower)
        elif height is not None:
            start = Relation(predicate="SPAWNED-ABOVE", ref=below, value=height)
        elif below is not None:
            start = Relation(predicate="PLACE-ON", ref=below)
        else:
            start = Relation(predicate="PLACE-ON-BASE")
        relations = [start]
        if lower is None:
            if previous is not None:
                relations.append(Relation(predicate=side, ref=previous, gap=GAP))
            previous = item.name
        ground.objects.append(item.model_copy(update={"relations": relations + item.relations}))
        ground.objectives += _objectives(thing, item, lower, last=index == len(made) - 1, cast=cast)
    ground.names[id(thing)] = [item.name for item in made]
    return previous


def _objects(thing: Thing, cast: Cast, taken: set[str]) -> list[PlanObject]:
    material = material_of(thing, cast)
    size = size_of(thing, material, WATER_DENSITY, cast)
    velocity: Vec3 = (0.0, 0.0, 0.0)
    if "roll" in thing.does:
        if thing.kind not in ("ball", "sphere"):
            raise UserError(f"{thing.words!r}: the builtin planner rolls balls only")
        speed = HIT_SPEED if thing.target is not None else ROLL_SPEED
        velocity = (speed, 0.0, 0.0)
        cast.assume(thing.words, f"starts at {speed:g} m/s along +X", "the prompt gives no speed")
    lying = [Relation(predicate="LIES-ALONG-Y")] if thing.kind == "log" else []
    return [
        PlanObject(
            name=name,
            role="rigid_body",
            primitive=PRIMITIVES[thing.kind],
            size=size,
            material=material,
            relations=lying,
            velocity=velocity,
            words=thing.words,
        )
        for name in names(thing, taken)
    ]


def _drop_height(thing: Thing, cast: Cast, ground: Ground) -> float | None:
    if "drop" not in thing.does:
        return None
    height = thing.drop_height
    if height is None:
        height = DROP_HEIGHT
        cast.assume(thing.words, f"dropped from {height:g} m above what it lands on", "the prompt gives no height")
    ground.duration = max(ground.duration, round(2.0 + 2 * (2 * height / 9.81) ** 0.5, 1))
    return height


def _objectives(thing: Thing, item: PlanObject, lower: str | None, last: bool, cast: Cast) -> list[Objective]:
    name = item.name
    if "topple" in thing.does:
        return [Objective(kind="topples", object=name, sentence=f"The stack falls: {name} comes down.")] if last else []
    if "roll" in thing.does:
        return [Objective(kind="stays_on", object=name, ref="ground", sentence=f"{name} stays on the ground.")]
    if _hit(thing, cast):
        if last:
            cast.assume(thing.words, "nothing is asked of it", "the prompt says that it is hit, not what comes of that")
        return []
    if lower is None:
        return [Objective(kind="rests_on", object=name, ref="ground", sentence=f"{name} comes to rest on the ground.")]
    if thing.kind in ("ball", "sphere", "log") or "drop" in thing.does:
        if thing.kind in ("box", "block", "cube", "cylinder"):
            return [Objective(kind="rests_on", object=name, ref=lower, sentence=f"{name} comes to rest on {lower}.")]
        cast.assume(thing.words, "nothing is asked of it", f"what is round may stay on {lower} or roll off")
        return []
    return [Objective(kind="stays_on", object=name, ref=lower, sentence=f"{name} stays on {lower}.")]


def _hit(thing: Thing, cast: Cast) -> bool:
    """Whether something rolls into it, or drops on the stack that it is."""
    return any(
        other.target is thing or (thing.group and "drop" in other.does and other.support is thing)
        for other in cast.things
    )


def _roll(thing: Thing, cast: Cast, taken: set[str], ground: Ground) -> None:
    """Add a ball that rolls along +X into its target. What becomes of the ball is left open."""
    target = thing.target
    if id(target) not in ground.names:
        raise UserError(f"{thing.words!r}: the builtin planner rolls a ball into things that stand still")
    if target is None or any(other.target is target and other is not thing for other in cast.things):
        raise UserError(f"{thing.words!r}: the builtin planner rolls one ball into one thing")
    [item] = _objects(thing, cast, taken)
    relations = [
        Relation(predicate="PLACE-ON-BASE"),
        Relation(predicate="BACK-OF", ref=ground.names[id(target)][0], gap=ROLL_DISTANCE),
    ]
    cast.assume(thing.words, f"starts {ROLL_DISTANCE:g} m from {target.words}", "the prompt gives no distance")
    ground.objects.append(item.model_copy(update={"relations": relations}))
    ground.names[id(thing)] = [item.name]
    ground.duration = max(ground.duration, 4.0)
