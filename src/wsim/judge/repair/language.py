"""Repair targets of objectives that are formulas: those of the predicate that decides."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from wsim.geometry.rotations import level
from wsim.judge.evidence.contact import distance
from wsim.judge.evidence.support import support_of
from wsim.judge.repair.asked import decider, objective_of, ref_of
from wsim.judge.repair.drive import by_drive, drive_of, to_point
from wsim.judge.repair.objectives import (
    beside,
    collides_with,
    fallen_through,
    floats,
    friction,
    settles,
    slides_off,
    stays_inside,
    submerged,
    swings,
)
from wsim.judge.repair.rule import (
    Rule,
    longer_run,
    shorter_step,
)
from wsim.judge.repair.run import damped, leak, settled
from wsim.judge.verdict import Finding, RepairTarget
from wsim.plan.schema.formula import Eventually, Formula, Predicate

if TYPE_CHECKING:
    from wsim.judge.evidence.evidence import Evidence
    from wsim.judge.language.measure import Measure


def formula(finding: Finding, evidence: Evidence) -> RepairTarget:
    """The rule of the predicate that decides; an event that comes about after its window is late."""
    found = decider(finding, evidence)
    covered = _uncovered(finding, evidence)
    if covered is not None:
        return covered
    if found is None:
        why = "an event is missing, or comes in another order: compare the times in the message"
        return RepairTarget(kind="program", prim=finding.prim, parameter="order", direction="change", why=why)
    predicate, measure = found
    late = _late(predicate, measure, finding, evidence)
    return late or RULES[predicate.op](finding.model_copy(update={"span": None}), evidence)


def _uncovered(finding: Finding, evidence: Evidence) -> RepairTarget | None:
    """The target where a window ends after the recording."""
    item = objective_of(finding, evidence)
    needed = _looks_ahead(item.formula) if item is not None and item.formula is not None else 0.0
    if finding.value is not None or needed <= evidence.world.duration:
        return None
    return longer_run(evidence, needed, "a window of the objective ends later than the run")


def _looks_ahead(formula: Formula) -> float:
    """How far into a recording a formula looks [s]."""
    windows = getattr(formula, "windows", None) or (getattr(formula, "window", None),)
    own = sum(window[1] or window[0] for window in windows if window is not None)
    own = max(own, getattr(formula, "seconds", None) or 0.0)
    return own + max((_looks_ahead(part) for part in formula.parts()), default=0.0)


def _late(predicate: Predicate, measure: Measure, finding: Finding, evidence: Evidence) -> RepairTarget | None:
    """The target of an event that happens, but after the moment that decides."""
    margin = np.broadcast_to(measure.margin, (1, len(evidence.time)))[0]
    after = evidence.time[(margin >= 0.0) & (evidence.time > (finding.time or 0.0))]
    if predicate.alone != "eventually" or not len(after):
        return None
    driven = _driven_there(finding, evidence)
    if driven is not None:
        return driven
    late = float(after[0]) - (finding.time or 0.0)
    why = f"it comes about at {after[0]:.3g} s, {late:.3g} s after the moment that decides: a nearer or a faster start"
    return RepairTarget(
        kind="settlement", prim=finding.prim, parameter="position", direction="change", unit="m", why=why
    )


# ---- rules that only predicates have
def rests(finding: Finding, evidence: Evidence) -> RepairTarget:
    """Not still; below what should carry it; or above it."""
    if finding.unit != "m":
        return settled(finding, evidence)
    predicate = decider(finding, evidence)
    ref = evidence.prim(getattr(predicate[0], "ref", "")) if predicate is not None else ""
    i = evidence.index(finding.prim or "")
    if ref and not support_of(evidence, i, ref).over[evidence.window].any():
        return beside(evidence, finding.prim or "", ref)
    fall = -float((evidence.body_qd[evidence.window, i, :3] @ evidence.up).mean())
    if fall > 0.0 and evidence.static(ref) is not None:
        return fallen_through(finding, evidence, finding.prim or "", ref)
    return longer_run(evidence, None, "it is not there yet, or stands on something else")


def reaches(finding: Finding, evidence: Evidence) -> RepairTarget:
    """It stops short, or goes another way."""
    short = abs((finding.value or 0.0) - (finding.limit or 0.0))
    driven = by_drive(evidence, finding.prim or "", None, f"its drive is set to {short:.3g} m beside that")
    if driven is not None:
        return driven if driven.suggested is not None else _driven_there(finding, evidence) or driven
    start = evidence.body(finding.prim or "").velocity
    why = f"it stays {short:.3g} m short of where it must get: faster, or aimed better"
    return RepairTarget(
        kind="physical parameter", prim=finding.prim, parameter="velocity",
        direction="change", current=float(np.linalg.norm(start)), unit="m/s", why=why,
    )  # fmt: skip


def _driven_there(finding: Finding, evidence: Evidence) -> RepairTarget | None:
    """What a drive is to be set to, so that its body comes to the point in the middle of the time for it."""
    found, item = decider(finding, evidence), objective_of(finding, evidence)
    point = getattr(found[0], "target", None) if found is not None else None
    if not isinstance(point, tuple) or item is None:
        return None
    windows = [node.window for node in item.formula.walk() if isinstance(node, Eventually)] if item.formula else []
    closed = [(window[0], window[1]) for window in windows if window is not None and window[1] is not None]
    return to_point(evidence, finding.prim or "", np.array(point), closed[0] if closed else None)


def apart(finding: Finding, evidence: Evidence) -> RepairTarget:
    """Two that must not touch."""
    why = "it comes too near: start it farther off, or send it another way"
    return RepairTarget(
        kind="settlement", prim=finding.prim, parameter="position", direction="change", unit="m", why=why
    )


def stays_within(finding: Finding, evidence: Evidence) -> RepairTarget:
    """It slides away, or goes too far."""
    why = "it gets too far: hold it, or start it slower or nearer"
    return slides_off(finding, evidence) or RepairTarget(
        kind="settlement", prim=finding.prim, parameter="position", direction="change", unit="m", why=why
    )


def upright(finding: Finding, evidence: Evidence) -> RepairTarget:
    """A wider foot tips later: the angle at which it does is that of its middle over its edge."""
    why = "it tips where its middle is over its edge: a wider or a lower body, or a weaker push"
    return RepairTarget(kind="geometry", prim=finding.prim, parameter="size", direction="change", unit="m", why=why)


def speed(finding: Finding, evidence: Evidence) -> RepairTarget:
    """The start decides how fast it is, by as much as is missing."""
    value, limit = finding.value or 0.0, finding.limit or 0.0
    now = float(np.linalg.norm(evidence.body(finding.prim or "").velocity))
    way = "raise" if value < limit else "lower"
    return RepairTarget(
        kind="physical parameter", prim=finding.prim, parameter="velocity", direction=way,
        current=now, suggested=max(0.0, now + limit - value), unit="m/s", why="it starts with that much less or more",
    )  # fmt: skip


def path(finding: Finding, evidence: Evidence) -> RepairTarget:
    """What follows a path is steered."""
    why = "it leaves its path: what steers it must turn sooner or go slower"
    return RepairTarget(kind="controller", prim=finding.prim, parameter="path", direction="change", why=why)


def grips(finding: Finding, evidence: Evidence) -> RepairTarget:
    """What slips has too little friction."""
    return friction(finding, evidence, "raise", None, "it slips where it should roll: more friction turns it")


def conserves(finding: Finding, evidence: Evidence) -> RepairTarget:
    """A fluid's mass leaks; energy and momentum go with the step's error."""
    if finding.unit == "kg":
        return leak(finding, evidence)
    return shorter_step(
        evidence, 0.5, "what is conserved drifts with the step's error; half the step is the first to try"
    )


def collides(finding: Finding, evidence: Evidence) -> RepairTarget:
    """They miss, pass through each other, or bounce otherwise than asked."""
    if finding.unit != "1" or finding.expected is None:
        return collides_with(finding, evidence)
    body = evidence.body(finding.prim or "")
    now = body.shapes[0].restitution if body.shapes else None
    return RepairTarget(
        kind="physical parameter", prim=body.prim, parameter="restitution",
        direction="raise" if (finding.value or 0.0) < finding.expected else "lower", current=now,
        suggested=finding.expected, why="the share of the speed of approach with which it parts",
    )  # fmt: skip


def pushes(finding: Finding, evidence: Evidence) -> RepairTarget:
    """What pushes goes on at the other, in its way and fast enough."""
    why = "it does not drive the other on for that long: aim it there, and keep it moving"
    return RepairTarget(
        kind="physical parameter", prim=finding.prim, parameter="velocity", direction="change", unit="m/s", why=why
    )


def ranged(finding: Finding, evidence: Evidence) -> RepairTarget:
    """What a joint moves, its drive does; what is free, its start."""
    prim, value, limit = finding.prim or "", finding.value or 0.0, finding.limit or 0.0
    way, short = ("raise" if value < limit else "lower"), f"{abs(limit - value):.3g} {finding.unit}"
    share = limit / value if value * limit > 0.0 else None
    driven = by_drive(evidence, prim, share, f"its drive brings it {short} off")
    if driven is not None:
        return driven
    why = f"it is {short} off: it starts otherwise, or something stops it"
    return RepairTarget(kind="physical parameter", prim=prim, parameter="velocity", direction=way, unit="m/s", why=why)


def bounces(finding: Finding, evidence: Evidence) -> RepairTarget:
    """From a height h a restitution e brings it up to e^2 h: as its square root, so is the restitution off."""
    body, value, expected = evidence.body(finding.prim or ""), finding.value or 0.0, finding.expected or 0.0
    now = body.shapes[0].restitution if body.shapes else None
    to = now * (expected / value) ** 0.5 if now and value > 0.0 else None
    return RepairTarget(
        kind="physical parameter", prim=body.prim, parameter="restitution",
        direction="raise" if value < expected else "lower", current=now, suggested=to,
        why="what bounces comes up to the square of its restitution of where it fell from",
    )  # fmt: skip


def counts(finding: Finding, evidence: Evidence) -> RepairTarget:
    """Some are beside it, or on their way."""
    why = "too few get into it: start them over it, or give it more room or time"
    return RepairTarget(kind="settlement", prim=finding.prim, parameter="position", direction="change", why=why)


def dies_down(finding: Finding, evidence: Evidence) -> RepairTarget:
    """What goes on as far is taken energy from: by its joint's drive, or where it touches."""
    prim = finding.prim or ""
    joint = drive_of(evidence, prim)
    if joint is None or joint.drive is None:
        return damped(evidence, evidence.index(prim), "nothing takes its energy: it goes as far each time")
    why = "nothing damps it: it goes as far each time"
    return RepairTarget(
        kind="drive", prim=joint.prim, parameter="drive.damping", direction="raise", current=joint.drive.damping,
        why=why,
    )  # fmt: skip


