"""Chains of hinges and sliders from what is held to a link: where the link is, and what holds it up.

Arrays follow the J joints of a chain, from the base on; poses are in the frame of the chain's root, which is that of
the first joint's parent anchor, so that robots which stand elsewhere are one chain.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import NDArray

from wsim.errors import UserError
from wsim.geometry.paths import exponential, logarithm
from wsim.geometry.rotations import conjugate, multiply, rotate
from wsim.scene.world import Body, Joint, World

Floats = NDArray[np.float64]
Pose = tuple[Floats, Floats]  # places (..., 3) [m] and turns (..., 4) xyzw

NOWHERE: Pose = (np.zeros(3), np.array([0.0, 0.0, 0.0, 1.0]))
ONE_FREEDOM = ("revolute", "prismatic")


def after(first: Pose, second: Pose) -> Pose:
    """The pose that `second` has in the frame of `first`, seen from where `first` is."""
    return first[0] + rotate(first[1], second[0]), multiply(first[1], second[1])


def inverse(pose: Pose) -> Pose:
    """What leads back."""
    back = conjugate(pose[1])
    return -rotate(back, pose[0]), back


@dataclass(frozen=True)
class Arm:
    """One chain.

    Attributes:
        prims: Of its joints.
        root: Pose of its root in the world.
        slides: Whether a joint is a slider, (J,).
        axis: Of each, in its own frame, (J, 3).
        ahead: Pose of each joint's frame in the link before, or of the first in the root.
        back: Pose of each joint's frame in its own link.
        tip: Pose of the chain's link in the last joint's, which it is or is fixed to.
        low, high: Limits (J,) [rad or m], infinite where there are none.
        fastest: [rad/s or m/s], infinite where its file says none.
        stiffness: Of the servos (J,) [N m/rad or N/m].
        damping: Of the servos and what damps beside them (J,) [N m s/rad or N s/m].
        weight: Mass that hangs on each link and on none that follows, (J,) [kg].
        com: Its centre, in the link's frame, as it is at the start (J, 3) [m].
        gravity: In the root's frame (3,) [m/s^2].
    """

    prims: tuple[str, ...]
    root: Pose
    slides: NDArray[np.bool_]
    axis: Floats
    ahead: Pose
    back: Pose
    tip: Pose
    low: Floats
    high: Floats
    fastest: Floats
    stiffness: Floats
    damping: Floats
    weight: Floats
    com: Floats
    gravity: Floats

    @classmethod
    def to(cls, world: World, link: str) -> Arm:
        """The chain that ends in a link.

        Raises:
            UserError: If it does not begin at what is held, is held by other joints, or one of them has no servo.
        """
        chain = _chain(world, link)
        joints = [joint for joint in chain if joint.kind in ONE_FREEDOM]
        ahead, gap = [], NOWHERE
        for joint in chain:
            ends = _anchors(joint)
            if joint.kind in ONE_FREEDOM:
                ahead.append(after(gap, ends[0]))
                gap = NOWHERE
            else:
                gap = after(gap, after(ends[0], inverse(ends[1])))
        root, ahead[0] = ahead[0], NOWHERE
        back = [_anchors(joint)[1] for joint in joints]
        weight, com = _loads(world, [joint.child for joint in joints])
        numbers = {
            name: np.array([each if each is not None else math for each in values])
            for name, values, math in (
                ("low", [joint.low for joint in joints], -np.inf),
                ("high", [joint.high for joint in joints], np.inf),
                ("fastest", [joint.fastest for joint in joints], np.inf),
            )
        }
        return cls(
            prims=tuple(joint.prim for joint in joints),
            root=root,
            slides=np.array([joint.kind == "prismatic" for joint in joints]),
            axis=np.eye(3)[["XYZ".index(joint.axis) for joint in joints]],
            ahead=_stacked(ahead),
            back=_stacked(back),
            tip=gap,
            stiffness=np.array([joint.drive.stiffness for joint in joints if joint.drive is not None]),
            damping=np.array([joint.drive.damping for joint in joints if joint.drive is not None]),
            weight=weight,
            com=com,
            gravity=rotate(conjugate(root[1]), np.array(world.gravity)),
            **numbers,
        )

    @property
    def shape(self) -> bytes:
        """What tells chains apart that are solved otherwise: not where they stand, nor what they carry."""
        kept = ("slides", "axis", "ahead", "back", "tip", "low", "high")
        parts = [part for each in fields(self) if each.name in kept for part in _parts(getattr(self, each.name))]
        return b"".join(np.ascontiguousarray(part).tobytes() for part in parts)

    def links(self, q: Floats) -> Iterator[tuple[Floats, Floats, Pose]]:
        """Of each joint in turn where it is, (N, 3), its axis, (N, 3), and the pose of its link, for coordinates
        (N, J)."""
        pose = tuple(np.broadcast_to(part, (len(q), len(part))) for part in NOWHERE)
        for j, slides in enumerate(self.slides):
            place, turn = after((pose[0], pose[1]), (self.ahead[0][j], self.ahead[1][j]))
            axis = rotate(turn, self.axis[j])
            along = q[:, j, None] * self.axis[j]
            still = np.broadcast_to(NOWHERE[1], (len(q), 4))
            moved = (along, still) if slides else (np.zeros_like(along), exponential(along))
            pose = after(after((place, turn), moved), inverse((self.back[0][j], self.back[1][j])))
            yield place, axis, pose

    def reach(self, q: Floats, point: Floats) -> Pose:
        """Where a point of the link is, (N, 3), and how the link is turned, (N, 4), for coordinates (N, J)."""
        *_, (_, _, last) = self.links(q)
        return after(after(last, self.tip), (point, NOWHERE[1]))

    def holding(self, q: Floats) -> Floats:
        """What each servo gives to hold the weight that hangs on it, (N, J) [N m or N], for coordinates (N, J)."""
        poses = list(self.links(q))
        found = np.zeros_like(q)
        for k, (_, _, (place, turn)) in enumerate(poses):
            center, pull = place + rotate(turn, self.com[k]), self.weight[k] * self.gravity
            for j, (pivot, axis, _) in enumerate(poses[: k + 1]):
                load = pull if self.slides[j] else np.cross(center - pivot, pull)
                found[:, j] -= (axis * load).sum(axis=1)
        return found

    def into(self, places: Floats, turns: Floats) -> Pose:
        """Poses of the world in the root's frame."""
        return after(inverse(self.root), (places, turns))

    def out(self, places: Floats) -> Floats:
        """Places in the root's frame, in the world."""
        return self.root[0] + rotate(self.root[1], places)


