"""What is drawn anew for each candidate: a mass, a friction, a level or a pose, within a range."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Literal

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, model_validator
from scipy.special import ndtr, ndtri

from wsim.errors import UserError
from wsim.runs.draws import MOST_FRICTION, TIMES

FORMS = (
    "BODY.mass=2:3, BODY.friction=0.3:0.6, TANK.level=0.2:0.4, any of them =log:0.5:2, =normal:MEAN:DEVIATION or "
    "=0.8:1.2x, or BODY.pose=0.05,5deg or =normal:0.05,5deg"
)
TAIL = 4.0  # deviations of a normal distribution, beyond which it is cut off: 6 of 100,000 values
SCALARS = ("mass", "friction", "level")


class Draw(BaseModel):
    """One number of a world, and the range that it is drawn from.

    Attributes:
        target: Name or path of the prim.
        what: Which number of it.
        low: Least value: [kg], [m], [deg], or without unit.
        high: Greatest value.
        times: Whether it multiplies what the stage states.
        spread: How it is drawn: evenly, evenly in its logarithm, or normally with `TAIL` deviations to either end.
    """

    model_config = ConfigDict(extra="forbid", frozen=True)

    target: str = Field(pattern=r"^[^.\s]+$")
    what: Literal["mass", "friction", "level", "pose.x", "pose.y", "pose.turn"]
    low: float = Field(allow_inf_nan=False)
    high: float = Field(allow_inf_nan=False)
    times: bool = False
    spread: Literal["even", "log", "normal"] = "even"

    @classmethod
    def parse(cls, target: str, what: str, text: str) -> Draw:
        """From "2:3", "log:2:3" or "normal:2.5:0.1", with an x behind it where the number multiplies what is stated.

        Raises:
            ValueError: Saying what is wrong, if it is understood.
        """
        spread, given = _spread(text.removesuffix("x"))
        low, high = map(_number, given.split(":"))
        if spread == "normal":
            if not high > 0.0:
                raise ValueError("not above 0")
            low, high = low - TAIL * high, low + TAIL * high
        data = {"target": target, "what": what, "low": low, "high": high, "times": text.endswith("x"), "spread": spread}
        return cls.model_validate(data)

    @model_validator(mode="after")
    def _is_a_range(self) -> Draw:
        if not math.isfinite(self.high - self.low):
            raise ValueError(f"from {self.low:g} to {self.high:g} is further than numbers go")
        if not self.low < self.high:
            raise ValueError(f"low {self.low:g} is not below high {self.high:g}")
        low, high = (f"{end} {value:g}" for end, value in (("low", self.low), ("high", self.high)))
        if self.spread == "normal":
            low, high = (f"{end}, {TAIL:g} deviations from the mean," for end in (low, high))
        if self.what == "friction" and self.low < 0.0:
            raise ValueError(f"{low} is below 0, and no friction is")
        if self.what in ("mass", "level") and self.low <= 0.0:
            raise ValueError(f"{low} must be above 0, as every {self.what} is")
        if self.what == "friction" and not self.times and self.high > MOST_FRICTION:
            raise ValueError(f"{high} is above {MOST_FRICTION:g}, the most that friction may be")
        if self.spread == "log" and self.low <= 0.0:
            raise ValueError(f"{low} has no logarithm; it must be above 0")
        return self

    @property
    def name(self) -> str:
        """Of the number, as `wsim.runs.draws.apply` takes it."""
        return f"{self.target}.{self.what}{TIMES if self.times else ''}"

    def at(self, seed: int, candidate: int, index: int) -> float:
        """The number that a candidate has, from NumPy's PCG64 of the sweep's seed, its number and the draw's place."""
        generator = np.random.default_rng([seed, candidate, index])
        if self.spread == "log":
            return math.exp(generator.uniform(math.log(self.low), math.log(self.high)))
        if self.spread == "normal":
            middle, deviation = (self.low + self.high) / 2.0, (self.high - self.low) / (2.0 * TAIL)
            return float(middle + deviation * ndtri(generator.uniform(ndtr(-TAIL), ndtr(TAIL))))
        return float(generator.uniform(self.low, self.high))


def parse(text: str) -> list[Draw]:
    """What `--randomise` says: "crate.mass=0.8:1.2x", "floor.friction=0.3:0.6", "crate.pose=0.05,5deg".

    A number is drawn evenly, with `log:` evenly in its logarithm, with `normal:` of a mean and a deviation. A pose is
    moved along x and along y by up to so much [m] either way and, where an angle is given, turned about the vertical by
    up to that; with `normal:` these are deviations.

    Raises:
        UserError: Naming what was given and what is understood.
    """
    name, _, rest = text.partition("=")
    target, _, what = name.rpartition(".")
    try:
        if what == "pose":
            return _pose(target, rest)
        if what not in SCALARS or "." in target:
            raise ValueError("unknown")
        return [Draw.parse(target, what, rest)]
    except ValueError as error:
        why = [str(each["ctx"]["error"]) for each in getattr(error, "errors", list)() if "error" in each.get("ctx", {})]
        raise UserError(f"--randomise {text}: {why[0] if why else f'expected {FORMS}'}") from error


def parse_all(texts: Sequence[str]) -> list[Draw]:
    """What all of the options say.

    Raises:
        UserError: If one is not understood, or a number is drawn twice.
    """
    draws = [draw for text in texts for draw in parse(text)]
    known = [(draw.target, draw.what) for draw in draws]
    for target, what in known:
        if known.count((target, what)) > 1:
            raise UserError(f"--randomise: {target}.{what.partition('.')[0]} is given twice; give it once")
    return draws


def _pose(target: str, rest: str) -> list[Draw]:
    spread, given = _spread(rest)
    if spread == "log":
        raise ValueError("both ways")
    parts = given.split(",")
    reaches = {"pose.x": parts[0], "pose.y": parts[0]}
    if len(parts) == 2 and parts[1].endswith("deg"):
        reaches["pose.turn"] = parts[1].removesuffix("deg")
    elif len(parts) != 1:
        raise ValueError("not a pose")
    found = []
    for what, text in reaches.items():
        reach = _number(text)
        if reach < 0.0:
            raise ValueError("below 0")
        if reach > 0.0:
            found.append(
                Draw.parse(target, what, f"normal:0:{reach!r}" if spread == "normal" else f"{-reach!r}:{reach!r}")
            )
    if not found:
        raise ValueError("nothing is drawn")
    return found


def _spread(text: str) -> tuple[Literal["even", "log", "normal"], str]:
    """How a number is drawn, and of what."""
    if text.startswith("log:"):
        return "log", text.removeprefix("log:")
    if text.startswith("normal:"):
        return "normal", text.removeprefix("normal:")
    return "even", text


def _number(text: str) -> float:
    value = float(text)
    if not math.isfinite(value):
        raise ValueError(f"{text} is not finite")
    return value
