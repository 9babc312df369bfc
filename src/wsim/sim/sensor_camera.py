"""Cameras that are sensors: what the renderer draws from a body, as numbers."""

from __future__ import annotations

import copy
import math
from collections.abc import Sequence
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
import warp as wp
from numpy.typing import NDArray

from wsim.scene.following import view_of
from wsim.scene.labels import labels_of, object_of
from wsim.scene.world import Camera as View
from wsim.scene.world import World
from wsim.sim import render_materials
from wsim.sim.cameras import REACH, CameraImage, CameraRenderer
from wsim.sim.joint_arrays import in_every_world
from wsim.sim.openings import seen_particles
from wsim.sim.render_views import vertical_fov

if TYPE_CHECKING:
    from wsim.sim.model import Built

LOST = 1e9  # [m]: from there on single precision places nothing


class Camera:
    """Reads one sensor in W worlds. Of several worlds it does not see springs and ropes: their models draw none.

    Args:
        built: The model.
        k: Which of the world's sensors it is.
        interval: Between samples [s].
        seeds: What each world's noise differs by; it has none.

    Attributes:
        spans: Whether a sample tells of the time before it.
    """

    spans = False

    def __init__(self, built: Built, k: int, interval: float, seeds: Sequence[int]) -> None:
        self._built, self._k = built, k
        sensor: Any = built.world.sensors[k]
        self._tells: list[str] = list(sensor.tells)
        self._worlds = max(1, built.model.world_count)
        self._farthest = [built.world_of(w).sensors[k].farthest for w in range(self._worlds)]  # type: ignore[union-attr]
        labels = {prim: number for number, prim in enumerate(labels_of(built.world))}
        numbers = [labels.get(object_of(str(label)), 0) for label in built.model.shape_label]
        self._number = np.array([*numbers, 0], dtype=np.int32)  # the last one, -1, is nothing

    def prepare(self) -> None:
        """Make what draws, which takes some time, before the first picture."""
        _ = self._renderers

    @cached_property
    def _renderers(self) -> list[CameraRenderer]:
        model, looks = _seen(self._built, self._built.world.sensors[self._k].body)  # type: ignore[union-attr]
        worlds = [_from_sensor(self._built.world_of(w), self._k) for w in range(self._worlds)]
        reach = max(map(_reach, (world.cameras[0] for world in worlds), self._farthest))
        return [
            CameraRenderer(model, world, world_index=w, looks=looks[w], reach=reach) for w, world in enumerate(worlds)
        ]

    def __call__(self, t: float, simulation: Any) -> dict[str, NDArray[Any]]:
        """Of each pixel `color` [sRGB] (W, H, W, 3) uint8, `depth` [m] and `segmentation` (W, H, W), as it tells.

        A world that has lost a body has no picture: it is black, infinitely deep, and of nothing.
        """
        state, fluids = simulation.state, self._built.fluids
        points = seen_particles(simulation.model, state) if fluids[0] else np.zeros((0, 3))
        lost, images = self._lost(state), []
        for w, renderer in enumerate(self._renderers):
            if lost[w]:
                images.append(_nothing(renderer.cameras[0]))
            else:
                placed = {prim: points[part] for prim, part in fluids[w].items()}
                images.append(next(iter(renderer.render(state, placed).values())))
        return {name: np.stack([self._told(name, image, w) for w, image in enumerate(images)]) for name in self._tells}

    def _lost(self, state: Any) -> NDArray[np.bool_]:
        """Which worlds have bodies whose poses are no numbers, or too large for any (W,)."""
        if not self._built.model.body_count:
            return np.zeros(self._worlds, dtype=bool)
        broken = ~(np.abs(state.body_q.numpy()) < LOST).all(axis=1)  # of what is no number as well
        of = self._built.model.body_world.numpy()[broken]
        return np.isin(np.arange(self._worlds), of) | (-1 in of)

    def _told(self, name: str, image: CameraImage, w: int) -> NDArray[Any]:
        if name == "color":
            return image.rgb
        if name == "segmentation":
            found: NDArray[np.int32] = self._number[image.shape_index]
            return found
        met = (image.shape_index >= 0) & (image.depth <= self._farthest[w])
        return np.where(met, image.depth, np.float32(np.inf)).astype(np.float32)


def _nothing(camera: View) -> CameraImage:
    size = camera.height, camera.width
    return CameraImage(np.zeros((*size, 3), np.uint8), np.full(size, -1, np.int32), np.zeros(size, np.float32))


def _reach(camera: View, farthest: float) -> float:
    """How far a ray must go to be `farthest` deep in the picture's corner [m], in round numbers: each is compiled."""
    slopes = (math.tan(angle / 2.0) for angle in (math.radians(camera.fov), vertical_fov(camera)))
    along = farthest * math.hypot(1.0, *slopes)
    return max(REACH, 10.0 ** math.ceil(math.log10(along)))


def _from_sensor(world: World, k: int) -> World:
    """The world, seen by its sensor k alone: a camera that is fixed to the sensor's body."""
    sensor: Any = world.sensors[k]
    return world.model_copy(update={"cameras": [view_of(sensor, world)]})


def _seen(built: Built, body: str | None) -> tuple[Any, list[render_materials.ShapeLooks]]:
    """The model as the sensor sees it, without what carries it, and what it looks like in each world.

    Its colours and its hierarchy of shapes, which lacks the glass of all worlds, are its own. Those of the model itself
    follow what is filmed, which may be a frame behind, in a thread of its own.
    """
    model = built.model
    seen, worlds = copy.copy(model), max(1, model.world_count)
    if not model.shape_count:
        return seen, [render_materials.shape_looks(seen, built.world_of(w), w) for w in range(worlds)]
    flags = model.shape_flags.numpy()
    if body is not None:
        row = [each.prim for each in built.world.bodies].index(body)
        carriers = in_every_world(built.bodies[[row]], worlds, model.body_count)
        flags = render_materials.without(flags, np.isin(model.shape_body.numpy(), carriers))
    seen.shape_flags = wp.array(flags, dtype=int, device=model.device)
    looks = [render_materials.shape_looks(seen, built.world_of(w), w) for w in range(worlds)]
    seen.shape_color = wp.clone(model.shape_color)
    render_materials.paint(seen, looks)
    seen.shape_flags.assign(render_materials.without(flags, [index for each in looks for index in each.hidden]))
    seen.shape_transform, seen.shape_scale = wp.clone(model.shape_transform), wp.clone(model.shape_scale)
    seen.bvh_build_shapes(model.state())
    return seen, looks
