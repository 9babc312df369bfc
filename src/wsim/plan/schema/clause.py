"""Clauses of the prompt in a plan: its words, and what shows that they came true."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field, model_validator

from wsim.plan.schema.base import Sparse, Text

# What of an object, and of a joint, the judge holds the world to, where the plan states it.
OF_OBJECTS = (
    "size", "mass", "density", "material", "color", "place", "velocity", "direction", "spin", "surface_velocity",
    "friction", "restitution", "rolling", "level", "volume", "actuation",
)  # fmt: skip
OF_JOINTS = ("axis", "anchor", "limits", "drive")
OF_CORDS = ("length", "stiffness", "damping", "rest_length")
OF_SCHEDULES = ("values", "times")
OF_OPENINGS = ("rate", "radius", "size", "start", "stop", "drop_speed", "offset")
WHOLE = "simulation"  # the run itself: its duration
Index = Annotated[int, Field(ge=0)]
Thing = Annotated[str, Field(pattern=r"^[A-Za-z_][A-Za-z0-9_]*(\.[a-z_]+)?$", max_length=120)]


class Clause(Sparse):
    """Words of the prompt, and what answers for them; or why nothing does.

    Attributes:
        words: As they stand in the prompt, one after another.
        by: Numbers of objectives, counted from 0; names of objects, joints, cords, schedules, openings, cameras, a
            property with a dot: "puck.mass".
        unchecked: Why nothing shows that they came true; given in place of `by`.
    """

    words: Annotated[Text, Field(min_length=1)]
    by: list[Index | Thing] | None = Field(None, max_length=1000)
    unchecked: Text | None = None

    @model_validator(mode="after")
    def _says_one(self) -> Clause:
        if bool(self.by) == bool(self.unchecked):
            raise ValueError(
                f'the clause "{self.words}": give "by", the objectives and objects that show it, or "unchecked", why '
                "none does"
            )
        return self

    @property
    def objectives(self) -> list[int]:
        """Numbers of the objectives that answer for it."""
        return [each for each in self.by or [] if isinstance(each, int)]

    @property
    def things(self) -> list[tuple[str, str]]:
        """(name, property) of what else does; the property is empty where the thing itself is meant."""
        named = [each for each in self.by or [] if isinstance(each, str)]
        return [(name, field) for name, _, field in (each.partition(".") for each in named)]
