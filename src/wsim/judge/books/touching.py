"""Where the shapes of a world touch, or are about to, at any poses of its bodies: by their geometry alone.

MuJoCo's search for contacts is asked, in double precision and with none of the simulator's own contacts, so that it
serves the trajectories of any engine. Bodies are without mass there; nothing is stepped.
"""

from __future__ import annotations

from copy import copy
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from wsim.geometry.rotations import conjugate, multiply, rotate
from wsim.judge.books.flats import flats
from wsim.judge.books.meshes import NEAR, Triangles, colliding, radius_about, touching
from wsim.judge.books.searching import Search
from wsim.judge.evidence.scheduled import changes, fastest, roughest
from wsim.scene.contact import Pair, pair_law, passing

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from wsim.judge.evidence.evidence import Evidence
    from wsim.scene.world import Body, Joint, Shape, Static, World

    Floats = NDArray[np.float64]
    Bools = NDArray[np.bool_]
    Rows = NDArray[np.intp]

WORLD = -1  # row of what never moves


@dataclass(frozen=True)
class Contacts:
    """Pairs of points that are near each other, n of them."""

    one: Rows  # row of a body, or WORLD
    two: Rows
    shapes: Rows  # (n, 2), of `Touching.shapes`
    point: Floats  # (n, 3) [m], halfway
    normal: Floats  # (n, 3), from one to two
    gap: Floats  # (n,) [m], negative where they are in each other

    def __len__(self) -> int:
        return len(self.gap)

    def surface(self, side: int) -> Floats:
        """Where each touches the first body's surface or the second's (1), (n, 3) [m]: they meet with these points."""
        return np.asarray(self.point + ((side - 0.5) * self.gap)[:, None] * self.normal)

    def only(self, chosen: NDArray[Any]) -> Contacts:
        """Some of them."""
        return Contacts(*(getattr(self, name)[chosen] for name in ("one", "two", "shapes", "point", "normal", "gap")))


_ROWS, _POINTS = np.zeros(0, dtype=np.intp), np.zeros((0, 3))
_NO_PAIRS = np.full(1, -1), np.zeros((1, 3))  # but one that is none
NONE = Contacts(_ROWS, _ROWS, _ROWS.reshape(0, 2), _POINTS, _POINTS, np.zeros(0))


def together(parts: list[Contacts]) -> Contacts:
    """All contacts of several poses."""
    return Contacts(*(np.concatenate([getattr(part, name) for part in (NONE, *parts)])
                      for name in ("one", "two", "shapes", "point", "normal", "gap")))  # fmt: skip


