"""Predicates about how far and how fast a body has turned or gone along an axis, by itself or against another."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from wsim.geometry.rotations import conjugate, multiply, rotate
from wsim.judge.language.contacts import about, gap, swept_gap, touch_reach
from wsim.judge.language.hollows import hollow_of
from wsim.judge.language.measure import Measure, measures, mends
from wsim.judge.repair.drive import by_drive
from wsim.judge.verdict import Finding, RepairTarget
from wsim.plan.schema.formula_contact import BouncesTo
from wsim.plan.schema.formula_place import Counts, GoneBetween, OwnSpinBetween, SpinBetween, TiltBetween, TurnedBetween

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsim.judge.evidence.evidence import Evidence
    from wsim.judge.language.signals import Signals
    from wsim.plan.schema.predicate import Predicate

    Floats = NDArray[np.float64]


def _range(what: str, prim: str, value: Floats, low: float, high: float, unit: str) -> list[Measure]:
    """A number between two limits."""
    scale = max(abs(low), abs(high), 1e-9)
    return [
        Measure(what, prim, value, limit, unit, scale, "the objective's range", at_most=at_most)
        for limit, at_most in ((low, False), (high, True))
    ]


def _turn(signals: Signals, name: str) -> Floats:
    """Rotation since the start, in the world's axes (W, T, 4)."""
    q = signals.q(name)[..., 3:]
    return multiply(q, np.broadcast_to(conjugate(q[:, :1]), q.shape))


@measures(TurnedBetween)
def _turned(asked: TurnedBetween, signals: Signals) -> list[Measure]:
    turn = _turn(signals, asked.object)
    if asked.of is not None and signals.moves(asked.of):
        turn = multiply(conjugate(_turn(signals, asked.of)), turn)
    # The twist about the axis, of a rotation's split in a swing and a twist; counted on beyond half a turn.
    k = "xyz".index(asked.axis)
    value = np.degrees(np.unwrap(2.0 * np.arctan2(turn[..., k], turn[..., 3]), axis=1))
    what = f"angle turned about {asked.axis}" + (f" against {signals.prim(asked.of)}" if asked.of else "")
    return _range(what, signals.prim(asked.object), value, asked.low, asked.high, "deg")


@measures(SpinBetween)
def _spin(asked: SpinBetween, signals: Signals) -> list[Measure]:
    w = signals.qd(asked.object)[..., 3:]
    if asked.of is not None and signals.moves(asked.of):
        w = w - signals.qd(asked.of)[..., 3:]
    value = np.degrees(w[..., "xyz".index(asked.axis)])
    what = f"rate of turning about {asked.axis}" + (f" against {signals.prim(asked.of)}" if asked.of else "")
    return _range(what, signals.prim(asked.object), value, asked.low, asked.high, "deg/s")


@measures(OwnSpinBetween)
def _own_spin(asked: OwnSpinBetween, signals: Signals) -> list[Measure]:
    w = rotate(conjugate(_turn(signals, asked.object)), signals.qd(asked.object)[..., 3:])
    value = np.degrees(w[..., "xyz".index(asked.axis)])
    what = f"rate of turning about its own {asked.axis}"
    return _range(what, signals.prim(asked.object), value, asked.low, asked.high, "deg/s")


@measures(TiltBetween)
def _tilt(asked: TiltBetween, signals: Signals) -> list[Measure]:
    up = rotate(_turn(signals, asked.object), signals.up)
    value = np.degrees(np.arctan2(up[..., "xy".index(asked.axis)], up @ signals.up))
    what = f"tilt towards {asked.axis}"
    return _range(what, signals.prim(asked.object), value, asked.low, asked.high, "deg")


@measures(GoneBetween)
def _gone(asked: GoneBetween, signals: Signals) -> list[Measure]:
    place = signals.centre(asked.object)
    if asked.of is not None and signals.moves(asked.of):
        # As seen from the other, in the axes that it started with.
        back = conjugate(_turn(signals, asked.of))
        place = rotate(back, place - signals.centre(asked.of))
    value = (place - place[:, :1])[..., "xyz".index(asked.axis)]
    what = f"way along {asked.axis}" + (f" against {signals.prim(asked.of)}" if asked.of else "")
    return _range(what, signals.prim(asked.object), value, asked.low, asked.high, "m")


