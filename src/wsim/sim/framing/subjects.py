"""What a run is about: the objects that its plan names, or else what moves, as points through time."""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import product
from typing import TYPE_CHECKING

import numpy as np

from wsim.geometry.rotations import rotate
from wsim.scene.labels import object_of, wholes
from wsim.sim.render_views import is_ground, outline, placed

if TYPE_CHECKING:
    from collections.abc import Sequence

    from wsim.scene.world import Body, Static, World
    from wsim.sim.framing.motion import Motion

Array = np.ndarray
MOST = 40  # objects of one sort that are looked at; of more, some
MOVES = 0.05  # of its size: what goes no farther stands still
# Weights of what is asked about, of what else moves, of what stands there, and of what could move and does not.
MAIN, BESIDE, STANDING, IDLE = 1.0, 0.25, 0.1, 0.0
ENDS = np.concatenate([np.eye(3), -np.eye(3)])
CORNERS = np.array(list(product((0.0, 1.0), repeat=3)))


@dataclass(frozen=True)
class Subject:
    """An object and the corners of the boxes round its parts.

    Attributes:
        prim: A child of the root.
        points: (F, n, 3) [m].
        parts: Prims of what it is made of, itself among them.
        weight: How much it matters that it is seen; those of all subjects sum up to about 1.
        main: Whether the run is about it.
        able: Whether it could move.
        asked: Whether it is named.
        body: Index of the body that a camera follows, which goes with it; None: it has none.
    """

    prim: str
    points: Array
    weight: float
    main: bool
    body: int | None = None
    parts: tuple[str, ...] = ()
    able: bool = True
    asked: bool = False

    @property
    def centre(self) -> Array:
        """(F, 3) [m]."""
        return np.asarray(0.5 * (self.points.min(axis=1) + self.points.max(axis=1)))

    @property
    def size(self) -> float:
        """Its longest edge, at the median of the times [m]."""
        return float(np.median(np.ptp(self.points, axis=1).max(axis=1)))

    @property
    def travel(self) -> float:
        """How far it gets from where it starts [m]."""
        return float(np.linalg.norm(self.centre - self.centre[0], axis=1).max())

    @property
    def moves(self) -> bool:
        """Whether it gets anywhere, or turns."""
        apart = np.linalg.norm(self.points - self.points[0], axis=2)
        return float(apart.max()) > MOVES * max(self.size, 1e-6)


def subjects(world: World, motion: Motion, named: Sequence[str] = ()) -> list[Subject]:
    """What is to be seen, the main ones first: what is named, what moves, what could, or what stands; never the ground.

    What those are tied to is as one of them, and so is the rope or the spring that ties it, from end to end.

    Args:
        world: What the stage states.
        motion: Of one frame or more.
        named: Names of the objects that are asked about.
    """
    whole = wholes(world)
    asked = {whole.get(prim, prim) for prim in (f"/World/{name}" for name in named)}
    bodies = _bodies(world, motion)
    fluids = [
        Subject(prim, _box_of(points), 0.0, False, parts=(prim,))
        for prim, points in motion.fluids.items()
        if points.shape[1]
    ]
    able = [*bodies, *fluids]
    movers = [each for each in able if each.moves]
    standing = _statics(world, len(motion.time))
    main = [each for each in able if each.prim in asked] or movers or able or standing
    tied = _tied(world, {each.prim for each in main})
    main += [each for each in (*able, *standing) if each.prim in tied]
    main += _cords(world, motion, {each.prim for each in main} | asked)
    mains = {each.prim for each in main}
    beside, around, idle = ([each for each in group if each.prim not in mains] for group in (movers, standing, able))
    idle = [each for each in idle if not each.moves]
    around = [replace(each, asked=each.prim in asked) for each in around]
    return [
        *_weighed(main, MAIN, True), *_weighed(beside, BESIDE, False), *_weighed(around, STANDING, False),
        *_weighed(idle, IDLE, False),
    ]  # fmt: skip


def alone(found: Sequence[Subject], one: Subject) -> list[Subject]:
    """The same subjects where one is all that a view is about."""
    return [
        replace(each, weight=MAIN if each.prim == one.prim else STANDING / len(found), main=each.prim == one.prim)
        for each in found
    ]


