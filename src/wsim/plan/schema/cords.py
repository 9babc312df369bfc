"""Ropes, springs and cables of a plan: what hangs, hoists, pulls back or sags between two objects."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Literal

from pydantic import Field, model_validator

from wsim.limits import TAUT
from wsim.plan.schema.base import Name, NotNegative, Positive, Sparse, Strict, Vec3

if TYPE_CHECKING:
    from wsim.plan.schema.draft import Draft
    from wsim.plan.schema.objects import PlanObject

_OF = {  # fields that one kind alone has
    "around": ("rope",), "length": ("rope", "cable"), "stiffness": ("spring",), "damping": ("spring",),
    "rest_length": ("spring",), "loose": ("cable",), "links": ("cable",), "mass_per_length": ("cable",),
}  # fmt: skip
_NO_ENDS = ("fluid", "ground", "terrain", "scatter")


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


def cord_problems(plan: Draft) -> Iterator[str]:
    """What makes a cord of a plan impossible beside its other parts."""
    items = {item.name: item for item in plan.objects}
    for i, cord in enumerate(plan.cords):
        ends = [(field, getattr(cord, field)) for field in ("a", "b") if getattr(cord, field) is not None]
        rounds = [(f"around.{k}.object", each.object) for k, each in enumerate(cord.around or ())]
        unknown = [(field, name) for field, name in (*ends, *rounds) if name not in items]
        for field, name in unknown:
            yield f"cords.{i}.{field}: no object {name!r}; the plan has {', '.join(items) or 'none'}"
        for field, name in () if unknown else ends:
            if items[name].primitive in _NO_ENDS:
                yield f"cords.{i}.{field}: {name} is a {items[name].primitive}; leave it out, and give anchor_{field}"
        for field, name in () if unknown else rounds:
            if items[name].primitive != "cylinder":
                yield f"cords.{i}.{field}: a rope runs round cylinders; {name} is a {items[name].primitive}"
        if not unknown and cord.kind != "cable" and not any(_yields(items[name]) for _, name in ends):
            yield f"cords.{i}: neither of its ends is at a body that it could move; tie it to a dynamic one"
        if not unknown and _apart(cord, items) < TAUT:
            yield f"cords.{i}: both its ends are at one place; give anchor_a or anchor_b, where it is fixed"
        for item in plan.objects:
            if cord.owns(item.name) and item.name != cord.name:
                yield f"cords.{i}.name: {item.name} is one of its links' names; give the object another name"


def _yields(item: PlanObject) -> bool:
    return item.state == "dynamic"


def _apart(cord: Cord, items: dict[str, PlanObject]) -> float:
    """From one end to the other as far as it is known [m]; as good as endless where it is not."""
    places = []
    for name, anchor in ((cord.a, cord.anchor_a), (cord.b, cord.anchor_b)):
        pose = items[name].pose if name is not None else None
        if anchor is None and pose is None:
            return 1e9
        places.append(anchor if anchor is not None or pose is None else pose.position)
    one, other = places
    assert one is not None and other is not None
    return float(sum((x - y) ** 2 for x, y in zip(one, other, strict=True)) ** 0.5)
