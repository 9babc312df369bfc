"""What a wheeled vehicle is in numbers, and the geometry of its steering."""

from __future__ import annotations

import math
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, fields
from functools import cache
from pathlib import Path
from typing import Any

from wsim.defaults import GRAVITY
from wsim.scene.validate import Call, shown, suggestion

DRIVEN = ("front", "rear", "all")
LOOKS = ("offroad", "buggy", "car", "truck", "cart")
CORNERS = ("front_left", "front_right", "rear_left", "rear_right")
LARGEST_STEER = 45.0  # [deg]
_PRESETS = Path(__file__).with_name("vehicles.toml")


@dataclass(frozen=True)
class VehicleSpec:
    """A vehicle of two axles and four wheels, the front ones steered. SI units; the defaults are those of a small car.

    Attributes:
        mass: Of all of it, wheels too [kg].
        wheelbase, track: Between the axles, and between the wheels of an axle [m].
        front_share: Share of the weight on the front axle, level.
        com_height: Of the centre of mass of all of it over the ground [m].
        inertia: Of the sprung body about its centre of mass, (roll, pitch, yaw) [kg m^2]; None: that of a box of its
            size.
        length, width, height, clearance: Of the body, and of its floor over the ground [m].
        wheel_radius, wheel_width, wheel_mass: Of a wheel with its tyre [m], [kg].
        upright_mass: What is between a wheel and the spring and goes up and down with the wheel [kg].
        spring_front, spring_rear: Stiffness at each wheel [N/m].
        damper_front, damper_rear: Damping at each wheel [N s/m].
        travel_up, travel_down: Of each wheel from where it rests to its stops [m].
        steer_limit_deg: Largest angle of the bicycle in the middle [deg], at which the inner wheel is turned by more.
        engine_torque, engine_power: The engine's largest [N m], [W].
        gear: Turns of the engine for one of a wheel.
        driven: "front", "rear" or "all": the wheels that the engine drives, each by an equal share.
        brake_torque: Of each wheel's brake, all four are alike [N m].
        friction, rolling: Of the tyres: coefficient of friction, and rolling resistance (torque / radius / load).
        looks: "offroad", "buggy", "car", "truck" or "cart".
        color: Of the body, RGB in 0..1.
    """

    mass: float = 1300.0
    wheelbase: float = 2.6
    track: float = 1.5
    front_share: float = 0.55
    com_height: float = 0.55
    inertia: tuple[float, float, float] | None = None
    length: float = 4.2
    width: float = 1.75
    height: float = 1.45
    clearance: float = 0.18
    wheel_radius: float = 0.31
    wheel_width: float = 0.195
    wheel_mass: float = 18.0
    upright_mass: float = 18.0
    spring_front: float = 25e3
    spring_rear: float = 24e3
    damper_front: float = 2.2e3
    damper_rear: float = 2.2e3
    travel_up: float = 0.08
    travel_down: float = 0.10
    steer_limit_deg: float = 32.0
    engine_torque: float = 200.0
    engine_power: float = 85e3
    gear: float = 13.0
    driven: str = "front"
    brake_torque: float = 2000.0
    friction: float = 0.9
    rolling: float = 0.012
    looks: str = "car"
    color: tuple[float, float, float] = (0.55, 0.08, 0.07)

    @property
    def sprung_mass(self) -> float:
        """Of the body alone [kg]."""
        return self.mass - 4.0 * (self.wheel_mass + self.upright_mass)

    @property
    def com(self) -> tuple[float, float, float]:
        """Centre of mass of the sprung body, from the point of the ground between the axles [m]."""
        unsprung = self.mass - self.sprung_mass
        x = self.mass * (self.front_share - 0.5) * self.wheelbase / self.sprung_mass
        z = (self.mass * self.com_height - unsprung * self.wheel_radius) / self.sprung_mass
        return x, 0.0, z

    @property
    def body_inertia(self) -> tuple[float, float, float]:
        """About the body's centre of mass, (roll, pitch, yaw) [kg m^2]."""
        if self.inertia is not None:
            return self.inertia
        a, b, c = self.length, self.width, self.height - self.clearance
        m = self.sprung_mass / 12.0
        return m * (b * b + c * c), m * (a * a + c * c), m * (a * a + b * b)

    @property
    def wheel_inertia(self) -> float:
        """About a wheel's axle [kg m^2]: of a rim of half its mass at half its radius, and a tyre near its radius."""
        return 0.5 * self.wheel_mass * self.wheel_radius**2 * (0.5**2 + 0.9**2)

    @property
    def driven_corners(self) -> tuple[str, ...]:
        """The wheels that the engine drives."""
        return CORNERS if self.driven == "all" else tuple(c for c in CORNERS if c.startswith(self.driven))

    @property
    def effective_mass(self) -> float:
        """What the driving force speeds up: the mass, and the wheels' inertia over their radius squared [kg]."""
        return self.mass + 4.0 * self.wheel_inertia / self.wheel_radius**2

    def braking(self, share: float = 1.0, ground: float = math.inf) -> float:
        """How fast it slows down on the level with its brakes pressed by a share [m/s^2].

        mu g where they lock the wheels, mu the smaller friction of the tyres and the `ground`; else what their torque
        gives.
        """
        most = min(self.friction, ground) * GRAVITY
        return min(most, 4.0 * share * self.brake_torque / self.wheel_radius / self.effective_mass)

    def load(self, corner: str, gravity: float) -> float:
        """Push of the level ground on a wheel at rest [N]."""
        share = self.front_share if corner.startswith("front") else 1.0 - self.front_share
        return 0.5 * share * self.mass * gravity

    def wheel_torque(self, speed: float) -> float:
        """Largest torque of the engine at each driven wheel [N m]: by its torque, or at a speed [m/s] by its power."""
        turns = max(abs(speed), 1e-6) / self.wheel_radius
        return min(self.engine_torque * self.gear, self.engine_power / turns) / len(self.driven_corners)

    def place(self, corner: str) -> tuple[float, float]:
        """Of a wheel from the middle between the axles: to the front, to the left [m]."""
        x = 0.5 * self.wheelbase if corner.startswith("front") else -0.5 * self.wheelbase
        return x, 0.5 * self.track if corner.endswith("left") else -0.5 * self.track

    def wheel_angle_deg(self, corner: str, steer_deg: float) -> float:
        """Angle of a wheel about the vertical [deg] for one of the bicycle in the middle (Ackermann's geometry).

        All axles point at one centre, on the line of the rear axle, wheelbase / tan(angle) to the left of its middle.
        """
        if not corner.startswith("front") or steer_deg == 0.0:
            return 0.0
        radius = self.turning_radius(steer_deg)
        return math.degrees(math.atan(self.wheelbase / (radius - self.place(corner)[1])))

    def turning_radius(self, steer_deg: float) -> float:
        """Of the middle of the rear axle [m], positive to the left; inf straight on."""
        return math.inf if steer_deg == 0.0 else self.wheelbase / math.tan(math.radians(steer_deg))

    def wheel_speed(self, corner: str, speed: float, steer_deg: float) -> float:
        """Of a wheel's centre along its own direction [m/s], where the middle of the rear axle has `speed`."""
        radius = self.turning_radius(steer_deg)
        if math.isinf(radius):
            return speed
        x, y = self.place(corner)
        return speed * math.hypot(x + 0.5 * self.wheelbase, radius - y) / abs(radius)


