"""MuJoCo's search for contacts between the shapes of a world: one model, which worlds of other sizes share.

To compile a model and to make its data takes as long as the search in a dozen frames: of a sweep's worlds, whose shapes
differ in size, one has them, and its sizes are set anew for each.
"""

from __future__ import annotations

from copy import copy
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Collection, Sequence

    from numpy.typing import NDArray

    from wsim.scene.world import Shape

    Floats = NDArray[np.float64]
    Bools = NDArray[np.bool_]
    Shapes = Sequence[tuple[int, str, Shape]]  # row of the body or below 0, prim of the owner, shape

HERE = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0)  # in its body's frame


class Search:
    """For contacts of one world's shapes, at any poses of its bodies."""

    def __init__(self, bodies: int, shapes: Shapes, apart: Collection[int]) -> None:
        """Of so many bodies; shapes whose numbers are put `apart` are left out."""
        import mujoco  # heavy, and wanted where there are bodies alone

        spec = mujoco.MjSpec()
        # Of what is round MuJoCo's further points are those of surfaces blown up by the reach: at 2 cm their normal was
        # 9 degrees off, and the nearest point was none of them. What is flat has its own (`flats`).
        spec.option.disableflags |= mujoco.mjtDisableBit.mjDSBL_MULTICCD
        items = [
            spec.worldbody.add_body(name=f"b{row}", mass=1.0, inertia=[1.0, 1.0, 1.0], explicitinertial=True)
            for row in range(bodies)
        ]
        for item in items:
            item.add_freejoint()
        kinds = mujoco.mjtGeom
        for k, (row, _, shape) in enumerate(shapes):
            if k not in apart:
                (x, y, z, w), kind = shape.rotation, getattr(kinds, f"mjGEOM_{shape.kind.upper()}")
                place = {"pos": shape.position, "quat": (w, x, y, z)}
                item = spec.worldbody if row < 0 else items[row]
                item.add_geom(name=f"s{k}", type=kind, size=_size(shape), **place)
        self._mujoco, self._shapes = mujoco, shapes
        self._model = spec.compile()
        self._data = mujoco.MjData(self._model)
        names = [self._model.geom(k).name for k in range(self._model.ngeom)]
        self.shape_of_geom = np.array([int(name[1:]) for name in names], dtype=np.intp)
        model = self._model
        views = model.geom_size, model.geom_rbound, model.geom_aabb, model.bvh_aabb
        self._sizes = [(view, view.copy()) for view in views]  # of the model, and what is to be in them
        self._in_use: list[object] = [self._sizes]  # what the model has; of all that share it

    def resized(self, shapes: Shapes) -> Search | None:
        """The same for shapes of other sizes, by the same model; None where they differ otherwise.

        A model has boxes about all that a body has, by which pairs are left out. They are known here of what is alone
        on its body, and at its place.
        """
        model, alone = self._model, np.bincount([row for row, *_ in self._shapes if row >= 0], minlength=1) == 1
        size, about, boxes, trees = (own.copy() for _, own in self._sizes)  # the model may have another's
        for geom, k in enumerate(self.shape_of_geom):
            (row, _, old), (_, _, new) = self._shapes[k], shapes[k]
            if all(getattr(old, name) == getattr(new, name) for name in ("size", "position", "rotation")):
                continue
            if (
                row < 0
                or not alone[row]
                or (old.position, old.rotation) != HERE
                or (new.position, new.rotation) != HERE
            ):
                return None
            half, about[geom] = _room(new)
            size[geom] = _size(new)
            boxes[geom, 3:] = half
            tree = model.body_bvhadr[model.geom_bodyid[geom]]
            trees[tree] = *np.zeros(3), *half
        found = copy(self)
        found._shapes = shapes
        views = (view for view, _ in self._sizes)
        found._sizes = list(zip(views, (size, about, boxes, trees), strict=True))
        return found

    def at(self, pose: Floats, far: Floats, ours: Bools, far_body: Floats, ours_body: Bools) -> Any:
        """What is found at a pose (7 B,) as MuJoCo has it: its contacts, until it is asked again.

        Args:
            pose: Place and quaternion wxyz of each body.
            far: How far about itself each geom is looked for [m].
            ours: Whether contacts are asked that it has.
            far_body: The most of the geoms of each body, the world's first.
            ours_body: Likewise.
        """
        model, data = self._model, self._data
        if self._in_use[0] is not self._sizes:
            for view, sizes in self._sizes:
                view[:] = sizes
            self._in_use[0] = self._sizes
        model.geom_margin[:], model.body_margin[:] = far, far_body
        model.geom_conaffinity[:], model.body_conaffinity[:] = ours, ours_body  # others pass over each other
        data.qpos[:] = pose
        self._mujoco.mj_kinematics(model, data)
        self._mujoco.mj_comPos(model, data)
        self._mujoco.mj_collision(model, data)
        return data.contact


def _size(shape: Shape) -> list[float]:
    """Of a shape, as MuJoCo has it: halves, but of radii [m]."""
    if shape.kind == "box":
        return [0.5 * edge for edge in shape.size]
    if shape.kind == "sphere":
        return [shape.size[0], 0.0, 0.0]
    return [shape.size[0], 0.5 * shape.size[1], 0.0] if shape.size else [0.0, 0.0, 1.0]


def _room(shape: Shape) -> tuple[Floats, float]:
    """Half the box about a shape in its frame (3,), and the radius of a ball [m]."""
    first, second, third = _size(shape)
    if shape.kind == "box":
        return np.array([first, second, third]), float(np.linalg.norm([first, second, third]))
    if shape.kind == "cylinder":
        return np.array([first, first, second]), float(np.hypot(first, second))
    return np.array([first, first, first + second]), first + second
