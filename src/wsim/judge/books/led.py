"""What kinematic bodies and belts give: the work of what is led, wherever a force ties it to what moves by itself.

A led body goes as it is told, whatever holds it back, and works by the impulse that it gives times its own motion: by
contacts, by springs, ropes and joints. Over an interval P . u is that of both means, and h / 12 of the product of their
changes more (Euler and Maclaurin), where both change evenly. A belt works by the impulse of its contacts times the
velocity that its surface has by itself, and friction takes what of that no body gets (`wsim.judge.books.losses`).

Impulses are those that a recording has. Where it has none, those of springs follow from their laws, and what contacts
gave is what changed a body's momentum, less gravity's and the springs' shares: an upper bound of their work.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from wsim.judge.books.laws import Laws
from wsim.judge.books.recorded import RecordedContacts
from wsim.judge.evidence.carriers import carried_work, carriers, leads

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsim.judge.evidence.evidence import Evidence

    Floats = NDArray[np.float64]

STEADY = 2.0  # times what something gives before or after: more than that is a blow


@dataclass(frozen=True)
class Led:
    """What loose bodies were given by what is led since the start, (T, B) each [J]; at most, where it is not told."""

    work: Floats
    unsure: Floats

    @staticmethod
    def of(evidence: Evidence) -> Led:
        """Of a recording, worked out once for all who ask."""
        if Led not in evidence.kept and not leads(evidence).any() and not carriers(evidence):
            evidence.kept[Led] = Led(*np.zeros((2, *evidence.motion.speed.shape)))
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
    found = np.zeros((2, len(evidence.time), len(motion.mass)))
    twist = np.concatenate([motion.v, motion.w], axis=2)
    for (row, to), push in _pushes(contacts, goes, ~motion.kinematic).items():
        found[:, 1:, to] += works(evidence, push, twist[:, row])
    for to, push, speed in _belts(contacts, ~motion.kinematic):
        found[:, 1:, to] += works(evidence, push, speed)
    work, unsure = np.cumsum(found, axis=1)
    return Led(work, unsure)


def works(evidence: Evidence, push: Floats, speed: Floats) -> tuple[Floats, Floats]:
    """The work of impulses at what moves by itself, and how unsure it is, (T - 1,) each [J].

    Of what comes all at once, a blow, no frame tells at which of the velocities between it came.

    Args:
        evidence: Of the recording.
        push: Impulses and angular impulses since the frame before, (T, n).
        speed: The velocities and angular velocities of where they act, (T, n).
    """
    h, given = evidence.motion.h[:, None], push[1:]
    change, mean = np.diff(speed, axis=0), 0.5 * (speed[1:] + speed[:-1])
    slope = np.gradient(speed, evidence.time, axis=0) if len(speed) > 1 else np.zeros_like(speed)
    mean -= h / 12.0 * np.diff(slope, axis=0)
    force = np.gradient(given / h, axis=0) if len(given) > 1 else np.zeros_like(given)
    bend = h * force * change / 12.0
    jump = np.abs(np.diff(bend, axis=0, prepend=0.0, append=0.0))
    size = np.abs(given)
    around = np.pad(size, ((1, 1), (0, 0)))
    blow = np.maximum(size - STEADY * np.minimum(around[2:], around[:-2]), 0.0)
    doubt = 0.5 * np.minimum(np.maximum(jump[1:], jump[:-1]), np.abs(bend)) + 0.5 * blow * np.abs(change)
    return np.sum(given * mean + bend, axis=1), np.sum(doubt, axis=1)


def _pushes(
    contacts: RecordedContacts, goes: NDArray[np.bool_], loose: NDArray[np.bool_]
) -> dict[tuple[int, int], Floats]:
    """Impulses and angular impulses, (T, 6), that led bodies gave by way of loose ones: by both their rows."""
    track, ties, frames = contacts.track, contacts.ties, len(contacts.given[0])
    found: dict[tuple[int, int], Floats] = {}

    def give(led: int, to: int, frame: NDArray[np.intp] | slice, back: Floats) -> None:
        np.subtract.at(found.setdefault((led, to), np.zeros((frames, 6))), frame, back)

    for side, sign in ((0, -1.0), (1, 1.0)):
        own, other = contacts.body[:, side], contacts.body[:, 1 - side]
        back = np.concatenate([sign * track.impulse, track.turn[:, side]], axis=1).astype(np.float64)
        ours = (own >= 0) & goes[own] & (other >= 0) & loose[other]
        for led, to in np.unique(np.stack([own, other], axis=1)[ours], axis=0).tolist():
            rows = np.flatnonzero(ours & (own == led) & (other == to))
            give(led, to, track.frame[rows].astype(np.intp), back[rows])
    for k, pair in enumerate(ties.pairs if ties is not None else ()):
        assert ties is not None
        for side, sign in ((0, -1.0), (1, 1.0)):
            led, to = pair[side], pair[1 - side]
            if min(led, to) >= 0 and goes[led] and loose[to]:
                back = np.concatenate([sign * ties.track.impulse[:, k], ties.track.turn[:, k, side]], axis=1)
                give(led, to, slice(None), back.astype(np.float64))
    for n, (cord, led) in enumerate(ties.ends if ties is not None else ()):
        assert ties is not None
        held = [row for other, row in ties.ends if other == cord and loose[row]]
        if held and goes[led]:
            give(led, held[0], slice(None), ties.track.cords[:, n, :6].astype(np.float64))
    return found


def _belts(contacts: RecordedContacts, loose: NDArray[np.bool_]) -> list[tuple[int, Floats, Floats]]:
    """Of all contacts of a belt with a body: who gets the work, the impulses and the belt's own velocity, (T, 3)."""
    track, frames, found = contacts.track, len(contacts.given[0]), []
    for side, sign in ((0, -1.0), (1, 1.0)):
        own, other = contacts.body[:, side], contacts.body[:, 1 - side]
        gets = np.where((other >= 0) & loose[other], other, np.where((own >= 0) & loose[own], own, -1))
        runs = np.array([any(shape.surface_velocity) for shape in contacts.shapes], dtype=bool)
        ours = runs[track.pair[:, side]] & (gets >= 0)
        for k, to in np.unique(np.stack([track.pair[:, side], gets], axis=1)[ours], axis=0).tolist():
            rows = np.flatnonzero(ours & (track.pair[:, side] == k) & (gets == to))
            push = np.zeros((frames, 3))
            np.add.at(push, track.frame[rows], -sign * track.impulse[rows].astype(np.float64))
            found.append((to, push, contacts.belt(k)))
    return found


