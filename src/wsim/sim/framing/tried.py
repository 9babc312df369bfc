"""Views that may show a run's subjects: from all round and above, of all their way or of a part, or going along."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

import numpy as np

from wsim.sim.framing.rooms import before_walls
from wsim.sim.render_views import fitted, is_ground

if TYPE_CHECKING:
    from wsim.scene.world import Camera, World
    from wsim.sim.framing.shown import Scenario

Array = np.ndarray
AZIMUTHS, ELEVATIONS = 12, (14.0, 30.0, 55.0)  # how many; [deg]
STEEP = 75.0  # [deg], of the last resort, over walls
ROOM = 0.35  # of the largest subject's edge, that is left round what is framed
ROOM_ALONG = 1.5  # likewise, where the camera goes along
FAR = 3.0  # of its size: what gets farther may be followed
CONTEXT = 2.5  # times what moves: what stands there and is no larger is framed with it
LEAST_HEIGHT = 0.05  # of its distance, that a camera is above the ground


def views(camera: Camera, scenario: Scenario, around: Array, steep: bool = False) -> Iterator[Camera]:
    """From all sides.

    Args:
        camera: Whose lens and picture they have.
        scenario: What is to be seen.
        around: (F,) frames about which something happens.
        steep: Also from high above, over walls.
    """
    yield from _from(camera, scenario, around, _sides(scenario, steep))


def views_from_there(camera: Camera, scenario: Scenario, around: Array) -> Iterator[Camera]:
    """From the side where a camera stands."""
    yield from _from(camera, scenario, around, [_side_of(camera)])


def views_of_all(camera: Camera, scenario: Scenario) -> Iterator[Camera]:
    """Of all the way, with the ground below it and what stands there: where the camera stands first, and all round."""
    whole, *_ = _stretches(scenario, np.zeros(len(scenario.weight), dtype=bool))
    low, high = _bounds([whole])
    ground = ground_of(scenario.world)
    if ground < low[2] <= ground + float((high - low).max()):
        low[2] = ground
    around = [each.points for each in scenario.subjects if not each.main]
    near = [points for points in around if _near(points, low, high)]
    framed = _corners(*_bounds([_corners(low, high), *near]))
    for azimuth, elevation in [_side_of(camera), *_sides(scenario, steep=True)]:
        for points in (_corners(low, high), framed):
            view = fitted(points, azimuth, elevation, camera)
            for each in (view, *before_walls(view, points, scenario.walls)):
                if _above(each, ground, elevation):
                    yield each


def _side_of(camera: Camera) -> tuple[float, float]:
    """Azimuth and elevation of the side where a camera stands [deg]."""
    back = np.subtract(camera.eye, camera.target)
    level = math.hypot(back[0], back[1])
    azimuth = math.degrees(math.atan2(back[1], back[0])) if level > 1e-9 else -90.0
    return azimuth, math.degrees(math.atan2(back[2], level))


def _sides(scenario: Scenario, steep: bool) -> list[tuple[float, float]]:
    """Azimuth and elevation of each [deg], all round, and of a few from high above."""
    ahead = _facing(scenario)
    sides = [(ahead + 360.0 * k / AZIMUTHS, up) for k in range(AZIMUTHS) for up in ELEVATIONS]
    return [*sides, *((ahead + 90.0 * k, STEEP) for k in range(4 if steep else 0))]


def _above(view: Camera, ground: float, elevation: float) -> bool:
    """Whether a camera stands clear of the ground, or is to look up from where it is."""
    return view.eye[2] >= ground + LEAST_HEIGHT * math.dist(view.eye, view.target) or elevation < 0.0


def _from(camera: Camera, scenario: Scenario, around: Array, sides: Sequence[tuple[float, float]]) -> Iterator[Camera]:
    ground = ground_of(scenario.world)
    framed = list(_stretches(scenario, around))
    for azimuth, elevation in sides:
        stands = [fitted(points, azimuth, elevation, camera) for points in framed]
        within = [
            v for view, points in zip(stands, framed, strict=True) for v in before_walls(view, points, scenario.walls)
        ]
        goes = [
            fitted(points, azimuth, elevation, camera).model_copy(update={"follows": prim})
            for prim, points in _followed(scenario)
            if elevation < STEEP
        ]
        yield from (view for view in (*stands, *within, *goes) if _above(view, ground, elevation))


def _stretches(scenario: Scenario, around: Array) -> Iterator[Array]:
    """Points to frame, (n, 3): of the whole run, of when something happens, of its first third."""
    main = [each for each in scenario.subjects if each.main]
    room = ROOM * float(np.median([each.size for each in main if each.able] or [each.size for each in main]))
    frames = len(scenario.weight)
    parts = [np.ones(frames, dtype=bool), around, np.arange(frames) <= frames // 3]
    told: list[bytes] = []
    for part in parts:
        if part.any() and part.tobytes() not in told:
            told.append(part.tobytes())
            low, high = _bounds([each.points[part] for each in main])
            yield _corners(low - room, high + room)
            more = [each.points[part] for each in scenario.subjects if not each.main]
            near = [points for points in more if _near(points, low, high)]
            if near:
                low, high = _bounds([_corners(low - room, high + room), *near])
                yield _corners(low, high)


def _near(points: Array, low: Array, high: Array) -> bool:
    """Whether other things, framed too, leave what is between two corners at a useful size."""
    first, last = _bounds([points, np.array([low, high])])
    return float(np.linalg.norm(last - first)) <= CONTEXT * max(float(np.linalg.norm(high - low)), 1e-9)


def _followed(scenario: Scenario) -> Iterator[tuple[str, Array]]:
    """Bodies that go far, and what is to be in frame about them as they start, (n, 3) [m]."""
    far = [each for each in scenario.subjects if each.main and each.body is not None]
    far = [each for each in far if each.travel > FAR * each.size]
    for subject in sorted(far, key=lambda each: -each.travel)[:2]:
        assert subject.body is not None
        place = scenario.motion.body_q[:, subject.body, :3]
        points = subject.points - place[:, None] + place[0]
        low, high = _bounds([points])
        room = ROOM_ALONG * subject.size
        yield scenario.world.bodies[subject.body].prim, _corners(low - room, high + room)


def _facing(scenario: Scenario) -> float:
    """Azimuth [deg] across the main motion, on the side nearest to -Y: there +X is to the right in the picture."""
    spread = np.zeros((2, 2))
    for subject in scenario.subjects:
        if subject.main:
            way = subject.centre[:, :2] - subject.centre[:, :2].mean(axis=0)
            spread += subject.weight * (way.T @ way) / max(subject.size, 1e-9) ** 2
    values, axes = np.linalg.eigh(spread)
    if values[1] < 1e-6 or values[0] > 0.5 * values[1]:
        return -90.0
    across = axes[:, 0] if axes[1, 0] <= 0.0 else -axes[:, 0]
    return math.degrees(math.atan2(across[1], across[0]))


def ground_of(world: World) -> float:
    """Height of the ground, below which no camera stands [m]."""
    tops = []
    for static in world.statics:
        for shape in static.shapes:
            if is_ground(shape):
                tops.append(shape.position[2] + (0.5 * shape.size[2] if shape.kind == "box" else 0.0))
    return max(tops, default=-math.inf)


def _bounds(parts: Sequence[Array]) -> tuple[Array, Array]:
    points = np.concatenate([part.reshape(-1, 3) for part in parts])
    return points.min(axis=0), points.max(axis=0)


def _corners(low: Array, high: Array) -> Array:
    return np.array([[(low, high)[k >> axis & 1][axis] for axis in range(3)] for k in range(8)])
