"""What recorded contacts take from what they act on, while surfaces go on slipping: by both ends of an interval."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsim.judge.books.recorded import RecordedContacts

    Floats = NDArray[np.float64]


def taken(contacts: RecordedContacts) -> tuple[Floats, Floats]:
    """What each row's impulses take from what they act on, by the velocities of both ends, and how much of that is
    unsure, (n, 2) and (n,) [J].

    Impulses times the velocities of centres of mass, and angular impulses about these times the turning: that asks
    of no place. Within an interval both may be another by half of what surfaces change by in their slip and their
    turning here, or in the intervals beside.
    """
    motion, track, slip = contacts.motion, contacts.track, contacts.slip
    push, turn, rate = track.impulse.astype(np.float64), np.zeros((len(slip), 3)), np.zeros_like(slip)
    found = -np.einsum("nei,ni->ne", slip - contacts.speed(1) + contacts.speed(0), push)  # what belts' surfaces take
    before = np.maximum(track.frame - 1, 0)
    for side, sign in ((0, -1.0), (1, 1.0)):  # both bodies' turns tell the same, where both move
        moves, rows = contacts.body[:, side] >= 0, np.maximum(contacts.body[:, side], 0)
        if not len(motion.mass):
            break
        own = track.turn[:, side].astype(np.float64)
        arm = track.point.astype(np.float64) - 0.5 * (motion.com[before, rows] + motion.com[track.frame, rows])
        turn = np.where(moves[:, None], sign * own - np.cross(arm, push), turn)
        for end, frame in enumerate((before, track.frame)):
            v, w = motion.v[frame, rows], motion.w[frame, rows]
            rate[:, end] += sign * np.where(moves[:, None], w, 0.0)
            work = sign * np.einsum("ni,ni->n", push, v) + np.einsum("ni,ni->n", own, w)
            found[:, end] -= np.where(moves, work, 0.0)
    change = slip[:, 1] - slip[:, 0]
    normal = track.along.astype(np.float64) / np.maximum(track.pressed.astype(np.float64), 1e-30)[:, None]
    nearer = np.einsum("ni,ni->n", change, normal)
    parts = (
        (contacts.rubbed, np.linalg.norm(change - nearer[:, None] * normal, axis=1)),
        (track.pressed.astype(np.float64), np.abs(nearer)),
        (np.linalg.norm(turn, axis=1), np.linalg.norm(rate[:, 1] - rate[:, 0], axis=1)),
    )
    return found, np.sum([0.5 * size * np.max([by, *beside(contacts, by)], axis=0) for size, by in parts], axis=0)


def beside(contacts: RecordedContacts, values: Floats) -> tuple[Floats, Floats]:
    """Of numbers of each row (n,) those of its pair in the interval before and after, 0 where it has none."""
    track, count = contacts.track, len(contacts.shapes)
    key = (track.frame.astype(np.int64) * count + track.pair[:, 0]) * count + track.pair[:, 1]
    order, step = np.argsort(key, kind="stable"), np.int64(count) ** 2

    def at(other: NDArray[np.int64]) -> Floats:
        place = np.minimum(np.searchsorted(key[order], other), max(len(key) - 1, 0))
        return np.where(key[order][place] == other, values[order][place], 0.0)

    return at(key - step), at(key + step)
