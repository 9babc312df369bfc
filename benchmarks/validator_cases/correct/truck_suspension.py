"""A four-wheeled truck with sprung axles drives over speed bumps.

The chassis hangs on four vertical sliders (springs and dampers); each slider carries a hub, and each hub a wheel with a
velocity drive. `control` ramps the wheels up, then brakes.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from wsim.scene import Drive, Handle, Material, Scene

# --- dimensions [m] and masses [kg] ---------------------------------------------------------------------------------
WHEEL_RADIUS = 0.18
WHEEL_WIDTH = 0.12
WHEELBASE = 1.3
TRACK = 0.8
CLEARANCE = 0.22
CHASSIS = (1.7, 0.6, 0.16)
CHASSIS_MASS = 120.0
CABIN = (0.5, 0.55, 0.4)
WHEEL_MASS = 8.0
HUB_MASS = 3.0

# --- drive ----------------------------------------------------------------------------------------------------------
CRUISE = 12.0  # [rad/s]
RAMP_TIME = 1.0  # [s]
BRAKE_AT = 5.0  # [s]


@dataclass(frozen=True)
class Corner:
    """One corner of the truck."""

    name: str
    front: bool
    left: bool

    @property
    def x(self) -> float:
        return WHEELBASE / 2 if self.front else -WHEELBASE / 2

    @property
    def y(self) -> float:
        return TRACK / 2 if self.left else -TRACK / 2


@dataclass(frozen=True)
class Suspension:
    stiffness: float
    damping: float
    travel: float = 0.08

    def drive(self, preload: float) -> Drive:
        """A spring that carries `preload` [N] at rest."""
        return Drive(position=-preload / self.stiffness, stiffness=self.stiffness, damping=self.damping)


def corners() -> Iterator[Corner]:
    for front in (True, False):
        for left in (True, False):
            name = f"{'front' if front else 'rear'}_{'left' if left else 'right'}"
            yield Corner(name, front, left)


def add_chassis(scene: Scene, paint: Material) -> Handle:
    z = WHEEL_RADIUS + CLEARANCE
    chassis = scene.box("chassis", size=CHASSIS, position=(0.0, 0.0, z), mass=CHASSIS_MASS, material=paint)
    cabin = scene.box(
        "cabin",
        size=CABIN,
        position=(0.35, 0.0, z + CHASSIS[2] / 2 + CABIN[2] / 2 + 0.01),
        mass=25.0,
        material=paint,
        color=(0.75, 0.8, 0.85),
    )
    scene.joint_fixed("cabin_mount", chassis, cabin)
    return chassis


def add_corner(scene: Scene, chassis: Handle, corner: Corner, suspension: Suspension, rubber: Material) -> Handle:
    center = np.array([corner.x, corner.y, WHEEL_RADIUS])
    inward = -1.0 if corner.left else 1.0
    hub_at = center + np.array([0.0, inward * (WHEEL_WIDTH / 2 + 0.04), 0.0])
    hub = scene.box(f"hub_{corner.name}", size=(0.06, 0.05, 0.06), position=hub_at, mass=HUB_MASS)
    share = (CHASSIS_MASS + 25.0) * 9.81 / 4
    scene.joint_prismatic(
        f"spring_{corner.name}",
        chassis,
        hub,
        axis="Z",
        limits=(-suspension.travel, suspension.travel),
        drive=suspension.drive(preload=share),
    )
    wheel = scene.cylinder(
        f"wheel_{corner.name}",
        radius=WHEEL_RADIUS,
        height=WHEEL_WIDTH,
        axis="Y",
        position=center,
        mass=WHEEL_MASS,
        material=rubber,
    )
    scene.joint_revolute(f"axle_{corner.name}", hub, wheel, anchor=center, axis="Y", drive=Drive(damping=60.0, max_force=150.0))
    return wheel


def add_bumps(scene: Scene, count: int = 3, pitch: float = 1.5) -> None:
    for k in range(count):
        scene.capsule(
            f"bump_{k}",
            radius=0.05,
            height=2.0,
            axis="Y",
            position=(2.0 + k * pitch, 0.0, -0.015),
            static=True,
            color=(0.9, 0.8, 0.1) if k % 2 else (0.1, 0.1, 0.1),
        )


def build(scene: Scene) -> None:
    scene.simulation(duration=7.0, frame_rate=60.0)
    scene.ground(friction=0.9)
    paint = scene.material("paint", friction=0.4, color=(0.6, 0.08, 0.05))
    rubber = scene.material("rubber", density=1100.0, friction=1.0, color=(0.03, 0.03, 0.03))

    soft = Suspension(
        stiffness=scene.param("spring_rate", 9000.0, low=3000.0, high=30000.0, unit="N/m"),
        damping=scene.param("damper", 600.0, low=100.0, high=3000.0, unit="N s/m"),
    )
    firm = replace(soft, stiffness=1.2 * soft.stiffness)

    chassis = add_chassis(scene, paint)
    wheels = {c.name: add_corner(scene, chassis, c, firm if c.front else soft, rubber) for c in corners()}
    assert set(wheels) == {c.name for c in corners()}
    add_bumps(scene)

    scene.light("sun", direction=(-0.5, 0.4, -1.0))
    scene.camera("chase", eye=(-4.0, -2.5, 1.8), target=(1.0, 0.0, 0.3))
    scene.camera("side", eye=(2.5, -6.0, 1.5), target=(2.5, 0.0, 0.3), fov=65.0)


def control(world, t: float) -> None:
    ramp = min(t / RAMP_TIME, 1.0) if t < BRAKE_AT else 0.0
    wanted = CRUISE * ramp * (1.0 - math.exp(-3.0 * t))
    for corner in corners():
        axle = world.joint(f"axle_{corner.name}")
        axle.force = np.clip(8.0 * (wanted - axle.velocity), -80.0, 80.0)


if __name__ == "__main__":
    from wsim import run

    run(build)
