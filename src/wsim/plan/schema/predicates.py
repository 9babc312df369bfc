"""The predicates of the topology: one table. What a row may state, what it means, and how the layout reads it.

The schema takes its names and arguments from here, the plan's checks the roles and supports, the layout the faces that
it ties, the measure the same, the templates what they expand to, docs/predicates.md its tables. A new predicate of a
kind that is there is one more entry; one of a new kind needs its equation in `wsim.plan.layout`, and its measure.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Literal

Kind = Literal["side", "alignment", "support", "size", "orientation", "posture", "fluid", "group", "level", "template"]

GAP = 0.05  # between neighbours whose side relation states no gap [m]
CLEARANCE = 0.02  # under what is let go over something [m]
OVERLAP = 0.05  # of a bridge's end on what carries it [m]


@dataclass(frozen=True)
class Predicate:
    """What a predicate takes and means.

    Attributes:
        name: As plans write it.
        kind: What it settles. Rows of the kinds side, alignment, level, orientation and posture are read by `axis` and
            `sign` alone.
        means: One line, as docs/predicates.md has it.
        words: The row as a person says it; `{ref}`, `{value}` and the other arguments are filled in.
        needs: Arguments that must be given.
        takes: Arguments that may be given.
        axis: 0, 1 or 2 for X, Y or Z: that the row is about.
        sign: The face, or the direction, on that axis: 1 the high one, -1 the low one, 0 the middle.
        carries: Whether it says what carries its object; one row of an object may.
        places: Whether it says where its object is, or how it is turned.
        by_place: Whether its heading, or size, hangs on where things are.
        of_role: The role that its object must have; any if none.
        ref_role: The role that `ref` must have.
        defaults: What arguments are that are not given.
        expands: Of a template: the rows it is written out as. Each takes those of the template's arguments it knows.
        renames: Of a template: arguments of those rows that it has under other names.
        fills: Of a template: the share of the hollow's height that a fluid fills; it is the rows' `value`.
    """

    name: str
    kind: Kind
    means: str
    words: str
    needs: tuple[str, ...] = ()
    takes: tuple[str, ...] = ()
    axis: int = 0
    sign: float = 0.0
    carries: bool = False
    places: bool = True
    by_place: bool = False
    of_role: str | None = None
    ref_role: str | None = None
    defaults: Mapping[str, float | str] = field(default_factory=dict)
    expands: tuple[str, ...] = ()
    renames: Mapping[str, str] = field(default_factory=dict)
    fills: float | None = None


_REF = ("ref",)
# The name of a direction, the same in lower case as in "the left edge", what stands there is, its axis and sign.
_DIRECTIONS = (
    ("LEFT", "left of", 1, 1.0),
    ("RIGHT", "right of", 1, -1.0),
    ("FRONT", "in front of", 0, 1.0),
    ("BACK", "behind", 0, -1.0),
)
_FRONT_FIRST = (*_DIRECTIONS[2:], *_DIRECTIONS[:2])
_LEVELS = {  # of faces: their row, how it is said, their side
    "top_flush": ("LEVEL-TOPS", "top faces level", 1.0),
    "bottom_flush": ("LEVEL-BOTTOMS", "bottom faces level", -1.0),
    "centers": ("LEVEL-CENTERS", "centres level", 0.0),
}


def _towards(axis: int, sign: float) -> str:
    return ("+" if sign > 0 else "-") + "XYZ"[axis]


def _side(name: str, words: str, axis: int, sign: float) -> Predicate:
    means = f"beside `ref` on its {_towards(axis, sign)} side, faces `gap` apart"
    return Predicate(
        f"{name}-OF", "side", means, f"{words} {{ref}}", _REF, ("gap",), axis=axis, sign=sign, defaults={"gap": GAP}
    )


def _edge(name: str, axis: int, sign: float) -> Predicate:
    edge = f"{name.lower()} edge"
    means = f"its {edge} in line with the {edge} of `ref`"
    return Predicate(f"ALIGN-{name}", "alignment", means, f"{edge} in line with {{ref}}", _REF, axis=axis, sign=sign)


def _center(name: str, words: str, axis: int) -> Predicate:
    means = f"its centre in line with that of `ref` along {'XYZ'[axis]}"
    return Predicate(f"ALIGN-CENTER-{name}", "alignment", means, f"in line with {{ref}} {words}", _REF, axis=axis)


def _facing(name: str, axis: int, sign: float) -> Predicate:
    side, means = name.lower(), f"its +X turned to {_towards(axis, sign)}"
    return Predicate(f"FACING-{name}", "orientation", means, f"facing {side}", axis=axis, sign=sign)


def _lying(axis: int) -> Predicate:
    along = "XYZ"[axis]
    means = f"a cylinder or capsule on its side, its axis along {along}"
    return Predicate(f"LIES-ALONG-{along}", "posture", means, f"lying along {along}", axis=axis)


def _level(name: str, said: str, sign: float) -> Predicate:
    return Predicate(name, "level", f"{said} with those of `ref`", f"{said} with {{ref}}", _REF, axis=2, sign=sign)


_PRIMITIVES = [
    *(_side(*direction) for direction in _DIRECTIONS),
    *(_edge(name, axis, sign) for name, _, axis, sign in _DIRECTIONS),
    _center("LR", "from left to right", 1),
    _center("FB", "from front to back", 0),
    Predicate("PLACE-ON-BASE", "support", "its bottom on the world's base plane", "on the ground", carries=True),
    Predicate("PLACE-ON", "support", "rests on the top of `ref`, or on its surface `anchor`, footprint supported",
              "on {ref}", _REF, ("anchor",), carries=True),
    Predicate("PLACE-IN", "support", "inside the hollow of `ref`, on its floor, not through its walls",
              "in {ref}", _REF, carries=True),
    Predicate("PLACE-ANYWHERE", "support",
              "must be there, place free: where it hinders nothing, inside `region` or on `ref`",
              "anywhere", takes=("ref", "region"), carries=True),
    Predicate("SPAWNED-ABOVE", "support",
              "starts with its bottom `value` above `ref`: a top, a fluid's surface, or the base without `ref`",
              "{value} m above {ref}", ("value",), _REF, carries=True),
    Predicate("HEIGHT", "size", "vertical extent of a procedural body that nothing else gives",
              "{value} m high", ("value",), places=False),
    *(_facing(name, axis, sign) for name, _, axis, sign in _FRONT_FIRST),
    Predicate("FACING-TO", "orientation", "its +X turned towards `ref`",
              "facing {ref}", _REF, sign=1.0, by_place=True),
    Predicate("FACING-OPPOSITE-TO", "orientation", "its +X turned away from `ref`",
              "facing away from {ref}", _REF, sign=-1.0, by_place=True),
    Predicate("FACING-SAME-AS", "orientation", "the heading of `ref`", "facing as {ref} does", _REF),
    Predicate("RANDOM-ROT", "orientation", "a yaw within `range` [deg], drawn with the plan's seed",
              "turned at random", takes=("range",)),
    Predicate("ORIENT-BY-RELATIVE-SIDE", "orientation", "looks at `ref`, square to the side of it on which it stands",
              "turned to the side of {ref} where it stands", _REF, by_place=True),
    _lying(0),
    _lying(1),
    Predicate("FREE-SURFACE-AT", "fluid",
              "of a fluid: its still surface `value` above the inner floor of its container",
              "its surface {value} m above the floor", ("value",), of_role="fluid"),
    Predicate("FLOATS-AT-SURFACE", "fluid",
              "starts with its bottom face on the surface of the fluid `ref`, or `gap` above it",
              "floating on {ref}", _REF, ("gap",), carries=True, ref_role="fluid"),
    Predicate("SUBMERGED", "fluid",
              "starts below the surface of the fluid `ref`: its top face, or its centre, at the depth `value`",
              "{value} m under the surface of {ref}", ("ref", "value"), ("by",), carries=True, ref_role="fluid"),
    Predicate("CONTAINS-FLUID", "fluid", "a container whose walls the program must keep, and keep see-through",
              "holding {ref}", _REF, places=False, of_role="container", ref_role="fluid"),
    Predicate("SYMMETRY-ALONG", "group",
              "mirror image of `ref` about the vertical plane through `axis` along its heading",
              "mirror image of {ref} about {axis}", ("ref", "axis")),
    Predicate("GROUP", "group",
              "this object and `members` are one, called `group`: it is their anchor, and they move with it",
              "with {members} the group {group}", ("group", "members"), places=False),
    Predicate("COPY-GROUP", "group",
              "this object and `members` are arranged as the group `group` and its members, in order",
              "with {members} arranged as {group}", ("group", "members")),
]  # fmt: skip
# Rows that templates alone make: what no primitive of a plan says.
_OF_TEMPLATES = [
    *(_level(*level) for level in _LEVELS.values()),
    Predicate("SPAN", "support",
              "a box whose length, heading and centre come from the gap between `ref` and `other`, on both tops",
              "from {ref} to {other}", ("ref", "other"), ("overlap",), carries=True, by_place=True),
]  # fmt: skip
ROWS = {row.name: row for row in [*_PRIMITIVES, *_OF_TEMPLATES]}  # what the layout reads


def template(
    name: str, means: str, words: str, expands: tuple[str, ...], needs: tuple[str, ...] = _REF, **more: Any
) -> Predicate:
    """A composite; it carries its object if one of the rows of `ROWS` does that it is written out as."""
    carries = any(ROWS[row].carries for row in expands)
    return Predicate(name, "template", means, words, needs, carries=carries, expands=expands, **more)


def _adjacent(side: str, axis: int, sign: float, level: str) -> Predicate:
    row, said, _ = _LEVELS[level]
    return template(
        f"adjacent_{'plus' if sign > 0 else 'minus'}_{'xyz'[axis]}_{level}",
        f"against the {_towards(axis, sign)} face of `ref`, {said}",
        f"against {{ref}}, {said}",
        (f"{side}-OF", row),
        takes=("gap",),
        defaults={"gap": 0.0},  # "against" the face: touching it
    )


def _at_surface(name: str, what: str, row: str, **defaults: float | str) -> Predicate:
    means, words = f"its {what} at the free surface of `ref`", f"its {what} at the surface of {{ref}}"
    return template(name, means, words, (row,), ref_role="fluid", defaults={"value": 0.0, **defaults})


def _filling(name: str, means: str, words: str, share: float) -> Predicate:
    rows = ("PLACE-IN", "FREE-SURFACE-AT")
    return template(name, means, words, rows, of_role="fluid", ref_role="container", fills=share)


_TEMPLATES = [
    template("spawned_on_top", "above the top of `ref` by a small clearance, centred", "let go just over {ref}",
             ("SPAWNED-ABOVE", "ALIGN-CENTER-FB", "ALIGN-CENTER-LR"), takes=("gap",),
             defaults={"gap": CLEARANCE}, renames={"value": "gap"}),
    template("placed_on_top", "PLACE-ON, touching, centre free", "on {ref}", ("PLACE-ON",)),
    template("centered_on_ref", "PLACE-ON and both centre alignments", "on the middle of {ref}",
             ("PLACE-ON", "ALIGN-CENTER-FB", "ALIGN-CENTER-LR")),
    *(_adjacent(name, axis, sign, level) for name, _, axis, sign in _FRONT_FIRST for level in _LEVELS),
    _at_surface("bottom_flush_water_surface", "bottom", "SPAWNED-ABOVE"),
    _at_surface("center_at_water_surface", "centre", "SUBMERGED", by="center"),
    _at_surface("top_flush_water_surface", "top", "SUBMERGED", by="top"),
    template("floats_at_surface", "FLOATS-AT-SURFACE, centred where no other row places it", "floating on {ref}",
             ("FLOATS-AT-SURFACE",), ref_role="fluid"),
    _filling("fills_container_to_top", "a fluid that fills `ref` to the rim", "filling {ref} to the rim", 1.0),
    _filling("fills_container_lower_half", "a fluid that fills the lower half of `ref`",
             "filling the lower half of {ref}", 0.5),
    template("bridge_between_a_and_b",
             "spans the gap between `ref` and `other`, its ends resting on both tops, its length from the gap",
             "a bridge from {ref} to {other}", ("SPAN",), ("ref", "other"), takes=("overlap",),
             defaults={"overlap": OVERLAP}),
    template("flush_with_platform_top", "its top face level with the top of `ref`",
             "its top level with that of {ref}", ("LEVEL-TOPS",)),
]  # fmt: skip
TEMPLATES = tuple(row.name for row in _TEMPLATES)
PREDICATES = {row.name: row for row in [*_PRIMITIVES, *_TEMPLATES]}  # what a plan may state
