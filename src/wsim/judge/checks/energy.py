"""The energy budget: what bodies have, less what was put into them, never rises, and falls by what may be taken."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, cast

import numpy as np

from wsim.geometry.rotations import lengths
from wsim.judge.books.differences import missed
from wsim.judge.books.driven import changes_hands
from wsim.judge.books.giving import held_by_joints
from wsim.judge.books.led import Led, late_fall, untold
from wsim.judge.books.losses import Losses
from wsim.judge.books.phases import Account, falling, hidden, latest, least, least_of, risen, sinking, turned_over
from wsim.judge.books.recorded import met
from wsim.judge.books.touching import Touching
from wsim.judge.checks.check import Check, Checks
from wsim.judge.checks.joint import beyond
from wsim.judge.evidence.contact import overlaps
from wsim.judge.evidence.motion import FLOAT32
from wsim.judge.verdict import RepairTarget

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from wsim.judge.evidence.evidence import Evidence
    from wsim.judge.verdict import Finding

    Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Asked:
    """What is asked of a recording's energy."""

    account: Account  # of each mechanism; of all as one where there is one, or where it is not known which was driven
    stored: Floats  # what contacts and stops may hold, (T, B) [J]
    phase: Floats  # what a frame's phase hides, (T, B) [J]
    driven: bool
    one: bool
    of: NDArray[np.bool_] | None = None  # which bodies each mechanism has, (B, n)
    together: Floats | None = None  # what all bodies have, less what they were given, (T,) [J]
    late: Floats = field(default_factory=lambda: np.zeros(1))  # of each mechanism [s], (n,)


