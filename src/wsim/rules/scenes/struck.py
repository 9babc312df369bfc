"""What stands where something will come along +X: at a pendulum's lowest point."""

from __future__ import annotations

from dataclasses import dataclass

from wsim.defaults import GRAVITY
from wsim.errors import UserError
from wsim.plan.schema import Objective, PlanObject, Pose
from wsim.rules.cast import Cast, Thing
from wsim.rules.scenes.knock import deep
from wsim.rules.scenes.motion import falls_off
from wsim.rules.scenes.part import Part, pair_friction, tall, tidy
from wsim.rules.scenes.tip import slender, upended
from wsim.rules.sizes import bodies

GAP = 0.01  # between the bob at its lowest point and what it hits [m]
ABOVE = 0.02  # of the bob over what carries its target, at least [m]
ROW_SHARE = 0.5  # of their height, between things in a row
NEAR_EDGE, LEAST_EDGE = 0.3, 0.03  # of the way that it slides, from the middle of what is to fall off to the edge [m]


@dataclass
class Struck:
    """What is hit, how high [m], and where on what carries it."""

    target: Thing
    items: list[PlanObject]
    height: float
    carrier: PlanObject | None
    met: PlanObject

    def ask(self, thing: Thing, item: PlanObject, speed: float, part: Part, cast: Cast) -> None:
        """That it is hit, and falls over or off where the prompt says so."""
        target, name = self.target, self.met.name
        last = self.items[-1] if target.arrangement == "stack" else self.items[0]
        if target.off and self.carrier is not None:
            _, slide = _pushed(thing, item, self.met, self.carrier, speed)
            self._to_edge(slide, part, cast)
            part.objectives.append(falls_off(self.met, self.carrier))
        elif "topple" in target.does:
            wanted = self.items if target.arrangement == "row" else [last]
            part.objectives += [
                Objective(kind="topples", object=o.name, sentence=f"{o.name} comes down.") for o in wanted
            ]
        sentence = f"{item.name} collides with {name}."
        part.objectives.append(Objective(kind="collides_with", object=item.name, ref=name, sentence=sentence))

    def _to_edge(self, slide: float, part: Part, cast: Cast) -> None:
        """Move the carrier back until its front edge is near what is to slide off it."""
        assert self.carrier is not None and self.carrier.pose is not None and self.met.pose is not None
        off = max(LEAST_EDGE, NEAR_EDGE * slide)
        if slide < 2 * LEAST_EDGE:
            choice = f"warning: it slides {slide:.2g} m and may stay on {self.carrier.name}"
            cast.assume(self.target.words, choice, "the plan asks for what the prompt says")
        x = self.met.pose.position[0] + min(off, self.carrier.size[0] / 2) - self.carrier.size[0] / 2
        _, y, z = self.carrier.pose.position
        moved = self.carrier.model_copy(update={"pose": Pose(position=(tidy(x), y, z))})
        part.objects = [moved if item is self.carrier else item for item in part.objects]


def _pushed(thing: Thing, item: PlanObject, met: PlanObject, carrier: PlanObject, speed: float) -> tuple[float, float]:
    """The speed of what is hit, by the momentum of a blow that gives none back [m/s], and how far it slides [m]."""
    masses = item.mass or 1.0, met.mass or 1.0
    after = speed * masses[0] / sum(masses)
    friction = pair_friction(met, carrier)
    return after, after**2 / (2 * max(friction, 0.01) * GRAVITY)


def stand_before(thing: Thing, item: PlanObject, part: Part, cast: Cast, taken: set[str]) -> Struck:
    """Stand a target at the lowest point of what swings along +X, on the ground or on what carries it.

    Raises:
        UserError: It stands where nothing can be hit so.
    """
    target = thing.target
    assert target is not None
    if (
        target.beside
        or target.inside is not None
        or (target.support is not None and target.support.support is not None)
    ):
        raise UserError(
            f"{target.words!r}: the builtin planner lets a pendulum hit what stands on the ground or a table"
        )
    base, carrier = 0.0, None
    if target.support is not None:
        [carrier] = bodies(target.support, cast, taken)
        base = tall(carrier)
    items = bodies(target, cast, taken)
    if "topple" in target.does and target.arrangement != "stack":
        items = [slender(target, upended(each), cast) for each in items]
    half = item.size[0] if item.primitive != "box" else item.size[2] / 2
    reach = item.size[0] if item.primitive != "box" else item.size[0] / 2
    heights = [_upright(each) for each in items]
    total = sum(heights) if target.arrangement == "stack" else heights[0]
    height = base + max(0.6 * total if target.arrangement == "stack" else total / 2, half + ABOVE)
    posed = _posed(items, heights, target, reach + GAP, base)
    part.posed += posed
    part.names[id(target)] = [each.name for each in posed]
    if carrier is not None:
        carrier = carrier.model_copy(
            update={"pose": Pose(position=(tidy(reach + GAP + deep(items[0]) / 2), 0.0, tidy(base / 2)))}
        )
        part.objects.append(carrier)
        part.names[id(target.support)] = [carrier.name]
    met = posed[0]
    if target.arrangement == "stack":
        tops = [base + sum(heights[: n + 1]) for n in range(len(heights))]
        met = posed[next((n for n, top in enumerate(tops) if top > height), len(posed) - 1)]
    return Struck(target, posed, height, carrier, met)


def _posed(items: list[PlanObject], heights: list[float], target: Thing, x: float, base: float) -> list[PlanObject]:
    made, at, z = [], x, base
    for each, height in zip(items, heights, strict=True):
        lying = each.relation("LIES-ALONG-Y") is not None
        turned = (90.0, 0.0, 0.0) if lying else (0.0, 0.0, 0.0)
        pose = Pose(position=(tidy(at + deep(each) / 2), 0.0, tidy(z + height / 2)), rotation_deg=turned)
        made.append(each.related([]).model_copy(update={"pose": pose}))
        if target.arrangement == "stack":
            z += height
        else:
            at += deep(each) + ROW_SHARE * height
    return made


def _upright(item: PlanObject) -> float:
    if item.primitive == "sphere" or item.relation("LIES-ALONG-Y") is not None:
        return 2 * item.size[0]
    return tall(item) + (2 * item.size[0] if item.primitive == "capsule" else 0.0)
