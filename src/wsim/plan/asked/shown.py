"""Which objectives can show a verb, or that it does not come to be: of verbs of one meaning alone."""

from __future__ import annotations

from typing import TYPE_CHECKING

from wsim.plan.asked.nodes import nodes
from wsim.plan.schema.formula import Always, Eventually, Not, Predicate

if TYPE_CHECKING:
    from collections.abc import Sequence, Set

    from wsim.plan.schema import Objective
    from wsim.plan.schema.nodes import Node

MOST = 0.9  # share of a run that is all of it
BLOWS = frozenset(
    ("hit", "strike", "collide", "crash", "smash", "ram", "bump", "slam", "kick", "slap", "whack", "thump")
)
_BLOWS = "collides_with touches reaches pushes topples stops_before bounces_to climbs_to rests_on"
_FALLS = """collides_with rests_on falls_freely drops topples submerged sinks floats flies bounces_to counts
contained_in stays_inside tilts tilts_to stays_on"""
_TURNS = "spin_between own_spin_between turned_between rolls"
_OVER = "topples not_upright drops tilt_between tilts tilts_to"
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
    ("topple knock tip overturn collapse tumble upset keel", _OVER),
    ("stop halt brake settle park", _STOPS),
)
# What shows that something does not happen, beside a denial of what would show that it does.
_STAYS = """stays_on stays_inside stays_within contained_in rests_on lies_on supported_by weighs_on settles upright
gone_between turned_between tilt_between conserves counts floats level_in"""
_STILL = f"{_STAYS} spin_between own_spin_between speed_between rolls_without_slip"
_KEEPS = "stays_inside contained_in stays_on stays_within conserves counts level_in fills gone_between"
_APART = "never_touches stops_before touches_only stays_within flies falls_freely gone_between"
_NOT_SHOWN = (
    (" ".join(sorted(BLOWS)) + " touch meet reach scrape graze", _APART),
    ("fall drop topple knock tip overturn collapse tumble land capsize", _STAYS),
    ("leave escape exit spill overflow empty drain splash leak drip gush", _KEEPS),
    ("move slide shift slip budge drift go turn spin rotate swing roll skid swivel pivot", _STILL),
    ("bounce rebound", "rests_on stays_on lies_on settles dies_down"),
    ("float", "sinks submerged rests_on lies_on"),
    ("sink", "floats level_in supported_by rests_on stays_on"),
    ("tilt", "tilt_between upright turned_between"),
    (
        "stop halt brake settle park rest",
        "moves slides swings speed_between crosses spin_between rolls gone_between reaches climbs_to",
    ),
)
NOT_SHOWN_BY = {base: frozenset(names.split()) for verbs, names in _NOT_SHOWN for base in verbs.split()}
# What a thing does itself, whatever it does it on or into.
_ITSELF = """float sink swing bounce rebound slide roll fall drop land plunge plummet plop topple tumble stop settle"""
BY_ITSELF = frozenset(_ITSELF.split())
SHOWN_BY = {base: frozenset(names.split()) for verbs, names in _SHOW for base in verbs.split()}


_WOULD_SHOW = frozenset(
    ["moves", "crosses", "gone_between", "touches", "reaches", "collides_with", "drops", "stays_inside", "contained_in"]
)


def shows(objective: Objective, names: Set[str]) -> bool:
    """Whether an objective asks for one of some kinds or predicates; a denied one has `not_` before its name.

    Of alternatives each must: the others need not come true.
    """
    return objective.kind in names or (objective.formula is not None and _asserts(objective.formula, names, False))


def _asserts(node: Node, names: Set[str], denied: bool) -> bool:
    op = str(getattr(node, "op", ""))
    if isinstance(node, Predicate):
        return (f"not_{op}" if denied else op) in names
    parts = [_asserts(part, names, denied ^ (op == "not")) for part in node.parts()]
    return all(parts) if op == ("and" if denied else "or") else any(parts)


def is_blow_shown(base: str, objectives: Sequence[Objective]) -> bool:
    """Whether a blow is asked for by some objectives: as such, or by what it does to another thing than the first."""
    if base not in BLOWS or not objectives:
        return True
    several = len({each.object for each in objectives}) > 1
    return several or any(shows(each, SHOWN_BY[base]) for each in objectives)


def for_a_while(objective: Objective, duration: float) -> bool:
    """Whether what it asks is so at some moment, or in a part of a run alone: not all the way.

    Args:
        objective: Of a plan.
        duration: Of the run [s].
    """
    top = objective.formula
    if isinstance(top, Eventually):
        return isinstance(top.of, Not)
    return isinstance(top, Always) and top.window is not None and (top.window[1] or duration) < MOST * duration


def is_idle(objective: Objective) -> bool:
    """Whether what it asks is a range that holds of what stands still, too: turned by -1000 to 1000 degrees."""
    found = [node for node, _ in nodes(objective) if isinstance(node, Predicate)]
    if len(found) != 1:
        return False
    low, high = getattr(found[0], "low", None), getattr(found[0], "high", None)
    return low is not None and high is not None and low <= 0.0 <= high


def denies(objective: Objective) -> bool:
    """Whether all that it asks is that something is not so."""
    if objective.formula is None:
        return objective.kind == "never_touches"
    found = [str(getattr(node, "op", "")) == "never_touches" or denied for node, denied in nodes(objective)
             if isinstance(node, Predicate)]  # fmt: skip
    return bool(found) and all(found)


def shows_not(objective: Objective, base: str) -> bool:
    """Whether an objective asks that something does not happen; of verbs of which nothing is known any may."""
    if base not in SHOWN_BY and base not in NOT_SHOWN_BY:
        return True
    denials = {f"not_{name}" for name in SHOWN_BY.get(base, frozenset()) | _WOULD_SHOW}
    return shows(objective, denials | NOT_SHOWN_BY.get(base, frozenset()))
