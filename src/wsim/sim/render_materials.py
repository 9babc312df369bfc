"""What the model's shapes look like: colours, glass, ground."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import newton
import numpy as np
import warp as wp

from wsim.geometry.colour import srgb_of
from wsim.scene.world import Shape
from wsim.sim.render_views import is_ground

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from wsim.scene.world import Fluid, World

OPAQUE = 0.995  # opacity from which a shape is drawn opaque
GLASS_GLOW = 0.35  # share of its colour that a thick piece of glass shows of itself: its edges read dark
SHADES, GOLDEN = 0.12, 0.618034  # of sRGB's values
CLARITY = 1.2  # how much of its colour a fluid that states no attenuation length shows across its largest edge
SHORTEST = 1.0e-5  # [m]: attenuation length of what lets no light through


def extinction_of_fluid(fluid: Fluid) -> np.ndarray:
    """Beer-Lambert coefficients of a fluid for red, green and blue [1/m], (3,).

    They are to each other as the logarithms of its colour, so that white light takes on that colour on its way, and
    their mean is one over the attenuation length. Of a fluid that states none, white light has taken on the colour, in
    part (`CLARITY`), after the longest edge of the box of fluid: a beaker and a pool look alike.
    """
    tint = -np.log(np.clip(np.asarray(fluid.color, dtype=np.float64), 0.02, 0.98))
    if fluid.attenuation_length is None:
        return tint * CLARITY / max(fluid.size)
    return tint / tint.mean() / max(fluid.attenuation_length, SHORTEST)


def extinction_of_glass(shape: Shape, thickness: float) -> np.ndarray:
    """Beer-Lambert coefficients of a glass shape [1/m], (3,): its tint is met straight across its thinnest side."""
    # The power keeps a usual opacity of 0.25 clear through the four panes of a tank, and 1 opaque.
    cover = min(shape.opacity, 0.999) ** 2.5
    tint = 1.0 - shape.opacity * (1.0 - np.clip(np.asarray(shape.color), 0.0, 1.0)) * 0.5
    return -np.log(np.clip((1.0 - cover) * tint, 1e-4, 1.0)) / max(thickness, 1e-6)


@dataclass(frozen=True)
class Pane:
    """One glass shape."""

    shape: int  # index in the model
    half: tuple[float, float, float]  # [m], half edges of its box
    mesh: wp.Mesh | None  # None for a box
    extinction: np.ndarray  # [1/m], (3,)
    color: tuple[float, float, float]

    @classmethod
    def of(cls, model: Any, index: int, shape: Shape) -> Pane:
        """The pane of the model's shape `index`, which the world describes as `shape`."""
        is_box = int(model.shape_type.numpy()[index]) == int(newton.GeoType.BOX)
        mesh = None if is_box else mesh_of(model, index)
        half = model.shape_scale.numpy()[index] if mesh is None else 0.5 * np.ptp(mesh.points.numpy(), axis=0)
        extinction = extinction_of_glass(shape, 2.0 * float(min(half)))
        x, y, z = (float(h) for h in half)
        return cls(index, (x, y, z), mesh, extinction, shape.color)


class Glass:
    """Glass shapes as the arrays that the compositing kernel reads, boxes first."""

    def __init__(self, panes: list[Pane], device: wp.Device) -> None:
        self._panes = sorted(panes, key=lambda pane: pane.mesh is not None)  # keeps the meshes alive
        panes = self._panes
        self.box_count = sum(pane.mesh is None for pane in panes)
        self.shape = wp.array([p.shape for p in panes], dtype=wp.int32, device=device)
        self.half = wp.array([p.half for p in panes], dtype=wp.vec3f, device=device)
        ids = [0 if p.mesh is None else int(p.mesh.id) for p in panes]
        self.mesh = wp.array(ids, dtype=wp.uint64, device=device)
        self.extinction = wp.array([tuple(p.extinction) for p in panes], dtype=wp.vec3f, device=device)
        self.color = wp.array([tuple(GLASS_GLOW * c for c in p.color) for p in panes], dtype=wp.vec3f, device=device)


@dataclass
class ShapeLooks:
    """How the model's shapes of one world are to be drawn."""

    panes: list[Pane]
    hidden: list[int]  # shapes that no picture shows: glass (drawn apart) and boxes of fluid
    ground: np.ndarray  # (shape_count,) 1 for ground
    color: dict[int, np.ndarray]  # (3,) sRGB, by index in the model


def shape_looks(model: Any, world: World, world_index: int) -> ShapeLooks:
    """Match the model's shapes of a world with its description's by prim path. Glass that is not VISIBLE is no pane."""
    labels = {int(index): str(model.shape_label[index]) for index in _shapes_of(model, world_index)}
    fluids = tuple(f"{f.prim}/" for f in world.fluids)
    looks = ShapeLooks(
        panes=[],
        hidden=[i for i, label in labels.items() if any(prim in f"{label}/" for prim in fluids)],
        ground=np.zeros(max(model.shape_count, 1), dtype=np.int32),
        color={},
    )
    flags = model.shape_flags.numpy() if labels else []
    for index, shape, ground in shapes_by_label(model, world, world_index):
        looks.color[index] = srgb_of(shape.color)
        looks.ground[index] = int(ground)
        # A plane has no thickness to look through, and nothing below it: a field of ice is drawn as ground.
        if shape.opacity < OPAQUE and shape.kind != "plane" and index not in looks.hidden:
            looks.hidden.append(index)
            if flags[index] & int(newton.ShapeFlags.VISIBLE):
                looks.panes.append(Pane.of(model, index, shape))
    return looks


