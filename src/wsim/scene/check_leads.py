"""What goes its own way, the world and kinematic bodies, and what joints hold to two of them.

A rigid piece is a body with all that fixed joints hold to it. A joint to what leads holds points of the piece: a ball
joint one, a hinge two of its axis, a fixed joint three. The piece keeps their distances; so must what leads it.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from itertools import combinations, pairwise
from typing import NamedTuple

import numpy as np
from pxr import Gf, Sdf, Usd, UsdPhysics

from wsim.geometry.paths import Curve, exponential
from wsim.geometry.rotations import conjugate, rotate
from wsim.scene.articulation import body_above, is_kinematic, joint_ends, joints_of, may_break
from wsim.scene.spanning import WORLD_END
from wsim.scene.usd_mass import mass_at
from wsim.scene.usd_motion import curve_of, path_of
from wsim.scene.usd_prims import rigid_frame, turn_of

Array = np.ndarray
SHORTEST_PARTING = 1e-4  # by which what leads a piece must part to be refused [m]
STRAIGHT = (0.1, 1.0, 10.0)  # times at which what goes straight is looked at [s]
LOOKS = 16  # within a turn, or between two keys of a path


class Hold(NamedTuple):
    """A joint by which something leads a piece."""

    joint: UsdPhysics.Joint
    lead: Sdf.Path
    points: Array  # which it holds, as the stage has them [m], (points, 3)


def parted(stage: Usd.Stage) -> Iterator[str]:
    """Rigid pieces that joints hold to two things which part, and which none of them can move."""
    ways: dict[Sdf.Path, Way] = {}
    for holds in pieces(stage).values():
        for one, other in combinations(holds, 2):
            if one.lead == other.lead:
                continue
            for lead in (one.lead, other.lead):
                if lead not in ways:
                    ways[lead] = Way(stage, lead)
            if _part(one, other, ways):
                names = " and ".join(
                    "the world" if each.lead == WORLD_END else f"<{each.lead}>" for each in (one, other)
                )
                fixed = all(each.joint.GetPrim().IsA(UsdPhysics.FixedJoint) for each in (one, other))
                yield (
                    f"{other.joint.GetPath()}: {'fixed joints' if fixed else 'joints'} hold {names} together, of which "
                    "neither gives way; leave this one out, or give it a break_force (physics:breakForce)"
                )
                break


def led(stage: Usd.Stage) -> dict[Sdf.Path, Sdf.Path]:
    """Of each body that fixed joints hold to the world or to a kinematic body what leads it: it goes as that goes."""
    top = tops(stage)
    firm: dict[Sdf.Path, Sdf.Path] = {}
    for joint in _welds(stage):
        ends = joint_ends(joint)
        for lead, end in (ends, ends[::-1]):
            if is_lead(stage, lead) and not is_lead(stage, end):
                firm.setdefault(top.get(end, end), lead)
    welded = {end for joint in _welds(stage) for end in joint_ends(joint)}
    return {end: firm[top.get(end, end)] for end in welded if top.get(end, end) in firm}


def _welds(stage: Usd.Stage) -> list[UsdPhysics.Joint]:
    return [joint for joint in joints_of(stage) if joint.GetPrim().IsA(UsdPhysics.FixedJoint) and not may_break(joint)]


def is_lead(stage: Usd.Stage, path: Sdf.Path) -> bool:
    """Whether something goes its own way."""
    return bool(path == WORLD_END or is_kinematic(stage.GetPrimAtPath(path)))


def tops(stage: Usd.Stage) -> dict[Sdf.Path, Sdf.Path]:
    """Of each body that is fixed to others which joints move as well, the one that stands for them all."""
    top: dict[Sdf.Path, Sdf.Path] = {}
    for joint in _welds(stage):
        ends = joint_ends(joint)
        if not any(is_lead(stage, end) for end in ends):
            kept, gone = (top.setdefault(end, end) for end in ends)
            top = {path: kept if now == gone else now for path, now in top.items()}
    return top


def pieces(stage: Usd.Stage) -> dict[Sdf.Path, list[Hold]]:
    """What leads each rigid piece, by the body that stands for it."""
    top, firm = tops(stage), led(stage)
    found: dict[Sdf.Path, list[Hold]] = {}
    for joint in joints_of(stage):
        ends = joint_ends(joint)
        leads = [is_lead(stage, end) for end in ends]
        if not any(leads) and not joint.GetPrim().IsA(UsdPhysics.FixedJoint):
            leads = [end in firm for end in ends]  # what is fixed to something that leads, leads as well
            leads[1] &= not leads[0]
        if may_break(joint) or sum(leads) != 1:
            continue
        lead, body = ends if leads[0] else ends[::-1]
        points = points_of(joint, lead)
        if len(points):
            found.setdefault(top.get(body, body), []).append(Hold(joint, firm.get(lead, lead), points))
    return found


def points_of(joint: UsdPhysics.Joint, lead: Sdf.Path) -> Array:
    """The points that a joint holds to one of its ends [m], (points, 3); none of one that slides."""
    prim = joint.GetPrim()
    steps: list[tuple[float, float, float]]
    if prim.IsA(UsdPhysics.SphericalJoint):
        steps = [(0.0, 0.0, 0.0)]
    elif prim.IsA(UsdPhysics.RevoluteJoint):
        along = Gf.Vec3d(*(float(letter == prim.GetAttribute("physics:axis").Get()) for letter in "XYZ"))
        steps = [(0.0, 0.0, 0.0), tuple(along)]
    elif prim.IsA(UsdPhysics.FixedJoint):
        steps = [(0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0)]
    else:
        return np.zeros((0, 3))
    frame = _frame(joint, lead)
    return np.array([frame.Transform(Gf.Vec3d(*step)) for step in steps])


def _frame(joint: UsdPhysics.Joint, lead: Sdf.Path) -> Gf.Matrix4d:
    """A joint's frame at what leads, in the world."""
    stage = joint.GetPrim().GetStage()
    sides = (
        (joint.GetBody0Rel(), joint.GetLocalPos0Attr(), joint.GetLocalRot0Attr()),
        (joint.GetBody1Rel(), joint.GetLocalPos1Attr(), joint.GetLocalRot1Attr()),
    )
    held = [stage.GetPrimAtPath(side[0].GetTargets()[0]) if side[0].GetTargets() else None for side in sides]
    k = [body_above(prim) if prim else WORLD_END for prim in held].index(lead)
    _, place, turn = sides[k]
    frame = Gf.Matrix4d().SetRotate(Gf.Quatd(turn.Get())).SetTranslateOnly(Gf.Vec3d(place.Get()))
    return frame * rigid_frame(held[k]) if held[k] else frame