def _at_most(evidence: Evidence) -> Led:
    """Of a recording without impulses: by springs as their laws say, by contacts no more than this."""
    motion = evidence.motion
    laws, goes = Laws(evidence), leads(evidence)
    found, pulled = np.zeros((2, len(evidence.time), len(motion.mass))), np.zeros((*motion.acceleration.shape[:2], 3))
    for law in laws.springs:
        for row, other, wrench in ((law.one, law.two, law.back), (law.two, law.one, law.wrench)):
            if row >= 0 and not motion.kinematic[row]:
                pulled[:, row] += 0.5 * (wrench[1:, :3] + wrench[:-1, :3]) * motion.h[:, None]
            elif row >= 0 and goes[row] and other >= 0 and not motion.kinematic[other]:
                twist = np.concatenate([motion.v[:, row], motion.w[:, row]], axis=1)
                work, doubt = over(evidence, -np.einsum("ti,ti->t", wrench, twist))
                found[:, 1:, other] += work, np.where(law.known, doubt, np.abs(work))
    work, unsure = np.cumsum(found, axis=1)
    return Led(work + carried_work(evidence, pulled), unsure)


def over(evidence: Evidence, power: Floats) -> tuple[Floats, Floats]:
    """A power (T,) over each interval, and how unsure that is, (T - 1,) each [J].

    By Euler and Maclaurin, with slopes by differences; where those jump they are no slopes.
    """
    h = evidence.motion.h
    slope = np.gradient(power, evidence.time, edge_order=2 if len(power) > 2 else 1)
    bend = h**2 / 12.0 * np.diff(slope)
    jump = np.abs(np.diff(bend, prepend=0.0, append=0.0))
    return 0.5 * h * (power[1:] + power[:-1]) - bend, 0.5 * np.minimum(np.maximum(jump[1:], jump[:-1]), np.abs(bend))
