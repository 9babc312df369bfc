"""How large the builtin planner makes a thing, of what, and in what colour, where the prompt leaves it open."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from wsim.errors import UserError
from wsim.plan.materials import COLORS, MATERIALS
from wsim.plan.schema import Material, PlanObject

if TYPE_CHECKING:
    from wsim.plan.cast import Cast, Thing

# Default sizes [m]. In water: flat enough to float level, as a block of wood with equal edges would not.
_IN_WATER: dict[str, tuple[float, ...]] = {
    "block": (0.2, 0.2, 0.14),
    "box": (0.2, 0.2, 0.14),
    "cube": (0.16, 0.16, 0.16),
    "ball": (0.06,),
    "sphere": (0.06,),
    "cylinder": (0.1, 0.14),
    "log": (0.08, 0.3),
}
_ON_GROUND: dict[str, tuple[float, ...]] = {
    "block": (0.2, 0.2, 0.14),
    "box": (0.2, 0.2, 0.2),
    "cube": (0.2, 0.2, 0.2),
    "ball": (0.1,),
    "sphere": (0.1,),
    "cylinder": (0.1, 0.25),
    "log": (0.08, 0.5),
}
_FLOATING_RADIUS = 0.09  # of a ball that is lighter than water: it must draw more than a particle or two
PRIMITIVES = {
    "block": "box",
    "box": "box",
    "cube": "box",
    "ball": "sphere",
    "sphere": "sphere",
    "cylinder": "cylinder",
    "log": "cylinder",
}
SMALLEST, LARGEST = 0.02, 5.0  # what a length in the prompt may be [m]


def material_of(thing: Thing, cast: Cast) -> Material:
    """The thing's material, its colour applied; what was not said is noted."""
    word = thing.phrase.material
    if word is None:
        word = _default_material(thing)
        cast.assume(thing.words, f"of {word}", "the prompt names no material")
    elif word == "metal":
        cast.assume(thing.words, "of steel", "the prompt says metal, not which")
    material = MATERIALS[word]
    if thing.phrase.color is not None:
        material = material.model_copy(update={"color": COLORS[thing.phrase.color], "opacity": 1.0})
    if word in ("wood", "wooden"):
        cast.assume(thing.words, f"wood of {material.density:g} kg/m^3", "the prompt does not say which wood")
    return material


def _default_material(thing: Thing) -> str:
    if "float" in thing.does or thing.kind in ("block", "box", "cube", "log"):
        return "steel" if "sink" in thing.does or "submerge" in thing.does else "wood"
    return "steel" if "roll" in thing.does or thing.place == "water" else "rubber"


def size_of(thing: Thing, material: Material, water_density: float, cast: Cast) -> tuple[float, ...]:
    """Size as the plan has it [m]: box edges, a radius, or radius and height.

    Raises:
        UserError: the prompt's length is out of range.
    """
    table = _IN_WATER if thing.place == "water" else _ON_GROUND
    size = table[thing.kind]
    if len(size) == 1 and thing.place == "water" and material.density < water_density:
        size = (_FLOATING_RADIUS,)
    scale = thing.phrase.scale
    length = thing.phrase.length
    if length is not None:
        if not SMALLEST <= length <= LARGEST:
            raise UserError(
                f"{thing.words!r}: {length:g} m is outside {SMALLEST:g} to {LARGEST:g} m, the builtin planner's range"
            )
        size = _from_length(thing.kind, length, size)
        cast.assume(thing.words, _describe(thing.kind, size), f"{length:g} m is {_MEANS[thing.kind]}")
    else:
        if scale is not None:
            size = tuple(round(edge * scale, 4) for edge in size)
        why = "the prompt says only how large against the usual" if scale is not None else "the prompt gives no size"
        cast.assume(thing.words, _describe(thing.kind, size), why)
    return size


_MEANS = {
    "block": "taken as every edge",
    "box": "taken as every edge",
    "cube": "its edge",
    "ball": "taken as the diameter",
    "sphere": "taken as the diameter",
    "cylinder": "taken as the height",
    "log": "taken as the length",
}


def _from_length(kind: str, length: float, default: tuple[float, ...]) -> tuple[float, ...]:
    if PRIMITIVES[kind] == "box":
        return (length, length, length)
    if PRIMITIVES[kind] == "sphere":
        return (round(length / 2, 6),)
    return (round(default[0] * length / default[1], 6), length)


def _describe(kind: str, size: tuple[float, ...]) -> str:
    if PRIMITIVES[kind] == "box":
        return f"{size[0]:g} x {size[1]:g} x {size[2]:g} m"
    if PRIMITIVES[kind] == "sphere":
        return f"radius {size[0]:g} m"
    return f"radius {size[0]:g} m, length {size[1]:g} m"


def thickness(item: PlanObject) -> float:
    """The smallest extent of a thing [m]: what the fluid's particles have to resolve."""
    if item.primitive == "sphere":
        return 2 * item.size[0]
    if item.primitive == "cylinder":
        return min(2 * item.size[0], item.size[1])
    return min(item.size)


def volume(item: PlanObject) -> float:
    """Volume of a thing [m^3]."""
    if item.primitive == "sphere":
        return 4 / 3 * math.pi * item.size[0] ** 3
    if item.primitive == "cylinder":
        return math.pi * item.size[0] ** 2 * item.size[1]
    if item.primitive == "capsule":
        radius, height = item.size
        return math.pi * radius**2 * (height + 4 / 3 * radius)
    return math.prod(item.size)


def names(thing: Thing, taken: set[str]) -> list[str]:
    """A name for each of the thing's objects: wooden_block_1, steel_ball; marks them as taken."""
    stem = "_".join(word for word in (thing.phrase.color, thing.phrase.material, thing.kind) if word)
    if thing.count == 1 and stem not in taken:
        taken.add(stem)
        return [stem]
    chosen: list[str] = []
    number = 1
    while len(chosen) < thing.count:
        name = f"{stem}_{number}"
        if name not in taken:
            taken.add(name)
            chosen.append(name)
        number += 1
    return chosen
