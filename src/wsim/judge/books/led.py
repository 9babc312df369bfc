"""What kinematic bodies and belts give: the work of what is led, wherever a force ties it to what moves by itself.

A led body goes as it is told, whatever holds it back, and works by the impulse that it gives times its own motion: by
contacts, by springs, ropes and joints. Over an interval P . u is that of both means, and h / 12 of the product of their
changes more (Euler and Maclaurin), where both change evenly. A belt works by the impulse of its contacts times the
velocity that its surface has by itself, and friction takes what of that no body gets (`wsim.judge.books.losses`).

A body on a path has in each step the velocity that takes it to the step's end, and frames show it half a step late. So
are the velocities that ropes, joints and friction give, those of the solver's steps; what surfaces press by their depth
goes with them as they are now, and shows as much slip. A spring pulls by places, which are late nowhere: its work is
its force, by its law, times the way of its end.

Impulses of contacts, ropes and joints are those that a recording has. Where it has none, what contacts gave is what
changed a body's momentum, less gravity's and the springs' shares: an upper bound of their work.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from wsim.geometry.rotations import lengths
from wsim.judge.books.laws import Laws
from wsim.judge.books.phases import COARSEST
from wsim.judge.books.recorded import RecordedContacts
from wsim.judge.evidence.carriers import carried_work, carriers, leads
from wsim.judge.evidence.scheduled import fastest

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsim.judge.books.recorded_ties import RecordedTies
    from wsim.judge.evidence.evidence import Evidence

    Floats = NDArray[np.float64]
    Rows = NDArray[np.intp]

STEADY = 2.0  # times what something gives before or after: more than that is a blow


@dataclass(frozen=True)
class Led:
    """What loose bodies were given by what is led since the start, (T, B) each [J]; at most, where it is not told."""

    work: Floats
    unsure: Floats
    late: Floats  # what it is more as surfaces go now, of what presses

    @staticmethod
    def of(evidence: Evidence) -> Led:
        """Of a recording, worked out once for all who ask."""
        if Led not in evidence.kept and not leads(evidence).any() and not carriers(evidence):
            evidence.kept[Led] = Led(*np.zeros((3, *evidence.motion.speed.shape)))
        if Led not in evidence.kept:
            evidence.kept[Led] = _of_record(evidence) if told(evidence) else _at_most(evidence)
        kept = evidence.kept[Led]
        assert isinstance(kept, Led)
        return kept


def told(evidence: Evidence) -> bool:
    """Whether a recording has the impulses of all that may act between bodies."""
    recording, world = evidence.recording, evidence.world
    ties = recording.ties is not None or not (world.joints or world.cords)
    return recording.contacts is not None and ties


def untold(evidence: Evidence) -> NDArray[np.bool_]:
    """The bodies of mechanisms on which something led works by a rope or a joint whose force is not known, (B,)."""
    world, unit, goes = evidence.world, evidence.motion.unit, leads(evidence)
    if told(evidence):
        return np.zeros(len(goes), dtype=bool)
    held = {end for joint in world.joints for end in (joint.parent, joint.child)}
    held |= {guide.body for rope in world.ropes for guide in rope.path}
    led = [goes[i] and body.prim in held for i, body in enumerate(world.bodies)]
    return np.isin(unit, unit[np.array(led, dtype=bool)])


def _of_record(evidence: Evidence) -> Led:
    motion, goes = evidence.motion, leads(evidence)
    assert evidence.recording.contacts is not None
    contacts = RecordedContacts(evidence, evidence.recording.contacts)
    found = np.zeros((3, len(evidence.time), len(motion.mass)))
    twist = np.concatenate([motion.v, motion.w], axis=2)
    for (row, to), push in _pushes(contacts, goes, ~motion.kinematic).items():
        change = np.diff(twist[:, row], axis=0)
        found[:2, 1:, to] += works(evidence, push[1:], _mean(evidence, twist[:, row]), change)
    for to, push, speed in _belts(contacts, ~motion.kinematic):
        found[:2, 1:, to] += works(evidence, push[1:], _mean(evidence, speed), np.diff(speed, axis=0))
    for side in (0, 1):
        own, other = contacts.body[:, side], contacts.body[:, 1 - side]
        rows = np.flatnonzero((own >= 0) & goes[own] & (other >= 0) & ~motion.kinematic[other])
        np.add.at(found[2], (contacts.track.frame[rows], other[rows]), late(contacts)[rows])
    laws = contacts.ties.laws if contacts.ties is not None else Laws(evidence)
    found[:2, 1:] += _by_springs(evidence, laws, contacts.ties)
    return Led(*np.cumsum(found, axis=1))


def works(evidence: Evidence, push: Floats, mean: Floats, change: Floats) -> tuple[Floats, Floats]:
    """The work of impulses at what moves by itself, and how unsure it is, (T - 1,) each [J].

    Of what comes all at once, a blow, no frame tells at which of the velocities between it came.

    Args:
        evidence: Of the recording.
        push: Impulses and angular impulses in each interval, (T - 1, n).
        mean: The mean velocity and angular velocity of where they act, (T - 1, n).
        change: By how much these change within, (T - 1, n).
    """
    h = evidence.motion.h[:, None]
    force = np.gradient(push / h, axis=0) if len(push) > 1 else np.zeros_like(push)
    bend = h * force * change / 12.0
    jump = np.abs(np.diff(bend, axis=0, prepend=0.0, append=0.0))
    size = np.abs(push)
    around = np.pad(size, ((1, 1), (0, 0)))
    blow = np.maximum(size - STEADY * np.minimum(around[2:], around[:-2]), 0.0)
    doubt = 0.5 * np.minimum(np.maximum(jump[1:], jump[:-1]), np.abs(bend)) + 0.5 * blow * np.abs(change)
    return np.sum(push * mean + bend, axis=1), np.sum(doubt, axis=1)


def _mean(evidence: Evidence, values: Floats) -> Floats:
    """Of values at frames (T, n) over each interval, (T - 1, n), by Euler and Maclaurin with slopes by differences."""
    slope = np.gradient(values, evidence.time, axis=0) if len(values) > 1 else np.zeros_like(values)
    found: Floats = 0.5 * (values[1:] + values[:-1]) - evidence.motion.h[:, None] / 12.0 * np.diff(slope, axis=0)
    return found


def _by_springs(evidence: Evidence, laws: Laws, ties: RecordedTies | None) -> Floats:
    """The work of springs' led ends on what is at their other ends, and how unsure it is, (2, T - 1, B) [J].

    Of what swings faster than frames tell the impulse is the recorded one: that of forces where steps start, half a
    step earlier than the places go.
    """
    motion, goes = evidence.motion, leads(evidence)
    found, h = np.zeros((2, len(motion.h), len(motion.mass))), motion.h[:, None]
    for cord, (spring, law) in enumerate(zip(evidence.world.springs, laws.springs, strict=True)):
        for end, (row, to, wrench) in enumerate(((law.one, law.two, law.back), (law.two, law.one, law.wrench))):
            if min(row, to) < 0 or not goes[row] or motion.kinematic[to]:
                continue
            place, force, known = laws.end(spring.path[end]), wrench[:, :3], law.known
            speed = motion.v[:, row] + np.cross(motion.w[:, row], laws.arm(row, place))
            push = -h * _mean(evidence, force)
            if ties is not None:
                given = ties.track.cords[1:, ties.ends.index((cord, row)), :3].astype(np.float64)
                push = np.where(known[:, None], push, -given - 0.5 * np.minimum(motion.dt, h) * np.diff(force, axis=0))
                known = np.ones_like(known)
            work, doubt = works(evidence, push, np.diff(place, axis=0) / h, np.diff(speed, axis=0))
            found[:, :, to] += work, np.where(known, doubt, np.abs(work))
    return found


def _pushes(
    contacts: RecordedContacts, goes: NDArray[np.bool_], loose: NDArray[np.bool_]
) -> dict[tuple[int, int], Floats]:
    """Impulses and angular impulses, (T, 6), that led bodies gave by way of loose ones: by both their rows."""
    track, ties, frames = contacts.track, contacts.ties, len(contacts.given[0])
    found: dict[tuple[int, int], Floats] = {}
    every = np.arange(frames)

    def give(led: int, to: int, back: Floats, frame: Rows = every) -> None:
        np.subtract.at(found.setdefault((led, to), np.zeros((frames, 6))), frame, back)

    for side, sign in ((0, -1.0), (1, 1.0)):
        own, other = contacts.body[:, side], contacts.body[:, 1 - side]
        back = np.concatenate([sign * track.impulse, track.turn[:, side]], axis=1).astype(np.float64)
        ours = (own >= 0) & goes[own] & (other >= 0) & loose[other]
        for led, to in np.unique(np.stack([own, other], axis=1)[ours], axis=0).tolist():
            rows = np.flatnonzero(ours & (own == led) & (other == to))
            give(led, to, back[rows], track.frame[rows].astype(np.intp))
    for k, pair in enumerate(ties.pairs if ties is not None else ()):
        assert ties is not None
        for side, sign in ((0, -1.0), (1, 1.0)):
            led, to = pair[side], pair[1 - side]
            if min(led, to) >= 0 and goes[led] and loose[to]:
                back = np.concatenate([sign * ties.track.impulse[:, k], ties.track.turn[:, k, side]], axis=1)
                give(led, to, back.astype(np.float64))
    springs = len(ties.laws.springs) if ties is not None else 0
    for n, (cord, led) in enumerate(ties.ends if ties is not None else ()):
        assert ties is not None
        held = [row for other, row in ties.ends if other == cord and loose[row]]
        if held and goes[led] and cord >= springs:  # what springs give follows from their law
            give(led, held[0], ties.track.cords[:, n, :6].astype(np.float64))
    return found


def late(contacts: RecordedContacts) -> Floats:
    """How much more each contact works as led surfaces go now, of those that are shown half a step late, (n,) [J].

    By what presses, and no more of it than slip shows.
    """
    motion, track = contacts.motion, contacts.track
    push, interval, found = track.along.astype(np.float64), np.maximum(track.frame - 1, 0), np.zeros(len(track.frame))
    step = 0.5 * np.minimum(motion.dt / motion.h[interval], 1.0)
    for side, sign in ((0, 1.0), (1, -1.0)):
        moves = np.append(motion.kinematic, False)[contacts.body[:, side]]
        speed = contacts.speed(side)
        found += np.where(moves, sign * step * np.einsum("ni,ni->n", push, speed[:, 1] - speed[:, 0]), 0.0)
    seen = np.einsum("ni,ni->n", push, contacts.slip.mean(axis=1))
    return np.clip(seen, np.minimum(found, 0.0), np.maximum(found, 0.0))


def _belts(contacts: RecordedContacts, loose: NDArray[np.bool_]) -> list[tuple[int, Floats, Floats]]:
    """Of all contacts of a belt with a body: who gets the work, the impulses and the belt's own velocity, (T, 3)."""
    track, frames, found, world = contacts.track, len(contacts.given[0]), [], contacts.world
    for side, sign in ((0, -1.0), (1, 1.0)):
        own, other = contacts.body[:, side], contacts.body[:, 1 - side]
        gets = np.where((other >= 0) & loose[other], other, np.where((own >= 0) & loose[own], own, -1))
        runs = np.array([any(fastest(world, shape)) for shape in contacts.shapes], dtype=bool)
        ours = runs[track.pair[:, side]] & (gets >= 0)
        for k, to in np.unique(np.stack([track.pair[:, side], gets], axis=1)[ours], axis=0).tolist():
            rows = np.flatnonzero(ours & (track.pair[:, side] == k) & (gets == to))
            push = np.zeros((frames, 3))
            np.add.at(push, track.frame[rows], -sign * track.impulse[rows].astype(np.float64))
            found.append((to, push, contacts.belt(k)))
    return found