def missed(found: Pose, wanted: Pose) -> tuple[Floats, Floats]:
    """How far poses are from others: (N,) [m] and (N,) [rad]."""
    off = logarithm(multiply(conjugate(wanted[1]), found[1]))
    return np.linalg.norm(found[0] - wanted[0], axis=-1), np.linalg.norm(off, axis=-1)


def _chain(world: World, link: str) -> list[Joint]:
    """The joints from what is held to a link, the base's first."""
    above = {joint.child: joint for joint in world.joints if not joint.closing}
    follows = {gear.second for gear in world.gears}
    found: list[Joint] = []
    body: str | None = link
    while body is not None:
        joint = above.get(body)
        if joint is None or len(found) > len(world.joints):
            raise UserError(f"{link}: joints do not lead from it to what is held, but to {body}; hold the robot's base")
        if joint.kind not in (*ONE_FREEDOM, "fixed") or joint.prim in follows:
            how = "follows another" if joint.prim in follows else f"is {joint.kind}"
            raise UserError(f"{link}: {joint.prim}, on which it hangs, {how}; to reach, hinges and sliders are needed")
        if joint.kind in ONE_FREEDOM and (joint.drive is None or joint.drive.stiffness <= 0.0):
            raise UserError(f"{link}: {joint.prim}, on which it hangs, has no servo; give it a stiffness and a damping")
        found.append(joint)
        body = joint.parent
    if not any(joint.kind in ONE_FREEDOM for joint in found):
        raise UserError(f"{link}: no joint moves it")
    return found[::-1]


def _anchors(joint: Joint) -> tuple[Pose, Pose]:
    """A joint's frame in its parent and in its child."""
    first, second = (
        (np.array(getattr(joint, f"{end}_anchor") or (0.0, 0.0, 0.0)), np.array(getattr(joint, f"{end}_turn")))
        for end in ("parent", "child")
    )
    return first, second


def _loads(world: World, links: list[str]) -> tuple[Floats, Floats]:
    """Masses, and their centres, of what hangs on each link and on none that follows."""
    bodies = {body.prim: body for body in world.bodies}
    above = {joint.child: joint.parent for joint in world.joints if not joint.closing}
    weight, moment = np.zeros(len(links)), np.zeros((len(links), 3))
    for body in world.bodies:
        owner: str | None = body.prim
        for _ in world.bodies:  # as many steps as there are, where joints lead in a ring
            if owner is None or owner in links:
                break
            owner = above.get(owner)
        if owner in links:
            k = links.index(owner)
            mass = body.mass * (1.0 - body.lift)
            own = after(inverse(_pose(bodies[owner])), _pose(body))
            weight[k] += mass
            moment[k] += mass * (own[0] + rotate(own[1], np.array(body.com)))
    return weight, moment / np.maximum(weight, 1e-12)[:, None]


def _pose(body: Body) -> Pose:
    return np.array(body.position), np.array(body.rotation)


def _stacked(poses: list[Pose]) -> Pose:
    return np.array([place for place, _ in poses]), np.array([turn for _, turn in poses])


def _parts(value: Floats | Pose) -> tuple[Floats, ...]:
    return value if isinstance(value, tuple) else (value,)
