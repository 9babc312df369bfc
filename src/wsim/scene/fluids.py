"""Fluid: a box of it as it stands at time 0."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from pxr import Gf, Sdf, UsdGeom

from wsim.limits import LEAST_ACROSS, MAX_FLOW_INDEX, MAX_SIZE, MAX_YIELD_STRESS, MIN_FLOW_INDEX, MIN_SIZE
from wsim.scene import schema
from wsim.scene.authoring import Handle, note_line, set_extent, set_pose
from wsim.scene.materials import Look, Material, bind
from wsim.scene.tanks import Tank, Tanks
from wsim.scene.validate import Call, Vec3, shown, suggestion

_WATER: Vec3 = (0.15, 0.4, 0.6)
_OPACITY = 0.6  # that USD's own tools draw it with, where nothing says how clear it is
_TOUCH = 1e-6  # [m]: rounding, not overlap


@dataclass(frozen=True)
class Fluid(Handle):
    """A volume of fluid: `size` and `center` of its box in the world, and particle `spacing` [m]."""

    size: Vec3
    center: Vec3
    spacing: float
    container: str | None = None

    @property
    def surface(self) -> float:
        """Height of the surface at time 0 [m]."""
        return self.center[2] + self.size[2] / 2


class Fluids(Tanks):
    """The call that makes fluid."""

    def __init__(self) -> None:
        super().__init__()
        self._fluids: list[Fluid] = []

    def fluid(
        self,
        name: str,
        *,
        spacing: float,
        fills: Handle | str | None = None,
        level: float | None = None,
        volume: float | None = None,
        size: Sequence[float] | None = None,
        position: Sequence[float] | None = None,
        container: Handle | str | None = None,
        velocity: Sequence[float] = (0.0, 0.0, 0.0),
        density: float = 1000.0,
        viscosity: float = 0.001,
        yield_stress: float = 0.0,
        flow_index: float = 1.0,
        speed_of_sound: float = 0.0,
        color: Sequence[float] = _WATER,
        attenuation_length: float | None = None,
    ) -> Fluid:
        """Fill a tank or another vessel, or stand a free box of fluid somewhere; each call is a liquid of its own.

        Args:
            name: Name of the prim.
            spacing: Distance between particles [m].
            fills: What to fill, with `level` or `volume`: a tank, or anything that is hollow as it stands: a mesh, an
                asset such as a bowl, what several shapes make up. Tilted it holds less; closed all round it holds most.
            level: Depth above the lowest point of its hollow, a tank's inner floor [m]; 0 for what a `tap` is to pour.
                What fills a tank after another fluid lies on it: oil on water.
            volume: Instead of `level`: of the fluid [m^3].
            size: Instead of `fills`: edges (x, y, z) of a box of fluid [m], with `position`.
            position: Centre of that box [m].
            container: The tank that box stands in; found by itself where the box lies inside one.
            velocity: That all of it starts with, in the world [m/s].
            density: Rest density [kg/m^3]; fluids of several densities go side by side, as oil of 900 and water do.
            viscosity: Dynamic viscosity [Pa s]; water 0.001, honey 10. Of what yields or thins the consistency k.
            yield_stress: Shear stress below which it stands [Pa], tau = tau_y + k rate^n (Herschel & Bulkley): paint 5,
                ketchup 15, mud 50, toothpaste 200.
            flow_index: n of that law, 0.1 to 2: 1 as of water, honey and Bingham's liquids; below 1 shear thins it.
            speed_of_sound: Numerical, of weakly compressible SPH [m/s]; 0 lets the solver choose.
            color: Linear RGB.
            attenuation_length: How clear it is: the way through it after which 1/e of the light is left [m], and has
                taken on its colour. 0 hides all that is in it (paint, lava); milk 0.001, cola 0.02, oil 0.1; not
                given, it is as clear as water, however large.

        Raises:
            SceneError: If the fluid does not fit what it fills, that has no hollow, it is thinner than one particle or
                overlaps another fluid, a tank is less than four particles across, or a number is out of range.
        """
        call = Call("fluid", name)
        path = self._path(call)
        step = call.size("spacing", spacing)
        amount: float | None = None
        holder: str | None
        if fills is not None:
            if size is not None or position is not None or container is not None:
                call.fail("fills is given with size, position or container; give fills and level, or size and position")
            if (level is None) == (volume is None):
                what = "without level" if level is None else "with level and volume"
                call.fail(f"fills is given {what}: give level, the depth above its inner floor in m, or volume in m^3")
            holder, edges, center, amount = self._filling(call, fills, level, volume, step)
        else:
            for field, value in (("level", level), ("volume", volume)):
                if value is not None:
                    call.fail(f"{field} = {shown(value)} needs fills=, the tank or vessel to fill")
            if size is None or position is None:
                call.fail("give fills= and level=, or size= and position= of a free box of fluid")
            edges, center = call.sizes("size", size), call.position("position", position)
            tank = self._holder(call, edges, center, container)
            holder = tank.path if tank else None
        if edges[2] > 0.0:
            _check_thickness(call, edges, step, "level" if fills is not None else "size", "the fluid")
            call.particles(edges, step)
        fluid = Fluid(name=name, path=path, kind="fluid", size=edges, center=center, spacing=step, container=holder)
        self._check_overlap(call, fluid)
        values = {
            "density": (Sdf.ValueTypeNames.Double, call.density(density)),
            "viscosity": (Sdf.ValueTypeNames.Double, call.within("viscosity", viscosity, 0.0, 1e6, "Pa s")),
            "yieldStress": (
                Sdf.ValueTypeNames.Double,
                call.within("yield_stress", yield_stress, 0.0, MAX_YIELD_STRESS, "Pa"),
            ),
            "flowIndex": (
                Sdf.ValueTypeNames.Double,
                call.within("flow_index", flow_index, MIN_FLOW_INDEX, MAX_FLOW_INDEX, ""),
            ),
            "spacing": (Sdf.ValueTypeNames.Double, step),
            "size": (Sdf.ValueTypeNames.Float3, Gf.Vec3f(*edges)),
            "velocity": (Sdf.ValueTypeNames.Float3, Gf.Vec3f(*call.velocity(velocity))),
            "speedOfSound": (
                Sdf.ValueTypeNames.Double,
                call.within("speed_of_sound", speed_of_sound, 0.0, 1e4, "m/s"),
            ),
        }
        if amount is not None:
            values["volume"] = (Sdf.ValueTypeNames.Double, amount)
        opacity = _OPACITY
        if attenuation_length is not None:
            length = call.within("attenuation_length", attenuation_length, 0.0, MAX_SIZE, "m")
            values["attenuationLength"] = (Sdf.ValueTypeNames.Double, length)
            opacity = 1.0 - math.exp(-max(edges) / length) if length > 0.0 else 1.0
        self._author_fluid(fluid, values, holder, call.color("color", color), opacity)
        return fluid

    def _author_fluid(
        self,
        fluid: Fluid,
        values: dict[str, tuple[Sdf.ValueTypeName, object]],
        holder: str | None,
        color: Vec3,
        opacity: float,
    ) -> None:
        prim = UsdGeom.Xform.Define(self._stage, fluid.path).GetPrim()
        note_line(prim)
        set_pose(prim, fluid.center)
        schema.apply(prim, schema.FLUID, values)
        relation = prim.CreateRelationship("wsim:container", False)
        if holder is not None:
            relation.SetTargets([Sdf.Path(holder)])
        cube = UsdGeom.Cube.Define(self._stage, f"{fluid.path}/volume")
        cube.CreateSizeAttr(1.0)
        # One that is empty yet is a film, which carries its look.
        set_pose(cube.GetPrim(), (0.0, 0.0, 0.0), scale=(fluid.size[0], fluid.size[1], max(fluid.size[2], MIN_SIZE)))
        set_extent(cube.GetPrim())
        note_line(cube.GetPrim())
        bind(cube.GetPrim(), self._liquid(fluid.name, color, opacity))
        self._fluids.append(fluid)

    def _liquid(self, name: str, color: Vec3, opacity: float) -> Material:
        call = Call("fluid", name)
        return self._surface(call, None, None, None, color, opacity=opacity, look=Look(roughness=0.02, ior=1.33))

    def _filling(
        self, call: Call, fills: Handle | str, level: float | None, volume: float | None, spacing: float
    ) -> tuple[str, Vec3, Vec3, float | None]:
        """What is filled, edges and centre of the fluid's box [m], and its volume [m^3] where it is no box."""
        prim = self._find(call, "fills", fills)
        tank = self._tanks.get(str(prim.GetPath()))
        if tank is not None:
            _check_coarse(call, tank, spacing)
            return tank.path, *_filling(call, tank, self._topmost(tank), level, volume), None
        from wsim.scene.vessels import Vessel  # with pydantic, and few programs fill another vessel

        vessel = Vessel(call, prim, spacing)
        return vessel.path, *vessel.filled(vessel.level_of(level, volume), spacing)

    def _topmost(self, tank: Tank) -> Fluid | None:
        """The fluid that fills a tank from wall to wall and is highest in it."""
        own = [
            each
            for each in self._fluids
            if each.container == tank.path
            and each.size[2] > 0.0
            and all(edge > wide - _TOUCH for edge, wide in zip(each.size[:2], tank.inner_size, strict=False))
        ]
        return max(own, key=lambda each: each.surface, default=None)

    def _tank(self, call: Call, field: str, what: Handle | str) -> Tank:
        path = str(self._find(call, field, what).GetPath())
        if path not in self._tanks:
            name = path.rsplit("/", 1)[-1]
            hint = suggestion(name, [tank.name for tank in self._tanks.values()])
            call.fail(f"{field} = {shown(name)} is not a tank; {hint}")
        return self._tanks[path]

    def _holder(self, call: Call, size: Vec3, center: Vec3, container: Handle | str | None) -> Tank | None:
        """The tank that a free box of fluid stands in."""
        if container is None:
            inside = [tank for tank in self._tanks.values() if _outside(tank, size, center) is None]
            return inside[0] if inside else None
        tank = self._tank(call, "container", container)
        axis = _outside(tank, size, center)
        if axis is not None:
            low, high = tank.low[axis], tank.low[axis] + tank.inner_size[axis]
            call.fail(
                f"the box reaches {'xyz'[axis]} = {center[axis] - size[axis] / 2:g} to "
                f"{center[axis] + size[axis] / 2:g} m, outside the hollow of {shown(tank.name)}, {low:g} to {high:g} m"
            )
        return tank

    def _check_overlap(self, call: Call, fluid: Fluid) -> None:
        for other in self._fluids:
            gaps = [abs(fluid.center[i] - other.center[i]) - (fluid.size[i] + other.size[i]) / 2 for i in range(3)]
            if max(gaps) < -_TOUCH:
                call.fail(f"the fluid overlaps {shown(other.name)}; move it or make one of them smaller")


