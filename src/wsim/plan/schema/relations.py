"""Rows of the topology: predicates, the templates that expand to them, and which arguments each takes."""

from __future__ import annotations

from dataclasses import dataclass
from difflib import get_close_matches
from typing import Annotated, Literal

from pydantic import Field, model_validator

from wsim.plan.schema.base import Name, NotNegative, Number, Positive, Strict

Kind = Literal["side", "alignment", "support", "size", "orientation", "fluid", "group", "template"]


@dataclass(frozen=True)
class Predicate:
    """What a predicate takes and means.

    Attributes:
        kind: What it settles.
        means: One line, as PREDICATES are documented.
        words: The row as a person says it; `{ref}`, `{value}` and the other arguments are filled in.
        needs: Arguments that must be given.
        takes: Arguments that may be given.
    """

    kind: Kind
    means: str
    words: str
    needs: tuple[str, ...] = ()
    takes: tuple[str, ...] = ()


def _side(side: str, axis: str) -> Predicate:
    return Predicate(
        "side",
        f"beside `ref` on its {axis} side, faces `gap` apart",
        f"{side} {{ref}}",
        needs=("ref",),
        takes=("gap",),
    )


def _edge(edge: str) -> Predicate:
    return Predicate(
        "alignment",
        f"its {edge} edge in line with the {edge} edge of `ref`",
        f"{edge} edge in line with {{ref}}",
        ("ref",),
    )


def _facing(side: str, axis: str) -> Predicate:
    return Predicate("orientation", f"its +X turned to {axis}", f"facing {side}")


def _adjacent(side: str, level: str) -> Predicate:
    sign, axis = side.split("_")
    towards = ("+" if sign == "plus" else "-") + axis.upper()
    heights = {"top_flush": "top faces level", "bottom_flush": "bottom faces level", "centers": "centres level"}[level]
    return Predicate(
        "template", f"against the {towards} face of `ref`, {heights}", f"against {{ref}}, {heights}", ("ref",), ("gap",)
    )


def _at_surface(what: str) -> Predicate:
    return Predicate(
        "template", f"its {what} at the free surface of `ref`", f"its {what} at the surface of {{ref}}", ("ref",)
    )