@measures(BouncesTo)
def _bounces(asked: BouncesTo, signals: Signals) -> list[Measure]:
    """The height of the flight that a frame is in over the one touch before it, (W, T); 0 before the first."""
    prim = signals.prim(asked.object)
    off, near = gap(signals, asked.object, asked.ref), about(swept_gap(signals, asked.object, asked.ref))
    reach, _ = touch_reach(signals, asked.object, asked.ref)
    touching = near <= reach
    low, tops = _tops(signals, asked.object)
    rising = signals.velocity(asked.object)[:, -1] @ signals.up > signals.gravity * signals.step
    value, frames = np.zeros(low.shape), low.shape[1]
    for w in range(signals.count):
        touches = np.flatnonzero(touching[w])
        # A flight lies between two frames of touch that do not follow one another, and after the last.
        for start, end in zip(touches, [*touches[1:], frames], strict=True):
            if end - start > 1 and not (end == frames and rising[w]):  # it gets higher than is seen
                ground = float(low[w, start] - off[w, start])
                value[w, start + 1 : end] = max(float(tops[w, start + 1 : end].max()) - ground, 0.0)
    value = np.where(np.isfinite(near), value, np.nan)
    within = asked.within or max(0.1 * asked.height, 0.02)
    source = "the objective's" if asked.within else "a tenth of the height, at least 2 cm"
    return [
        Measure.about(
            value, asked.height, within, what=f"height of the bounce off {signals.prim(asked.ref)}", prim=prim,
            unit="m", limit_from=source,
        )
    ]  # fmt: skip


def _tops(signals: Signals, name: str) -> tuple[Floats, Floats]:
    """Height of a body's lowest point at each frame, and the greatest about each, between frames too, (W, T) [m]."""
    low, course = signals.ends(name)[0], signals.course(name)
    height = course.place @ signals.up
    # At the end it may be on its way to a top that is less than a frame ahead.
    left = np.clip(course.velocity[:, -1:] @ signals.up, 0.0, signals.gravity * signals.step)
    beyond = height[:, -1:] + left**2 / (2.0 * max(signals.gravity, 1e-9))
    top = np.concatenate([height[:, :1], course.greatest(signals.up), beyond], axis=1)
    return low, low + np.maximum(top[:, :-1], top[:, 1:]) - height


@measures(Counts)
def _counts(asked: Counts, signals: Signals) -> list[Measure]:
    """How many of some objects are in a container, at each frame."""
    hollow = hollow_of(signals, asked.ref)
    inside = [hollow.room(signals, name) >= -0.05 * signals.solid(name).smallest for name in asked.objects]
    value = np.sum(inside, axis=0).astype(np.float64)
    return [
        Measure(
            f"number of {len(asked.objects)} objects in it", signals.prim(asked.ref), value, asked.least, "objects",
            1.0, "the objective's", at_most=False,
        )
    ]  # fmt: skip


# ---- what to change
@mends(TurnedBetween, SpinBetween, GoneBetween, OwnSpinBetween, TiltBetween)
def _drive(asked: Predicate, finding: Finding, evidence: Evidence) -> RepairTarget:
    """What a joint moves, its drive does; what is free, its start."""
    prim, value, limit = finding.prim or "", finding.value or 0.0, finding.limit or 0.0
    way, short = ("raise" if value < limit else "lower"), f"{abs(limit - value):.3g} {finding.unit}"
    share = limit / value if value * limit > 0.0 else None
    driven = by_drive(evidence, prim, share, f"its drive brings it {short} off")
    if driven is not None:
        return driven
    why = f"it is {short} off: it starts otherwise, or something stops it"
    return RepairTarget.model_validate(
        {"kind": "physical parameter", "prim": prim, "parameter": "velocity", "direction": way, "unit": "m/s",
         "why": why}
    )  # fmt: skip


@mends(BouncesTo)
def _bounce(asked: BouncesTo, finding: Finding, evidence: Evidence) -> RepairTarget:
    """From a height h a restitution e brings it up to e^2 h: as its square root, so is the restitution off."""
    body, value, expected = evidence.body(finding.prim or ""), finding.value or 0.0, finding.expected or 0.0
    now = body.shapes[0].restitution if body.shapes else None
    to = now * (expected / value) ** 0.5 if now and value > 0.0 else None
    return RepairTarget(
        kind="physical parameter", prim=body.prim, parameter="restitution",
        direction="raise" if value < expected else "lower", current=now, suggested=to,
        why="what bounces comes up to the square of its restitution of where it fell from",
    )  # fmt: skip


@mends(Counts)
def _gather(asked: Counts, finding: Finding, evidence: Evidence) -> RepairTarget:
    """Some are beside it, or on their way."""
    why = "too few get into it: start them over it, or give it more room or time"
    return RepairTarget(kind="settlement", prim=finding.prim, parameter="position", direction="change", why=why)
