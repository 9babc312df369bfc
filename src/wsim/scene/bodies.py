"""What all solid objects share: a pose, a mass, a motion, a surface, and how they are written to the stage."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from pxr import Gf, Usd, UsdGeom, UsdPhysics

from wsim.defaults import BODY_DENSITY
from wsim.scene.authoring import Handle, note_line, rotation, set_extent, set_pose
from wsim.scene.materials import Material, Materials, bind
from wsim.scene.principal import principal
from wsim.scene.rolling import RollingStart, Round
from wsim.scene.validate import Call, Vec3, shown


@dataclass(frozen=True)
class BodyOptions:
    """The arguments that every solid takes, as they were given."""

    position: Sequence[float]
    rotation_deg: Sequence[float]
    density: float | None
    mass: float | None
    velocity: Sequence[float]
    angular_velocity_deg: Sequence[float]
    static: bool
    kinematic: bool
    material: Handle | str | None
    friction: float | None
    restitution: float | None
    color: Sequence[float] | None
    rolling_friction: float | None = None
    rolling: bool = False


@dataclass(frozen=True)
class Start:
    """How a solid starts, in the world: position [m], velocity [m/s], spin [deg/s]."""

    position: Vec3
    turn: Gf.Quatd
    velocity: Vec3
    spin: Vec3
    moving: bool
    kinematic: bool


@dataclass(frozen=True)
class MassProperties:
    """Mass properties that geometry alone would not give: mass [kg], com [m], principal inertia [kg m^2] and axes."""

    mass: float
    com: Gf.Vec3f
    inertia: Gf.Vec3f
    axes: Gf.Quatf

    @classmethod
    def of(cls, mass: float, com: NDArray[np.float64], inertia: NDArray[np.float64]) -> MassProperties:
        """From a mass [kg], its centre (3,) [m] and the inertia about it (3, 3) [kg m^2]."""
        moments, axes = principal(inertia)
        return cls(mass, Gf.Vec3f(*com.tolist()), Gf.Vec3f(*moments.tolist()), axes)


class Bodies(Materials):
    """Writes a solid: an Xform with the body's physics, and one child with its geometry."""

    def __init__(self) -> None:
        super().__init__()
        self._up = Gf.Vec3d.ZAxis()  # against gravity
        self._rolling: list[RollingStart] = []

    def _solid(
        self,
        call: Call,
        options: BodyOptions,
        geometry: Callable[[str], UsdGeom.Gprim],
        mass_properties: Callable[[float | None, float | None], MassProperties | None] | None = None,
        rolls: Round | None = None,
    ) -> Handle:
        """Author one solid.

        Args:
            call: The call, for its name and errors.
            options: What the call was given.
            geometry: Defines the Gprim at a path, centred on the body.
            mass_properties: From (mass, density), what is to be written instead of leaving it to the geometry.
            rolls: How it rolls, of what is round.
        """
        path = self._path(call)
        start = self._start(call, options, rolls)
        mass, density = self._mass_or_density(call, options)
        material = self._surface(
            call,
            options.material,
            options.friction,
            options.restitution,
            options.color,
            rolling=options.rolling_friction,
        )
        if mass is None and density is None:
            density = material.density or BODY_DENSITY

        def author() -> MassProperties | None:
            shape = geometry(f"{path}/geometry").GetPrim()
            note_line(shape)
            finish_collider(shape, material)
            return mass_properties(mass, density) if mass_properties else None

        made = self._body_of(call, start, path, author, mass, density)
        if options.rolling and rolls is not None:
            prim = self._stage.GetPrimAtPath(path)
            self._rolling.append(RollingStart(call, prim, rolls, start.velocity, start.turn))
        return made

    def _turn_up(self, up: Gf.Vec3d) -> None:
        """Say which way is up; what was made to start rolling rolls by that. SceneError where it then cannot."""
        spins = [(start.prim, start.spin(up)) for start in self._rolling if start.prim]
        self._up = up
        for prim, spin in spins:
            UsdPhysics.RigidBodyAPI(prim).GetAngularVelocityAttr().Set(spin)

    def _start(self, call: Call, options: BodyOptions, rolls: Round | None = None) -> Start:
        """How a solid starts, checked before anything is authored."""
        position = call.position("position", options.position)
        turn = rotation(call.angles(options.rotation_deg))
        velocity = call.velocity(options.velocity)
        spin = call.spin(options.angular_velocity_deg)
        for field in ("static", "kinematic"):
            call.flag(field, getattr(options, field))
        moving = self._moving(call, options, velocity, spin)
        if not isinstance(options.rolling, bool):
            call.fail(f"rolling = {shown(options.rolling)} must be True or False; its resistance is rolling_friction")
        if options.rolling and rolls is not None:
            spin = self._spin_of(call, options, velocity, spin, turn, rolls)
        return Start(position, turn, velocity, spin, moving, options.kinematic)

    def _body_of(
        self,
        call: Call,
        start: Start,
        path: str,
        author: Callable[[], MassProperties | None],
        mass: float | None = None,
        density: float | None = None,
    ) -> Handle:
        """Author the Xform of a solid, and what `author` puts under it; what that gives weighs before the rest."""
        prim = UsdGeom.Xform.Define(self._stage, path).GetPrim()
        note_line(prim)
        set_pose(prim, start.position, start.turn)
        if start.moving:
            _make_rigid(prim, start.turn, start.velocity, start.spin, kinematic=start.kinematic)
        properties = author()
        if start.moving:
            _set_mass(prim, mass, density, properties)
        return Handle(name=prim.GetName(), path=path, kind="body" if start.moving else "static")

    def _mass_or_density(self, call: Call, options: BodyOptions) -> tuple[float | None, float | None]:
        mass = None if options.mass is None else call.mass(options.mass)
        density = None if options.density is None else call.density(options.density)
        if mass is not None and density is not None:
            call.fail(f"mass = {mass:g} kg and density = {density:g} kg/m^3 are both given; give one")
        if options.static and not (mass is None and density is None):
            said = f"density = {density:g} kg/m^3" if mass is None else f"mass = {mass:g} kg"
            call.fail(f"{said} on a static object, which nothing moves; leave it out, or give static=False")
        return mass, density

    def _moving(self, call: Call, options: BodyOptions, velocity: Vec3, spin: Vec3) -> bool:
        if options.static and options.kinematic:
            call.fail("static = True and kinematic = True are both given; a static object never moves")
        if options.static and (any(velocity) or any(spin)):
            field, value = ("velocity", velocity) if any(velocity) else ("angular_velocity_deg", spin)
            call.fail(f"{field} = {value} on a static object; leave it out, or give static=False")
        return not options.static

    def _spin_of(
        self, call: Call, options: BodyOptions, velocity: Vec3, spin: Vec3, turn: Gf.Quatd, rolls: Round
    ) -> Vec3:
        """The spin with which it starts, where it is to roll."""
        if options.static or options.kinematic:
            what = "static" if options.static else "kinematic"
            call.fail(f"rolling = True on a {what} object; only a loose body rolls")
        if any(spin):
            call.fail(
                f"rolling = True and angular_velocity_deg = {spin} are both given; rolling gives the spin: keep one"
            )
        return rolls.spin(call, velocity, turn, self._up)


