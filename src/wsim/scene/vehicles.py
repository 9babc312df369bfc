"""Wheeled vehicles: a body on four sprung wheels, steered, driven and braked, made of ordinary prims."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from pxr import Gf, Usd, UsdPhysics

from wsim.limits import MAX_DRIVE_SPEED, MAX_POSITION
from wsim.scene.authoring import Handle, rotation
from wsim.scene.bodies import MassProperties
from wsim.scene.compounds import Compounds, Part
from wsim.scene.contacts import Contacts
from wsim.scene.joints import Drive, Joints, write_drive, write_friction
from wsim.scene.materials import Material
from wsim.scene.validate import Call, Vec3
from wsim.scene.vehicle_looks import Piece, body_pieces, wheel_pieces
from wsim.scene.vehicle_spec import CORNERS, VehicleSpec, spec_of

_HERE = (0.0, 0.0, 0.0)
_SLIP = 1.0  # [rad/s]: an engine gives its full torque to a wheel that lags by so much
_STEER_STEP = 0.625e-3  # [s]: the time step that the stiffness of the steering leaves
_STEER_SHARE = 0.25  # of 1 / omega, that a step may be
_GYRATION = 0.4  # of an upright, in radii of its wheel


@dataclass(frozen=True)
class Vehicle(Handle):
    """A vehicle: its body is the handle itself; `wheels`, `steering` and `axles` are by corner, such as "front_left".

    What `drive`, `steer` and `brake` say holds for the whole run, from its start; the last call of each counts.
    """

    spec: VehicleSpec
    wheels: dict[str, Handle]
    steering: dict[str, Handle]  # hinges of the front wheels about the vertical
    axles: dict[str, Handle]  # hinges that the wheels turn on
    _stage: Usd.Stage = field(repr=False, compare=False)
    _asked: dict[str, float] = field(repr=False, compare=False, default_factory=dict)

    def drive(self, speed: float) -> None:
        """Let the engine hold a speed of the rear axle's middle [m/s], negative backwards, and let go of the brakes.

        Its torque at a driven wheel is at most what the engine gives at this speed, by its torque and its power.
        """
        call = Call("vehicle.drive", self.name)
        self._asked["speed"] = call.within("speed", speed, -MAX_DRIVE_SPEED, MAX_DRIVE_SPEED, "m/s")
        for corner in CORNERS:
            if self._prim(self.axles[corner]).HasAttribute("newton:friction"):
                self._prim(self.axles[corner]).GetAttribute("newton:friction").Set(0.0)
        self._author_drive()

    def steer(self, angle_deg: float) -> None:
        """Turn the front wheels to the left [deg], each by Ackermann's geometry for this angle between them."""
        call, most = Call("vehicle.steer", self.name), self.spec.steer_limit_deg
        angle = call.within("angle_deg", angle_deg, -most, most, "deg")
        self._asked["steer"] = angle
        for corner, joint in self.steering.items():
            api = UsdPhysics.DriveAPI(self._prim(joint), "angular")
            api.GetTargetPositionAttr().Set(self.spec.wheel_angle_deg(corner, angle))
        self._author_drive()

    def brake(self, share: float = 1.0) -> None:
        """Press all brakes with a share, 0 to 1, of their torque, and take the engine off."""
        torque = Call("vehicle.brake", self.name).fraction("share", share) * self.spec.brake_torque
        self._asked.pop("speed", None)
        for corner in CORNERS:
            prim = self._prim(self.axles[corner])
            write_friction(prim, torque)
            prim.RemoveAPI(UsdPhysics.DriveAPI, "angular")

    def _author_drive(self) -> None:
        speed = self._asked.get("speed")
        if speed is None:
            return
        spec, steer = self.spec, self._asked.get("steer", 0.0)
        torque = spec.wheel_torque(speed)
        for corner in spec.driven_corners:
            turns = spec.wheel_speed(corner, speed, steer) / spec.wheel_radius
            motor = Drive(velocity=math.degrees(turns), damping=torque / _SLIP, max_force=torque)
            write_drive(self._prim(self.axles[corner]), "angular", motor, math.pi / 180.0)

    def _prim(self, handle: Handle) -> Usd.Prim:
        return self._stage.GetPrimAtPath(handle.path)


@dataclass(frozen=True)
class _Frame:
    """Where a vehicle stands: places and directions of its own in the world."""

    origin: Gf.Vec3d
    turn: Gf.Quatd
    rotation_deg: Vec3
    velocity: Vec3
    speed: float

    def at(self, x: float, y: float, z: float) -> Vec3:
        """A place [m]."""
        return _tuple(self.origin + self.turn.Transform(Gf.Vec3d(x, y, z)))

    def along(self, x: float, y: float, z: float) -> Vec3:
        """A direction."""
        return _tuple(self.turn.Transform(Gf.Vec3d(x, y, z)))