PREDICATES: dict[str, Predicate] = {
    "LEFT-OF": _side("left of", "+Y"),
    "RIGHT-OF": _side("right of", "-Y"),
    "FRONT-OF": _side("in front of", "+X"),
    "BACK-OF": _side("behind", "-X"),
    "ALIGN-LEFT": _edge("left"),
    "ALIGN-RIGHT": _edge("right"),
    "ALIGN-FRONT": _edge("front"),
    "ALIGN-BACK": _edge("back"),
    "ALIGN-CENTER-LR": Predicate(
        "alignment", "its centre in line with that of `ref` along Y", "in line with {ref} from left to right", ("ref",)
    ),
    "ALIGN-CENTER-FB": Predicate(
        "alignment", "its centre in line with that of `ref` along X", "in line with {ref} from front to back", ("ref",)
    ),
    "PLACE-ON-BASE": Predicate("support", "its bottom on the world's base plane", "on the ground"),
    "PLACE-ON": Predicate(
        "support",
        "rests on the top of `ref`, or on its surface `anchor`, footprint supported",
        "on {ref}",
        ("ref",),
        ("anchor",),
    ),
    "PLACE-IN": Predicate(
        "support", "inside the hollow of `ref`, on its floor, not through its walls", "in {ref}", ("ref",)
    ),
    "PLACE-ANYWHERE": Predicate(
        "support",
        "must be there, place free: where it hinders nothing, inside `region` or on `ref`",
        "anywhere",
        takes=("ref", "region"),
    ),
    "SPAWNED-ABOVE": Predicate(
        "support",
        "starts with its bottom `value` above `ref`: a top, a fluid's surface, or the base without `ref`",
        "{value} m above {ref}",
        ("value",),
        ("ref",),
    ),
    "HEIGHT": Predicate(
        "size", "vertical extent of a procedural body that nothing else gives", "{value} m high", ("value",)
    ),
    "FACING-FRONT": _facing("front", "+X"),
    "FACING-BACK": _facing("back", "-X"),
    "FACING-LEFT": _facing("left", "+Y"),
    "FACING-RIGHT": _facing("right", "-Y"),
    "FACING-TO": Predicate("orientation", "its +X turned towards `ref`", "facing {ref}", ("ref",)),
    "FACING-OPPOSITE-TO": Predicate("orientation", "its +X turned away from `ref`", "facing away from {ref}", ("ref",)),
    "FACING-SAME-AS": Predicate("orientation", "the heading of `ref`", "facing as {ref} does", ("ref",)),
    "RANDOM-ROT": Predicate(
        "orientation", "a yaw within `range` [deg], drawn with the plan's seed", "turned at random", takes=("range",)
    ),
    "ORIENT-BY-RELATIVE-SIDE": Predicate(
        "orientation",
        "looks at `ref`, square to the side of it on which it stands",
        "turned to the side of {ref} where it stands",
        ("ref",),
    ),
    "LIES-ALONG-X": Predicate("orientation", "a cylinder or capsule on its side, its axis along X", "lying along X"),
    "LIES-ALONG-Y": Predicate("orientation", "a cylinder or capsule on its side, its axis along Y", "lying along Y"),
    "FREE-SURFACE-AT": Predicate(
        "fluid",
        "of a fluid: its still surface `value` above the inner floor of its container",
        "its surface {value} m above the floor",
        ("value",),
    ),
    "FLOATS-AT-SURFACE": Predicate(
        "fluid",
        "starts with its bottom face on the surface of the fluid `ref`, or `gap` above it",
        "floating on {ref}",
        ("ref",),
        ("gap",),
    ),
    "SUBMERGED": Predicate(
        "fluid",
        "starts below the surface of the fluid `ref`: its top face, or its centre, at the depth `value`",
        "{value} m under the surface of {ref}",
        ("ref", "value"),
        ("by",),
    ),
    "CONTAINS-FLUID": Predicate(
        "fluid", "a container whose walls the program must keep, and keep see-through", "holding {ref}", ("ref",)
    ),
    "SYMMETRY-ALONG": Predicate(
        "group",
        "mirror image of `ref` about the vertical plane through `axis` along its heading",
        "mirror image of {ref} about {axis}",
        ("ref", "axis"),
    ),
    "GROUP": Predicate(
        "group",
        "this object and `members` are one, called `group`: it is their anchor, and they move with it",
        "with {members} the group {group}",
        ("group", "members"),
    ),
    "COPY-GROUP": Predicate(
        "group",
        "this object and `members` are arranged as the group `group` and its members, in order",
        "with {members} arranged as {group}",
        ("group", "members"),
    ),
    "spawned_on_top": Predicate(
        "template", "above the top of `ref` by a small clearance, centred", "let go just over {ref}", ("ref",), ("gap",)
    ),
    "placed_on_top": Predicate("template", "PLACE-ON, touching, centre free", "on {ref}", ("ref",)),
    "centered_on_ref": Predicate("template", "PLACE-ON and both centre alignments", "on the middle of {ref}", ("ref",)),
    **{
        f"adjacent_{side}_{level}": _adjacent(side, level)
        for side in ("plus_x", "minus_x", "plus_y", "minus_y")
        for level in ("top_flush", "bottom_flush", "centers")
    },
    "bottom_flush_water_surface": _at_surface("bottom"),
    "center_at_water_surface": _at_surface("centre"),
    "top_flush_water_surface": _at_surface("top"),
    "floats_at_surface": Predicate(
        "template",
        "FLOATS-AT-SURFACE, centred where no other row places it",
        "floating on {ref}",
        ("ref",),
    ),
    "fills_container_to_top": Predicate(
        "template", "a fluid that fills `ref` to the rim", "filling {ref} to the rim", ("ref",)
    ),
    "fills_container_lower_half": Predicate(
        "template", "a fluid that fills the lower half of `ref`", "filling the lower half of {ref}", ("ref",)
    ),
    "bridge_between_a_and_b": Predicate(
        "template",
        "spans the gap between `ref` and `other`, its ends resting on both tops, its length from the gap",
        "a bridge from {ref} to {other}",
        ("ref", "other"),
        ("overlap",),
    ),
    "flush_with_platform_top": Predicate(
        "template", "its top face level with the top of `ref`", "its top level with that of {ref}", ("ref",)
    ),
}  # fmt: skip
TEMPLATES = tuple(name for name, spec in PREDICATES.items() if spec.kind == "template")
ARGUMENTS = ("ref", "other", "axis", "gap", "value", "anchor", "by", "region", "range", "overlap", "group", "members")


