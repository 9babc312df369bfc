"""What a tank is said to hold: which liquid, and how much of it."""

from __future__ import annotations

from dataclasses import replace

from wsim.errors import UserError
from wsim.rules.cast import Cast
from wsim.rules.liquids import Filled, Liquid, liquids
from wsim.rules.phrases import Phrase
from wsim.rules.tokens import NotUnderstood

AMOUNTS = ("share", "volume", "level")


def depth_of(phrase: Phrase) -> float | None:
    """How deep a liquid is said to be [m]: "10 cm of water", "water 10 cm deep"."""
    return phrase.measures.get("z", phrase.measures.get("y", phrase.length))


def bare(phrase: Phrase) -> Phrase:
    """A liquid's phrase without what may be said of one: its colour, and how deep it is."""
    if phrase.kind != "water":
        return phrase
    strange = {name: value for name, value in phrase.measures.items() if name not in ("y", "z", "flow", "rainfall")}
    return replace(phrase, color=None, length=None, measures=strange)


def named(cast: Cast, phrase: Phrase) -> None:
    """Take in a liquid that is named by itself."""
    fill(cast, Filled(phrase.liquid, volume=phrase.volume, level=depth_of(phrase), color=phrase.color), phrase.words)
    cast.water = cast.water or phrase.words


def fill(cast: Cast, held: Filled, words: str) -> None:
    """Take in what a tank, or a vessel, is said to hold.

    Raises:
        UserError: It is another liquid than before, or another amount.
    """
    before = cast.filled
    if before is None:
        cast.filled = held
        return
    if before.liquid != held.liquid:
        one, other = (liquids()[each.liquid].words[0] for each in (before, held))
        raise UserError(f"{words!r}: the builtin planner has one liquid in a scene, not {one} and {other}")
    for name in (*AMOUNTS, "color"):
        old, new = getattr(before, name), getattr(held, name)
        if None not in (old, new) and old != new:
            raise UserError(f"{words!r}: the prompt says something else of the {held.liquid} before")
    given = {name: getattr(held, name) for name in (*AMOUNTS, "color") if getattr(held, name) is not None}
    cast.filled = replace(before, **given)


def full(cast: Cast, phrase: Phrase) -> None:
    """Take in how full a tank is said to be, and with what.

    Raises:
        UserError: It is said otherwise before.
    """
    if phrase.share is not None:
        if cast.share not in (None, phrase.share):
            raise UserError(f"{phrase.words!r}: the prompt says before how full it is")
        cast.share = phrase.share
    if phrase.filled:
        fill(cast, phrase.filled, phrase.words)
        cast.water = cast.water or phrase.words
    cast.stands = cast.stands or bool(phrase.filled) or bool(phrase.share)


def check_amount(cast: Cast) -> None:
    """Refuse more than one amount, and an empty tank in which something is to be.

    Raises:
        NotUnderstood: Nothing is built of it.
        UserError: Two amounts are said.
    """
    held = cast.filled
    said = [name for name in AMOUNTS if held is not None and getattr(held, name) is not None]
    if cast.share and "share" not in said:
        said.append("share")
    if len(said) > 1:
        raise UserError(f"{cast.water or cast.tank!r}: the prompt says how full it is and how much is in it; keep one")
    comes = [flow for flow in cast.flows if flow.kind != "drain"]
    known = [value for flow in comes for value in (flow.volume, flow.level)]
    left = [name for name in said if name != "share" and getattr(held, name) not in known]
    if left and comes and not cast.stands and len(comes) == len(cast.flows):
        raise NotUnderstood([cast.water or comes[0].words], "cannot tell whether so much is there before, or comes in:")
    if cast.tank is not None and any(flow.vessel is not None for flow in cast.flows):
        raise NotUnderstood([cast.tank], "fills one tank or one vessel, and not this as well:")
    if cast.share == 0.0 and cast.tank is not None and not cast.flows and cast.pour is None:
        raise NotUnderstood([cast.tank], "has an empty tank only for what flows or is poured into it:")


def note_liquid(liquid: Liquid, cast: Cast) -> None:
    """What a liquid's word leaves open."""
    if liquid.assume:
        numbers = f"{liquid.material.density:g} kg/m^3, {liquid.viscosity:g} Pa s"
        cast.assume(liquid.words[0], f"{liquid.assume}: {numbers}", "the prompt does not say which")