def _part(one: Hold, other: Hold, ways: dict[Sdf.Path, Way]) -> bool:
    """Whether points that one holds come nearer to those that the other does, or go away from them."""
    first, second = ways[one.lead], ways[other.lead]
    times = np.unique(np.concatenate([first.times, second.times]))
    apart = np.array([
        first.after(one.points, time)[:, None] - second.after(other.points, time)[None] for time in (0.0, *times)
    ])  # fmt: skip
    distances = np.linalg.norm(apart, axis=-1)
    return bool(np.abs(distances - distances[0]).max() > SHORTEST_PARTING)


class Way:
    """How something goes that no joint moves.

    Attributes:
        times: At which to look where it is [s].
    """

    def __init__(self, stage: Usd.Stage, path: Sdf.Path) -> None:
        self.times = np.zeros(0)
        self._curve: Curve | None = None
        self._velocity = self._spin = self._center = np.zeros(3)
        if path == WORLD_END:
            return
        prim = stage.GetPrimAtPath(path)
        frame, rigid = rigid_frame(prim), UsdPhysics.RigidBodyAPI(prim)
        self._place, self._turn = np.array(frame.ExtractTranslation()), np.array(turn_of(frame))
        if (keys := path_of(prim)) is not None:
            self._curve = curve_of(keys)
            spans = [np.linspace(*span, LOOKS, endpoint=False) for span in pairwise(keys.times)]
            self.times = np.array([*np.concatenate(spans), keys.times[-1]])
            self.times = self.times[self.times > 0.0]
            return
        self._velocity, spin = (
            np.array(frame.TransformDir(Gf.Vec3d(stated.Get() or Gf.Vec3f(0.0))))
            for stated in (rigid.GetVelocityAttr(), rigid.GetAngularVelocityAttr())
        )
        self._spin = np.radians(spin)
        rate = float(np.linalg.norm(self._spin))
        self.times = np.array(STRAIGHT) if self._velocity.any() else self.times
        if rate > 0.0:
            self._center = np.array(frame.Transform(Gf.Vec3d(*_center(prim))))
            self.times = np.append(self.times, np.linspace(0.0, 2.0 * math.pi / rate, LOOKS + 1)[1:])

    def after(self, points: Array, time: float) -> Array:
        """Where points on it, (points, 3) [m], have come to at a time [s]."""
        if self._curve is None:
            turned = rotate(exponential(self._spin * time), points - self._center)
            return np.asarray(self._center + turned + self._velocity * time)
        place, turn = self._curve.pose(time)
        return np.asarray(place + rotate(turn, rotate(conjugate(self._turn), points - self._place)))


def _center(prim: Usd.Prim) -> tuple[float, float, float]:
    """A body's centre of mass, in its axes [m]."""
    x, y, z = mass_at(prim).com
    return float(x), float(y), float(z)
