"""Ropes, springs and cables of a plan: what hangs, hoists, pulls back or sags between two objects."""

from __future__ import annotations

from typing import Literal

from pydantic import Field, model_validator

from wsim.plan.schema.base import Name, NotNegative, Positive, Sparse, Strict, Vec3

_OF = {  # fields that one kind alone has
    "around": ("rope",), "length": ("rope", "cable"), "stiffness": ("spring",), "damping": ("spring",),
    "rest_length": ("spring",), "loose": ("cable",), "links": ("cable",), "mass_per_length": ("cable",),
}  # fmt: skip


class Around(Strict):
    """A cylinder that a rope runs round, and on which side: "over", "under", or a direction from its axis."""

    object: Name
    side: Literal["over", "under"] | Vec3 = "over"


class Cord(Sparse):
    """What ties two objects, or one and the world: `scene.rope`, `scene.spring` or `scene.cable`.

    A rope weighs nothing, does not stretch, pulls where it is taut, and slips on what it runs round. A spring gives
    stiffness (length - rest_length) + damping (rate of length). A cable is a chain of links that weigh, sag, lie and
    rub. Anchors are in the world, as it starts [m]; an end without one is at its object's centre.
    """

    name: Name
    kind: Literal["rope", "spring", "cable"]
    a: Name | None = None  # what its first end is fixed to; None: the world
    b: Name | None = None
    anchor_a: Vec3 | None = None
    anchor_b: Vec3 | None = None
    around: tuple[Around, ...] | None = Field(None, max_length=100)  # from `a` to `b`
    length: Positive | None = None  # [m]; its way at the start if left out, and slack if longer
    stiffness: NotNegative | None = None  # [N/m]
    damping: NotNegative | None = None  # [N s/m]
    rest_length: NotNegative | None = None  # [m]; its length at the start if left out
    loose: bool | None = None  # the end at `anchor_b` is tied to nothing
    links: int | None = Field(None, ge=2, le=200)
    mass_per_length: Positive | None = None  # [kg/m]
    radius: Positive | None = None  # [m]

    @model_validator(mode="after")
    def _holds_together(self) -> Cord:
        for field, kinds in _OF.items():
            if getattr(self, field) is not None and self.kind not in kinds:
                raise ValueError(f"{self.name}: {field} is of a {' or a '.join(kinds)}; it is a {self.kind}: remove it")
        if self.kind == "spring" and not (self.stiffness or self.damping):
            raise ValueError(f"{self.name}: a spring needs stiffness [N/m], or damping [N s/m]")
        for end, anchor in (("a", self.anchor_a), ("b", self.anchor_b)):
            if getattr(self, end) is None and anchor is None:
                raise ValueError(f'{self.name}: without "{end}" it ends at the world; give anchor_{end}, where [m]')
        if self.a is not None and self.a == self.b:
            raise ValueError(f"{self.name}: both its ends are {self.a}; name another object, or the world at an anchor")
        if self.loose and self.b is not None:
            raise ValueError(f'{self.name}: its end is loose and tied to {self.b}; leave "b" or "loose" out')
        return self

    def owns(self, prim: str) -> bool:
        """Whether a prim's own name is that of it, of one of its links, or of a joint between them."""
        head, _, number = prim.rpartition("_")
        return prim == self.name or (
            self.kind == "cable" and number.isdigit() and head in (self.name, f"{self.name}_joint")
        )
