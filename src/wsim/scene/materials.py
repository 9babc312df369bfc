"""Materials: how a surface looks and how it rubs, bounces and weighs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from pxr import Gf, Sdf, Usd, Vt

from wsim.scene import schema, specs
from wsim.scene.authoring import LOOKS, Author, Handle, calling_line
from wsim.scene.specs import define, put, spec_of
from wsim.scene.validate import Call, Vec3, shown, suggestion

# Told apart by people with any kind of colour vision (Okabe and Ito 2008), linear RGB.
_PALETTE: tuple[Vec3, ...] = (
    (0.79, 0.35, 0.0),
    (0.09, 0.45, 0.81),
    (0.0, 0.34, 0.17),
    (0.87, 0.78, 0.05),
    (0.0, 0.17, 0.45),
    (0.67, 0.11, 0.0),
    (0.6, 0.19, 0.39),
)


@dataclass(frozen=True)
class Material(Handle):
    """A material by name.

    `density` [kg/m^3] is None where it is left to the object, `friction`, `restitution` and `rolling` where they are
    left to what it touches.
    """

    density: float | None
    friction: float | None
    restitution: float | None
    color: Vec3
    opacity: float
    rolling: float | None = None


@dataclass(frozen=True)
class Look:
    """How light meets a surface, beyond colour and opacity."""

    roughness: float = 0.6
    metallic: float = 0.0
    ior: float = 1.5


class Materials(Author):
    """The calls that make materials."""

    def __init__(self) -> None:
        super().__init__()
        self._materials: dict[str, Material] = {}
        self._colors_used = 0

    def material(
        self,
        name: str,
        *,
        density: float | None = None,
        friction: float | None = None,
        restitution: float | None = None,
        rolling: float | None = None,
        color: Sequence[float] = (0.7, 0.7, 0.7),
        opacity: float = 1.0,
    ) -> Material:
        """Make a material that objects can name.

        Args:
            name: Name of the prim, under /World/Looks.
            density: [kg/m^3]; what an object made of it weighs unless the object says otherwise.
            friction: Coefficient of friction, 0 to 10. Of two surfaces the smaller counts; not given, the other's,
                and 0.5 if neither states one.
            restitution: 0 (dead) to 1 (elastic); likewise, and 0 if neither states one.
            rolling: Rolling resistance, 0 to 1: the torque that slows a ball, a wheel or a log is this times its radius
                times the push on it. Of two surfaces the larger counts; 0 if neither states one.
            color: Linear red, green, blue, 0 to 1.
            opacity: 0 (clear) to 1.

        Raises:
            SceneError: If the name is taken or a number is out of range.
        """
        call = Call("material", name)
        path = self._path(call, LOOKS)
        material = Material(
            name=name,
            path=path,
            kind="material",
            density=None if density is None else call.density(density),
            friction=None if friction is None else call.friction(friction),
            restitution=None if restitution is None else call.fraction("restitution", restitution),
            rolling=None if rolling is None else call.fraction("rolling", rolling),
            color=call.color("color", color),
            opacity=call.fraction("opacity", opacity),
        )
        self._materials[name] = self._author_material(material)
        return material

    def _author_material(self, material: Material, look: Look | None = None) -> Material:
        author_material(self._stage.GetRootLayer(), material, look or Look())
        return material

    def _surface(
        self,
        call: Call,
        material: Handle | str | None,
        friction: float | None,
        restitution: float | None,
        color: Sequence[float] | None,
        *,
        rolling: float | None = None,
        opacity: float = 1.0,
        look: Look | None = None,
    ) -> Material:
        """The material of an object: the one it names, or one of its own where it overrides or names none."""
        base = self._named(call, material)
        if base is not None and friction is None and restitution is None and rolling is None and color is None:
            return base
        name = str(call.name)
        while self._stage.GetPrimAtPath(f"{LOOKS}/{name}"):
            name += "_look"
        own = Material(
            name=name,
            path=f"{LOOKS}/{name}",
            kind="material",
            density=base.density if base else None,
            friction=call.friction(friction) if friction is not None else base.friction if base else None,
            restitution=(
                call.fraction("restitution", restitution)
                if restitution is not None
                else base.restitution
                if base
                else None
            ),
            color=call.color("color", color) if color is not None else base.color if base else self._next_color(),
            opacity=base.opacity if base else opacity,
            rolling=(
                call.fraction("rolling_friction", rolling) if rolling is not None else base.rolling if base else None
            ),
        )
        return self._author_material(own, look)

    def _named(self, call: Call, material: Handle | str | None) -> Material | None:
        if material is None or isinstance(material, Material):
            return material
        if isinstance(material, str) and material in self._materials:
            return self._materials[material]
        if not isinstance(material, str):
            call.fail(f"material = {shown(material)} must be what scene.material returned, or its name")
        hint = suggestion(material, self._materials)
        return call.fail(f'material = "{material}" is not in the scene; {hint}; make it with scene.material(name)')

    def _next_color(self) -> Vec3:
        self._colors_used += 1
        return _PALETTE[(self._colors_used - 1) % len(_PALETTE)]


def author_material(layer: Sdf.Layer, material: Material, look: Look) -> None:
    """Write a material and its shader: at once, as a stage composes anew after each change that it is told of."""
    kinds = Sdf.ValueTypeNames
    physics = {
        "density": material.density,
        "dynamicFriction": material.friction,
        "restitution": material.restitution,
        "staticFriction": material.friction,
    }
    looks = {"roughness": look.roughness, "metallic": look.metallic, "ior": look.ior, "opacity": material.opacity}
    with Sdf.ChangeBlock():
        define(layer, LOOKS, "Scope")
        usd = define(layer, material.path, "Material")
        surface = define(layer, f"{material.path}/surface", "Shader")
        put(surface, "info:id", kinds.Token, "UsdPreviewSurface", Sdf.VariabilityUniform)
        put(surface, "inputs:diffuseColor", kinds.Color3f, Gf.Vec3f(*material.color))
        for name, value in looks.items():
            put(surface, f"inputs:{name}", kinds.Float, value)
        output = put(surface, "outputs:surface", kinds.Token)
        put(usd, "outputs:surface", kinds.Token).connectionPathList.explicitItems = [output.path]
        for name, stated in physics.items():
            if stated is not None:
                put(usd, f"physics:{name}", kinds.Float, stated)
        schemas = ["PhysicsMaterialAPI"]
        if material.rolling is not None:
            put(usd, "wsim:rolling", kinds.Double, material.rolling, Sdf.VariabilityUniform)
            schemas.append(schema.MATERIAL)
        specs.apply(usd, *schemas)
        usd.customData = {"wsim": {"line": calling_line()}}


def bind(prim: Usd.Prim, material: Material) -> None:
    """Give a piece of geometry its material, and its colour for tools that read no materials."""
    kinds = Sdf.ValueTypeNames
    with Sdf.ChangeBlock():
        spec = spec_of(prim)
        specs.apply(spec, "MaterialBindingAPI")
        bound = spec.relationships.get("material:binding") or Sdf.RelationshipSpec(
            spec, "material:binding", custom=False
        )
        bound.targetPathList.explicitItems = [Sdf.Path(material.path)]
        put(spec, "primvars:displayColor", kinds.Color3fArray, Vt.Vec3fArray([Gf.Vec3f(*material.color)]))
        put(spec, "primvars:displayOpacity", kinds.FloatArray, Vt.FloatArray([material.opacity]))
