"""How large the builtin planner makes a thing, of what, and in what colour, where the prompt leaves it open."""

from __future__ import annotations

from wsim.assets import get
from wsim.errors import UserError
from wsim.plan.schema import External, Material, PlanObject, Proxy, Registration, Relation
from wsim.rules.cast import ROUND, Cast, Thing
from wsim.rules.lexicon import Noun, lexicon
from wsim.rules.materials import material_named

_FLOATING_RADIUS = 0.09  # of a ball that is lighter than water: it must draw more than a particle or two [m]
ROW_SHARE = 0.3  # of a vessel's mouth, of each of three in a row across it
_PLAY = 0.8  # of a vessel's width, which what is put in it takes up at most
ROW_ROOM = 0.85  # of a table's depth, which a row of dominoes takes up at most
_LANDING = 0.6  # the same of what comes down in it from aside
SMALLEST, LARGEST = 0.02, 5.0  # what a length in the prompt may be [m]
HARD = 1500.0  # density of what is made in no lighter kind [kg/m^3]
LIGHTEST, HEAVIEST = 0.001, 10_000.0  # and a mass [kg]


def material_of(thing: Thing, cast: Cast) -> Material:
    """The thing's material, its colour applied; what was not said is noted."""
    word = thing.phrase.material
    if word is None:
        word = _by_weight(thing) or thing.noun.material or _default_material(thing)
        asked = (word,) in lexicon().entries  # what a prompt cannot name is no answer either
        cast.assume(thing.words, f"of {word}", "the prompt names no material", *(("material", word) if asked else ()))
    elif word == "metal":
        cast.assume(thing.words, "of steel", "the prompt says metal, not which")
    material = material_named(word)
    if thing.phrase.color is not None:
        material = material.model_copy(update={"color": lexicon().colors[thing.phrase.color], "opacity": 1.0})
    weighed = bool({"mass", "density"} & set(thing.phrase.measures))
    if word in ("wood", "wooden") and not weighed:
        cast.assume(thing.words, f"wood of {material.density:g} kg/m^3", "the prompt does not say which wood")
    density = thing.phrase.measures.get("density") or _weighty(thing, material, cast)
    own = {} if density is None else {"density": density}
    return material.model_copy(update={**own, **thing.surface}) if own or thing.surface else material


def _by_weight(thing: Thing) -> str | None:
    """The material of what is said to be heavy or light, where none is named."""
    if thing.phrase.weight is None or "mass" in thing.phrase.measures or thing.noun.asset is not None:
        return None
    return "steel" if thing.phrase.weight > 1.0 else "cork"


def _weighty(thing: Thing, material: Material, cast: Cast) -> float | None:
    """The density of what is heavy or light; of a metal or a stone it is what it is [kg/m^3]."""
    factor = thing.phrase.weight
    if factor is None or "mass" in thing.phrase.measures:
        return None
    what = "heavy" if factor > 1.0 else "light"
    if material.density > HARD:
        cast.assume(thing.words, f"{material.density:g} kg/m^3", f"the density of {material.name}, {what} or not")
        return None
    made = round(material.density * (min(factor, 1.3) if factor > 1.0 else max(factor, 0.6)), 1)
    cast.assume(thing.words, f"{made:g} kg/m^3", f"the prompt says {what}, not how much; of {material.name}")
    return made


def _default_material(thing: Thing) -> str:
    if "float" in thing.does or thing.noun.primitive == "box" or thing.noun.lies:
        return "steel" if "sink" in thing.does or "submerge" in thing.does else "wood"
    if thing.path is not None and thing.target is not None and thing.target.arrangement == "row":
        return "wood"  # what is heavy against a row, and comes fast, pushes it together rather than over
    return "steel" if ("roll" in thing.does and "bounce" not in thing.does) or thing.place == "water" else "rubber"


