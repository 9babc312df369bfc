"""The solids: ground, box, sphere, cylinder, capsule, mesh."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from pathlib import Path

from pxr import UsdGeom

from wsim.limits import MAX_POSITION
from wsim.scene.authoring import Handle, calling_folder, note_line, set_pose
from wsim.scene.bodies import Bodies, BodyOptions, finish_collider
from wsim.scene.mesh_file import MeshFile
from wsim.scene.rolling import Round
from wsim.scene.validate import Call

_HERE = (0.0, 0.0, 0.0)
_GROUND_SIZE = 100.0  # [m], how far the ground is drawn; it collides without end


class Shapes(Bodies):
    """The calls that make solids.

    All take the same options:
        position: Of the centre, in the world [m]; of a mesh, of the origin of its file.
        rotation_deg: Roll, pitch, yaw about the world's X, Y, Z, in this order [deg].
        density, mass: [kg/m^3] or [kg]; give one. Neither: the material's density, else 1000 kg/m^3.
        velocity, angular_velocity_deg: At time 0, in the world's axes [m/s], [deg/s].
        rolling: Of what is round: it starts with the spin that fits its velocity, v / r, so that it rolls and does not
            slip, on the level or straight up or down a slope; a cylinder or a capsule across its axis.
        static: Never moves.
        kinematic: Moves and turns by its velocity whatever it meets, and carries and pushes what it meets.
        material: What `scene.material` returned, or its name; friction, restitution, rolling_friction and color
            override it.
        friction, restitution: Of two surfaces the smaller counts; one that states none leaves it to the other, and
            it is 0.5 and 0 if neither does.
        rolling_friction: The material's `rolling`: what slows a ball that rolls. Of two surfaces the larger counts,
            and it is 0 if neither states one.
    A call raises `SceneError`, naming the argument and its value, for what cannot be built.
    """

    def ground(
        self,
        name: str = "ground",
        *,
        height: float = 0.0,
        material: Handle | str | None = None,
        friction: float | None = None,
        restitution: float | None = None,
        color: Sequence[float] | None = None,
        rolling_friction: float | None = None,
    ) -> Handle:
        """Make a level plane without end, at z = `height` [m]."""
        call = Call("ground", name)
        path = self._path(call)
        z = call.within("height", height, -MAX_POSITION, MAX_POSITION, "m")
        if material is None and color is None:
            color = (0.35, 0.36, 0.38)
        surface = self._surface(call, material, friction, restitution, color, rolling=rolling_friction)
        prim = UsdGeom.Xform.Define(self._stage, path).GetPrim()
        note_line(prim)
        set_pose(prim, (0.0, 0.0, z))
        plane = UsdGeom.Plane.Define(self._stage, f"{path}/geometry")
        plane.CreateAxisAttr("Z")
        plane.CreateWidthAttr(_GROUND_SIZE)
        plane.CreateLengthAttr(_GROUND_SIZE)
        note_line(plane.GetPrim())
        finish_collider(plane.GetPrim(), surface)
        return Handle(name=prim.GetName(), path=path, kind="static")

    def box(
        self,
        name: str,
        *,
        size: Sequence[float],
        position: Sequence[float] = _HERE,
        rotation_deg: Sequence[float] = _HERE,
        density: float | None = None,
        mass: float | None = None,
        velocity: Sequence[float] = _HERE,
        angular_velocity_deg: Sequence[float] = _HERE,
        static: bool = False,
        kinematic: bool = False,
        material: Handle | str | None = None,
        friction: float | None = None,
        restitution: float | None = None,
        color: Sequence[float] | None = None,
        rolling_friction: float | None = None,
    ) -> Handle:
        """Make a box with full edge lengths `size` = (x, y, z) [m]. For the other options see `Shapes`."""
        call = Call("box", name)
        edges = call.sizes("size", size)

        def geometry(path: str) -> UsdGeom.Gprim:
            cube = UsdGeom.Cube.Define(self._stage, path)
            cube.CreateSizeAttr(1.0)
            set_pose(cube.GetPrim(), _HERE, scale=edges)
            return cube

        options = BodyOptions(
            position,
            rotation_deg,
            density,
            mass,
            velocity,
            angular_velocity_deg,
            static,
            kinematic,
            material,
            friction,
            restitution,
            color,
            rolling_friction,
        )
        return self._solid(call, options, geometry)

    def sphere(
        self,
        name: str,
        *,
        radius: float,
        position: Sequence[float] = _HERE,
        rotation_deg: Sequence[float] = _HERE,
        density: float | None = None,
        mass: float | None = None,
        velocity: Sequence[float] = _HERE,
        angular_velocity_deg: Sequence[float] = _HERE,
        rolling: bool = False,
        static: bool = False,
        kinematic: bool = False,
        material: Handle | str | None = None,
        friction: float | None = None,
        restitution: float | None = None,
        color: Sequence[float] | None = None,
        rolling_friction: float | None = None,
    ) -> Handle:
        """Make a ball of `radius` [m]. For the other options see `Shapes`."""
        call = Call("sphere", name)
        r = call.size("radius", radius)

        def geometry(path: str) -> UsdGeom.Gprim:
            ball = UsdGeom.Sphere.Define(self._stage, path)
            ball.CreateRadiusAttr(r)
            return ball

        options = BodyOptions(
            position,
            rotation_deg,
            density,
            mass,
            velocity,
            angular_velocity_deg,
            static,
            kinematic,
            material,
            friction,
            restitution,
            color,
            rolling_friction,
            rolling,
        )
        return self._solid(call, options, geometry, rolls=Round(r))

    def cylinder(
        self,
        name: str,
        *,
        radius: float,
        height: float,
        axis: str = "Z",
        position: Sequence[float] = _HERE,
        rotation_deg: Sequence[float] = _HERE,
        density: float | None = None,
        mass: float | None = None,
        velocity: Sequence[float] = _HERE,
        angular_velocity_deg: Sequence[float] = _HERE,
        rolling: bool = False,
        static: bool = False,
        kinematic: bool = False,
        material: Handle | str | None = None,
        friction: float | None = None,
        restitution: float | None = None,
        color: Sequence[float] | None = None,
        rolling_friction: float | None = None,
    ) -> Handle:
        """Make a cylinder of `radius` and `height` [m] along its own `axis` X, Y or Z: a can, a pole, a solid pipe.

        For the rest see `Shapes`."""
        call = Call("cylinder", name)
        geometry = self._round(call, UsdGeom.Cylinder, radius, height, axis)
        options = BodyOptions(
            position,
            rotation_deg,
            density,
            mass,
            velocity,
            angular_velocity_deg,
            static,
            kinematic,
            material,
            friction,
            restitution,
            color,
            rolling_friction,
            rolling,
        )
        return self._solid(call, options, geometry, rolls=Round(radius, call.axis(axis)))

    def capsule(
        self,
        name: str,
        *,
        radius: float,
        height: float,
        axis: str = "Z",
        position: Sequence[float] = _HERE,
        rotation_deg: Sequence[float] = _HERE,
        density: float | None = None,
        mass: float | None = None,
        velocity: Sequence[float] = _HERE,
        angular_velocity_deg: Sequence[float] = _HERE,
        rolling: bool = False,
        static: bool = False,
        kinematic: bool = False,
        material: Handle | str | None = None,
        friction: float | None = None,
        restitution: float | None = None,
        color: Sequence[float] | None = None,
        rolling_friction: float | None = None,
    ) -> Handle:
        """Make a capsule, a rod with round ends: `radius`, `height` [m], caps not counted. See `Shapes`."""
        call = Call("capsule", name)
        geometry = self._round(call, UsdGeom.Capsule, radius, height, axis)
        options = BodyOptions(
            position,
            rotation_deg,
            density,
            mass,
            velocity,
            angular_velocity_deg,
            static,
            kinematic,
            material,
            friction,
            restitution,
            color,
            rolling_friction,
            rolling,
        )
        return self._solid(call, options, geometry, rolls=Round(radius, call.axis(axis)))

    def mesh(
        self,
        name: str,
        *,
        file: str | Path,
        scale: float | Sequence[float] = 1.0,
        up_axis: str = "Z",
        collision: str | None = None,
        smooth_deg: float = 0.0,
        position: Sequence[float] = _HERE,
        rotation_deg: Sequence[float] = _HERE,
        density: float | None = None,
        mass: float | None = None,
        velocity: Sequence[float] = _HERE,
        angular_velocity_deg: Sequence[float] = _HERE,
        static: bool = False,
        kinematic: bool = False,
        material: Handle | str | None = None,
        friction: float | None = None,
        restitution: float | None = None,
        color: Sequence[float] | None = None,
        rolling_friction: float | None = None,
    ) -> Handle:
        """Make a solid from a triangle mesh. For the other options see `Shapes`.

        A mesh with holes has no volume of its own: it then weighs and turns as its convex hull does.

        Args:
            name: Name of the prim.
            file: OBJ, STL, PLY or GLB; a relative path starts at the program's folder.
            scale: One factor, or one for each axis of the file; 0.001 for a file in millimetres.
            up_axis: "Z", or "Y" for a file with Y up (every GLB).
            collision: "convexHull" (default), "convexDecomposition", or "none" for the triangles as they are
                (default of a static mesh, and for static meshes only): a bowl holds, an arch lets through.
            smooth_deg: Where the triangles of a static mesh meet at a smaller angle they stand for a curve, and what
                rolls or slides there keeps its energy; 0: all are flat [deg].
            position: See `Shapes`, as for the rest.
            rotation_deg: [deg].
            density: [kg/m^3].
            mass: [kg].
            velocity: [m/s].
            angular_velocity_deg: [deg/s].
            static: Never moves.
            kinematic: Moves by its velocity whatever it meets.
            material: Handle or name.
            friction: Overrides the material's.
            restitution: Overrides the material's.
            color: Overrides the material's.
            rolling_friction: Overrides the material's rolling.

        Raises:
            SceneError: If the file cannot be read, or as all shapes do.
        """
        call = Call("mesh", name)
        source = MeshFile.read(call, file, calling_folder(), scale=scale, up_axis=up_axis)
        approximation = source.approximation(call, collision, static=call.flag("static", static))
        smooth = math.radians(call.within("smooth_deg", smooth_deg, 0.0, 90.0, "deg"))

        def geometry(path: str) -> UsdGeom.Gprim:
            return source.define(self._stage, path, approximation, smooth)

        options = BodyOptions(
            position,
            rotation_deg,
            density,
            mass,
            velocity,
            angular_velocity_deg,
            static,
            kinematic,
            material,
            friction,
            restitution,
            color,
            rolling_friction,
        )
        return self._solid(call, options, geometry, source.mass_properties)

    def _round(self, call: Call, kind: type, radius: float, height: float, axis: str) -> Callable[[str], UsdGeom.Gprim]:
        r, h, along = call.size("radius", radius), call.size("height", height), call.axis(axis)

        def geometry(path: str) -> UsdGeom.Gprim:
            prim = kind.Define(self._stage, path)  # type: ignore[attr-defined]
            prim.CreateRadiusAttr(r)
            prim.CreateHeightAttr(h)
            prim.CreateAxisAttr(along)
            return prim

        return geometry
