"""Blows between two bodies that nothing else holds: how fast they met, and how fast they parted.

Between two frames bodies fly on parabolas but for the blow itself. The speed at which the gap closes, and the gap, give
when they met and how fast; those of the next frame, when they parted and how fast. If both moments agree there was one
blow, short beside the frames, and Newton's law of impact holds for it: parting over approach is the restitution.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from wsim.judge.books.forces import Poses, slip
from wsim.judge.books.touching import Contacts, Touching
from wsim.scene.contact import pair_law

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsim.judge.evidence.evidence import Evidence

    Floats = NDArray[np.float64]

LEAST = 0.2  # [m/s] of approach: slower ones are lost in what a step does
ACROSS = 0.2  # cosine between the normals of two contacts that do not share a blow
SPIN = 0.05  # of the approach: the surface of what turns by less meets the other as its centre does


@dataclass(frozen=True)
class Blow:
    """Two bodies that met once in an interval."""

    interval: int
    one: int  # row of a body, or below 0: what never moves
    two: int
    prims: tuple[str, str]
    approach: float  # [m/s]
    parting: float  # [m/s]
    restitution: float  # by the pair's law
    unsure: float  # of either speed [m/s]: what a step changes, and how far the normal turned


def blows(evidence: Evidence) -> list[Blow]:
    """All of a recording that stand alone."""
    motion = evidence.motion
    changed = np.linalg.norm(motion.acceleration - motion.gravity, axis=2) * motion.h[:, None] > LEAST
    # What lies still is pushed as well, and changes nothing: of a pair that meets one changes by half of it at least.
    changed &= np.linalg.norm(np.diff(motion.v, axis=0), axis=2) > 0.5 * LEAST
    changed &= ~motion.jointed & ~motion.kinematic
    if not changed.any():
        return []
    touching, found = Touching.of(evidence), []
    for k in np.flatnonzero(changed.any(axis=1)):
        found += _of_interval(evidence, touching, int(k), changed[k])
    return found


def _of_interval(evidence: Evidence, touching: Touching, k: int, changed: NDArray[np.bool_]) -> list[Blow]:
    motion = evidence.motion
    reach = 2.0 * float(motion.reach[k].max())
    ends = [_poses(evidence, frame) for frame in (k, k + 1)]
    near = [touching.at(end.q, reach) for end in ends]
    closing = [_closing(touching, contacts, end) for contacts, end in zip(near, ends, strict=True)]
    found = []
    for pair in sorted({(int(a), int(b)) for a, b in zip(near[0].one, near[0].two, strict=True)}):
        rows = [row for row in pair if row >= 0]
        if not any(changed[row] for row in rows) or any(motion.jointed[row] for row in rows):
            continue
        at = [_of_pair(contacts, pair) for contacts in near]
        if not len(at[0]) or not len(at[1]):
            continue
        before, after = (int(n[np.argmin(c.gap[n])]) for n, c in zip(at, near, strict=True))
        if not _alone(near, (before, after), pair):
            continue
        blow = _blow(evidence, touching, k, pair, near, (before, after), closing)
        if blow is not None:
            found.append(blow)
    return found


def _blow(
    evidence: Evidence, touching: Touching, k: int, pair: tuple[int, int], near: list[Contacts],
    which: tuple[int, int], closing: list[Floats],
) -> Blow | None:  # fmt: skip
    motion, h = evidence.motion, float(evidence.motion.h[k])
    normal = near[0].normal[which[0]]
    pulled = [motion.gravity if row >= 0 and not motion.kinematic[row] else np.zeros(3) for row in pair]
    pull = float((pulled[0] - pulled[1]) @ normal)  # at which gravity closes the gap
    gaps = [max(float(contacts.gap[n]), 0.0) for contacts, n in zip(near, which, strict=True)]
    towards, back = float(closing[0][which[0]]), -float(closing[1][which[1]])
    approach, parting = (np.sqrt(max(speed * speed + 2.0 * pull * gap, 0.0)) for speed, gap in
                         zip((towards, back), gaps, strict=True))  # fmt: skip
    if towards <= 0.0 or approach < LEAST or _turns(evidence, k, pair, approach):
        return None
    shapes = [touching.shapes[s][2] for s in near[0].shapes[which[0]]]
    law = pair_law(evidence.world, *shapes)
    spent = 2.0 * gaps[0] / (towards + approach)
    flown = 2.0 * gaps[1] / (back + parting) if back > 0.0 else 0.0
    slack = motion.dt + 0.02 * h + 2.0 * gaps[0] * 1e-3 / approach
    lies = abs(back) < 0.05 * approach and gaps[1] < 0.01 * approach * h
    again = 2.0 * law.restitution * approach < pull * (h - spent)  # it may have bounced and come back
    if (not lies and (back <= 0.0 or abs(spent + flown - h) > slack)) or again:
        return None
    across = [
        slip(touching, c, _poses(evidence, k + end))[n] for end, (c, n) in enumerate(zip(near, which, strict=True))
    ]
    turned = float(np.linalg.norm(np.cross(normal, near[1].normal[which[1]])))
    unsure = 2.0 * evidence.gravity * motion.dt + turned * max(float(np.linalg.norm(u)) for u in across)
    prims = tuple(_owner(evidence, touching, near[0], which[0], side) for side in (0, 1))
    return Blow(k, *pair, (prims[0], prims[1]), float(approach), 0.0 if lies else float(parting), law.restitution,
                unsure)  # fmt: skip


def _owner(evidence: Evidence, touching: Touching, contacts: Contacts, n: int, side: int) -> str:
    return touching.shapes[int(contacts.shapes[n, side])][1]


def _turns(evidence: Evidence, k: int, pair: tuple[int, int], approach: float) -> bool:
    """Whether what is no ball turns, so that one point of it may part while another still comes."""
    motion = evidence.motion
    for row in pair:
        if row < 0:
            continue
        solid = [shape for shape in evidence.world.bodies[row].shapes if shape.collides]
        ball = len(solid) == 1 and solid[0].kind == "sphere"
        rate = float(np.linalg.norm(motion.w[k : k + 2, row], axis=1).max())
        if not ball and rate * motion.radius[row] > SPIN * approach:
            return True
    return False


def _alone(near: list[Contacts], which: tuple[int, int], pair: tuple[int, int]) -> bool:
    """Whether neither body has another contact that pushes along the same way."""
    for contacts, n in zip(near, which, strict=True):
        shared = np.zeros(len(contacts), dtype=bool)
        for row in pair:
            if row >= 0:
                shared |= (contacts.one == row) | (contacts.two == row)
        shared &= ~((contacts.one == pair[0]) & (contacts.two == pair[1]))
        if np.any(shared & (np.abs(contacts.normal @ contacts.normal[n]) > ACROSS)):
            return False
    return True


def _of_pair(contacts: Contacts, pair: tuple[int, int]) -> NDArray[np.intp]:
    return np.flatnonzero((contacts.one == pair[0]) & (contacts.two == pair[1]))


def _closing(touching: Touching, contacts: Contacts, poses: Poses) -> Floats:
    """How fast each gap closes, (n,) [m/s]."""
    found: Floats = -np.einsum("ni,ni->n", slip(touching, contacts, poses), contacts.normal)
    return found


def _poses(evidence: Evidence, frame: int) -> Poses:
    motion = evidence.motion
    return Poses(evidence.body_q[frame], motion.com[frame], motion.v[frame], motion.w[frame])