def size_of(thing: Thing, material: Material, water_density: float, cast: Cast) -> tuple[float, ...]:
    """Size as the plan has it [m]: box edges, a radius, or radius and height.

    Raises:
        UserError: the prompt's length is out of range.
    """
    noun, phrase = thing.noun, thing.phrase
    size = noun.afloat if thing.place == "water" else noun.size
    if len(size) == 1 and thing.place == "water" and material.density < water_density:
        size = (_FLOATING_RADIUS,)
    given = [v for k, v in phrase.measures.items() if k in ("x", "y", "z", "radius", "diameter")]
    for length in (*given, *([] if phrase.length is None else [phrase.length]), *(phrase.edges or ())):
        if not SMALLEST <= length <= LARGEST:
            raise UserError(
                f"{thing.words!r}: {length:g} m is outside {SMALLEST:g} to {LARGEST:g} m, the builtin planner's range"
            )
    why = "the prompt gives no size"
    vessel = thing.inside or thing.into
    if vessel is not None and noun.asset is None:  # what the catalogue has is as large as it is
        scaled = tuple(edge * (phrase.scale or 1.0) for edge in size)
        held = sum(one.count for one in cast.things if one.inside is vessel)
        share = ROW_SHARE if held > 1 else 1.0
        room = tuple(edge * share for edge in mouth(vessel.noun))
        fitting = _fitting(scaled, room, _PLAY if thing.into is None else _LANDING)
        why = why if fitting == scaled else f"so that it goes into {vessel.words}"
        size = tuple(edge / (phrase.scale or 1.0) for edge in fitting)
    if noun.key == "domino" and phrase.length is None:
        size, why = _for_ball(thing, size, cast, why)
    if noun.family == "vessel" and phrase.length is None:
        size, why = _roomy(thing, size, cast, why)
    if phrase.shape is not None:
        size, why = _shaped(noun.primitive, size, *phrase.shape), "the prompt says only how it is against the usual"
    if phrase.length is not None:
        size = _from_length(thing, phrase.length, size)
        why = f"{phrase.length:g} m is {_MEANS[noun.length]}"
    elif phrase.scale is not None:
        size = tuple(round(edge * phrase.scale, 4) for edge in size)
        why = "the prompt says only how large against the usual"
    if given or phrase.edges:
        size = _measured(thing, size)
        why = "the prompt's own measures; the rest is the usual"
    cast.assume(thing.words, _describe(noun.primitive, size), why)
    return size


def mouth(noun: Noun) -> tuple[float, ...]:
    """The room in a vessel [m]: a catalogue's own is round, and narrower than the box round it."""
    asset = get(noun.asset) if noun.asset is not None else None
    return noun.size if asset is None or asset.hollow is None else tuple(asset.hollow.size)


def _for_ball(thing: Thing, size: tuple[float, ...], cast: Cast, why: str) -> tuple[tuple[float, ...], str]:
    """Dominoes as large against what rolls into them as the usual ones are against the usual ball [m].

    So its middle is above theirs, and the blow turns them away from it.
    """
    usual = lexicon().nouns["ball"].size[0]
    radii = [
        one.phrase.measures.get("radius", (one.phrase.length or 2 * one.noun.size[0]) / 2) * (one.phrase.scale or 1.0)
        for one in cast.things
        if one.target is thing and one.noun.primitive in ROUND
    ]
    share = min(2.0, radii[0] / usual) if radii else 1.0
    if thing.support is not None and thing.support.noun.family == "furniture":  # a row has to go on it
        pitch = size[0] + 0.5 * size[2]
        share = min(share, ROW_ROOM * thing.support.noun.size[0] / (pitch * thing.count))
    if 0.7 <= share <= 1.5:
        return size, why
    return tuple(round(share * edge, 4) for edge in size), "as large against what rolls into them as usual"


def _roomy(thing: Thing, size: tuple[float, ...], cast: Cast, why: str) -> tuple[tuple[float, ...], str]:
    """A vessel larger than usual where a catalogue's thing, which is as large as it is, goes into it [m]."""
    loads = [one for one in cast.things if thing in (one.inside, one.into) and one.noun.asset is not None]
    widest = max(
        (2 * one.noun.size[0] if len(one.noun.size) < 3 else max(one.noun.size[:2]) for one in loads), default=0
    )
    share = widest / (_PLAY * min(mouth(thing.noun)[:2]))
    if share <= 1.0:
        return size, why
    factor = widest / (_PLAY * min(size[:2]))
    return tuple(round(max(1.0, factor) * edge, 4) for edge in size), f"so that {loads[0].words} goes into it"


def _fitting(size: tuple[float, ...], room: tuple[float, ...], play: float) -> tuple[float, ...]:
    """The usual size, made smaller where it does not go into a vessel with play around it, and up to the rim [m]."""
    round_ = len(size) < 3
    wide = 2 * size[0] if round_ else max(size[:2])
    tall = size[-1] if len(size) > 1 else wide
    share = min(1.0, play * min(room[:2]) / wide, room[2] / tall)
    return size if share == 1.0 else tuple(round(edge * share, 4) for edge in size)


def _shaped(primitive: str, size: tuple[float, ...], axis: str, factor: float) -> tuple[float, ...]:
    """The size with one axis longer or shorter: "tall", "long", "thin" [m]."""
    if primitive == "sphere":
        raise UserError(f"a ball is as high as it is wide, not {factor:g} times that; say small or large")
    made = [*size]
    at = "xyz".index(axis) if len(made) == 3 else (1 if axis in "xz" else 0)
    made[at] = round(factor * made[at], 4)
    return tuple(made)