@dataclass
class CheckEnergy(Check):
    """Nothing gains energy from nowhere: kinetic, potential and springs' energy, less work done on it, only fall.

    By mechanism, over the time in which it meets no other, and for all bodies together. Where contacts, joints and
    cords are recorded, what is lost must be what friction, blows, stops and dampers may take by their laws; elsewhere
    that is not known, and of what is lost nothing is asked here.
    """

    share: float = 0.01  # of the energy that changes hands
    settling: float = 2e-3  # of its smallest extent, that a body may be lifted out of what it stands in

    def evaluate(self, evidence: Evidence) -> list[Finding]:
        """The largest gain of any mechanism by itself, and of all together."""
        motion = evidence.motion
        if len(motion.h) == 0 or self._unknown(evidence):
            return []
        if CheckEnergy not in evidence.kept:
            self.prepare_similar([evidence])
        asked, unknown = cast("Asked", evidence.kept[CheckEnergy]), untold(evidence)
        found = [] if asked.of is None else self._by_mechanism(evidence, asked, asked.of)
        rows = np.flatnonzero(~motion.kinematic)
        if unknown.any() or any(not finding.passed for finding in found):
            return found  # what one gains all have together
        losses = Losses.of(evidence)
        if len(rows) and (losses is None or not losses.whole or (asked.one and not asked.driven)):
            gained = self._together(evidence, rows, asked)
            if losses is None or not losses.whole or not gained.passed:
                found.append(gained)
        return found if losses is None else [*found, *self._accounted(evidence, losses, asked)]

    def prepare_similar(self, copies: Sequence[Evidence]) -> None:
        """The phase of each mechanism's steps at which it gains least, of all copies at once."""
        some = [evidence for evidence in copies if len(evidence.motion.h) and not self._unknown(evidence)]
        asked = [self._asked(evidence) for evidence in some]
        phases = least_of([each.account for each in asked], [latest(evidence) for evidence in some])
        for evidence, each, late in zip(some, asked, phases, strict=True):
            evidence.kept[CheckEnergy] = replace(each, late=late)

    def _asked(self, evidence: Evidence) -> Asked:
        motion, led = evidence.motion, Led.of(evidence)
        energy = motion.kinetic + motion.potential + motion.elastic
        if motion.applied_work is not None:
            energy = energy - motion.applied_work
        late = np.maximum(np.diff(led.late, axis=0, prepend=led.late[:1]), 0.0)
        energy = energy - led.work - led.unsure - np.cumsum(late, axis=0)
        energy[:, motion.kinematic | untold(evidence)] = 0.0  # they go where they are told to
        none = np.zeros(len(evidence.time))
        worked, unsure = (evidence.recording.scalars.get(f"work/drives{end}", none) for end in ("", "_unsure"))
        # The work on joints, by drives or by a controller, is not known of each mechanism.
        driven, one = any(joint.drive for joint in evidence.world.joints) or bool(np.any(worked)), self._one(evidence)
        together = energy.sum(axis=1) - np.nancumsum(worked) - np.nancumsum(unsure)
        phase, sinks = hidden(evidence) + missed(evidence), sinking(evidence)
        stored = self._stored(evidence)
        units, rows = np.unique(motion.unit[~motion.kinematic]), np.flatnonzero(~motion.kinematic)
        if driven or one or not len(units):
            whole = (each[:, rows].sum(axis=1)[:, None] for each in (sinks, phase, stored))
            return Asked(Account(together[:, None], *whole), stored, phase, driven, one)
        of = motion.unit[:, None] == units  # (B, mechanisms)
        meets = ((motion.meets | met(evidence)) @ of.astype(np.float32)) > 0.0
        held = _summed(stored, of)
        # What a contact took up while it met another, it may give back after.
        gave = np.where(meets[:-1] & ~meets[1:] & np.isfinite(held[1:-1]), held[1:-1], 0.0)
        account = Account(energy @ of, sinks @ of, phase @ of, held, meets, gave)
        return Asked(account, stored, phase, driven, one, of, together)

    def _accounted(self, evidence: Evidence, losses: Losses, asked: Asked) -> list[Finding]:
        """Of bodies that hang together or touch: the gain or the loss that is largest by its limit."""
        motion = evidence.motion
        energy = motion.kinetic + motion.potential + motion.elastic
        if motion.applied_work is not None:
            energy = energy - motion.applied_work
        unseen, stored = asked.phase, asked.stored
        held = np.where(np.isfinite(stored), stored, 0.0)
        found: list[tuple[float, Finding]] = []
        for rows in losses.groups:
            taken, of = losses.of_group(rows), _only(rows, len(motion.mass))
            limit, scale = (float(each[0]) for each in self._limit(evidence, of))
            limit, scale = self._with_drives(limit, scale, taken.held)
            limits = limit + held_by_joints(evidence, losses.ties, rows), scale
            known, phase = energy[:, rows].sum(axis=1) - taken.driven + taken.damped, unseen[:, rows].sum(axis=1)
            gives = np.where(np.isfinite(stored[:, rows]).all(axis=1), held[:, rows].sum(axis=1), np.inf)
            (ahead, stray), fall = losses.ahead(rows), late_fall(evidence, rows)
            for verb, sign, most in (("gains", 1.0, -taken.least), ("loses", -1.0, taken.most)):
                seen, hides = sign * known - taken.unsure - most, (gives, phase)
                by_poses = seen + sign * ahead - stray
                balances = [by_poses, self._by_phase(evidence, rows, seen, sign, hides, verb)]
                if fall.any():
                    balances.append(seen - sign * fall)
                each = (self._changed(evidence, rows, balance, hides, limits, verb) for balance in balances)
                found.append(min(each, key=_ratio))
        return [max(found, key=_ratio)[1]] if found else []

    @staticmethod
    def _by_phase(
        evidence: Evidence, rows: NDArray[np.intp], seen: Floats, sign: float, unseen: tuple[Floats, Floats], verb: str
    ) -> Floats:
        """A balance by the one phase of all steps at which it rises least: a rise that lasts is one for every phase.

        Where frames are so few that a swing bends between two of them, poses do not tell it (`Losses.ahead`).
        """
        sinks = sign * sinking(evidence)[:, rows].sum(axis=1)
        late, _ = least(lambda t: np.array([_rise(seen + t * sinks, unseen, verb).max()]), 1, latest(evidence))
        return np.asarray(seen + late * sinks)

    def _changed(
        self, evidence: Evidence, rows: NDArray[np.intp], balance: Floats, unseen: tuple[Floats, Floats],
        limits: tuple[float, float], verb: str,
    ) -> tuple[float, Finding]:  # fmt: skip
        """How far a balance rises, by its limit; contacts and stops may have held, or hidden, a part at either end."""
        had, rise = _had(balance, unseen, verb), _rise(balance, unseen, verb)
        end = int(np.argmax(rise))
        start, value, (limit, scale) = int(np.argmin(had[: end + 1])), max(float(rise[end]), 0.0), limits
        over = np.flatnonzero(rise > limit)
        motion = evidence.motion
        body = evidence.world.bodies[rows[int(np.argmax(motion.kinetic[:, rows].max(axis=0)))]]
        story = "that nothing gives" if verb == "gains" else "that nothing takes"
        return value / max(limit, 1e-300), self.measured(
            f"{body.prim}{' and what it meets' if len(rows) > 1 else ''} {verb} {value:.3g} J {story}"
            + (f", {value / scale:.2%} of what moves it" if scale else ""),
            value, limit, "J", expected=0.0, prim=body.prim, time=float(evidence.time[over[0] if len(over) else end]),
            span=(float(evidence.time[start]), float(evidence.time[end])),
            fine="What bodies lose is what friction, blows, stops, drives and dampers may take",
            limit_from=f"{self.share:g} of the {scale:.3g} J that change hands, what one time step cannot resolve, and "
            f"a lift by {self.settling:g} of the size of what may touch something",
            target=RepairTarget(kind="program", prim=body.prim, why="something takes or gives energy unseen"),
        )  # fmt: skip

    @staticmethod
    def _one(evidence: Evidence) -> bool:
        """Whether all that moves is one mechanism."""
        return len(np.unique(evidence.motion.unit[~evidence.motion.kinematic])) < 2

    @staticmethod
    def _unknown(evidence: Evidence) -> bool:
        """Whether something works on the bodies whose work is not in the recording."""
        recording, world = evidence.recording, evidence.world
        pushed = bool(world.fluids) or bool(recording.metadata.get("controlled"))
        driven = any(joint.drive for joint in world.joints)
        return (
            len(world.bodies) == 0
            or (pushed and recording.applied_work is None)
            or (driven and "work/drives" not in recording.scalars)
        )

    def _stored(self, evidence: Evidence) -> Floats:
        """What contacts and joint stops may hold as springs and give back, (T, B) [J].

        Of a contact that is its force times the depth to which it gives, as far as a time step can tell: by as much as
        it comes nearer in one. Along what a ball lies on it does not, and its turning brings no point of it nearer.
        """
        motion, recording = evidence.motion, evidence.recording
        deepest = recording.scalars.get("contact/penetration")
        size = motion.smallest
        give = self.settling * size[None] if deepest is None else np.nan_to_num(deepest)[:, None]
        push = np.asarray(recording.contact_force, dtype=np.float64)
        force = lengths(push)
        turns = motion.rate * np.where(self._balls(evidence), 0.0, motion.radius)
        stored = force * (give + turns * motion.dt) + np.abs(np.sum(push * motion.v, axis=-1)) * motion.dt
        if evidence.world.give.time > 0.0:
            stored = stored + self._pressed_in(evidence)
        for joint in evidence.world.joints:
            track = evidence.joint(joint)
            if track is not None and (joint.low is not None or joint.high is not None):
                rows = motion.unit == motion.unit[evidence.index(joint.child)]
                stored[np.ix_(beyond(joint, track) > 0.0, rows)] = np.inf
        return stored

    @staticmethod
    def _balls(evidence: Evidence) -> NDArray[np.bool_]:
        """Which bodies are balls about their centre of mass, (B,)."""
        bodies = evidence.world.bodies
        return np.array([all(s.kind == "sphere" and _at(s.position, body.com) for s in body.shapes) for body in bodies])

    @staticmethod
    def _pressed_in(evidence: Evidence) -> Floats:
        """What soft contacts hold, (T, B) [J]: of a mass m that is in by d, and their time t, m (d / t)^2 / 2 + m g d.

        m is all that hangs together with the body. Its weight they carry besides, as they push it out again.
        """
        motion, held = evidence.motion, np.zeros(evidence.motion.speed.shape)
        heavy = np.array([motion.mass[motion.unit == unit].sum() for unit in motion.unit])

        def of_one(depth: Floats) -> Floats:
            return 0.5 * (depth / evidence.world.give.time) ** 2 + evidence.gravity * depth

        for pair in overlaps(evidence):
            for row in (row for row in (pair.a.body, pair.b.body) if row >= 0):
                held[:, row] += heavy[row] * of_one(np.maximum(pair.depth, 0.0))
        return np.maximum(held, heavy * of_one(_deep_in_meshes(evidence)))

    def _by_mechanism(self, evidence: Evidence, asked: Asked, of: NDArray[np.bool_]) -> list[Finding]:
        """The mechanism with the largest gain in its own scale; what it gets from others is left out."""
        account, late = asked.account, asked.late
        limit, scale = self._limit(evidence, of)
        limit = limit + turned_over(evidence, falling(evidence) @ of)
        gains = account.gains(late)
        worst = int(np.argmax(np.maximum(gains, 0.0) / np.where(limit > 0.0, limit, 1.0)))
        rows = np.flatnonzero(of[:, worst])
        unseen = account.phase[:, worst], account.held[:, worst]
        limits = float(limit[worst]), float(scale[worst])
        return [self._finding(evidence, rows, account.balance(late)[:, worst], unseen, limits)]

    def _together(self, evidence: Evidence, rows: NDArray[np.intp], asked: Asked) -> Finding:
        """What all bodies gain: where they are one mechanism, by the phase of its steps at which that is least."""
        phase, held = (each[:, rows].sum(axis=1) for each in (asked.phase, asked.stored))
        limit, scale = (float(each[0]) for each in self._limit(evidence, _only(rows, len(evidence.motion.mass))))
        limit, scale = self._with_drives(limit, scale, changes_hands(evidence, rows))
        if asked.one:
            balance = asked.account.balance(asked.late)[:, 0]
            limit += float(turned_over(evidence, falling(evidence)[:, rows].sum(axis=1)[:, None])[0])
        else:
            balance = asked.account.energy[:, 0] if asked.together is None else asked.together
            limit += float(self._late(evidence)[rows].sum())
        return self._finding(evidence, rows, balance, (phase, held), (limit, scale))

    def _finding(
        self, evidence: Evidence, rows: NDArray[np.intp], balance: Floats, unseen: tuple[Floats, Floats],
        limits: tuple[float, float],
    ) -> Finding:  # fmt: skip
        motion = evidence.motion
        gain, had = np.maximum(risen(balance, *unseen), 0.0), balance + unseen[0] + unseen[1]
        end = int(np.argmax(gain))
        start = int(np.argmin(had[: end + 1]))
        limit, scale = limits
        wrong = gain[end] > limit
        alone = len(np.unique(motion.unit[rows])) == 1
        body = evidence.world.bodies[rows[int(np.argmax(motion.kinetic[end, rows]))]]
        who = body.prim if alone else "All bodies together"
        over = np.flatnonzero(gain > limit)
        time = float(evidence.time[over[0] if len(over) else end])
        value = float(gain[end])
        return self.measured(
            f"{who} {'gains' if wrong else 'gains at most'} {value:.3g} J from nowhere"
            + (f", {value / scale:.2%} of what moves it, by {time:.3f} s" if wrong and scale else ""),
            value,
            limit,
            "J",
            expected=0.0,
            prim=body.prim if alone or wrong else None,
            time=time,
            span=(float(evidence.time[start]), float(evidence.time[end])),
            limit_from=f"{self.share:g} of the {scale:.3g} J that change hands, "
            + "what one time step cannot resolve, and "
            + f"a lift by at most {self.settling:g} of the size of what may touch something",
            target=RepairTarget(
                kind="time step", prim=body.prim, parameter="time_step", direction="lower",
                why="an integrator that gains energy gains less of it in shorter steps, unless something pushes unseen"
            ),
        )  # fmt: skip

    def _limit(self, evidence: Evidence, of: NDArray[np.bool_]) -> tuple[Floats, Floats]:
        """The gain that is no finding yet, and the energy that changes hands, of groups of bodies (B, n), (n,) [J]."""
        motion, weight = evidence.motion, evidence.motion.mass * evidence.gravity
        kinetic, potential, elastic = (each @ of for each in (motion.kinetic, motion.potential, motion.elastic))
        scale = np.max([kinetic.max(axis=0), np.ptp(potential, axis=0), np.ptp(elastic, axis=0)], axis=0)
        size = motion.smallest
        height = (np.abs(motion.com) @ np.abs(evidence.up)).max(axis=0)
        # What hangs on a joint and touches nothing all run is lifted out of nothing.
        if (CheckEnergy, self.settling) not in evidence.kept:  # asked of each mechanism, and of all
            evidence.kept[CheckEnergy, self.settling] = self._give(evidence, size)
        settles = cast("Floats", evidence.kept[CheckEnergy, self.settling]) * (
            motion.touched.any(axis=0) | ~motion.jointed
        )
        lift = weight * (settles + 4.0 * FLOAT32 * height)
        # Joints close in a step what single precision leaves between their two sides, whatever else moves or does not.
        closes = np.where(motion.jointed, 0.5 * motion.mass * (FLOAT32 * motion.radius / motion.dt) ** 2, 0.0)
        for joint in evidence.world.joints:  # what dry friction takes on a way that is lost in rounding
            reach = 1.0 if joint.kind == "revolute" else float(size[evidence.index(joint.child)])
            closes[evidence.index(joint.child)] += 4.0 * FLOAT32 * joint.friction * reach
        return self.share * scale + (lift + closes) @ of, scale

    def _with_drives(self, limit: float, scale: float, held: float) -> tuple[float, float]:
        """The same where what drives hold as springs changes hands, too [J]."""
        return limit + self.share * (max(scale, held) - scale), max(scale, held)

    def _give(self, evidence: Evidence, size: Floats) -> Floats:
        """How far bodies may be lifted out of what they stand in, (B,) [m]: as deep as they are said to be, or are."""
        found, deepest = self.settling * size, evidence.recording.scalars.get("contact/penetration")
        if deepest is not None:
            found = np.minimum(found, float(np.nan_to_num(deepest).max(initial=0.0)))
        if any(shape.shape.kind == "mesh" for shape in evidence.placed):
            return found  # how deep something is in one poses do not tell
        balls = [all(shape.kind == "sphere" for shape in body.shapes) for body in evidence.world.bodies]
        deep = np.zeros(len(size) + 1)
        for pair in overlaps(evidence):
            for row in (pair.a.body, pair.b.body):
                deep[row] = max(deep[row], float(pair.depth.max()))
        return np.where(balls, np.minimum(found, deep[:-1]), found)

    @staticmethod
    def _late(evidence: Evidence) -> Floats:
        """A first-order step leaves positions behind velocities by up to half a step's fall, (B,) [J]."""
        motion = evidence.motion
        late: Floats = motion.mass * evidence.gravity * motion.speed.max(axis=0) * latest(evidence)
        return late


