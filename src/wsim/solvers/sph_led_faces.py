"""Bodies that are led, as faces that no fluid gets behind (`wsim.kernels.sph.faces`)."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import warp as wp
from newton import BodyFlags, GeoType, ShapeFlags

from wsim.kernels.sph.faces import BOX, MESH, ROUND, keep_out_of_led
from wsim.kernels.sph.faces import LedFaces as Shapes
from wsim.solvers.sph_blows import Blows
from wsim.solvers.sph_faces import MESHES, ROUNDS, closed_mesh, round_size

Array = np.ndarray
KINDS = (GeoType.BOX, *ROUNDS, *MESHES)


class LedFaces:
    """The shapes of each world's led bodies.

    Those of bodies that the fluid moves are not among them: these give way before anything gets in.

    Args:
        model: The `newton.Model`.
        world_count: W.
        reach: How deep in a mesh a particle is still put back [m]; more than it goes in a step.
        spared: Whether the shape of a label has a skin instead (`wsim.solvers.sph_skins`).

    Attributes:
        count: How many shapes.
    """

    def __init__(self, model: Any, world_count: int, reach: float, spared: Callable[[Any], bool]) -> None:
        self._model = model
        bodies, kinds = model.shape_body.numpy(), model.shape_type.numpy()
        led = (model.body_flags.numpy() & int(BodyFlags.KINEMATIC)) != 0 if model.body_count else np.zeros(0, bool)
        seen = ((model.shape_flags.numpy() & ShapeFlags.COLLIDE_SHAPES) != 0) & (bodies >= 0) & np.isin(kinds, KINDS)
        wanted = [k for k in np.flatnonzero(seen).tolist() if led[bodies[k]] and not spared(model.shape_label[k])]
        self.count = len(wanted)
        if not wanted:
            return
        worlds = np.maximum(model.body_world.numpy()[bodies[wanted]], 0)
        order = np.argsort(worlds, kind="stable")
        which = np.array(wanted)[order]
        scales = model.shape_scale.numpy().astype(float)
        self._meshes: dict[tuple[Any, ...], wp.Mesh] = {}
        found = [self._shape(int(kinds[k]), scales[k], model.shape_source[k]) for k in which]
        self._shapes: Any = Shapes()
        self._shapes.first = wp.array(np.searchsorted(worlds[order], np.arange(world_count + 1)), dtype=int)
        self._shapes.body = wp.array(bodies[which], dtype=int)
        self._shapes.pose = wp.array(model.shape_transform.numpy()[which], dtype=wp.transform)
        self._shapes.kind = wp.array([kind for kind, _, _, _ in found], dtype=int)
        self._shapes.size = wp.array(np.array([size for _, size, _, _ in found]), dtype=wp.vec3)
        self._shapes.mesh = wp.array(np.array([mesh for _, _, mesh, _ in found], dtype=np.uint64), dtype=wp.uint64)
        self._shapes.ball = wp.array([ball for _, _, _, ball in found], dtype=float)
        self._shapes.reach = reach

    def _shape(self, kind: int, scale: Array, source: Any) -> tuple[int, Array, int, float]:
        """Kind, size, mesh and radius about its origin."""
        if kind == GeoType.BOX:
            return int(BOX), scale, 0, float(np.linalg.norm(scale))
        if kind in ROUNDS:
            size = round_size(kind, scale)
            return int(ROUND), size, 0, float(size[0] + size[1])
        vertices = np.asarray(source.vertices, dtype=float).reshape(-1, 3) * scale
        key = id(source), kind, *scale.tolist()
        if key not in self._meshes:
            triangles = np.asarray(source.indices).reshape(-1, 3)
            self._meshes[key] = closed_mesh(vertices, triangles, kind == GeoType.CONVEX_MESH)
        return int(MESH), np.zeros(3), self._meshes[key].id, float(np.linalg.norm(vertices, axis=1).max())

    def keep_out(self, fluid: Any, dt: float, moved: Any, state: Any, blows: Blows) -> None:
        """Put back what a face went over in the step that ends.

        Args:
            fluid: The particles, as `SortedParticles`; what is in pipes of taps and drains goes where it is led.
            dt: Of the step [s].
            moved: The state whose particles have moved.
            state: The one that poses and velocities of the bodies are of.
            blows: On the bodies, added to.
        """
        if not self.count:
            return
        model = self._model
        wp.launch(
            keep_out_of_led,
            dim=model.particle_count,
            inputs=[
                *(fluid.world, fluid.stage, model.particle_mass, self._shapes, state.body_q, state.body_qd),
                *(model.body_com, blows.spacing, blows.quantum(dt), dt),
            ],
            outputs=[moved.particle_q, moved.particle_qd, blows.impulse],
        )