def presets() -> tuple[str, ...]:
    """The kinds of vehicle that there are."""
    return tuple(_table())


def spec_of(call: Call, given: object) -> VehicleSpec:
    """The spec that an argument means, checked: a kind's name, or a `VehicleSpec`."""
    if isinstance(given, VehicleSpec):
        return _checked(call, given)
    if not isinstance(given, str):
        call.fail(f"spec = {shown(given)} must be a VehicleSpec or one of {', '.join(presets())}")
    if given not in _table():
        call.fail(f"spec = {shown(given)} is no kind of vehicle; {suggestion(given, presets())}")
    return preset(given)


def preset(kind: str) -> VehicleSpec:
    """The spec of a kind; KeyError if there is none."""
    values: dict[str, Any] = {
        key: tuple(each) if isinstance(each, list) else each for key, each in _table()[kind].items()
    }
    return VehicleSpec(**values)


@cache
def _table() -> Mapping[str, dict[str, Any]]:
    return tomllib.loads(_PRESETS.read_text(encoding="utf-8"))


_UNITS = {"mass": "kg", "inertia": "kg m^2", "spring": "N/m", "damper": "N s/m", "torque": "N m", "power": "W"}
_FREE = ("front_share", "inertia", "driven", "looks", "color", "friction", "rolling", "steer_limit_deg", "gear")


