"""The open tank: five glass plates around a hollow."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from pxr import Gf, Sdf, UsdGeom

from wsim.scene import schema
from wsim.scene.authoring import Handle, note_line, set_pose
from wsim.scene.bodies import finish_collider
from wsim.scene.materials import Look
from wsim.scene.terrain import Terrains
from wsim.scene.validate import Call, Vec3

_GLASS: Vec3 = (0.75, 0.88, 0.9)
_OPACITY = 0.25


@dataclass(frozen=True)
class Tank(Handle):
    """A tank: `inner_size` and `inner_center` of its hollow, in the world [m]."""

    inner_size: Vec3
    inner_center: Vec3

    @property
    def floor(self) -> float:
        """Height of the inner floor [m]."""
        return self.inner_center[2] - self.inner_size[2] / 2

    @property
    def low(self) -> Vec3:
        """The hollow's lowest corner [m]."""
        return (
            self.inner_center[0] - self.inner_size[0] / 2,
            self.inner_center[1] - self.inner_size[1] / 2,
            self.floor,
        )


class Tanks(Terrains):
    """The call that makes a tank."""

    def __init__(self) -> None:
        super().__init__()
        self._tanks: dict[str, Tank] = {}

    def tank(
        self,
        name: str,
        *,
        inner_size: Sequence[float],
        position: Sequence[float] = (0.0, 0.0, 0.0),
        wall: float = 0.02,
        material: Handle | str | None = None,
        friction: float | None = None,
        restitution: float | None = None,
        color: Sequence[float] | None = None,
    ) -> Tank:
        """Make an open glass tank that stands still.

        Args:
            name: Name of the prim.
            inner_size: Width, depth and height (x, y, z) of the hollow [m].
            position: Centre of the OUTER bottom face [m]: at z = 0 the tank stands on the ground and its inner
                floor lies at z = `wall`.
            wall: Thickness of floor and walls [m].
            material: What `scene.material` returned, or its name; glass if not given.
            friction: Overrides the material's.
            restitution: Overrides the material's.
            color: Linear RGB; overrides the material's.

        Raises:
            SceneError: If the name is taken or a number is out of range.
        """
        call = Call("tank", name)
        path = self._path(call)
        inner = call.sizes("inner_size", inner_size)
        place = call.position("position", position)
        thickness = call.size("wall", wall)
        if material is None and color is None:
            color = _GLASS
        surface = self._surface(
            call,
            material,
            friction,
            restitution,
            color,
            opacity=_OPACITY,
            look=Look(roughness=0.05, ior=1.5) if material is None else None,
        )
        prim = UsdGeom.Xform.Define(self._stage, path).GetPrim()
        note_line(prim)
        set_pose(prim, place)
        center = (0.0, 0.0, thickness + inner[2] / 2)
        floats = Sdf.ValueTypeNames.Float3
        schema.apply(
            prim,
            schema.CONTAINER,
            {"innerSize": (floats, Gf.Vec3f(*inner)), "innerCenter": (floats, Gf.Vec3f(*center))},
        )
        for part, size, middle in _plates(inner, thickness):
            cube = UsdGeom.Cube.Define(self._stage, f"{path}/{part}")
            cube.CreateSizeAttr(1.0)
            set_pose(cube.GetPrim(), middle, scale=size)
            note_line(cube.GetPrim())
            finish_collider(cube.GetPrim(), surface)
        tank = Tank(
            name=name,
            path=path,
            kind="tank",
            inner_size=inner,
            inner_center=(place[0], place[1], place[2] + center[2]),
        )
        self._tanks[path] = tank
        return tank


def _plates(inner: Vec3, t: float) -> list[tuple[str, Vec3, Vec3]]:
    """Name, size and centre of each plate [m]: a floor under all, x walls between the y walls."""
    x, y, z = inner
    middle = t + z / 2
    return [
        ("floor", (x + 2 * t, y + 2 * t, t), (0.0, 0.0, t / 2)),
        ("wall_minus_x", (t, y, z), (-(x + t) / 2, 0.0, middle)),
        ("wall_plus_x", (t, y, z), ((x + t) / 2, 0.0, middle)),
        ("wall_minus_y", (x + 2 * t, t, z), (0.0, -(y + t) / 2, middle)),
        ("wall_plus_y", (x + 2 * t, t, z), (0.0, (y + t) / 2, middle)),
    ]