class Region(Strict):
    """An upright rectangle on the ground [m]."""

    low: tuple[Number, Number]
    high: tuple[Number, Number]

    @model_validator(mode="after")
    def _ordered(self) -> Region:
        if not (self.low[0] < self.high[0] and self.low[1] < self.high[1]):
            raise ValueError(f"low {self.low} must be below high {self.high} along X and Y; swap them")
        return self


class Relation(Strict):
    """One row of the topology: `predicate` applied to the object, with its arguments."""

    predicate: Annotated[str, Field(max_length=60)]
    ref: Name | None = None
    other: Name | None = None  # the second reference of a bridge
    axis: Name | None = None  # the object that a mirror plane goes through
    gap: NotNegative | None = None  # [m], between faces
    value: NotNegative | None = None  # [m]: a height or a depth
    anchor: Name | None = None  # a named surface of `ref`
    by: Literal["top", "center"] | None = None
    region: Region | None = None
    range: tuple[Number, Number] | None = None  # [deg]
    overlap: Positive | None = None  # [m], of a bridge's end on what carries it
    group: Name | None = None
    members: list[Name] | None = Field(None, max_length=1000)

    @model_validator(mode="after")
    def _arguments(self) -> Relation:
        spec = PREDICATES.get(self.predicate)
        if spec is None:
            near = get_close_matches(self.predicate, PREDICATES, n=1, cutoff=0.4)
            way = f"did you mean {near[0]}?" if near else f"the predicates are {', '.join(PREDICATES)}"
            raise ValueError(f"there is no predicate {self.predicate!r}; {way}")
        given = {name for name in ARGUMENTS if getattr(self, name) is not None}
        for name in spec.needs:
            if name not in given:
                raise ValueError(f'{self.predicate} needs "{name}": {_MEANS[name]}')
        strange = sorted(given - set(spec.needs) - set(spec.takes))
        if strange:
            takes = ", ".join((*spec.needs, *spec.takes)) or "no arguments"
            raise ValueError(f'{self.predicate} takes {takes}; remove "{strange[0]}"')
        return self

    @property
    def spec(self) -> Predicate:
        """What the predicate takes and means."""
        return PREDICATES[self.predicate]

    def refs(self) -> list[tuple[str, str]]:
        """Every object that the row names, with the argument that names it."""
        named = [(field, getattr(self, field)) for field in ("ref", "other", "axis")]
        named += [(f"members.{i}", name) for i, name in enumerate(self.members or [])]
        return [(field, name) for field, name in named if name is not None]

    def sentence(self) -> str:
        """The row as a person says it."""
        values = {name: getattr(self, name) for name in ARGUMENTS}
        values["members"] = ", ".join(self.members or [])
        values["ref"] = self.ref or "the ground"
        values["value"] = "" if self.value is None else f"{self.value:g}"
        words = self.spec.words.format(**values)
        words += f", {self.gap:g} m apart" if self.gap is not None and self.spec.kind == "side" else ""
        return words + (f" at its {self.anchor}" if self.anchor else "")


_MEANS = {
    "ref": "the name of another object",
    "other": "the name of a second object",
    "axis": "the name of the object that the mirror plane goes through",
    "value": "a height or depth in metres",
    "group": "the group's name",
    "members": "a list of objects' names",
}
