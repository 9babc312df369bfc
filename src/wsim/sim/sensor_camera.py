"""Cameras that are sensors: what the renderer draws from a body, as numbers."""

from __future__ import annotations

import copy
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import newton
import numpy as np
import warp as wp
from numpy.typing import NDArray

from wsim.scene.following import view_of
from wsim.scene.labels import labels_of, object_of
from wsim.scene.world import World
from wsim.sim.cameras import CameraImage, CameraRenderer
from wsim.sim.joint_arrays import in_every_world

if TYPE_CHECKING:
    from wsim.sim.model import Built


class Camera:
    """Reads one sensor in W worlds.

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
        self._built = built
        sensor: Any = built.world.sensors[k]
        self._tells: list[str] = list(sensor.tells)
        worlds = max(1, built.model.world_count)
        model = _seen(built, sensor.body)
        self._farthest = [built.world_of(w).sensors[k].farthest for w in range(worlds)]  # type: ignore[union-attr]
        self._renderers = [
            CameraRenderer(model, _from_sensor(built.world_of(w), k), world_index=w) for w in range(worlds)
        ]
        labels = {prim: number for number, prim in enumerate(labels_of(built.world))}
        numbers = [labels.get(object_of(_own(prim)), 0) for prim in self._renderers[0].shape_prims]
        self._number = np.array([*numbers, 0], dtype=np.int32)  # the last one, -1, is nothing

    def __call__(self, t: float, simulation: Any) -> dict[str, NDArray[Any]]:
        """Of each pixel `color` [sRGB] (W, H, W, 3) uint8, `depth` [m] and `segmentation` (W, H, W), as it tells."""
        state, fluids = simulation.state, self._built.fluids
        points = state.particle_q.numpy() if fluids[0] else np.zeros((0, 3))
        images = [
            next(iter(renderer.render(state, {prim: points[part] for prim, part in fluids[w].items()}).values()))
            for w, renderer in enumerate(self._renderers)
        ]
        return {name: np.stack([self._told(name, image, w) for w, image in enumerate(images)]) for name in self._tells}

    def _told(self, name: str, image: CameraImage, w: int) -> NDArray[Any]:
        if name == "color":
            return image.rgb
        if name == "segmentation":
            found: NDArray[np.int32] = self._number[image.shape_index]
            return found
        met = (image.shape_index >= 0) & (image.depth <= self._farthest[w])
        return np.where(met, image.depth, np.float32(np.inf)).astype(np.float32)


def _own(label: str) -> str:
    """A shape's prim; in a batch there is something before it."""
    return label[max(label.find("/World/"), 0) :]


def _from_sensor(world: World, k: int) -> World:
    """The world, seen by its sensor k alone: a camera that is fixed to the sensor's body."""
    sensor: Any = world.sensors[k]
    return world.model_copy(update={"cameras": [view_of(sensor, world)]})


def _seen(built: Built, body: str | None) -> Any:
    """The model as the sensor sees it: without what carries it, and with shapes of its own to refit.

    Those of the model itself follow what is filmed, which may be a frame behind, in a thread of its own.
    """
    model = built.model
    seen = copy.copy(model)
    if not model.shape_count:
        return seen
    flags = model.shape_flags.numpy().copy()
    if body is not None:
        row = [each.prim for each in built.world.bodies].index(body)
        carriers = in_every_world(built.bodies[[row]], max(1, model.world_count), model.body_count)
        flags[np.isin(model.shape_body.numpy(), carriers)] &= ~int(newton.ShapeFlags.VISIBLE)
    seen.shape_flags = wp.array(flags, dtype=int, device=model.device)
    seen.shape_transform, seen.shape_scale = wp.clone(model.shape_transform), wp.clone(model.shape_scale)
    seen.bvh_build_shapes(model.state())
    return seen
