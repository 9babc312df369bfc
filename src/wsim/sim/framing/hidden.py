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
SPECK = 1.5  # [px] of these: what is smaller may have none, hidden or not
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
        self._counts: dict[tuple[str, int], dict[str, int]] = {}
        world = built.world
        owners: list[Body | Static] = [*world.bodies, *world.statics]
        self._opaque = {object_of(each.prim) for each in owners if each.shapes}
        self._opaque -= {object_of(each.prim) for each in owners for s in each.shapes if s.opacity < OPAQUE}

    def __call__(self, camera: Camera, scenario: Scenario, seen: Shown) -> Array:
        """(S,) share of each subject that others hide, of the stills that it is in; of what is clear none is."""
        frames = np.flatnonzero(scenario.stills)
        size = WIDTH**2 * camera.height / camera.width
        shares = np.zeros((len(frames), len(scenario.subjects)))
        weights = np.zeros_like(shares)
        for k, frame in enumerate(frames):
            count = self._count(camera, scenario, int(frame))
            pixels = sum(count.values())
            for s, subject in enumerate(scenario.subjects):
                large = seen.inside[frame, s] >= IN and seen.size[frame, s] * WIDTH >= SPECK
                if self._opaque.issuperset(subject.parts) and large and pixels:
                    left, top, right, bottom = seen.box[frame, s]
                    area = max(0.25 * (right - left) * (bottom - top) * size, 1.0 / FILLS)
                    shares[k, s] = 1.0 - min(1.0, sum(count.get(p, 0) for p in subject.parts) / (FILLS * area))
                    weights[k, s] = scenario.weight[frame]
        total = weights.sum(axis=0)
        return np.asarray((weights * shares).sum(axis=0) / np.where(total > 0.0, total, 1.0))

    def _count(self, camera: Camera, scenario: Scenario, frame: int) -> dict[str, int]:
        """Pixels of each object; of a view that comes again it is known."""
        key = (camera.model_dump_json(exclude={"prim", "fixed"}), frame)
        if key not in self._counts:
            if self._built.bodies is not None and len(scenario.world.bodies):
                q = self._state.body_q.numpy()
                q[self._built.bodies] = scenario.motion.body_q[frame]
                self._state.body_q.assign(q)
            picture = self._renderer.shapes_in(camera, self._state, WIDTH)
            self._counts[key] = self._objects.count(picture)
        return self._counts[key]