class Vehicles(Compounds, Joints, Contacts):
    """The call that makes vehicles."""

    def vehicle(
        self,
        name: str,
        spec: VehicleSpec | str = "car",
        *,
        position: Sequence[float] = _HERE,
        yaw_deg: float = 0.0,
        pitch_deg: float = 0.0,
        roll_deg: float = 0.0,
        speed: float = 0.0,
    ) -> Vehicle:
        """Make a vehicle that stands on its wheels: body, springs and dampers with stops, Ackermann steering, brakes.

        It rolls freely until `drive` or `brake` of what is returned is called. Its bodies are `name` and, by corner,
        `name`_wheel_front_left, `name`_hub_… (between spring and wheel) and `name`_knuckle_… (of the steered ones); its
        joints `name`_spring_…, `name`_steer_… and `name`_axle_….

        Args:
            name: Of the body's prim, with which the others begin.
            spec: A `VehicleSpec`, or "hmmwv", "polaris", "car", "truck", "cart".
            position: Of the point of the ground between the axles [m].
            yaw_deg: To the left [deg].
            pitch_deg: Nose down [deg]: that of the ground, on a slope up ahead negative.
            roll_deg: Left side up [deg]: that of the ground, too.
            speed: Forward at the start, with wheels that roll [m/s].

        Raises:
            SceneError: If there is no such kind, or a number of the spec is out of range or does not fit the others.
        """
        call = Call("vehicle", name)
        self._path(call)
        made = spec_of(call, spec)
        frame = self._frame(call, position, (roll_deg, pitch_deg, yaw_deg), speed)
        body = self._vehicle_body(name, made, frame)
        tyre = self.material(f"{name}_tyre", friction=made.friction, rolling=made.rolling, color=(0.04, 0.04, 0.045))
        wheels, steering, axles = {}, {}, {}
        for corner in CORNERS:
            holder = self._spring(name, corner, made, frame, body)
            if corner.startswith("front"):
                steering[corner], holder = self._steering(name, corner, made, frame, holder)
            wheels[corner] = self._wheel(name, corner, made, frame, tyre)
            axles[corner] = self.joint_revolute(
                f"{name}_axle_{corner}", holder, wheels[corner], axis=frame.along(0.0, 1.0, 0.0)
            )
        return Vehicle(body.name, body.path, body.kind, made, wheels, steering, axles, self._stage)

    def _frame(self, call: Call, position: Sequence[float], turns_deg: Vec3, speed: float) -> _Frame:
        place = call.position("position", position)
        turns = (
            call.within("roll_deg", turns_deg[0], -60.0, 60.0, "deg"),
            call.within("pitch_deg", turns_deg[1], -60.0, 60.0, "deg"),
            call.within("yaw_deg", turns_deg[2], -MAX_POSITION, MAX_POSITION, "deg"),
        )
        fast = call.within("speed", speed, -MAX_DRIVE_SPEED, MAX_DRIVE_SPEED, "m/s")
        turn = rotation(turns)
        return _Frame(Gf.Vec3d(*place), turn, turns, _tuple(turn.Transform(Gf.Vec3d(fast, 0.0, 0.0))), fast)

    def _vehicle_body(self, name: str, spec: VehicleSpec, frame: _Frame) -> Handle:
        """The sprung mass, its origin on the ground between the axles."""
        inertia = np.diag(spec.body_inertia)
        properties = MassProperties.of(spec.sprung_mass, np.array(spec.com), inertia)
        return self._piece(name, body_pieces(spec), frame, _HERE, properties)

    def _wheel(self, name: str, corner: str, spec: VehicleSpec, frame: _Frame, tyre: Material) -> Handle:
        x, y = spec.place(corner)
        spin = spec.wheel_inertia
        inertia = np.diag([0.5 * spin + spec.wheel_mass * spec.wheel_width**2 / 12.0, spin,
                           0.5 * spin + spec.wheel_mass * spec.wheel_width**2 / 12.0])  # fmt: skip
        properties = MassProperties.of(spec.wheel_mass, np.zeros(3), inertia)
        turns = math.degrees(frame.speed / spec.wheel_radius)
        rolls = _tuple(Gf.Vec3d(*frame.along(0.0, 1.0, 0.0)) * turns)
        pieces = wheel_pieces(spec)
        return self._piece(f"{name}_wheel_{corner}", pieces, frame, (x, y, spec.wheel_radius), properties, tyre, rolls)

    def _spring(self, name: str, corner: str, spec: VehicleSpec, frame: _Frame, body: Handle) -> Handle:
        """A hub that goes up and down under the body, on a spring that carries its share of the weight at zero."""
        front = corner.startswith("front")
        mass = 0.5 * spec.upright_mass if front else spec.upright_mass
        hub = self._upright(f"{name}_hub_{corner}", corner, spec, frame, mass)
        up = Gf.Vec3d(*frame.along(0.0, 0.0, 1.0))
        carried = spec.load(corner, self._weight(up)) - self._weight(up) * (spec.wheel_mass + spec.upright_mass)
        stiffness, damping = (
            (spec.spring_front, spec.damper_front) if front else (spec.spring_rear, spec.damper_rear)
        )  # fmt: skip
        drive = Drive(position=-carried / stiffness, stiffness=stiffness, damping=damping)
        self.joint_prismatic(f"{name}_spring_{corner}", body, hub, axis=_tuple(up),
                             limits=(-spec.travel_down, spec.travel_up), drive=drive)  # fmt: skip
        return hub

    def _steering(
        self, name: str, corner: str, spec: VehicleSpec, frame: _Frame, hub: Handle
    ) -> tuple[Handle, Handle]:  # fmt: skip
        """A knuckle that turns about the vertical: its hinge, and itself."""
        mass = 0.5 * spec.upright_mass
        knuckle = self._upright(f"{name}_knuckle_{corner}", corner, spec, frame, mass)
        inertia = 0.5 * mass * (_GYRATION * spec.wheel_radius) ** 2  # of two alike against each other
        stiffness = inertia * (_STEER_SHARE / _STEER_STEP) ** 2
        damping = 2.0 * math.sqrt(stiffness * (inertia + 0.5 * spec.wheel_inertia))
        most = 1.2 * max(abs(spec.wheel_angle_deg(corner, side * spec.steer_limit_deg)) for side in (-1, 1))
        hinge = self.joint_revolute(f"{name}_steer_{corner}", hub, knuckle, axis=frame.along(0.0, 0.0, 1.0),
                                    limits_deg=(-most, most),
                                    drive=Drive(stiffness=stiffness, damping=damping))  # fmt: skip
        return hinge, knuckle

    def _upright(self, name: str, corner: str, spec: VehicleSpec, frame: _Frame, mass: float) -> Handle:
        """A small body beside a wheel, inside of it, which meets nothing."""
        x, y = spec.place(corner)
        inward = math.copysign(0.5 * spec.wheel_width, -y)
        part = Part("cylinder", radius=0.25 * spec.wheel_radius, height=0.4 * spec.wheel_width, axis="Y",
                    position=(0.0, inward, 0.0), color=(0.2, 0.2, 0.21))  # fmt: skip
        properties = MassProperties.of(mass, np.zeros(3), mass * (_GYRATION * spec.wheel_radius) ** 2 * np.eye(3))
        return self._piece(name, [Piece(part, True)], frame, (x, y, spec.wheel_radius), properties)

    def _piece(
        self, name: str, pieces: list[Piece], frame: _Frame, at: Vec3, properties: MassProperties,
        surface: Material | None = None, spin_deg: Vec3 = _HERE,
    ) -> Handle:  # fmt: skip
        """One body of given mass properties, in the vehicle's frame; its trim does not collide."""
        parts = [replace(piece.part, material=piece.part.material or surface) for piece in pieces]
        body = self.compound(name, parts=parts, position=frame.at(*at), rotation_deg=frame.rotation_deg,
                             velocity=frame.velocity, angular_velocity_deg=spin_deg)  # fmt: skip
        prim = self._stage.GetPrimAtPath(body.path)
        for k, piece in enumerate(pieces):
            if piece.trim:
                prim.GetChild(f"part_{k}").RemoveAPI(UsdPhysics.CollisionAPI)
        mass = UsdPhysics.MassAPI(prim)
        mass.GetMassAttr().Set(properties.mass)
        mass.GetCenterOfMassAttr().Set(properties.com)
        mass.GetDiagonalInertiaAttr().Set(properties.inertia)
        mass.GetPrincipalAxesAttr().Set(properties.axes)
        return body

    def _weight(self, up: Gf.Vec3d) -> float:
        """Gravity against a direction [m/s^2]."""
        scene = next(prim for prim in self._stage.Traverse() if prim.IsA(UsdPhysics.Scene))
        magnitude = float(UsdPhysics.Scene(scene).GetGravityMagnitudeAttr().Get())
        return magnitude * max(0.0, float(Gf.Dot(up, self._up)))


def _tuple(vector: Gf.Vec3d) -> Vec3:
    return float(vector[0]), float(vector[1]), float(vector[2])