def _at_most(evidence: Evidence) -> Led:
    """Of a recording without impulses: by springs as their laws say, by contacts no more than this."""
    motion, laws = evidence.motion, Laws(evidence)
    pulled = np.zeros((len(motion.h), len(motion.mass), 3))
    for law in laws.springs:
        for row, wrench in ((law.one, law.back), (law.two, law.wrench)):
            if row >= 0:
                pulled[:, row] += 0.5 * (wrench[1:, :3] + wrench[:-1, :3]) * motion.h[:, None]
    work, unsure = np.cumsum(np.pad(_by_springs(evidence, laws, None), ((0, 0), (1, 0), (0, 0))), axis=1)
    return Led(work + carried_work(evidence, pulled), unsure, np.zeros_like(work))


def late_fall(evidence: Evidence, rows: Rows) -> Floats:
    """What gravity gives some bodies by their velocities beyond what it does by their places, (T,) [J].

    Of what joints hang on led bodies: these are where they are now, and go and turn as half a step before, so that what
    hangs there is shown with no velocity that it ever had, and its momentum is that. What of it is more than turning
    and gaining speed explain counts for nothing.
    """
    motion, world, goes = evidence.motion, evidence.world, leads(evidence)
    ends = [[evidence.index(end) for end in (joint.parent, joint.child) if end is not None] for joint in world.joints]
    units = {int(motion.unit[i]) for pair in ends if goes[pair].any() for i in pair if not goes[i]}
    hangs = rows[np.isin(motion.unit[rows], list(units))]
    if not len(hangs):
        return np.zeros(len(evidence.time))
    mass, v, h = motion.mass[hangs], motion.v[:, hangs], motion.h[:, None]
    way = h * _mean(evidence, v @ motion.gravity)
    found = mass * (way - np.diff(motion.com[:, hangs] @ motion.gravity, axis=0))
    speed, rate = lengths(v), motion.rate[:, hangs]
    turns = h * np.maximum(speed[1:] * rate[1:], speed[:-1] * rate[:-1])
    most = 0.5 * min(motion.dt, COARSEST) * mass * evidence.gravity * (lengths(np.diff(v, axis=0)) + turns)
    return np.concatenate([[0.0], np.cumsum(np.clip(found, -most, most).sum(axis=1))])


def over(evidence: Evidence, power: Floats) -> tuple[Floats, Floats]:
    """A power (T,) over each interval, and how unsure that is, (T - 1,) each [J].

    By Euler and Maclaurin, with slopes by differences; where those jump they are no slopes.
    """
    h = evidence.motion.h
    slope = np.gradient(power, evidence.time, edge_order=2 if len(power) > 2 else 1)
    bend = h**2 / 12.0 * np.diff(slope)
    jump = np.abs(np.diff(bend, prepend=0.0, append=0.0))
    return 0.5 * h * (power[1:] + power[:-1]) - bend, 0.5 * np.minimum(np.maximum(jump[1:], jump[:-1]), np.abs(bend))
