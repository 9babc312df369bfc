"""What is drawn anew for each candidate: a mass, a friction, a level or a pose, within a range."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Literal

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, model_validator

from wsim.errors import UserError
from wsim.runs.draws import MOST_FRICTION, TIMES

FORMS = "BODY.mass=2:3, BODY.friction=0.3:0.6, TANK.level=0.2:0.4, any of them =0.8:1.2x, or BODY.pose=0.05,5deg"
SCALARS = ("mass", "friction", "level")


class Draw(BaseModel):
    """One number of a world, and the range that it is drawn from, evenly.

    Attributes:
        target: Name or path of the prim.
        what: Which number of it.
        low: Least value: [kg], [m], [deg], or without unit.
        high: Greatest value.
        times: Whether it multiplies what the stage states.
    """

    model_config = ConfigDict(extra="forbid", frozen=True)

    target: str = Field(pattern=r"^[^.\s]+$")
    what: Literal["mass", "friction", "level", "pose.x", "pose.y", "pose.turn"]
    low: float = Field(allow_inf_nan=False)
    high: float = Field(allow_inf_nan=False)
    times: bool = False

    @model_validator(mode="after")
    def _is_a_range(self) -> Draw:
        if not self.low < self.high:
            raise ValueError(f"low {self.low:g} is not below high {self.high:g}")
        if self.what == "friction" and self.low < 0.0:
            raise ValueError(f"low {self.low:g} is below 0, and no friction is")
        if self.what in ("mass", "level") and self.low <= 0.0:
            raise ValueError(f"low {self.low:g} must be above 0, as every {self.what} is")
        if self.what == "friction" and not self.times and self.high > MOST_FRICTION:
            raise ValueError(f"high {self.high:g} is above {MOST_FRICTION:g}, the most that friction may be")
        return self

    @property
    def name(self) -> str:
        """Of the number, as `wsim.runs.draws.apply` takes it."""
        return f"{self.target}.{self.what}{TIMES if self.times else ''}"

    def at(self, seed: int, candidate: int, index: int) -> float:
        """The number that a candidate has, from NumPy's PCG64 of the sweep's seed, its number and the draw's place."""
        return float(np.random.default_rng([seed, candidate, index]).uniform(self.low, self.high))


def parse(text: str) -> list[Draw]:
    """What `--randomise` says: "crate.mass=0.8:1.2x", "floor.friction=0.3:0.6", "crate.pose=0.05,5deg".

    A pose is moved along x and along y by up to so much [m] either way, and, where an angle is given, turned about the
    vertical by up to that.

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
        low, high = map(_number, rest.removesuffix("x").split(":"))
        times = rest.endswith("x")
        return [Draw.model_validate({"target": target, "what": what, "low": low, "high": high, "times": times})]
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
    parts = rest.split(",")
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
            found.append(Draw.model_validate({"target": target, "what": what, "low": -reach, "high": reach}))
    if not found:
        raise ValueError("nothing is drawn")
    return found


def _number(text: str) -> float:
    value = float(text)
    if not math.isfinite(value):
        raise ValueError(f"{text} is not finite")
    return value
