"""A vessel of the catalogue that stands still, and the liquid in it."""

from __future__ import annotations

import math
from functools import lru_cache
from typing import TYPE_CHECKING

from wsim.assets import get
from wsim.errors import UserError
from wsim.plan.layout.bodies import around
from wsim.plan.schema import CameraPlan, FromAsset, Objective, PlanObject, Relation
from wsim.rules.cast import Cast, Thing
from wsim.rules.contents import note_liquid
from wsim.rules.scenes.part import Part, tidy

if TYPE_CHECKING:
    from wsim.geometry.hollows import Hollow

FULL = 0.8  # of its depth, where the prompt does not say how full: what is full to the rim spills
MOST = 0.95  # of the same, that the prompt may ask for
PARTICLES, MOST_PARTICLES = 4000, 30_000
DEEP, ACROSS = 4, 6  # spacings, at least
LASTS = 2.0  # [s]
NEAR, DOWN = 3.0, 50.0  # of the camera: times the vessel's largest edge away, and how far it looks down [deg]
GRID = 30  # spacings in a vessel, with which its hollow is looked for


def add_liquid(thing: Thing | None, scene: Part, objects: list[PlanObject], cast: Cast) -> list[PlanObject]:
    """The objects with the vessel standing still, and its liquid behind it.

    Args:
        thing: The vessel; None where there is none.
        scene: Of which it is; gets what is asked, and how fine the particles are.
        objects: Things of the catalogue as themselves.
        cast: What the prompt speaks of.

    Raises:
        UserError: It is not the catalogue's own, or holds less than the prompt says.
    """
    if thing is None:
        return objects
    [name] = scene.names[id(thing)]
    vessel = next(item for item in objects if item.name == name)
    if not isinstance(vessel.built, FromAsset):
        raise UserError(
            f"{thing.words!r}: the builtin planner fills the catalogue's {thing.kind} as it is; leave its size and "
            "material out"
        )
    level, volume = _amount(thing, vessel.built.asset, cast)
    scene.spacing = _spacing(thing, level, volume)
    liquid = cast.liquid.fluid(thing.words, [Relation(predicate="PLACE-IN", ref=name)])
    if thing.phrase.filled is not None and thing.phrase.filled.volume is not None:
        registration = liquid.registration.model_copy(update={"volume": volume})
        liquid = liquid.model_copy(update={"registration": registration})
    else:
        liquid = liquid.related([*liquid.relations, Relation(predicate="FREE-SURFACE-AT", value=level)])
    cast.assume(thing.words, "stands still", "a vessel that is full of a liquid does not move here")
    note_liquid(cast.liquid, cast)
    scene.objectives = [one for one in scene.objectives if name != one.object]
    sentence = f"The {cast.liquid.words[0]} stays inside {name}."
    scene.objectives.append(Objective(kind="stays_inside", object=liquid.name, ref=name, sentence=sentence))
    still = vessel.model_copy(update={"state": "static", "role": "background"})
    made = [still if item is vessel else item for item in objects]
    return [*made, liquid]


def look_in(vessel: PlanObject) -> CameraPlan:
    """A view down into a vessel that has its place: what is in it is behind its walls from the side."""
    box = around(vessel)
    x, y, _ = box.center
    away = NEAR * max(box.size)
    rise, back = away * math.sin(math.radians(DOWN)), away * math.cos(math.radians(DOWN))
    eye = (tidy(x - 0.3 * back), tidy(y - back), tidy(box.high[2] + rise))
    return CameraPlan(name="inside", eye=eye, target=(tidy(x), tidy(y), tidy(box.high[2] - 0.3 * box.size[2])))


def _amount(thing: Thing, asset: str, cast: Cast) -> tuple[float, float]:
    """How high the liquid stands over the lowest point [m], and how much it is [m^3].

    Raises:
        UserError: It holds less, or nothing.
    """
    held, hollow = thing.phrase.filled, hollow_of(asset)
    assert held is not None
    if hollow is None:
        raise UserError(
            f"{thing.words!r}: the catalogue's {asset} has no room that could be filled; name another vessel"
        )
    deep = hollow.rim - hollow.floor
    most = hollow.filling(hollow.floor + MOST * deep).volume
    if held.volume is not None:
        if held.volume > most:
            raise UserError(
                f"{thing.words!r}: the catalogue's {asset} holds up to {1000 * most:.2g} litres, and not "
                f"{1000 * held.volume:g}; say less"
            )
        return hollow.level_of(held.volume) - hollow.floor, held.volume
    share = thing.phrase.share if thing.phrase.share is not None else held.share
    level = held.level if held.level is not None else (FULL if share is None else share) * deep
    if share is None and held.level is None:
        cast.assume(thing.words, f"{100 * level:.2g} cm deep", f"{FULL:.0%} of its depth: full to the rim it spills")
    elif share is not None:
        cast.assume(thing.words, f"{100 * level:.2g} cm deep", f"{share:.0%} of its depth, not of its volume")
    if not 0.0 < level <= MOST * deep:
        raise UserError(
            f"{thing.words!r}: {level:g} m is not above 0 and up to {MOST * deep:.2g} m, as deep as the catalogue's "
            f"{asset} can be filled"
        )
    return tidy(level), hollow.filling(hollow.floor + level).volume


def _spacing(thing: Thing, level: float, volume: float) -> float:
    """Between particles: some thousand, and four or more layers [m]."""
    across = (volume / level) ** 0.5
    spacing = float(f"{min((volume / PARTICLES) ** (1 / 3), level / DEEP, across / ACROSS):.2g}")
    if volume / spacing**3 > MOST_PARTICLES:
        raise UserError(
            f"{thing.words!r}: so thin a layer would need {volume / spacing**3:,.0f} particles; the builtin planner "
            f"uses up to {MOST_PARTICLES:,}: say more"
        )
    return spacing


@lru_cache(maxsize=32)
def hollow_of(asset: str) -> Hollow | None:
    """What something of the catalogue holds as it stands; None where that is nothing."""
    from wsim.scene import Scene  # loads USD, which no other plan needs
    from wsim.scene.errors import SceneError
    from wsim.scene.validate import Call
    from wsim.scene.vessels import Vessel

    scene = Scene()
    try:
        handle = scene.asset("vessel", asset, static=True)
        spacing = max(get(asset).size) / GRID
        return Vessel(Call("fluid", "liquid"), scene.stage.GetPrimAtPath(handle.path), spacing).hollow
    except SceneError:
        return None
