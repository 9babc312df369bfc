"""Which objectives can show a verb: of verbs of one meaning alone."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Sequence

    from wsim.plan.schema import Objective

BLOWS = frozenset(("hit", "strike", "collide", "crash", "smash", "ram", "bump", "slam", "kick", "slap"))
_BLOWS = "collides_with touches pushes topples stops_before bounces_to climbs_to rests_on"
_FALLS = """collides_with rests_on falls_freely drops topples submerged sinks floats flies bounces_to counts
contained_in stays_inside tilts tilts_to stays_on"""
_TURNS = "spin_between own_spin_between turned_between rolls"
_OVER = "topples upright drops tilt_between tilts tilts_to"
_STOPS = "settles speed_between stops_before stays_within rests_on"
_SHOW = (  # verbs of one meaning alone, and the kinds of objective and predicates that show it
    ("float", "floats level_in"),
    ("sink", "sinks submerged rests_on"),
    ("swing", "swings turned_between"),
    ("bounce rebound", "bounces_to climbs_to dies_down collides_with"),
    ("slide", "slides goes_down gone_between moves"),
    ("roll", "rolls rolls_down rolls_freely rolls_without_slip"),
    ("carry", "stays_on moves contained_in"),
    ("fill", "fills fills_to level_in stays_inside"),
    ("tilt", "tilts tilts_to tilt_between"),
    (" ".join(sorted(BLOWS)), _BLOWS),
    ("fall drop land plunge plummet plop", _FALLS),
    ("turn spin rotate revolve swivel pivot whirl twirl", _TURNS),
    ("topple knock tip overturn collapse tumble", _OVER),
    ("stop halt brake settle park", _STOPS),
)
SHOWN_BY = {base: frozenset(names.split()) for verbs, names in _SHOW for base in verbs.split()}


def names_of(objective: Objective) -> set[str]:
    """The kind of an objective, and the predicates of its formula."""
    nodes = objective.formula.walk() if objective.formula is not None else ()
    return {objective.kind, *(str(getattr(node, "op", "")) for node in nodes)}


def is_blow_shown(base: str, objectives: Sequence[Objective]) -> bool:
    """Whether a blow is asked for by some objectives: as such, or by what it does to another thing than the first."""
    if base not in BLOWS or not objectives:
        return True
    several = len({each.object for each in objectives}) > 1
    return several or any(names_of(each) & SHOWN_BY[base] for each in objectives)