def _at(place: tuple[float, ...], other: tuple[float, ...]) -> bool:
    return place == other or bool(np.allclose(place, other))


def _had(balance: Floats, unseen: tuple[Floats, Floats], verb: str) -> Floats:
    """What may have been there at each moment, of what contacts and stops give and a phase hides."""
    gives, phase = unseen
    return np.asarray(balance + phase + (gives if verb == "gains" else 0.0))


def _rise(balance: Floats, unseen: tuple[Floats, Floats], verb: str) -> Floats:
    """How far a balance has risen at each moment over the least that it had."""
    gives, phase = unseen
    lower = np.minimum.accumulate(_had(balance, unseen, verb))
    return np.asarray(balance - phase - (0.0 if verb == "gains" else gives) - lower)


def _ratio(found: tuple[float, Finding]) -> float:
    return found[0]


def _deep_in_meshes(evidence: Evidence) -> Floats:
    """How deep bodies are in something at most by the search for contacts with meshes, (T, B) [m]; 0 without any."""
    found, touching = np.zeros(evidence.motion.speed.shape), Touching.of(evidence)
    if touching.triangles:
        frames = np.arange(len(found))
        contacts = touching.of_many(evidence.body_q, np.zeros(len(found)), frames)
        for rows in (contacts.one, contacts.two):
            np.maximum.at(found.reshape(-1), rows[rows >= 0], -contacts.gap[rows >= 0])
    return np.maximum(found, 0.0)


def _only(rows: NDArray[np.intp], count: int) -> NDArray[np.bool_]:
    """These of so many bodies, as a group, (count, 1)."""
    found = np.zeros((count, 1), dtype=bool)
    found[rows] = True
    return found


def _summed(energy: Floats, of: NDArray[np.bool_]) -> Floats:
    """Energies (T, B) of groups of bodies (B, n), (T, n), of which some may be infinite."""
    known = np.isfinite(energy)
    found: Floats = np.where((~known).astype(np.float32) @ of > 0.0, np.inf, np.where(known, energy, 0.0) @ of)
    return found


CHECKS: Checks = (CheckEnergy,)
