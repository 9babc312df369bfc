"""Predicates about what a body touches, what carries it and what it hits."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from wsim.geometry.kinds import ROUND
from wsim.geometry.rotations import level
from wsim.judge.evidence.contact import distance
from wsim.judge.evidence.faces import normal_under
from wsim.judge.evidence.motion import FLOAT32
from wsim.judge.evidence.recorded import MissingError
from wsim.judge.language.blows import blows
from wsim.judge.language.contacts import NEAR, about, against, moving_size, normals, swept_gap, touch_limit, touch_reach
from wsim.judge.language.measure import Measure, measures, mends
from wsim.judge.language.measures_carried import borne
from wsim.judge.repair.lasting import settled
from wsim.judge.repair.matter import friction, slides_off
from wsim.judge.repair.passing import missed
from wsim.judge.verdict import Finding, RepairTarget
from wsim.plan.schema.formula_contact import (
    CollidesWith,
    NeverTouches,
    Pushes,
    RollsWithoutSlip,
    Settles,
    StopsBefore,
    SupportedBy,
    Touches,
    TouchesOnly,
)

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsim.judge.evidence.evidence import Evidence
    from wsim.judge.language.signals import Signals

    Floats = NDArray[np.float64]

STILL, QUIET = 0.05, 0.02  # of sqrt(g L): what rests bobs by 5 % of L, what has settled by 2 %, as in the checks
CHANGE = 0.05  # of the speed of approach, that a collision changes at least
SURE = 0.5  # of what a restitution may be off: a blow that is less sure shows none where another is


@measures(Touches)
def _touches(asked: Touches, signals: Signals) -> list[Measure]:
    return [_touching(asked.object, asked.ref, asked.within, signals)]


def _touching(one: str, other: str, within: float | None, signals: Signals) -> Measure:
    limit, source = touch_limit(signals, one, other)
    if within is not None:
        limit, source = np.full(1, within), "the objective's"
    return _near(one, other, limit, source, signals)


def _near(one: str, other: str, limit: Floats, source: str, signals: Signals) -> Measure:
    value = about(swept_gap(signals, one, other))
    scale = np.maximum(limit, FLOAT32 * moving_size(signals, one, other))
    return Measure(f"gap to {signals.prim(other)}", signals.prim(one), value, limit, "m", scale, source)


@measures(NeverTouches)
def _never_touches(asked: NeverTouches, signals: Signals) -> list[Measure]:
    value = swept_gap(signals, asked.object, asked.ref)
    size = moving_size(signals, asked.object, asked.ref)
    source = "the objective's clearance" if asked.clearance else "the surfaces"
    return [
        Measure(
            f"gap to {signals.prim(asked.ref)}", signals.prim(asked.object), value,
            max(asked.clearance, FLOAT32 * size),  # what presses has no gap
            "m", asked.clearance or size, source, at_most=False,
        )
    ]  # fmt: skip


@measures(TouchesOnly)
def _touches_only(asked: TouchesOnly, signals: Signals) -> list[Measure]:
    """The force by which each other thing presses on it, as a mean since the frame before; it is to be none."""
    prim, weight = signals.prim(asked.object), signals.weight(asked.object)
    others = signals.pressing(asked.object, asked.objects)
    return [
        Measure(f"force by which {other} presses on it", prim, force, 0.0, "N", weight, "it touches nothing else",
                expected=0.0)
        for other, force in (others or {"anything else": np.zeros((1, len(signals.time)))}).items()
    ]  # fmt: skip


@measures(SupportedBy)
def _supported_by(asked: SupportedBy, signals: Signals) -> list[Measure]:
    touching = _near(asked.object, asked.ref, *touch_reach(signals, asked.object, asked.ref), signals)
    weight = sum(signals.weight(each) for each in sorted(signals.together(asked.object)))
    value = borne(signals, asked.object, asked.ref)
    source = f"{asked.share:g} of its weight"
    limit = asked.share * weight
    carried = Measure("force of contacts upwards", touching.prim, value, limit, "N", weight, source, at_most=False)
    return [touching, carried]


@measures(Settles)
def _settles(asked: Settles, signals: Signals) -> list[Measure]:
    size, twist = signals.solid(asked.object).smallest, signals.qd(asked.object)
    value = np.linalg.norm(twist[..., :3], axis=-1) + np.linalg.norm(twist[..., 3:], axis=-1) * size / 2
    limit = asked.speed or QUIET * signals.speed_scale(size)
    source = "the objective's" if asked.speed else f"{QUIET:g} sqrt(g L), L = {size:.3g} m"
    what, prim = "speed of its fastest point", signals.prim(asked.object)
    return [Measure(what, prim, value, limit, "m/s", limit, source, expected=0.0)]


@measures(StopsBefore)
def _stops_before(asked: StopsBefore, signals: Signals) -> list[Measure]:
    prim, gaps = signals.prim(asked.object), swept_gap(signals, asked.object, asked.ref)
    size = moving_size(signals, asked.object, asked.ref)
    # Before a frame they have not touched: what touches in the interval after it does so later.
    so_far = np.minimum.accumulate(np.concatenate([gaps[:, :1], gaps[:, :-1]], axis=1), axis=1)
    what = f"least gap to {signals.prim(asked.ref)} so far"
    source = f"{NEAR:g} L: what is nearer touches"
    found = [Measure(what, prim, so_far, NEAR * size, "m", size, source, at_most=False)]
    if asked.within is not None:
        what, source = f"gap to {signals.prim(asked.ref)}", "the objective's"
        found.append(Measure(what, prim, gaps, asked.within, "m", asked.within, source))
    return [*found, *_settles(Settles(object=asked.object), signals)]


@measures(RollsWithoutSlip)
def _rolls(asked: RollsWithoutSlip, signals: Signals) -> list[Measure]:
    prim, body = signals.prim(asked.object), signals.body(asked.object)
    round_ = [s for s in body.shapes if s.collides and s.kind in ROUND]
    if not round_:
        raise MissingError("it is not round: only a sphere, a cylinder or a capsule rolls")
    radius = max(shape.size[0] for shape in round_)
    normal = _normal(signals, asked.object, asked.on)
    twist = signals.qd(asked.object)
    under = signals.velocity(asked.on) if asked.on else 0.0
    v, w = twist[..., :3] - under, twist[..., 3:]
    slip = v + np.cross(w, -radius * normal)
    slip = slip - (slip @ normal)[..., None] * normal
    value = np.linalg.norm(slip, axis=-1)
    speed = np.maximum(np.linalg.norm(v, axis=-1), np.linalg.norm(w, axis=-1) * radius)
    rest = QUIET * signals.speed_scale(radius)
    source = f"{asked.share:g} of its speed, and {rest:.3g} m/s = {QUIET:g} sqrt(g r), at which it counts as at rest"
    limit = asked.share * speed + rest
    what = "speed of the point where it touches"
    return [Measure(what, prim, value, limit, "m/s", limit, source, expected=0.0)]


def _normal(signals: Signals, name: str, on: str | None) -> Floats:
    """What a body rolls on faces (3,): up, or as the face of a fixed object that it is over."""
    if on is None or signals.moves(on):
        return signals.up
    prim = signals.prim(on)
    shapes = next(static.shapes for static in signals.world.statics if static.prim == prim)
    return normal_under(shapes, signals.centre(name).reshape(-1, 3), signals.up)


@measures(CollidesWith)
def _collides_with(asked: CollidesWith, signals: Signals) -> list[Measure]:
    """At each frame the collision that is between the frame before and the one after it.

    They come at each other along the impulse, and it ends that at once. What is pushed for long and then parts from
    what pushed it came at nothing.
    """
    touching = _touching(asked.object, asked.ref, None, signals)
    u = signals.velocity(asked.object) - signals.velocity(asked.ref)
    before, after = np.concatenate([u[:, :1], u[:, :-1]], axis=1), np.concatenate([u[:, 1:], u[:, -1:]], axis=1)
    span = 2 * signals.step
    free = signals.moves(asked.object) and signals.moves(asked.ref)
    pull = np.zeros(3) if free else np.array(signals.world.gravity)
    jolt = after - before - pull * span * (1.0 if signals.moves(asked.object) else -1.0)
    jump = np.linalg.norm(jolt, axis=-1)
    speed = np.linalg.norm(before, axis=-1)
    # What carries a body changes its speed against gravity's, and what rubs on it besides: neither is a collision.
    carried = np.hypot(1.0, signals.friction) * signals.gravity * span
    floor = CHANGE * signals.speed_scale(moving_size(signals, asked.object, asked.ref))
    scale = np.maximum(speed, floor)
    limit = CHANGE * scale + carried
    change = Measure(
        f"change of its speed to {signals.prim(asked.ref)}", touching.prim, jump, limit, "m/s", scale,
        f"{CHANGE:g} of the speed of approach, and what weight and friction can do in two frames", at_most=False,
    )  # fmt: skip
    # They come at each other along the contact's normal: what is struck by a third thing meanwhile, or goes on over
    # what it touches, does not.
    w, t = np.nonzero((touching.margin >= 0.0) & (change.margin >= 0.0))
    normal = jolt / np.where(jump > 0.0, jump, 1.0)[..., None]
    normal[w, t] = normals(signals, asked.object, asked.ref, w, t)
    approach = -np.sum(before * normal, axis=-1)
    coming = Measure(
        f"speed at which it comes at {signals.prim(asked.ref)}", touching.prim, approach, floor, "m/s", scale,
        f"{CHANGE:g} sqrt(g L), along the contact's normal: what does not come at the other parts from it",
        at_most=False,
    )  # fmt: skip
    found = [touching, change, coming]
    if asked.restitution is not None:
        found.append(_restitution(asked, signals, floor))
    return found


def _restitution(asked: CollidesWith, signals: Signals, least: float) -> Measure:
    """At the frames of each blow that can be told apart what the first of them shows; it is the surfaces' own.

    Where none is told as well as is asked, the surest shows it, to as much more as it may be off: twice that at most.
    """
    found = blows(signals, asked.object, asked.ref)
    came = np.maximum(found.approach, 1e-30)
    ratio = found.parting / came
    off = (1.0 + np.abs(ratio)) * found.unsure / came
    fast = (found.approach > least) & np.isfinite(off)
    shown = fast & (off <= SURE * asked.within)
    # What has no blow has no restitution: as far from the one asked as one can be.
    value = np.full((signals.count, len(signals.time)), -1.0)
    within = np.full((signals.count, 1), asked.within)
    for w in np.setdiff1d(found.world[fast], found.world[shown]):
        unclear = np.flatnonzero(fast & (found.world == w))
        n = unclear[np.argmin(off[unclear])]
        shown[n], within[w] = True, asked.within + min(off[n], asked.within)
    for n in np.flatnonzero(shown)[::-1]:
        w = found.world[n]
        value[w, value[w] > -1.0] = np.clip(ratio[n], -1.0, 2.0)
        value[w, found.first[n] : found.last[n] + 1] = np.clip(ratio[n], -1.0, 2.0)
    finite = np.isfinite(signals.velocity(asked.object) - signals.velocity(asked.ref)).all(axis=-1)
    source = f"{asked.within:g} about the objective's; of the first blow that frames tell to {SURE:g} of that; if none"
    source += " is, of the surest, and what a step may change of it"
    return Measure.about(
        np.where(finite, value, np.nan), asked.restitution or 0.0, within, what="restitution",
        prim=signals.prim(asked.object), unit="1", limit_from=source,
    )  # fmt: skip


@measures(Pushes)
def _pushes(asked: Pushes, signals: Signals) -> list[Measure]:
    """For how long, without a break, the one has been behind the other, touching it, and going on with it (W, T)."""
    gaps = about(swept_gap(signals, asked.object, asked.ref))
    near = gaps <= touch_reach(signals, asked.object, asked.ref)[0]
    v, u = signals.velocity(asked.object), signals.velocity(asked.ref)
    speed = np.linalg.norm(u, axis=-1)
    ahead = u / np.where(speed > 0.0, speed, 1.0)[..., None]
    still = QUIET * signals.speed_scale(moving_size(signals, asked.object, asked.ref))
    # It drives the other on: from behind, and by its own motion, at a speed that is the other's along its way.
    behind = np.sum((signals.centre(asked.ref) - signals.centre(asked.object)) * ahead, axis=-1) > 0.0
    together = np.abs(np.sum((v - u) * ahead, axis=-1)) <= np.maximum(STILL * speed, still)
    on = near & (speed > still) & behind & together
    # It begins and ends between frames, where the ways before and after a blow meet.
    course = against(signals, asked.object, asked.ref)
    late, early = np.zeros((2, *on.shape))
    w, t = np.nonzero(course.struck)
    when = course.meet(t, t + 1, w)[0]
    late[w, t], early[w, t + 1] = when, course.h[t] - when
    held = np.where(on, early, 0.0)
    for k in range(1, on.shape[1]):
        goes_on = held[:, k - 1] + signals.time[k] - signals.time[k - 1]
        held[:, k] = np.where(on[:, k] & on[:, k - 1], goes_on, held[:, k])
    ends = on & ~np.concatenate([on[:, 1:], np.ones_like(on[:, :1])], axis=1)
    value = np.where(np.isfinite(gaps), held + np.where(ends, late, 0.0), np.nan)
    return [
        Measure(
            f"time for which it has pushed {signals.prim(asked.ref)}", signals.prim(asked.object), value,
            asked.least, "s", asked.least, "the objective's: a blow is over sooner", at_most=False,
        )
    ]  # fmt: skip


# ---- what to change
@mends(Touches)
def _aim(asked: Touches, finding: Finding, evidence: Evidence) -> RepairTarget:
    """They miss each other."""
    return missed(evidence, finding.prim or "", evidence.prim(asked.ref), finding.value or 0.0)


@mends(NeverTouches, TouchesOnly)
def _part(asked: NeverTouches | TouchesOnly, finding: Finding, evidence: Evidence) -> RepairTarget:
    """Two that must not touch."""
    why = "it comes too near: start it farther off, or send it another way"
    return RepairTarget(
        kind="settlement", prim=finding.prim, parameter="position", direction="change", unit="m", why=why
    )


@mends(Settles)
def _still(asked: Settles, finding: Finding, evidence: Evidence) -> RepairTarget:
    """What has slid down what it started on came to rest elsewhere, if at all: time does not help; else it may."""
    return slides_off(evidence, finding.prim or "") or settled(finding, evidence)


@mends(StopsBefore)
def _stop(asked: StopsBefore, finding: Finding, evidence: Evidence) -> RepairTarget:
    """Under friction it goes v^2 / (2 mu g): as much friction as lets it stop in the gap that it starts with."""
    if finding.unit == "m/s":
        return settled(finding, evidence)
    prim, ref = finding.prim or "", evidence.prim(asked.ref)
    speed = float(np.linalg.norm(level(np.array(evidence.body(prim).velocity), evidence.up)))
    gap = float(distance(evidence, prim, ref)[0])
    to = speed**2 / (2.0 * evidence.gravity * gap) if gap > 0.0 and evidence.gravity > 0.0 else None
    why = f"to stop within {gap:.3g} m it needs a friction of v^2 / (2 g s)"
    return friction(evidence, prim, "raise", to, why, ref)


@mends(RollsWithoutSlip)
def _grip(asked: RollsWithoutSlip, finding: Finding, evidence: Evidence) -> RepairTarget:
    """What slips has too little friction."""
    under, why = evidence.prim(asked.on) if asked.on else "", "it slips where it should roll: more friction turns it"
    return friction(evidence, finding.prim or "", "raise", None, why, under)


@mends(CollidesWith)
def _collide(asked: CollidesWith, finding: Finding, evidence: Evidence) -> RepairTarget:
    """They miss, pass through each other, or bounce otherwise than asked."""
    body, ref = evidence.body(finding.prim or ""), evidence.prim(asked.ref)
    if finding.unit != "1":
        return missed(evidence, body.prim, ref, None if finding.unit == "m/s" else finding.value or 0.0)
    now, expected = body.shapes[0].restitution if body.shapes else None, finding.expected or 0.0
    return RepairTarget(
        kind="physical parameter", prim=body.prim, parameter="restitution",
        direction="raise" if (finding.value or 0.0) < expected else "lower", current=now, suggested=expected,
        why="the share of the speed of approach with which it parts",
    )  # fmt: skip


@mends(Pushes)
def _push(asked: Pushes, finding: Finding, evidence: Evidence) -> RepairTarget:
    """What pushes goes on at the other, in its way and fast enough."""
    why = "it does not drive the other on for that long: aim it there, and keep it moving"
    return RepairTarget(
        kind="physical parameter", prim=finding.prim, parameter="velocity", direction="change", unit="m/s", why=why
    )