def climbs(finding: Finding, evidence: Evidence) -> RepairTarget:
    """What comes up too little has lost too much on its way."""
    return friction(finding, evidence, "lower", None, "it loses too much on its way up")


def stops(finding: Finding, evidence: Evidence) -> RepairTarget:
    """Under friction it goes v^2 / (2 mu g): as much friction as lets it stop in the gap that it starts with."""
    if finding.unit == "m/s":
        return settled(finding, evidence)
    prim, ref = finding.prim or "", ref_of(finding, evidence)
    body = evidence.body(prim)
    speed = float(np.linalg.norm(level(np.array(body.velocity), evidence.up)))
    gap = float(distance(evidence, prim, ref)[0])
    to = speed**2 / (2.0 * evidence.gravity * gap) if gap > 0.0 and evidence.gravity > 0.0 else None
    return friction(finding, evidence, "raise", to, f"to stop within {gap:.3g} m it needs a friction of v^2 / (2 g s)")


def swirls(finding: Finding, evidence: Evidence) -> RepairTarget:
    """What turns a fluid is a body, a wall or a jet that goes round."""
    why = "something must drive it round: a paddle, a wall that turns, an inlet along the wall"
    return RepairTarget(kind="fluid", prim=finding.prim, parameter="motion", direction="change", why=why)