class Touching:
    """The shapes of a world that collide: what MuJoCo finds between those of its own kinds, and meshes' triangles."""

    @staticmethod
    def of(evidence: Evidence) -> Touching:
        """Of a recording's world, made once for all who ask."""
        if Touching not in evidence.kept:
            evidence.kept[Touching] = Touching(evidence.world)
        kept = evidence.kept[Touching]
        assert isinstance(kept, Touching)
        return kept

    def __init__(self, world: World) -> None:
        self.world = world
        self.worlds = [world]
        self.parts: list[Touching] = []  # one of each world, where they are joined
        self.shapes: list[tuple[int, str, Shape]] = []  # row of the body, prim of the owner, shape
        self._pairs, self._numbers = _NO_PAIRS  # of shapes that were asked for, in order, and their laws
        self._meshes: dict[int, Triangles] = {}
        items: list[tuple[int, Body | Static]] = [*enumerate(world.bodies), *((WORLD, each) for each in world.statics)]
        for row, item in items:
            for shape in item.shapes:
                self._add(row, item.prim, shape)

    @cached_property
    def _searches(self) -> list[Search]:
        """For contacts in each world: one of its own, or that of another, of other sizes."""
        first, others = (self.parts or [self])[0]._search, self.parts[1:]
        return [first, *(first.resized(part.shapes) or part._search for part in others)]

    @cached_property
    def _search(self) -> Search:
        """For contacts in the one world that this is of."""
        return Search(len(self.world.bodies), self.shapes, self._meshes)

    @staticmethod
    def join(parts: Sequence[Touching]) -> Touching:
        """That of several worlds whose shapes are alike but in their sizes, places and laws.

        Shapes are counted on from world to world, S in each.
        """
        joined = copy(parts[0])
        joined._meet, joined._flat = parts[0]._meet, parts[0]._flat  # of the kinds alone
        joined.parts = list(parts)
        joined.worlds = [world for part in parts for world in part.worlds]
        joined.shapes = [shape for part in parts for shape in part.shapes]
        joined._pairs, joined._numbers = _NO_PAIRS
        for name in ("_margin", "_row_of_shape", "_radii", "_own", "surface_velocity", "changing", "_searches"):
            joined.__dict__.pop(name, None)
        return joined

    def like(self, other: Touching) -> bool:
        """Whether both can be joined: their shapes are of the same kinds, on the same bodies, and none is a mesh."""
        kinds, others = ([(row, shape.kind) for row, _, shape in each.shapes] for each in (self, other))
        return kinds == others and not self._meshes and np.array_equal(self._meet, other._meet)

    @cached_property
    def _margin(self) -> Floats:
        """Of each shape [m], (shapes,)."""
        return np.array([shape.margin for _, _, shape in self.shapes], dtype=np.float64)

    @cached_property
    def _row_of_shape(self) -> Rows:
        return np.array([row for row, _, _ in self.shapes], dtype=np.intp)

    @cached_property
    def _radii(self) -> Floats:
        """Of the balls about shapes that they are in [m], (shapes,)."""
        meshes = self._meshes
        return np.array([
            meshes[k].radius if k in meshes else radius_about(shape) for k, (_, _, shape) in enumerate(self.shapes)
        ])  # fmt: skip

    @cached_property
    def _own(self) -> Floats:
        """Where each shape is on its body, (shapes, 7)."""
        return np.array([(*shape.position, *shape.rotation) for _, _, shape in self.shapes]).reshape(-1, 7)

    def _add(self, row: int, owner: str, shape: Shape) -> None:
        if not shape.collides:
            return
        for piece in colliding(shape) if shape.kind == "mesh" else [shape]:
            if shape.kind == "mesh":
                self._meshes[len(self.shapes)] = Triangles(piece)
            self.shapes.append((row, owner, piece))

    def at(self, poses: Floats, reach: float, about: Sequence[int] | None = None) -> Contacts:
        """Contacts at poses (B, 7) [m; xyzw] whose gap is at most `reach` [m]; those of the bodies `about` alone."""
        chosen = None if about is None else np.isin(np.arange(len(poses)), about)[None]
        return self.of_many(poses[None], np.array([reach]), np.zeros(1, dtype=np.intp), about=chosen)

    def of_many(
        self, poses: Floats, reach: Floats, rows: Rows, worlds: Rows | None = None, about: Bools | None = None
    ) -> Contacts:
        """Contacts at several poses.

        Args:
            poses: (K, B, 7).
            reach: Of each pose, (K,) [m]; or of each body and the world, of which two have the sum, (K, B + 1).
            rows: A body's row is that of these by B, (K,).
            worlds: Which of the joined worlds each is a pose of, (K,); None: all of the first.
            about: Bodies, (K, B); contacts that none of them has are left out.
        """
        which = np.zeros(len(poses), dtype=np.intp) if worlds is None or len(self.worlds) == 1 else worlds
        if reach.ndim == 1:
            reach = np.repeat(0.5 * reach[:, None], poses.shape[1] + 1, axis=1)
        shapes, place, normal, gap, at = self._found(poses, reach, which, about)
        one, two = self._row_of_shape[shapes].T
        contacts = Contacts(one, two, shapes, place, normal, gap - self._margin[shapes].sum(axis=1))
        if self._meshes or self._flat:
            both = zip(poses, reach, strict=True) if self._meshes else ()
            others = [self._on_meshes(each, 2.0 * float(far.max())) for each, far in both]
            further, of = self._flats(shapes, normal, at, poses)
            near = further.gap <= reach[of, further.one] + reach[of, further.two]
            at = np.concatenate([at, np.repeat(np.arange(len(others)), [len(other) for other in others]), of[near]])
            order = np.argsort(at, kind="stable")  # what is of one pose stays together
            contacts, at = together([contacts, *others, further.only(near)]).only(order), at[order]
            if about is not None and self._meshes:
                ours = np.pad(about, ((0, 0), (0, 1)))
                chosen = np.flatnonzero(ours[at, contacts.one] | ours[at, contacts.two])
                contacts, at = contacts.only(chosen), at[chosen]
        by = rows[at] * poses.shape[1]
        one, two = (np.where(row >= 0, row + by, row) for row in (contacts.one, contacts.two))
        contacts = replace(contacts, one=one, two=two)
        if self._meet.all():
            return contacts
        own = contacts.shapes % len(self._meet)
        return contacts.only(self._meet[own[:, 0], own[:, 1]])

    def _found(
        self, poses: Floats, reach: Floats, worlds: Rows, about: Bools | None = None
    ) -> tuple[Rows, Floats, Floats, Floats, Rows]:
        """What MuJoCo finds at poses (K, B, 7): shapes (n, 2), points and normals (n, 3), gaps, and at which pose."""
        qpos = poses[..., [0, 1, 2, 6, 3, 4, 5]].reshape(len(poses), -1)
        margins = self._margin.reshape(len(self.worlds), -1)
        of_geom = self._searches[0].shape_of_geom
        body = self._row_of_shape[of_geom]  # of each geom; the world's is the last
        asked = np.pad(np.ones(poses.shape[:2], dtype=bool) if about is None else about, ((0, 0), (0, 1)))
        by_geom = reach[:, body] + margins[worlds][:, of_geom], asked[:, body]
        by_body = np.roll(reach, 1, axis=1) + margins.max(axis=1, initial=0.0)[worlds, None], np.roll(asked, 1, axis=1)
        geoms, places, frames, gaps = [NONE.shapes], [_POINTS], [np.zeros((0, 9))], [NONE.gap]
        counts, searches = np.zeros(len(poses), dtype=np.intp), self._searches
        for k, (pose, world, *each) in enumerate(zip(qpos, worlds.tolist(), *by_geom, *by_body, strict=True)):
            found = searches[world].at(pose, *each)
            counts[k] = len(found)
            if not counts[k]:
                continue
            geoms.append(np.array(found.geom).reshape(-1, 2))
            places.append(np.array(found.pos).reshape(-1, 3))
            frames.append(np.array(found.frame).reshape(-1, 9))
            gaps.append(np.array(found.dist).reshape(-1))
        at = np.repeat(np.arange(len(poses)), counts)
        shapes = of_geom[np.concatenate(geoms)] + (worlds[at] * margins.shape[1])[:, None]
        return shapes, np.concatenate(places), np.concatenate(frames)[:, :3], np.concatenate(gaps), at

    def near(self, poses: Floats, worlds: Rows) -> Bools:
        """Whether two bodies are near each other, (K, B, B), at poses (K, B, 7), each of one of the joined worlds."""
        reach = np.full((len(poses), poses.shape[1] + 1), 0.5 * NEAR)
        which = worlds if len(self.worlds) > 1 else np.zeros_like(worlds)
        shapes, *_, at = self._found(poses, reach, which)
        own = shapes % len(self._meet)
        one, two = self._row_of_shape[shapes].T
        meet = self._meet[own[:, 0], own[:, 1]] & (one >= 0) & (two >= 0)
        pairs = [(at[meet], one[meet], two[meet])]
        for k, pose in enumerate(poses if self._meshes else ()):
            contacts = self._on_meshes(pose, NEAR)
            both = np.flatnonzero((contacts.one >= 0) & (contacts.two >= 0))
            pairs.append((np.full(len(both), k), contacts.one[both], contacts.two[both]))
        found = np.zeros((len(poses), poses.shape[1], poses.shape[1]), dtype=bool)
        for each, a, b in pairs:
            found[each, a, b] = found[each, b, a] = True
        return found

    def deepest(self, poses: Floats) -> Floats:
        """How deep shapes are in each other at most at each of several poses (K, B, 7), meshes aside, (K,) [m]."""
        every = np.zeros(len(poses), dtype=np.intp)
        shapes, _, _, gap, at = self._found(poses, np.zeros((len(poses), poses.shape[1] + 1)), every)
        found, meet = np.zeros(len(poses)), self._meet[shapes[:, 0], shapes[:, 1]]
        np.maximum.at(found, at[meet], -gap[meet])
        return found

    @property
    def triangles(self) -> bool:
        """Whether any shape is a mesh."""
        return bool(self._meshes)

    @cached_property
    def _meet(self) -> NDArray[np.bool_]:
        """Whether two shapes may touch at all: not where a joint ties their objects, or they are made to pass.

        Nor where neither gives way: what is kinematic goes as it is told, through all that is so too or stands still.
        """
        tied, passes = _tied(self.world), passing(self.world)
        named = [(owner, shape.prim) for _, owner, shape in self.shapes]
        meet = [[frozenset((a[0], b[0])) not in tied and not passes(a, b) for b in named] for a in named]
        yields = np.array([row >= 0 and not self.world.bodies[row].kinematic for row, _, _ in self.shapes], dtype=bool)
        both = np.array(meet, dtype=bool).reshape(len(named), len(named))
        return both & (yields[:, None] | yields[None, :])

    @cached_property
    def _flat(self) -> bool:
        """Whether there are solids with flat or straight sides beside others."""
        kinds = [shape.kind for _, _, shape in self.shapes]
        return "cylinder" in kinds or kinds.count("box") > 1 or kinds.count("capsule") > 1

    def _flats(self, pairs: Rows, normal: Floats, at: Rows, poses: Floats) -> tuple[Contacts, Rows]:
        """Further points of what is flat among contacts, each at one of several poses; and at which these are."""
        if not self._flat:
            return NONE, NONE.one
        places = self._placed(pairs, poses, at[:, None])
        further = flats(pairs, normal, at, [shape for _, _, shape in self.shapes], places)
        shapes = pairs[further.of]
        gap = further.gap - self._margin[shapes].sum(axis=1)
        one, two = self._row_of_shape[shapes].T
        return Contacts(one, two, shapes, further.point, further.normal, gap), at[further.of]

    def _on_meshes(self, poses: Floats, reach: float) -> Contacts:
        """Contacts of all shapes with all meshes of other bodies at poses (B, 7); of two meshes, with both's faces."""
        if not self._meshes:
            return NONE
        places = self._placed(np.arange(len(self.shapes)), poses)
        found = []
        for m, mesh in self._meshes.items():
            row, pose = self.shapes[m][0], places[m]
            apart = rotate(conjugate(pose[3:]), places[:, :3] - pose[:3])
            may = self._meet[m] & (self._row_of_shape != row) & (mesh.beyond(apart) <= self._radii + reach)
            for k in np.flatnonzero(may).tolist():
                other, _, shape = self.shapes[k]
                local = np.concatenate([apart[k], multiply(conjugate(pose[3:]), places[k][3:])])
                near = touching(mesh, shape, self._meshes.get(k), local, reach)
                if near is None or not len(near.gap):
                    continue
                count = len(near.gap)
                point, normal = rotate(pose[3:], near.point) + pose[:3], rotate(pose[3:], near.normal)
                rows = np.full(count, row, dtype=np.intp), np.full(count, other, dtype=np.intp)
                found.append(Contacts(*rows, np.tile([m, k], (count, 1)), point, normal, near.gap))
        return together(found)

    def _placed(self, shapes: Rows, poses: Floats, at: Rows | None = None) -> Floats:
        """Where shapes (...) are in the world, (..., 7), at poses (B, 7), or each `at` one of several (K, B, 7)."""
        own, rows = self._own[shapes], self._row_of_shape[shapes]
        if not poses.shape[-2]:
            return own
        body = np.maximum(rows, 0)
        q = poses[body] if at is None else poses[at, body]
        place = q[..., :3] + rotate(q[..., 3:], own[..., :3])
        moved = np.concatenate([place, multiply(q[..., 3:], own[..., 3:])], axis=-1)
        return np.where((rows >= 0)[..., None], moved, own)

    def laws(self, shapes: Rows) -> tuple[Floats, Floats]:
        """Friction and rolling resistance of pairs of shapes (n, 2), (n,) each."""
        found = self._of_pairs(shapes)
        return found[:, 0], found[:, 1]

    def bounces(self, shapes: Rows) -> Floats:
        """Restitution of pairs of shapes (n, 2), (n,)."""
        return self._of_pairs(shapes)[:, 2]

    def _of_pairs(self, shapes: Rows) -> Floats:
        """Friction, rolling resistance and restitution of pairs (n, 2), (n, 3): each pair's looked up once."""
        count = max(len(self.shapes), 1)
        asked = shapes @ [count, 1]
        at = np.searchsorted(self._pairs, asked)
        if len(asked) and not np.array_equal(self._pairs.take(at, mode="clip"), asked):
            new = np.setdiff1d(asked, self._pairs)
            laws = [self._law(int(pair) // count, int(pair) % count) for pair in new]
            own = np.array([(law.friction, law.rolling, law.restitution) for law in laws])
            where = np.searchsorted(self._pairs, new)
            self._pairs, self._numbers = (
                np.insert(self._pairs, where, new),
                np.insert(self._numbers, where, own, axis=0),
            )
            at = np.searchsorted(self._pairs, asked)
        return self._numbers[at]

    def _law(self, one: int, two: int) -> Pair:
        world, shapes = self._world_of(one), (self.shapes[one][2], self.shapes[two][2])
        law = pair_law(world, *shapes)
        return replace(law, friction=roughest(world, *shapes, law.friction)) if world.schedules else law

    @cached_property
    def surface_velocity(self) -> Floats:
        """Of each shape [m/s], in its body's axes, (shapes, 3)."""
        stated = [fastest(self._world_of(k), shape) for k, (_, _, shape) in enumerate(self.shapes)]
        return np.array(stated, dtype=np.float64).reshape(-1, 3)

    @cached_property
    def changing(self) -> NDArray[np.bool_]:
        """Whether a schedule changes how each shape's surface runs or rubs, (shapes,)."""
        return np.array([changes(self._world_of(k), shape) for k, (_, _, shape) in enumerate(self.shapes)], dtype=bool)

    def _world_of(self, k: int) -> World:
        """The world that a shape is in."""
        return self.worlds[k // max(len(self.shapes) // len(self.worlds), 1)]


def touching_of(copies: Sequence[Evidence]) -> Touching:
    """The shapes of several recordings' worlds: those of one world, or joined."""
    every = [Touching.of(evidence) for evidence in copies]
    if all(each is every[0] for each in every):
        return every[0]
    joined = copies[0].kept.get(touching_of)
    if not isinstance(joined, Touching) or joined.parts != every:
        joined = copies[0].kept[touching_of] = Touching.join(every)
    return joined


def _tied(world: World) -> set[frozenset[str]]:
    """Pairs of objects that a joint ties, which do not touch."""
    return {frozenset((end, joint.child)) for joint in world.joints if (end := _other_end(joint)) is not None}


def _other_end(joint: Joint) -> str | None:
    return joint.parent or joint.fixture
