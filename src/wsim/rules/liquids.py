"""The liquids of the lexicon: what a fluid of a plan is made of."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache

from wsim.defaults import FLUID_DENSITY
from wsim.plan.schema import Material, PlanObject, Registration, Relation
from wsim.rules.data import read

SHARES = {"half": 0.5, "a quarter": 0.25, "a third": 1 / 3, "two thirds": 2 / 3, "three quarters": 0.75}
THICK = 0.1  # from where on viscosity is felt beside the solver's own [Pa s]


@dataclass(frozen=True)
class Filled:
    """What a vessel is said to hold."""

    liquid: str  # a liquid's key
    share: float | None = None  # of its height that it is full
    volume: float | None = None  # [m^3]
    level: float | None = None  # [m]
    color: str | None = None


@dataclass(frozen=True)
class Liquid:
    """A liquid.

    Attributes:
        key: Its name in the data, and of its object.
        words: What it is called.
        material: Its density and look.
        viscosity: [Pa s]; None: water's, which a plan need not say.
        assume: What its word leaves open, and is taken.
    """

    key: str
    words: tuple[str, ...]
    material: Material
    viscosity: float | None
    assume: str

    @property
    def thick(self) -> bool:
        """Whether it flows so slowly that this is seen."""
        return (self.viscosity or 0.0) >= THICK

    def fluid(self, words: str, rows: list[Relation], size: tuple[float, ...] = ()) -> PlanObject:
        """An object of it that fills what its rows say, or a block of a size [m]."""
        own = {} if self.viscosity is None else {"registration": Registration(viscosity=self.viscosity)}
        return PlanObject.proxy(
            name=self.key, role="fluid", primitive="fluid", size=size, material=self.material, state="fluid",
            relations=rows, words=words, **own,
        )  # fmt: skip


@lru_cache(maxsize=1)
def liquids() -> dict[str, Liquid]:
    """All of them, by key."""
    return {key: _liquid(key, fields) for key, fields in read("liquids")["liquid"].items()}


def colored(liquid: Liquid, color: tuple[float, float, float] | None) -> Liquid:
    """The same in a colour: red paint, blue water."""
    if color is None:
        return liquid
    return Liquid(
        liquid.key, liquid.words, liquid.material.model_copy(update={"color": color}), liquid.viscosity, liquid.assume
    )


def _liquid(key: str, fields: dict[str, object]) -> Liquid:
    clear = "attenuation_length" not in fields
    material = Material.model_validate(
        {"name": key, "density": fields.get("density", FLUID_DENSITY), "friction": 0.0, "color": fields["color"]}
        | ({"opacity": 0.6} if clear else {"attenuation_length": fields["attenuation_length"]})
    )
    viscosity = fields.get("viscosity")
    return Liquid(
        key,
        tuple(str(word) for word in fields["words"]),  # type: ignore[attr-defined]
        material,
        float(str(viscosity)) if viscosity is not None else None,
        str(fields.get("assume", "")),
    )


# How a vessel is said to hold a liquid; {} is the liquid's word, or how full it is and the word.
_HOLDS = (
    "of {}",
    "of {} in it",
    "with {} in it",
    "with {}",
    "filled with {}",
    "full of {}",
    "holding {}",
    "containing {}",
)
_PARTLY = ("{} full of {}", "{} filled with {}", "{} full with {}")
_FULL = ("{} full", "{} filled")


def liquid_words() -> Iterator[tuple[str, str, object]]:
    """Words, the grammar's terminal and the meaning: of liquids, of what holds them, and of how full that is."""
    for key, liquid in liquids().items():
        for word in liquid.words:
            yield word, "FLUID", key
            for form in _HOLDS:
                yield form.format(word), "FILLED", Filled(key)
            for said, share in SHARES.items():
                for form in _PARTLY:
                    yield form.format(said, word), "FILLED", Filled(key, share=share)
    for said, share in SHARES.items():
        for form in _FULL:
            yield form.format(said), "FULL", share
    yield "empty", "FULL", 0.0


_PER = {
    "FLOW": {"s": 1.0, "sec": 1.0, "second": 1.0, "min": 60.0, "minute": 60.0, "h": 3600.0, "hour": 3600.0},
    "RAINFALL": {"min": 60.0, "minute": 60.0, "h": 3600.0, "hr": 3600.0, "hour": 3600.0},
}


def flow_units(volumes: dict[str, float], depths: dict[str, float]) -> dict[tuple[str, ...], tuple[str, float]]:
    """Units of flows [m^3/s] and of rain [m/s], each with its terminal: "l/min", "litres per minute", "mm an hour"."""
    found: dict[tuple[str, ...], tuple[str, float]] = {}
    for terminal, units in (("FLOW", volumes), ("RAINFALL", depths)):
        for unit, size in units.items():
            for per, seconds in _PER[terminal].items():
                said = [f"{unit} per {per}", f"{unit}/{per}"]
                said += [f"{unit} {article} {per}" for article in ("a", "an", "each", "every") if len(per) > 3]
                found |= {tuple(each.split()): (terminal, size / seconds) for each in said}
    return found
