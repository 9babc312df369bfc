"""Compound bodies: several shapes on one body, with the mass that they have together."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from pxr import UsdGeom

from wsim.defaults import BODY_DENSITY
from wsim.geometry.rotations import matrices
from wsim.scene.authoring import Handle, note_line, rotation, set_pose
from wsim.scene.bodies import BodyOptions, MassProperties, finish_collider
from wsim.scene.solids import about_all, solid
from wsim.scene.tracks import Tracks
from wsim.scene.validate import Call, shown

Floats = NDArray[np.float64]

_SHAPES = {"box": ("size",), "sphere": ("radius",), "cylinder": ("radius", "height"), "capsule": ("radius", "height")}
_HERE = (0.0, 0.0, 0.0)


@dataclass(frozen=True)
class Part:
    """One shape of a `scene.compound`: what it is, where it sits on the body, what it weighs and looks like.

    A box takes `size` = (x, y, z) [m]; a sphere `radius`; a cylinder and a capsule `radius`, `height` [m] and `axis`.
    `position` [m] and `rotation_deg` are those on the body. Give `density` [kg/m^3] or `mass` [kg]; neither: the
    material's density, else 1000 kg/m^3. Friction, restitution and color override the material's.
    """

    shape: str
    size: Sequence[float] | None = None
    radius: float | None = None
    height: float | None = None
    axis: str = "Z"
    position: Sequence[float] = _HERE
    rotation_deg: Sequence[float] = _HERE
    density: float | None = None
    mass: float | None = None
    material: Handle | str | None = None
    friction: float | None = None
    restitution: float | None = None
    color: Sequence[float] | None = None


class Compounds(Tracks):
    """The call that makes a compound body."""

    def compound(
        self,
        name: str,
        *,
        parts: Sequence[Part],
        position: Sequence[float] = _HERE,
        rotation_deg: Sequence[float] = _HERE,
        mass: float | None = None,
        velocity: Sequence[float] = _HERE,
        angular_velocity_deg: Sequence[float] = _HERE,
        static: bool = False,
        kinematic: bool = False,
    ) -> Handle:
        """Make one body of several shapes, which do not collide with each other. For the other options see `Shapes`.

        Its mass, centre of mass and inertia are those of its parts together; where parts overlap, both weigh.

        Args:
            name: Name of the prim; its parts are part_0, part_1, … under it.
            parts: `Part`s, e.g. Part("box", size=(0.1, 0.1, 0.1), position=(0.2, 0.0, 0.0), density=7850.0).
            position: Of the body's origin, from which the parts' positions count [m].
            rotation_deg: [deg].
            mass: Of all together, shared out as the parts weigh; by default what they weigh [kg].
            velocity: Of the centre of mass [m/s].
            angular_velocity_deg: [deg/s].
            static: Never moves.
            kinematic: Moves by its velocity whatever it meets.

        Raises:
            SceneError: If a part lacks a size, or as all shapes do.
        """
        call = Call("compound", name)
        listed = _listed(call, parts)
        each = [replace(call, part=f"parts[{k}].") for k in range(len(listed))]
        made = [self._part_geometry(one, part) for one, part in zip(each, listed, strict=True)]
        options = BodyOptions(
            position,
            rotation_deg,
            None,
            mass,
            velocity,
            angular_velocity_deg,
            static,
            kinematic,
            None,
            None,
            None,
            None,
        )
        whole = None if mass is None else call.mass(mass)
        # It brings pydantic, and a program without compounds does not wait for it.
        from wsim.scene.usd_shapes import read_shape

        path, start = self._path(call), self._start(call, options)
        surfaces = [
            self._surface(one, p.material, p.friction, p.restitution, p.color)
            for one, p in zip(each, listed, strict=True)
        ]
        densities = [surface.density or BODY_DENSITY for surface in surfaces]

        def author() -> MassProperties:
            weights, solids = [], []
            for k, (part, geometry) in enumerate(zip(listed, made, strict=True)):
                gprim = geometry(f"{path}/part_{k}")
                note_line(gprim.GetPrim())
                finish_collider(gprim.GetPrim(), surfaces[k])
                frame = UsdGeom.Xformable(self._stage.GetPrimAtPath(path)).ComputeLocalToWorldTransform(0)
                shape = read_shape(gprim.GetPrim(), frame)
                assert shape is not None
                body = solid(shape)
                weights.append(part.mass if part.mass is not None else (part.density or densities[k]) * body.volume)
                turn = matrices(np.array(shape.rotation))
                inertia = turn @ body.inertia @ turn.T * (weights[-1] / body.volume)
                solids.append((np.array(shape.position) + turn @ body.com, inertia))
            return _together(np.array(weights, dtype=np.float64), solids, whole)

        return self._body_of(call, start, path, author)

    def _part_geometry(self, call: Call, part: Part) -> Callable[[str], UsdGeom.Gprim]:
        """What defines a part's Gprim at a path; all numbers are checked now."""
        needs = _SHAPES[call.one_of("shape", part.shape, tuple(_SHAPES))]
        for field in ("size", "radius", "height"):
            given = getattr(part, field)
            if (given is not None) != (field in needs):
                call.fail(f"{field} = {shown(given)}: a {part.shape} takes {' and '.join(needs)}")
        if part.mass is not None and part.density is not None:
            call.fail(f"mass = {part.mass!r} and density = {part.density!r} are both given; give one")
        if part.mass is not None:
            call.mass(part.mass)
        if part.density is not None:
            call.density(part.density)
        place = call.position("position", part.position)
        turn = rotation(call.angles(part.rotation_deg))
        axis = call.axis(part.axis)
        edges = call.sizes("size", part.size) if part.shape == "box" else None
        radius = None if part.radius is None else call.size("radius", part.radius)
        height = None if part.height is None else call.size("height", part.height)

        def geometry(path: str) -> UsdGeom.Gprim:
            if edges is not None:
                cube = UsdGeom.Cube.Define(self._stage, path)
                cube.CreateSizeAttr(1.0)
                set_pose(cube.GetPrim(), place, turn, scale=edges)
                return cube
            kind = {"sphere": UsdGeom.Sphere, "cylinder": UsdGeom.Cylinder, "capsule": UsdGeom.Capsule}[part.shape]
            prim = kind.Define(self._stage, path)
            prim.CreateRadiusAttr(radius)
            if height is not None:
                prim.CreateHeightAttr(height)
                prim.CreateAxisAttr(axis)
            set_pose(prim.GetPrim(), place, turn)
            return prim

        return geometry


def _listed(call: Call, parts: Sequence[Part]) -> list[Part]:
    if isinstance(parts, (str, bytes, Part)) or not isinstance(parts, Sequence) or not parts:
        call.fail(f"parts = {shown(parts)} must be a list of Part(...), one or more")
    for k, part in enumerate(parts):
        if not isinstance(part, Part):
            call.fail(f'parts[{k}] = {shown(part)} must be a Part, e.g. Part("sphere", radius=0.1)')
    return list(parts)


def _together(weights: Floats, solids: list[tuple[Floats, Floats]], mass: float | None) -> MassProperties:
    """Mass, centre and inertia of parts, by Steiner's theorem of parallel axes."""
    if mass is not None:
        factor = mass / float(weights.sum())
        weights = weights * factor
        solids = [(place, inertia * factor) for place, inertia in solids]
    com, inertia = about_all(weights, *zip(*solids, strict=True))
    return MassProperties.of(float(weights.sum()), com, inertia)
