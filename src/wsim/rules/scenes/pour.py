"""Water that is poured: a block of it, let go in the mouth of a tank, a bowl or a bucket."""

from __future__ import annotations

import math

from wsim.defaults import WALL
from wsim.errors import UserError
from wsim.plan.schema import Objective, PlanObject, Pose
from wsim.plan.schema.formula_fluid import LevelIn
from wsim.rules.cast import Cast
from wsim.rules.contents import note_liquid
from wsim.rules.lexicon import lexicon
from wsim.rules.materials import GLASS_LOOK
from wsim.rules.scenes.lasting import asked
from wsim.rules.scenes.part import Part, fall_time, tidy
from wsim.rules.sizes import bodies

FILL = 0.25  # of the vessel's volume: so that the splash stays in
HEIGHT = 0.08  # that the water falls to the vessel's floor, or 0.4 of the vessel's own height where that is less [m]
FLAT = 0.5  # height of the falling block against its smaller side, at most
PARTICLES = 1500  # that so much would take
MARGIN = 3.0  # spacings between the falling water and the walls' planes
MOST_HEIGHT = 0.3  # [m]: from higher up too much of it would splash out


def build_pour(cast: Cast, taken: set[str]) -> Part:
    """The vessel and the water over it.

    Raises:
        UserError: something else is in the scene, or the water falls from too high.
    """
    part = Part()
    if cast.pour is None:
        return part
    if any(thing is not cast.pour.vessel for thing in cast.things):
        raise UserError("the builtin planner pours water into an empty vessel; leave the other things out")
    vessel = _vessel(cast, taken)
    held = cast.filled
    note_liquid(cast.liquid, cast)
    x, y, z = vessel.size
    height = cast.pour.height if cast.pour.height is not None else round(min(HEIGHT, 0.4 * z), 3)
    why = "the prompt gives no height" if cast.pour.height is None else "the prompt says from where, not above what"
    cast.assume("water", f"falls {height:g} m to the floor of the {vessel.name}", why)
    if not 0.0 < height <= MOST_HEIGHT:
        raise UserError(f"water poured from {height:g} m: give a height above 0 and up to {MOST_HEIGHT:g} m")
    level = cast.pour.level
    if level is not None and not 0.0 < level <= FILL * z:
        raise UserError(
            f"water poured up to {level:g} m: give a level above 0 and up to {FILL * z:.3g} m, or it splashes"
        )
    amount = (FILL * z if level is None else level) * x * y
    if held is not None and held.volume is not None:
        if held.volume > 1.05 * amount or level is not None:
            raise UserError(
                f"{cast.water!r}: {1000 * held.volume:g} litres of it are poured at once; up to {1000 * amount:.2g} "
                f"stay in the {vessel.name}: say less, or pour it at a rate"
            )
        amount = held.volume
    spacing = math.ceil((amount / PARTICLES) ** (1 / 3) * 1000) / 1000
    across = [max(2, math.floor(edge / spacing - 2 * MARGIN)) * spacing for edge in (x, y)]
    # A tall column runs up the walls as it collapses, and over the rim.
    most = max(2, math.floor(FLAT * min(across) / spacing))
    tall = min(most, max(2, round(amount / (across[0] * across[1] * spacing)))) * spacing
    exact = 1.0
    if held is not None and held.volume is not None:  # as many particles as before, and as much as is said
        exact = (held.volume / (across[0] * across[1] * tall)) ** (1 / 3)
        spacing = round(exact * spacing, 6)
    size = (tidy(exact * across[0]), tidy(exact * across[1]), tidy(exact * tall))
    bottom = WALL + height
    cast.assume(
        "water",
        f"{1000 * math.prod(size):.3g} litres",
        f"at most {FILL:.0%} of what the vessel holds, and flat: the splash stays in",
    )
    cast.assume("water", f"a block of {size[0]:g} x {size[1]:g} x {size[2]:g} m", "a jet would need an inlet")
    middle = Pose(position=(0.0, 0.0, tidy(bottom + size[2] / 2)))
    water = cast.liquid.fluid(cast.water or "", [], size).model_copy(update={"pose": middle})
    name = cast.liquid.words[0]
    taken.add(water.name)
    part.objects.append(vessel)
    part.posed.append(water)
    part.objectives.append(
        Objective(kind="fills", object=water.name, ref=vessel.name, sentence=f"The {name} ends in {vessel.name}.")
    )
    if level is not None:
        sentence = f"The {name} stands {level:g} m high in {vessel.name}."
        part.objectives.append(asked(water.name, sentence, LevelIn(fluid=water.name, ref=vessel.name, level=level)))
    part.spacing = spacing
    part.duration = round(1.2 + fall_time(height), 1)
    return part


def _vessel(cast: Cast, taken: set[str]) -> PlanObject:
    assert cast.pour is not None
    if cast.pour.vessel is not None:
        [vessel] = bodies(cast.pour.vessel, cast, taken)
    else:
        size, held = lexicon().nouns["tank"].size, cast.filled
        if held is not None and held.volume is not None:
            grown = (held.volume / (FILL * math.prod(size))) ** (1 / 3)
            size = (round(grown * size[0], 3), round(grown * size[1], 3), round(grown * size[2], 3))
        cast.assume("tank", f"{size[0]:g} x {size[1]:g} x {size[2]:g} m inside", "the prompt gives no size")
        taken.add("tank")
        vessel = PlanObject.proxy(
            name="tank", role="container", primitive="tank", size=size, material=GLASS_LOOK, state="static",
            words=cast.tank or "",
        )  # fmt: skip
    return vessel.model_copy(update={"pose": Pose(position=(0.0, 0.0, 0.0)), "state": "static"})
