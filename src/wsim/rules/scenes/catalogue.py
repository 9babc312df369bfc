"""Things of the catalogue as themselves, where the prompt asks for nothing that they are not."""

from __future__ import annotations

from wsim.assets import get
from wsim.plan.schema import External, FromAsset, Objective, PlanObject, Registration, Relation
from wsim.plan.schema.formula_contact import LiesOn, SupportedBy
from wsim.plan.schema.formula_place import ContainedIn, StaysInside
from wsim.rules.cast import Cast, Thing
from wsim.rules.lexicon import Noun, lexicon
from wsim.rules.scenes.bounce import bounces

_ANCHORS = ("seat", "shelf_3", "shelf_2", "top")  # where things stand on one, in the order of preference
WOODS = ("oak", "pine")
ON_FLOOR = 0.005  # of a catalogue's thing, whose place is the middle of its underside: that is on the floor [m]
_LOWER = 0.01  # that an anchor must be below the highest point to be named [m]


def themselves(
    objects: list[PlanObject], names: dict[int, list[str]], cast: Cast, joined: set[str]
) -> list[PlanObject]:
    """The objects, each stand-in of a catalogue's thing replaced by that thing if it is as large, and starts at rest.

    Args:
        objects: With rows or poses; a stand-in's pose that turns it is left alone.
        names: Of each thing's objects, by the thing's identity.
        cast: What the prompt speaks of; what was assumed of the stand-ins is taken back.
        joined: Names of what joints hold, which keep their shape.
    """
    things = {name: thing for thing in cast.things for name in names.get(id(thing), [])}
    made = {item.name: itself(item, things[item.name], cast) for item in objects
            if item.name in things and item.name not in joined}  # fmt: skip
    found = {name: item for name, item in made.items() if item is not None}
    whole = {id(things[name]) for name in found}
    for thing in cast.things:
        if id(thing) in whole:
            gone = (thing.words, f"a {thing.noun.primitive} stands for it")
            cast.assumptions = [one for one in cast.assumptions if (one.subject, one.choice) != gone]
            cast.assume(thing.words, f"the catalogue's {thing.noun.asset}", "with its own size, mass and surfaces")
    return [_on_anchors(found.get(item.name, item), found) for item in objects]


def itself(item: PlanObject, thing: Thing, cast: Cast) -> PlanObject | None:
    """The catalogue's thing in place of its stand-in; None where that is another."""
    noun, phrase = thing.noun, thing.phrase
    own = isinstance(item.construction, External) and (noun.mass is not None) and item.size == noun.size
    said = (
        not _is_of(phrase.material, noun)
        or phrase.color
        or phrase.measures
        or phrase.weight
        or phrase.shape
        or thing.surface
    )
    moves = any(item.velocity) or item.angular_velocity_deg or item.rolling or thing.force is not None
    rubs = any(name != "friction" for _, name, _ in thing.pairs)
    if "topple" in thing.does:
        return None  # a box of its size falls over as surely as it is pushed to, whatever is under its feet
    if not own or said or moves or rubs or bounces(thing) or noun.asset is None or thing.bridges is not None:
        return None
    if any(beside.predicate == "under" and beside.ref is thing for one in cast.things for beside in one.beside):
        return None  # the layout takes a catalogue's thing for a box: a top on legs has room under it
    if (cast.pour is not None and cast.pour.vessel is thing) or any(flow.vessel is thing for flow in cast.flows):
        return None  # water is poured into a tank, whose room the judge knows
    if item.pose is not None and (item.primitive != "tank" or any(item.pose.rotation_deg)):
        return None
    rows = [row for row in item.relations if not row.predicate.startswith("LIES-ALONG")]
    if len(rows) < len(item.relations):
        return None
    role = "background" if item.role == "container" else item.role
    itself = {"construction": FromAsset(asset=noun.asset), "material": None, "registration": Registration()}
    return item.model_copy(update={"role": role, **itself})


def _is_of(word: str | None, noun: Noun) -> bool:
    """Whether a catalogue's thing is of what the prompt says: "a wooden table" is the oak one."""
    if word is None or noun.asset is None:
        return True
    asset, material = get(noun.asset), lexicon().materials[word]
    texts = " ".join([asset.description, *asset.names]).lower().split()
    kinds = {word, material.name, *(["wood", "wooden", *WOODS] if material.name == "wood" else [])}
    return bool(kinds & {text.strip(",.") for text in texts}) or noun.material in kinds


def as_they_are(objectives: list[Objective], objects: list[PlanObject]) -> list[Objective]:
    """The objectives, said of the catalogue's things in ways that hold of these.

    Of what is in one of its vessels it is asked that it lies there: only of tanks is the room known. Of what stands on
    a seat or a board, below the highest point, that it is borne by what it stands on.
    """
    own = {item.name: item for item in objects if item.primitive == "asset"}
    fluids = {item.name for item in objects if item.primitive == "fluid"}
    made = []
    for one in objectives:
        vessel = _vessel(one) if one.object not in fluids else None  # a fluid is in it by all of its particles
        if vessel is not None and vessel not in own and one.object in own:
            made.append(_asked(one, StaysInside(object=one.object, ref=vessel, within=ON_FLOOR)))
        elif vessel in own and vessel is not None:
            made.append(_asked(one, LiesOn(object=one.object, ref=vessel)))
            if _falls(one.object, objects):
                sentence = f"{one.object} falls onto {vessel}."
                made.append(Objective(kind="collides_with", object=one.object, ref=vessel, sentence=sentence))
        elif one.kind == "stays_on" and one.ref in own and _anchor(own[one.ref]) is not None:
            made.append(_asked(one, SupportedBy(object=one.object, ref=one.ref)))
        else:
            made.append(one)
    return made


def _asked(objective: Objective, formula: LiesOn | SupportedBy | StaysInside) -> Objective:
    return Objective(kind="formula", object=objective.object, sentence=objective.sentence, formula=formula)


def _falls(name: str, objects: list[PlanObject]) -> bool:
    """Whether it starts in the air, with nothing but its weight to move it."""
    return any(o.name == name and o.relation("SPAWNED-ABOVE") is not None and not any(o.velocity) for o in objects)


def _vessel(objective: Objective) -> str | None:
    if isinstance(objective.formula, ContainedIn):
        return objective.formula.ref
    return objective.ref if objective.kind == "stays_inside" else None


def _on_anchors(item: PlanObject, found: dict[str, PlanObject]) -> PlanObject:
    """The object with its row of what it stands on naming the seat, or the board, of that."""
    rows = []
    for row in item.relations:
        below = found.get(row.ref or "") if row.predicate == "PLACE-ON" else None
        anchor = _anchor(below) if below is not None else None
        rows.append(Relation(predicate=row.predicate, ref=row.ref, anchor=anchor) if anchor else row)
    return item.related(rows)


def _anchor(item: PlanObject) -> str | None:
    assert isinstance(item.built, FromAsset)
    asset = get(item.built.asset)
    return next(
        (name for name in _ANCHORS if name in asset.anchors and asset.anchors[name][2] < asset.size[2] - _LOWER), None
    )