def _filling(
    call: Call, tank: Tank, under: Fluid | None, level: float | None, volume: float | None
) -> tuple[Vec3, Vec3]:
    """Size and centre of the fluid in a tank [m], on what fills it so far."""
    x, y, high = tank.inner_size
    bottom = 0.0 if under is None else under.surface - tank.floor
    if level is None:
        amount = call.positive("volume", volume, 1e9, "m^3")
        depth, what = bottom + amount / (x * y), f"volume = {amount:g} m^3"
    else:
        depth = call.number("level", level, "m")
        if depth != 0.0:
            depth = call.size("level", level)
        what = f"level = {depth:g} m"
        if under is not None and depth < bottom + _TOUCH:
            call.fail(
                f"{what} is not above {shown(under.name)}, which fills tank {shown(tank.name)} to {bottom:g} m; what "
                "fills a tank after it lies on it"
            )
    if depth > high + _TOUCH:
        call.fail(f'{what} is above the rim of tank "{tank.name}": its hollow is {high:g} m high')
    middle = tank.floor + 0.5 * (bottom + depth)
    return (x, y, depth - bottom), (tank.inner_center[0], tank.inner_center[1], middle)


def _check_thickness(call: Call, size: Vec3, spacing: float, field: str, what: str) -> None:
    thinnest = min(size)
    if thinnest < spacing * (1.0 - 1e-9):
        call.fail(
            f"spacing = {spacing:g} m is wider than {what}: its {field}, least edge {thinnest:g} m, must hold at "
            f"least one particle; take spacing <= {thinnest / 4:.3g}"
        )


def _check_coarse(call: Call, tank: Tank, spacing: float) -> None:
    least = min(tank.inner_size)
    if least < LEAST_ACROSS * spacing * (1.0 - 1e-9):
        call.fail(
            f'spacing = {spacing:g} m is too coarse for tank "{tank.name}": its inner_size, least edge {least:g} m, '
            f"must hold {LEAST_ACROSS} particles; take spacing <= {least / LEAST_ACROSS:.3g}, or a larger tank"
        )


def _outside(tank: Tank, size: Vec3, center: Vec3) -> int | None:
    """The first axis along which a box leaves the hollow of a tank; None if it lies inside."""
    for axis in range(3):
        low, high = center[axis] - size[axis] / 2, center[axis] + size[axis] / 2
        if low < tank.low[axis] - _TOUCH or high > tank.low[axis] + tank.inner_size[axis] + _TOUCH:
            return axis
    return None