_MEANS = {
    "edges": "taken as every edge",
    "edge": "its edge",
    "diameter": "taken as the diameter",
    "x": "taken as the length",
    "y": "taken as the width",
    "z": "taken as the height",
}


def _from_length(thing: Thing, length: float, default: tuple[float, ...]) -> tuple[float, ...]:
    noun = thing.noun
    if noun.primitive == "sphere":
        return (round(length / 2, 6),)
    if noun.primitive in ("cylinder", "capsule"):
        return (round(default[0] * length / default[1], 6), length)
    if noun.length in ("edges", "edge"):
        return (length, length, length)
    axis = "xyz".index(noun.length)
    return tuple(length if i == axis else edge for i, edge in enumerate(default))


def _measured(thing: Thing, size: tuple[float, ...]) -> tuple[float, ...]:
    """The size with the measures that the prompt names: "0.5 m long", "with a radius of 5 cm"."""
    primitive, measures = thing.noun.primitive, thing.phrase.measures
    known = {"box": {"x", "y", "z"}, "tank": {"x", "y", "z"}, "sphere": {"radius", "diameter"}}
    if thing.phrase.edges and primitive not in ("box", "tank"):
        raise UserError(f"{thing.words!r}: a {thing.kind} has no three edges; give one of its own measures")
    strange = set(measures) - known.get(primitive, {"radius", "diameter", "z", "x"}) - {"mass", "density"}
    if strange:
        raise UserError(f"{thing.words!r}: a {thing.kind} has no {min(strange)}; give one of its own measures")
    made = [float(edge) for edge in size]
    if primitive in ("box", "tank"):
        made = list(thing.phrase.edges or made)
        for i, axis in enumerate("xyz"):
            made[i] = measures.get(axis, made[i])
        return tuple(made)
    made[0] = measures.get("radius", measures.get("diameter", 2 * made[0]) / 2)
    if len(made) > 1:
        made[1] = measures.get("z", measures.get("x", made[1]))
    return tuple(round(edge, 6) for edge in made)


def _describe(primitive: str, size: tuple[float, ...]) -> str:
    if primitive in ("box", "tank"):
        return f"{size[0]:g} x {size[1]:g} x {size[2]:g} m"
    if primitive == "sphere":
        return f"radius {size[0]:g} m"
    return f"radius {size[0]:g} m, length {size[1]:g} m"


def bodies(thing: Thing, cast: Cast, taken: set[str]) -> list[PlanObject]:
    """The thing's objects, without rows or motion."""
    noun = thing.noun
    material = material_of(thing, cast)
    size = size_of(thing, material, cast.liquid.material.density, cast)
    proxy = Proxy(primitive=noun.primitive, size=size)
    mass = _mass(thing, size)
    static = noun.family in ("furniture", "ramp", "vessel", "belt", "turntable")
    if noun.asset is not None:
        cast.assume(thing.words, f"a {noun.primitive} stands for it", "the builtin planner builds with plain shapes")
    made = PlanObject(
        name="thing",
        role={
            "furniture": "background",
            "vessel": "container",
            "ramp": "terrain",
            "belt": "background",
            "turntable": "background",
        }.get(noun.family, "rigid_body"),
        construction=proxy if noun.asset is None else External(candidate=noun.asset, stand_in=proxy),
        material=None if noun.family == "vessel" else material,
        state="static" if static else "dynamic",
        registration=Registration(mass=None if static else mass),
        words=thing.words,
    )
    if "mass" in thing.phrase.measures and not static and made.density is not None:
        why = f"the prompt gives its mass; solid {material.name} has {material.density:g}"
        cast.assume(thing.words, f"{made.density:.3g} kg/m^3 on average", why)
    rows = [Relation(predicate="LIES-ALONG-Y")] if noun.lies else []
    return [made.model_copy(update={"name": name}).related(rows) for name in names(thing, taken)]


def _mass(thing: Thing, size: tuple[float, ...]) -> float | None:
    """What the prompt says, or the catalogue of a thing as large as its own and of its own material [kg]."""
    mass = thing.phrase.measures.get("mass")
    if mass is None and thing.phrase.weight is not None:
        return None
    if mass is None:
        own = thing.phrase.material is None and not thing.phrase.measures and size == thing.noun.size
        return thing.noun.mass if own else None
    if not LIGHTEST <= mass <= HEAVIEST:
        raise UserError(
            f"{thing.words!r}: {mass:g} kg is outside {LIGHTEST:g} to {HEAVIEST:g} kg, the builtin planner's range"
        )
    return mass


def thickness(item: PlanObject) -> float:
    """The smallest extent of a thing [m]: what the fluid's particles have to resolve."""
    if item.primitive in ("sphere", "capsule"):
        return 2 * item.size[0]
    if item.primitive == "cylinder":
        return min(2 * item.size[0], item.size[1])
    return min(item.size)


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