def shapes_by_label(model: Any, world: World, world_index: int) -> Iterator[tuple[int, Shape, bool]]:
    """Index in the model, the world's description, and whether it is ground, of each shape that the world knows."""
    described = {shape.prim: (shape, is_ground(shape)) for static in world.statics for shape in static.shapes}
    described |= {shape.prim: (shape, False) for body in world.bodies for shape in body.shapes}
    for cord in world.cords:
        drawn = Shape(prim=cord.prim, kind="capsule", size=(cord.radius, 0.0), color=cord.color, collides=False)
        described[cord.prim] = (drawn, False)
    for index in _shapes_of(model, world_index):
        path = str(model.shape_label[index])
        while path and path not in described:  # a decomposed mesh's parts lie below its prim
            path = path.rpartition("/")[0]
        if path:
            yield int(index), *described[path]


def things(model: Any, world: World, ground: np.ndarray) -> np.ndarray:
    """Which shapes are one thing, (shape_count,): those of a body, of a static, of a cord; -1 for the ground."""
    bodies = model.shape_body.numpy() if model.shape_count else np.zeros(0, dtype=np.int32)
    owners = {shape.prim: static.prim for static in world.statics for shape in static.shapes}
    cords = {cord.prim for cord in world.cords}
    numbers: dict[object, int] = {}
    found = np.full(max(model.shape_count, 1), -1, dtype=np.int32)
    for index, body in enumerate(bodies):
        label = str(model.shape_label[index])
        above = label.rpartition("/")[0]
        thing = above if above in cords else int(body) if body >= 0 else owners.get(label, label)
        if not ground[index]:
            found[index] = numbers.setdefault(thing, len(numbers))
    return found


def told_apart(color: dict[int, np.ndarray], thing: np.ndarray) -> dict[int, np.ndarray]:
    """Colours by shape, of which those that several things share differ in shade, up to `SHADES` to both sides."""
    users: dict[tuple[float, ...], list[int]] = {}
    for index, rgb in color.items():
        of_it = users.setdefault(tuple(np.round(rgb, 4).tolist()), [])
        if thing[index] >= 0 and thing[index] not in of_it:
            of_it.append(int(thing[index]))
    shaded = {}
    for index, rgb in color.items():
        of_it = users[tuple(np.round(rgb, 4).tolist())]
        if len(of_it) > 1 and thing[index] >= 0:
            # Steps of the golden ratio: neighbours in the order in which they were made differ most.
            step = (of_it.index(int(thing[index])) * GOLDEN) % 1.0
            rgb = np.clip(rgb * (1.0 + SHADES * (2.0 * step - 1.0)), 0.0, 1.0)
        shaded[index] = rgb
    return shaded


def _shapes_of(model: Any, world_index: int) -> np.ndarray:
    """Indices of a world's shapes, and of those that all worlds have: other worlds' have the same labels."""
    worlds = model.shape_world.numpy() if model.shape_count else np.zeros(0, dtype=np.int32)
    return np.flatnonzero((worlds == -1) | (worlds == world_index))


def paint(model: Any, looks: Sequence[ShapeLooks]) -> None:
    """Give the model's shapes of some worlds their colours."""
    color = {index: rgb for each in looks for index, rgb in each.color.items()}
    if color:
        colors = model.shape_color.numpy().copy()
        colors[list(color)] = list(color.values())
        model.shape_color.assign(colors)


def hide(model: Any, state: Any, hidden: list[int]) -> None:
    """Leave shapes out of what rays of the model's camera meet; the model's flags stay as they were."""
    if not hidden:
        return
    flags = model.shape_flags.numpy().copy()
    model.shape_flags.assign(without(flags, hidden))
    model.bvh_build_shapes(state)
    model.shape_flags.assign(flags)


def without(flags: np.ndarray, hidden: Sequence[int] | np.ndarray) -> np.ndarray:
    """Newton's flags of shapes (S,), some of which are to be VISIBLE no more, by index or by mask."""
    shown = flags.copy()
    shown[hidden] &= ~int(newton.ShapeFlags.VISIBLE)
    return shown


def mesh_of(model: Any, index: int) -> wp.Mesh:
    """A closed mesh of any shape that is not a box, in the shape's frame."""
    kind = newton.GeoType(int(model.shape_type.numpy()[index]))
    size = [float(s) for s in model.shape_scale.numpy()[index]]
    if kind == newton.GeoType.SPHERE:
        mesh = newton.Mesh.create_sphere(size[0])
    elif kind == newton.GeoType.CAPSULE:
        mesh = newton.Mesh.create_capsule(size[0], size[1], up_axis=newton.Axis.Z)
    elif kind == newton.GeoType.CYLINDER:
        mesh = newton.Mesh.create_cylinder(size[0], size[1], up_axis=newton.Axis.Z)
    elif kind in (newton.GeoType.MESH, newton.GeoType.CONVEX_MESH):
        source = model.shape_source[index]
        mesh = newton.Mesh(np.asarray(source.vertices) * size, source.indices, compute_inertia=False)
    else:
        raise ValueError(f"shape {model.shape_label[index]}: a {kind.name.lower()} is not drawn as glass or in fluid")
    return wp.Mesh(
        points=wp.array(np.asarray(mesh.vertices), dtype=wp.vec3f, device=model.device),
        indices=wp.array(np.asarray(mesh.indices).reshape(-1), dtype=wp.int32, device=model.device),
        support_winding_number=True,
    )
