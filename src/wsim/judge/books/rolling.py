"""What resists rolling: the torque about the line on which a round body rolls, over many frames.

About the points where it touches nothing has an arm but gravity: what its angular momentum lacks there is the torque
that the pair's rolling resistance C gives, C R N against its turning, R the radius of the gap between both surfaces
and N the push. Where friction takes a share x of its most, the one cone that both have in wsim leaves sqrt(1 - x^2) of
it (docs/rigid.md); a pair that states no resistance gives none.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from wsim.geometry.rotations import multiply, rotate
from wsim.judge.books.balance import SOFT, rounding
from wsim.judge.books.creep import INTERVALS
from wsim.judge.books.forces import STILL, Poses, slip
from wsim.judge.books.touching import NEAR, Contacts, Touching
from wsim.scene.contact import curvature

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsim.judge.evidence.evidence import Evidence
    from wsim.scene.world import Body

    Floats = NDArray[np.float64]
    Bools = NDArray[np.bool_]

FLAT = 1e-4  # 1 - cosine: what it rolls on turns by less
LYING = 0.05  # cosine between a cylinder's axis and what it lies on
PRESSED = 0.1  # of gravity: with less it hardly rolls
ASIDE = 0.1  # of its rate: what turns aside by less keeps its way
HALF = 0.5  # of friction's most: what takes more of it may come to slip


@dataclass(frozen=True)
class Rolls:
    """A body that rolls on one other for some frames."""

    row: int
    first: int  # frame
    last: int
    other: str  # prim of what it rolls on
    radius: float  # [m]
    resisted: float  # torque against its turning, over the push [m]
    stated: float  # by the pair's law [m]
    least: float  # that friction leaves of it [m]
    unsure: float  # by rounding [m]


@dataclass(frozen=True)
class Near:
    """What touches in a frame, or may in the intervals about it, looked for once for all that rolls."""

    poses: Poses
    contacts: Contacts
    slip: Floats  # (n, 3) [m/s], of each contact

    @classmethod
    def of(cls, evidence: Evidence, frames: list[int], about: Bools) -> dict[int, Near]:
        """Of some bodies (B,), in each of some frames."""
        motion, touching, count = evidence.motion, Touching.of(evidence), len(frames)
        bodies, arrays = len(about), (evidence.body_q, motion.com, motion.v, motion.w)
        every = Poses(*(array[frames].reshape(-1, array.shape[2]) for array in arrays))
        before = np.maximum(np.array(frames) - 1, 0)
        after = np.minimum(frames, len(motion.h) - 1)
        reach = 0.5 * NEAR + np.pad(np.maximum(motion.reach[before], motion.reach[after]), ((0, 0), (0, 1)))
        contacts = touching.of_many(evidence.body_q[frames], reach, np.arange(count), about=np.tile(about, (count, 1)))
        at = np.maximum(contacts.one, contacts.two) // bodies
        over = slip(touching, contacts, every)
        apart = np.abs(np.einsum("ni,ni->n", over, contacts.normal))
        close = contacts.gap <= NEAR + apart * np.maximum(motion.h[before], motion.h[after])[at]
        found = {}
        for n, frame in enumerate(frames):
            ours = np.flatnonzero(close & (at == n))
            own = contacts.only(ours)
            one, two = (np.where(rows >= 0, rows - n * bodies, rows) for rows in (own.one, own.two))
            poses = Poses(*(array[frame] for array in arrays))
            found[frame] = cls(poses, replace(own, one=one, two=two), over[ours])
        return found


def rolls(evidence: Evidence) -> list[Rolls]:
    """All of a recording, in spans that overlap by a half."""
    motion = evidence.motion
    given, unit = evidence.recording.applied_impulse, max(evidence.gravity, 1.0)
    force = motion.acceleration - motion.gravity
    odd = np.linalg.norm(force, axis=2) > SOFT * unit  # something hit it
    if given is not None:
        odd |= np.any(given[1:] != 0.0, axis=2)
    free = ~motion.jointed & ~motion.kinematic & np.array([_round(body) for body in evidence.world.bodies], dtype=bool)
    turning = np.linalg.norm(motion.w, axis=2) * motion.radius > STILL
    spans = []
    for first in range(0, len(motion.h) - INTERVALS + 1, INTERVALS // 2):
        span = slice(first, first + INTERVALS)
        calm = free & turning[first : first + INTERVALS + 1].all(axis=0) & ~odd[span].any(axis=0)
        spans += [(int(row), _asked(evidence, int(row), first)) for row in np.flatnonzero(calm)]
    if not spans or Touching.of(evidence).changing.any():
        return []
    near = Near.of(evidence, sorted({frame for _, frames in spans for frame in frames}), free)
    rounds = rounding(evidence)
    found = [_of_span(evidence, near, row, frames, rounds[:, row]) for row, frames in spans]
    return [each for each in found if each is not None]


def _asked(evidence: Evidence, row: int, first: int) -> list[int]:
    """The frames at which it is looked what a body touches in a span: the middle, the first, the last, and others."""
    last = first + INTERVALS
    others = range(first + 1, last) if evidence.motion.meets[first:last, row].any() else ()
    return [(first + last) // 2, first, last, *others]  # what comes by may touch it for a frame, or between two


def _round(body: Body) -> bool:
    solid = [shape for shape in body.shapes if shape.collides]
    return len(solid) == 1 and solid[0].kind in ("sphere", "cylinder", "capsule")


def _of_span(evidence: Evidence, near: dict[int, Near], row: int, frames: list[int], rounds: Floats) -> Rolls | None:
    motion, touching, (middle, first, last) = evidence.motion, Touching.of(evidence), frames[:3]
    ends: list[Contacts] = []
    for frame in frames:
        contacts = _touches(evidence, near[frame], row)
        if contacts is None:
            return None
        ends.append(contacts)
    met = ends[0]
    other, sign = _other(met, row)
    normal = sign * met.normal[0]  # towards the body
    if any(np.any(end.shapes[0] != met.shapes[0]) or end.normal[0] @ met.normal[0] < 1.0 - FLAT for end in ends):
        return None  # it came from one thing to another, as from a board to a carpet
    sides = [touching.shapes[int(shape)] for shape in met.shapes[0]]
    if any(shape.exact for *_, shape in sides):
        return None  # its triangles stand for what is curved
    bend = sum(curvature(shape, moves=owner >= 0) for owner, _, shape in sides)
    axis = _axis(evidence, row, other, normal, first, STILL * bend)
    mean = slice(first, last)
    force = (motion.acceleration[mean, row] - motion.gravity).mean(axis=0)
    push = float(force @ normal)
    friction, rolling = (float(law[0]) for law in touching.laws(met.shapes[:1]))
    share = float(np.linalg.norm(force - push * normal)) / max(friction * push, 1e-12)
    if axis is None or push < PRESSED * max(evidence.gravity, 1.0) or share > HALF:
        return None
    torque = motion.torque[mean, row].mean(axis=0) / motion.mass[row]
    arm = met.point.mean(axis=0) - motion.com[middle, row]
    resisted = -float((torque - np.cross(arm, force)) @ axis) / push
    least = max(np.sqrt(1.0 - share**2) - (rolling / max(friction, 1e-12)) ** 2, 0.0)
    unsure = float(rounds[mean].mean()) / INTERVALS / push
    radius, prim = float(motion.radius[row]), sides[0 if sign > 0 else 1][1]
    return Rolls(row, first, last, prim, radius, resisted, rolling / bend, rolling / bend * least, unsure * radius)


def _axis(evidence: Evidence, row: int, other: int, normal: Floats, first: int, slowest: float) -> Floats | None:
    """About what a body turns over another all of a span, (3,); None where that does not last."""
    frames = slice(first, first + INTERVALS + 1)
    w = evidence.motion.w[frames, row] - (evidence.motion.w[frames, other] if other >= 0 else 0.0)
    w = w - (w @ normal)[:, None] * normal
    mean = w.mean(axis=0)
    axis: Floats = mean / max(float(np.linalg.norm(mean)), 1e-12)
    rate = w @ axis
    aside = np.linalg.norm(w - rate[:, None] * axis, axis=1).max()
    lasts = rate.min() > max(slowest, np.abs(np.diff(rate)).max()) and aside < ASIDE * rate.min()
    return axis if lasts else None


def _other(contacts: Contacts, row: int) -> tuple[int, float]:
    """The row of what touches a body, and whether the contacts' normals point towards the body."""
    return (int(contacts.one[0]), 1.0) if contacts.two[0] == row else (int(contacts.two[0]), -1.0)


def _touches(evidence: Evidence, near: Near, row: int) -> Contacts | None:
    """The contacts of a body that rolls on one thing, along one line, without slipping; None where it does not."""
    ours = np.flatnonzero((near.contacts.one == row) | (near.contacts.two == row))
    if not len(ours) or np.any(near.contacts.shapes[ours] != near.contacts.shapes[ours[0]]):
        return None
    contacts, over = near.contacts.only(ours), near.slip[ours]
    if np.any(contacts.normal @ contacts.normal[0] < 1.0 - FLAT):
        return None
    if np.linalg.norm(over, axis=1).max() > STILL:
        return None
    body = evidence.world.bodies[row]
    shape = next(shape for shape in body.shapes if shape.collides)
    if shape.kind != "sphere":
        turn = multiply(near.poses.q[row, 3:], np.array(shape.rotation))
        if abs(float(rotate(turn, np.array([0.0, 0.0, 1.0])) @ contacts.normal[0])) > LYING:
            return None
    return contacts