def level_in(finding: Finding, evidence: Evidence) -> RepairTarget:
    """More or less of the fluid must come into the vessel."""
    way = "raise" if (finding.value or 0.0) < (finding.expected or 0.0) else "lower"
    why = "what comes into the vessel stands as high as its volume over the vessel's floor"
    return RepairTarget(kind="fluid", prim=finding.prim, parameter="size", direction=way, unit="m", why=why)


def fills_to(finding: Finding, evidence: Evidence) -> RepairTarget:
    """As much fluid as the level needs: the level is as high as the volume."""
    value, expected = finding.value or 0.0, finding.expected
    fluid = evidence.fluid(finding.prim or "")
    now = fluid.size[2]
    return RepairTarget(
        kind="fluid", prim=fluid.prim, parameter="level", direction="raise" if value < (expected or 0.0) else "lower",
        current=now, suggested=now * expected / value if expected and value > 0.0 else None, unit="m",
        why="in the same container the level is as high as the volume",
    )  # fmt: skip


RULES: dict[str, Rule] = {
    "reaches": reaches,
    "stays_within": stays_within,
    "rests_on": rests,
    "supported_by": rests,
    "contained_in": stays_inside,
    "stays_inside": stays_inside,
    "floats": floats,
    "sinks": submerged,
    "submerged": submerged,
    "touches": collides_with,
    "never_touches": apart,
    "upright": upright,
    "speed_between": speed,
    "follows_path": path,
    "crosses": reaches,
    "swings": swings,
    "rolls_without_slip": grips,
    "settles": settles,
    "conserves": conserves,
    "collides_with": collides,
    "pushes": pushes,
    "turned_between": ranged,
    "spin_between": ranged,
    "gone_between": ranged,
    "bounces_to": bounces,
    "counts": counts,
    "fills_to": fills_to,
    "own_spin_between": ranged,
    "tilt_between": ranged,
    "dies_down": dies_down,
    "climbs_to": climbs,
    "stops_before": stops,
    "swirls_between": swirls,
    "level_in": level_in,
}
