"""Water that is poured: a block of it, let go in the mouth of a tank, a bowl or a bucket."""

from __future__ import annotations

import math

from wsim.defaults import WALL
from wsim.errors import UserError
from wsim.plan.schema import Objective, PlanObject, Pose
from wsim.plan.schema.formula_fluid import LevelIn
from wsim.rules.cast import Cast
from wsim.rules.lexicon import lexicon
from wsim.rules.materials import GLASS_LOOK, WATER
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
    spacing = math.ceil((amount / PARTICLES) ** (1 / 3) * 1000) / 1000
    across = [max(2, math.floor(edge / spacing - 2 * MARGIN)) * spacing for edge in (x, y)]
    # A tall column runs up the walls as it collapses, and over the rim.
    most = max(2, math.floor(FLAT * min(across) / spacing))
    tall = min(most, max(2, round(amount / (across[0] * across[1] * spacing)))) * spacing
    size = (tidy(across[0]), tidy(across[1]), tidy(tall))
    bottom = WALL + height
    cast.assume(
        "water",
        f"{1000 * math.prod(size):.3g} litres",
        f"at most {FILL:.0%} of what the vessel holds, and flat: the splash stays in",
    )
    cast.assume("water", f"a block of {size[0]:g} x {size[1]:g} x {size[2]:g} m", "a jet would need an inlet")
    water = PlanObject.proxy(
        name="water", role="fluid", primitive="fluid", size=size, material=WATER, state="fluid",
        pose=Pose(position=(0.0, 0.0, tidy(bottom + size[2] / 2))), words=cast.water or "",
    )  # fmt: skip
    taken.add("water")
    part.objects.append(vessel)
    part.posed.append(water)
    part.objectives.append(
        Objective(kind="fills", object="water", ref=vessel.name, sentence=f"The water ends in {vessel.name}.")
    )
    if level is not None:
        sentence = f"The water stands {level:g} m high in {vessel.name}."
        part.objectives.append(asked("water", sentence, LevelIn(fluid="water", ref=vessel.name, level=level)))
    part.spacing = spacing
    part.duration = round(1.2 + fall_time(height), 1)
    return part


def _vessel(cast: Cast, taken: set[str]) -> PlanObject:
    assert cast.pour is not None
    if cast.pour.vessel is not None:
        [vessel] = bodies(cast.pour.vessel, cast, taken)
    else:
        size = lexicon().nouns["tank"].size
        cast.assume("tank", f"{size[0]:g} x {size[1]:g} x {size[2]:g} m inside", "the prompt gives no size")
        taken.add("tank")
        vessel = PlanObject.proxy(
            name="tank", role="container", primitive="tank", size=size, material=GLASS_LOOK, state="static",
            words=cast.tank or "",
        )  # fmt: skip
    return vessel.model_copy(update={"pose": Pose(position=(0.0, 0.0, 0.0)), "state": "static"})
