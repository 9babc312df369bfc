"""What hides what in a view, counted in small pictures of it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from wsim.scene.labels import object_of
from wsim.sim.framing.shown import IN
from wsim.sim.render_materials import OPAQUE
from wsim.sim.seen import ObjectPixels

if TYPE_CHECKING:
    from wsim.scene.world import Body, Camera, Static
    from wsim.sim.cameras import CameraRenderer
    from wsim.sim.framing.shown import Scenario, Shown
    from wsim.sim.model import Built

Array = np.ndarray
WIDTH = 160  # [px] of the pictures
TIMES = 6  # that are looked at
FILLS = 0.12  # of the box round it in the picture, that an object which nothing hides fills at least


class Hidden:
    """Draws small pictures of views, and counts the pixels of their subjects.

    Args:
        renderer: Of the model.
        built: The model, whose bodies stand where the motion has them.
    """

    def __init__(self, renderer: CameraRenderer, built: Built) -> None:
        self._renderer, self._built = renderer, built
        self._state: Any = built.model.state()
        self._objects = ObjectPixels(renderer.shape_prims)
        world = built.world
        owners: list[Body | Static] = [*world.bodies, *world.statics]
        self._opaque = {object_of(each.prim) for each in owners if each.shapes}
        self._opaque -= {object_of(each.prim) for each in owners for s in each.shapes if s.opacity < OPAQUE}

    def __call__(self, camera: Camera, scenario: Scenario, seen: Shown) -> Array:
        """(S,) share of each subject that others hide, of the time that it is in the picture; clear ones are not."""
        frames = np.unique(np.linspace(0, len(scenario.weight) - 1, TIMES).astype(int))
        shares = np.zeros((len(frames), len(scenario.subjects)))
        weights = np.zeros_like(shares)
        for k, frame in enumerate(frames):
            count = self._objects.count(self._picture(camera, scenario, int(frame)))
            pixels = sum(count.values())
            for s, subject in enumerate(scenario.subjects):
                if subject.prim in self._opaque and seen.inside[frame, s] >= IN and pixels:
                    left, top, right, bottom = seen.box[frame, s]
                    area = max(0.25 * (right - left) * (bottom - top) * self._size, 1.0 / FILLS)
                    shares[k, s] = 1.0 - min(1.0, count.get(subject.prim, 0) / (FILLS * area))
                    weights[k, s] = scenario.weight[frame]
        total = weights.sum(axis=0)
        return np.asarray((weights * shares).sum(axis=0) / np.where(total > 0.0, total, 1.0))

    def _picture(self, camera: Camera, scenario: Scenario, frame: int) -> Array:
        if self._built.bodies is not None and len(scenario.world.bodies):
            q = self._state.body_q.numpy()
            q[self._built.bodies] = scenario.motion.body_q[frame]
            self._state.body_q.assign(q)
        picture = self._renderer.shapes_in(camera, self._state, WIDTH)
        self._size = picture.size
        return picture