def _tied(world: World, prims: set[str]) -> set[str]:
    """What joints, springs and ropes tie objects to: it is seen with them, as what they hang from."""
    ties = [[guide.owner or guide.body for guide in cord.path] for cord in world.cords]
    ties += [[joint.child, joint.parent or joint.fixture] for joint in world.joints]
    whole = wholes(world)
    groups = [{whole.get(prim, prim) for prim in (object_of(owner) for owner in tie if owner)} for tie in ties]
    return {prim for group in groups if group & prims for prim in group - prims}


def _cords(world: World, motion: Motion, prims: set[str]) -> list[Subject]:
    """Springs and ropes that are asked about, or hold an object that is: what they are fixed to and run through."""
    rows, whole, found = {body.prim: k for k, body in enumerate(world.bodies)}, wholes(world), []
    for cord in world.cords:
        held = {object_of(owner) for guide in cord.path if (owner := guide.owner or guide.body)}
        if prims & {object_of(cord.prim), *held, *(whole.get(prim, prim) for prim in held)}:
            points = np.zeros((len(motion.time), len(cord.path), 3))
            for k, guide in enumerate(cord.path):
                place = np.array(guide.position)
                if guide.body is None:
                    points[:, k] = place
                else:
                    poses = motion.body_q[:, rows[guide.body]]
                    points[:, k] = poses[:, :3] + rotate(poses[:, 3:], place[None])
            prim = object_of(cord.prim)
            found.append(Subject(prim, points, 0.0, False, parts=(prim,), able=False))
    return found


def _weighed(found: list[Subject], weight: float, main: bool) -> list[Subject]:
    """Some of many, which share a weight; what stands still has half of what moves."""
    if len(found) > MOST:
        found = [found[k] for k in np.unique(np.linspace(0, len(found) - 1, MOST).astype(int))]
    shares = np.array([1.0 if each.moves else 0.5 for each in found])
    parts = weight * shares / max(shares.sum(), 1.0)
    return [replace(each, weight=float(part), main=main) for each, part in zip(found, parts, strict=True)]


def _bodies(world: World, motion: Motion) -> list[Subject]:
    """Each object that has bodies; the heaviest of them is followed."""
    parts: dict[str, list[int]] = {}
    whole = wholes(world)
    for k, body in enumerate(world.bodies):
        if body.shapes:
            parts.setdefault(whole[object_of(body.prim)], []).append(k)
    found = []
    for prim, rows in parts.items():
        points = np.concatenate([_moved(world.bodies[k], motion.body_q[:, k]) for k in rows], axis=1)
        heaviest = max(rows, key=lambda k: world.bodies[k].mass)
        names = tuple(dict.fromkeys(object_of(world.bodies[k].prim) for k in rows))
        found.append(Subject(prim, points, 0.0, False, heaviest, names))
    return found


def _moved(body: Body, poses: Array) -> Array:
    """Corners of a body's box through time, (F, 8, 3); of a ball, the ends of its diameters, (F, 6, 3)."""
    if len(body.shapes) == 1 and body.shapes[0].kind == "sphere":
        middle = poses[:, None, :3] + rotate(poses[:, None, 3:], np.array(body.shapes[0].position)[None, None])
        return np.asarray(middle + body.shapes[0].size[0] * ENDS)
    outlines = [placed(outline(shape), shape.position, shape.rotation) for shape in body.shapes]
    local = np.concatenate(outlines) if outlines else np.zeros((1, 3))
    corners = local.min(axis=0) + CORNERS * np.ptp(local, axis=0)
    return np.asarray(poses[:, None, :3] + rotate(poses[:, None, 3:], corners[None]))


def _statics(world: World, frames: int) -> list[Subject]:
    groups: dict[str, list[Static]] = {}
    for static in world.statics:
        groups.setdefault(object_of(static.prim), []).append(static)
    found = []
    for prim, members in groups.items():
        shapes = [shape for static in members for shape in static.shapes]
        if shapes and not any(is_ground(shape) for shape in shapes):
            local = np.concatenate([placed(outline(shape), shape.position, shape.rotation) for shape in shapes])
            corners = local.min(axis=0) + CORNERS * np.ptp(local, axis=0)
            found.append(Subject(prim, np.broadcast_to(corners, (frames, 8, 3)), 0.0, False, parts=(prim,), able=False))
    return found


def _box_of(points: Array) -> Array:
    """Corners of the boxes round most of a fluid's particles, (F, 8, 3): single drops are not followed."""
    low, high = (np.percentile(points, share, axis=1) for share in (3.0, 97.0))
    return np.asarray(low[:, None] + CORNERS * (high - low)[:, None])