def _make_rigid(prim: Usd.Prim, turn: Gf.Quatd, velocity: Vec3, spin: Vec3, *, kinematic: bool) -> None:
    body = UsdPhysics.RigidBodyAPI.Apply(prim)
    if kinematic:
        body.CreateKinematicEnabledAttr(True)
    set_start(prim, turn, velocity, spin)


def set_start(prim: Usd.Prim, turn: Gf.Quatd, velocity: Vec3, spin: Vec3) -> None:
    """State how a body starts, in the world [m/s, deg/s]: UsdPhysics has it in the body's own axes."""
    body, back = UsdPhysics.RigidBodyAPI(prim), turn.GetInverse()
    if any(velocity):
        body.CreateVelocityAttr(Gf.Vec3f(back.Transform(Gf.Vec3d(*velocity))))
    if any(spin):
        body.CreateAngularVelocityAttr(Gf.Vec3f(back.Transform(Gf.Vec3d(*spin))))


def _set_mass(prim: Usd.Prim, mass: float | None, density: float | None, given: MassProperties | None) -> None:
    api = UsdPhysics.MassAPI.Apply(prim)
    if given is not None:
        api.CreateMassAttr(given.mass)
        api.CreateCenterOfMassAttr(given.com)
        api.CreateDiagonalInertiaAttr(given.inertia)
        api.CreatePrincipalAxesAttr(given.axes)
    elif mass is not None:
        api.CreateMassAttr(mass)
    elif density is not None:
        api.CreateDensityAttr(density)


def finish_collider(prim: Usd.Prim, material: Material) -> None:
    """Make a piece of geometry collide, and give it its surface."""
    UsdPhysics.CollisionAPI.Apply(prim)
    set_extent(prim)
    bind(prim, material)