def _checked(call: Call, spec: VehicleSpec) -> VehicleSpec:
    for field in fields(spec):
        if field.name not in _FREE:
            unit = next((unit for word, unit in _UNITS.items() if word in field.name), "m")
            call.positive(f"spec.{field.name}", getattr(spec, field.name), 1e7, unit)
    call.positive("spec.gear", spec.gear, 1e4, "")
    call.friction(spec.friction)
    call.fraction("spec.rolling", spec.rolling)
    call.within("spec.front_share", spec.front_share, 0.05, 0.95)
    call.positive("spec.steer_limit_deg", spec.steer_limit_deg, LARGEST_STEER, "deg")
    call.one_of("spec.driven", spec.driven, DRIVEN)
    call.one_of("spec.looks", spec.looks, LOOKS)
    call.color("spec.color", spec.color)
    if spec.inertia is not None:
        moments = sorted(call.vector("spec.inertia", spec.inertia, 1e9, "kg m^2"))
        if moments[0] <= 0.0 or moments[2] > moments[0] + moments[1]:
            call.fail(f"spec.inertia = {shown(spec.inertia)} kg m^2: all must be positive, and none more than the "
                      "other two together")  # fmt: skip
    _check_shape(call, spec)
    return spec


def _check_shape(call: Call, spec: VehicleSpec) -> None:
    """Whether its parts fit each other."""
    most = 0.45 * spec.wheelbase
    if spec.wheel_radius > most:
        call.fail(f"spec.wheel_radius = {spec.wheel_radius:g} m: at most {most:.3g} m on a wheelbase of "
                  f"{spec.wheelbase:g} m, or the wheels meet")  # fmt: skip
    if spec.sprung_mass <= 0.1 * spec.mass:
        rest = spec.mass - spec.sprung_mass
        call.fail(f"spec.mass = {spec.mass:g} kg: the wheels and uprights alone are {rest:g} kg; at most nine tenths")
    if spec.com[2] <= 0.0:
        call.fail(f"spec.com_height = {spec.com_height:g} m is so low that the body's own would be under the ground")
    turned = spec.wheel_radius * math.sin(math.radians(LARGEST_STEER)) + spec.wheel_width
    if 0.5 * spec.track <= turned:
        call.fail(f"spec.track = {spec.track:g} m leaves the steered wheels no room: more than {2 * turned:.3g} m")
    top = 2.0 * spec.wheel_radius + spec.travel_up
    if spec.height <= top + 0.05:
        call.fail(f"spec.height = {spec.height:g} m: the wheels at their upper stops reach {top:.3g} m; make it higher")
    if spec.clearance >= top:
        call.fail(f"spec.clearance = {spec.clearance:g} m must be less than the wheels' top, {top:.3g} m")
    if spec.length < spec.wheelbase:
        call.fail(f"spec.length = {spec.length:g} m is less than spec.wheelbase = {spec.wheelbase:g} m")
    if spec.width < spec.track - spec.wheel_width:
        call.fail(f"spec.width = {spec.width:g} m is narrower than between the wheels, "
                  f"{spec.track - spec.wheel_width:.3g} m")  # fmt: skip
