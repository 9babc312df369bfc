"""Whether a plan's liquid, and what comes in and goes out of it, is what the prompt says."""

from __future__ import annotations

from collections.abc import Iterator

from wsim.plan.schema import OpeningPlan, Plan, PlanObject
from wsim.rules.cast import Cast, Flow
from wsim.rules.tokens import NotUnderstood

CLOSE = 0.05  # share by which a number may be another
KINDS = {"tap": "tap", "rain": "tap", "drain": "drain"}


def check_wet(plan: Plan, cast: Cast) -> None:
    """Refuse a plan whose liquid is not as the prompt says.

    Raises:
        NotUnderstood: It is another one, or another amount, or comes in and goes out otherwise.
    """
    fluids = [item for item in plan.objects if item.primitive == "fluid"]
    for item in fluids:
        for lost in _amount(plan, item, cast):
            raise NotUnderstood([lost], "knows these words, but could not build all of them together:")
    if (cast.filled is not None or cast.flows) and not fluids:
        raise NotUnderstood([cast.water or cast.flows[0].words], "knows this, but could not build it with the rest:")
    rains = {bool(each.drop_speed) for each in plan.openings if each.kind == "tap"}
    for flow in cast.flows:
        made = [each for each in plan.openings if each.kind == KINDS[flow.kind]]
        if len(made) != 1 or (flow.kind != "drain" and rains != {flow.kind == "rain"}):
            raise NotUnderstood([flow.words], "knows this, but could not build it with the rest:")
        for lost in _opened(plan, flow, made[0]):
            raise NotUnderstood([f"{flow.words} {lost}"], "knows this, but could not build it so:")
    if len(plan.openings) != len(cast.flows):
        raise NotUnderstood([plan.openings[0].name], "lets nothing in or out that the prompt does not name:")


def _amount(plan: Plan, item: PlanObject, cast: Cast) -> Iterator[str]:
    """What of the liquid is not as it is said."""
    held, liquid = cast.filled, cast.liquid
    if item.material is None or item.material.name != liquid.material.name:
        yield liquid.words[0]
    level, inside = item.relation("FREE-SURFACE-AT"), item.relation("PLACE-IN")
    volume = item.registration.volume
    if volume is not None and held is not None and (held.volume is None or not _is(volume, held.volume)):
        yield f"{1000 * volume:g} litres of {liquid.words[0]}"
    if item.volume is not None and held is not None and held.volume is not None and not _is(item.volume, held.volume):
        yield f"{1000 * held.volume:g} litres of {liquid.words[0]}"
    if level is None or level.value is None or inside is None:
        return
    if cast.share == 0.0 and level.value > 0.0:
        yield "empty"
    size = plan.object(inside.ref or "").size
    stands = cast.stands or not cast.flows
    if held is None or not stands:
        return
    if held.level is not None and not _is(level.value, held.level):
        yield f"{held.level:g} m of {liquid.words[0]}"
    if held.volume is not None and size and not _is(level.value * size[0] * size[1], held.volume):
        yield f"{1000 * held.volume:g} litres of {liquid.words[0]}"
    if cast.share and size and not _is(level.value / size[2], cast.share):
        yield f"{cast.share:.0%} full"


def _opened(plan: Plan, flow: Flow, made: OpeningPlan) -> Iterator[str]:
    """What of an opening is not as it is said."""
    said = flow.said
    rate = (made.rate or 0.0) / (made.area if flow.kind == "rain" else 1.0)
    ends = made.stop if made.stop is not None else plan.simulation.duration
    for name, value, built in (
        ("rate", said.get("rate"), rate),
        ("width", said.get("width"), made.narrowest),
        ("start", said.get("start"), made.start or 0.0),
        ("lasts", said.get("lasts"), ends - (made.start or 0.0)),
        ("volume", said.get("volume"), made.poured(plan.simulation.duration)),
        ("height", said.get("height"), made.offset[2]),
    ):
        if value is not None and not _is(built, value):
            yield f"{name} {value:g}"
    if flow.wall != (made.kind == "drain" and made.direction is not None):
        yield "in the wall"


def _is(value: float, said: float) -> bool:
    return abs(value - said) <= CLOSE * abs(said) + 1e-9
