"""Sound worlds of bodies on joints, drives, springs, ropes and moved parts."""

from __future__ import annotations

import math

from benchmarks.judge_families.drawn import Draw, mechanism
from wsim.scene import Drive, Scene


def _rod(scene: Scene, draw: Draw, name: str, length: float, start: tuple[float, float], angle: float) -> tuple:
    """A box that hangs from `start` = (x, z) at an angle from the plumb [rad]; the other end."""
    x, z = start[0] + length * math.sin(angle), start[1] - length * math.cos(angle)
    thick = length * draw.between(0.08, 0.2)
    scene.box(name, size=(thick, thick * draw.between(0.5, 1.0), length), position=((start[0] + x) / 2, 0,
              (start[1] + z) / 2), rotation_deg=(0, -math.degrees(angle), 0), density=draw.density(length))  # fmt: skip
    return x, z


@mechanism("gravity", "hinge", "inertia", "joint", "swings")
def pendulum(scene: Scene, draw: Draw) -> None:
    """A rod swings on a hinge."""
    draw.gravity(scene, 1.2, low=2.0)
    length = draw.log(0.03, 10.0)
    _rod(scene, draw, "rod", length, (0.0, length), math.radians(draw.between(20, 120)))
    scene.joint_revolute("pivot", None, "rod", anchor=(0, 0, length), axis="Y")


@mechanism("gravity", "hinge", "inertia", "joint", "mass", "swings")
def double_pendulum(scene: Scene, draw: Draw) -> None:
    """Two rods swing on two hinges."""
    draw.gravity(scene, 1.0, low=2.0)
    length = draw.log(0.03, 5.0)
    end = _rod(scene, draw, "upper", length, (0.0, 2 * length), math.radians(draw.between(20, 100)))
    _rod(scene, draw, "lower", length * draw.between(0.6, 1.0), end, math.radians(draw.between(-60, 100)))
    scene.joint_revolute("pivot", None, "upper", anchor=(0, 0, 2 * length), axis="Y")
    scene.joint_revolute("elbow", "upper", "lower", anchor=(end[0], 0, end[1]), axis="Y")


@mechanism("gravity", "joint", "swings")
def ball_joint(scene: Scene, draw: Draw) -> None:
    """A rod swings round on a ball joint."""
    g = draw.gravity(scene, 1.2, low=2.0)
    length = draw.log(0.03, 10.0)
    angle = math.radians(draw.between(20, 70))
    thick = length * draw.between(0.08, 0.2)
    centre = (0.5 * length * math.sin(angle), 0, length - 0.5 * length * math.cos(angle))
    rate = draw.between(0.0, 1.0) * math.sqrt(g / length)
    scene.box("rod", size=(thick, thick, length), position=centre, rotation_deg=(0, -math.degrees(angle), 0),
              density=draw.density(length), velocity=(0, rate * centre[0], 0),
              angular_velocity_deg=(0, 0, math.degrees(rate)))  # fmt: skip
    scene.joint_spherical("pivot", None, "rod", anchor=(0, 0, length))


@mechanism("gravity", "hinge", "joint", "limit")
def stop(scene: Scene, draw: Draw) -> None:
    """A rod swings on a hinge until a stop holds it."""
    draw.gravity(scene, 1.2, low=4.0)
    length = draw.log(0.03, 3.0)
    _rod(scene, draw, "rod", length, (0.0, length), math.radians(draw.between(50, 100)))
    way = draw.between(20, 45)
    scene.joint_revolute("pivot", None, "rod", anchor=(0, 0, length), axis="Y", limits_deg=(-way, way))


@mechanism("spring", "mass", "joint", "slider")
def oscillator(scene: Scene, draw: Draw) -> None:
    """A block on a rail swings on a spring, with or without damping."""
    draw.gravity(scene, 1.5)
    size = draw.log(0.02, 3.0)
    density = draw.density(size)
    mass, period, apart = size**3 * density, draw.between(0.4, 1.5), size * draw.between(1.5, 4.0)
    stiffness = mass * (2 * math.pi / period) ** 2
    scene.box("block", size=(size, size, size), position=(apart + size / 2, 0, 0), mass=mass)
    scene.joint_prismatic("rail", None, "block", axis="X")
    scene.spring("coil", None, "block", stiffness=stiffness, rest_length=apart * draw.between(0.6, 0.9),
                 damping=draw.pick((0.0, draw.between(0.02, 0.3))) * math.sqrt(stiffness * mass),
                 anchor_a=(0, 0, 0), anchor_b=(apart, 0, 0))  # fmt: skip


@mechanism("spring", "gravity", "air")
def bob(scene: Scene, draw: Draw) -> None:
    """A ball hangs on a spring and swings on it, up and down and to and fro."""
    g = draw.gravity(scene, 1.5, low=2.0)
    radius = draw.log(0.01, 1.0)
    density = draw.density(2 * radius)
    mass, long = density * 4 / 3 * math.pi * radius**3, radius * draw.between(4.0, 10.0)
    stiffness = mass * g / (long * draw.between(0.2, 0.8))
    scene.sphere("ball", radius=radius, position=(long * draw.between(0.0, 0.5), 0, 0), mass=mass)
    scene.spring("coil", None, "ball", stiffness=stiffness, rest_length=long, anchor_a=(0, 0, long),
                 damping=draw.pick((0.0, draw.between(0.02, 0.2))) * math.sqrt(stiffness * mass))  # fmt: skip


@mechanism("drive", "mass", "joint", "slider")
def lift(scene: Scene, draw: Draw) -> None:
    """A slider is driven to a height."""
    g = draw.gravity(scene, 1.5)
    size = draw.log(0.02, 3.0)
    density = draw.density(size)
    mass, rate = size**3 * density, draw.between(4.0, 12.0)
    scene.box("cage", size=(size, size, size), mass=mass)
    drive = Drive(position=size * draw.between(0.5, 2.0), stiffness=mass * rate**2,
                  damping=2 * mass * rate * draw.between(0.4, 1.0),
                  max_force=draw.pick((None, mass * g * draw.between(1.5, 4.0))))  # fmt: skip
    scene.joint_prismatic("rail", None, "cage", axis="Z", drive=drive)


@mechanism("drive", "inertia", "hinge", "joint")
def arm(scene: Scene, draw: Draw) -> None:
    """A rod on a hinge is driven to an angle."""
    draw.gravity(scene, 1.5)
    length = draw.log(0.05, 5.0)
    thick, mass = 0.15 * length, draw.density(length) * 0.02 * length**3
    turned, rate = mass * length**2 / 3, draw.between(5.0, 14.0)
    scene.box("rod", size=(length, thick, thick), position=(length / 2, 0, 0), mass=mass)
    drive = Drive(position=draw.between(20, 70) * draw.sign(), stiffness=turned * rate**2,
                  damping=2 * turned * rate * draw.between(0.3, 1.0))  # fmt: skip
    scene.joint_revolute("hub", None, "rod", anchor=(0, 0, 0), axis=draw.pick(("Y", "Z")), drive=drive)


@mechanism("drive", "inertia", "hinge", "joint", "wheel")
def wheel(scene: Scene, draw: Draw) -> None:
    """A wheel is brought to a speed by its motor."""
    draw.gravity(scene, 1.2)
    radius = draw.log(0.02, 3.0)
    mass, seconds = draw.density(2 * radius) * radius**3, draw.between(0.1, 0.6)
    turned, speed = 0.5 * mass * radius**2, draw.between(90, 500)
    scene.cylinder("wheel", radius=radius, height=0.3 * radius, axis="Y", mass=mass)
    limit = draw.pick((None, turned * math.radians(speed) / seconds * draw.between(0.5, 0.9)))
    drive = Drive(velocity=speed * draw.sign(), damping=turned / seconds, max_force=limit)
    scene.joint_revolute("axle", None, "wheel", anchor=(0, 0, 0), axis="Y", drive=drive)


@mechanism("gravity", "joint", "slider")
def rail(scene: Scene, draw: Draw) -> None:
    """A block slides down an inclined rail, against the rail's friction or without."""
    g = draw.gravity(scene, 1.0)
    size = draw.log(0.02, 5.0)
    density = draw.density(size)
    turn = math.radians(draw.between(15, 60))
    mass = density * size**3
    scene.box("block", size=(size, size, size), mass=mass)
    rubs = draw.pick((0.0, 0.4)) * mass * g * math.sin(turn)
    scene.joint_prismatic("rail", None, "block", axis=(math.cos(turn), 0, -math.sin(turn)), friction=rubs)


@mechanism("rope", "gravity", "air")
def tether(scene: Scene, draw: Draw) -> None:
    """A ball swings on a rope."""
    draw.gravity(scene, 1.2, low=2.0)
    radius = draw.log(0.01, 1.0)
    long, angle = radius * draw.between(4.0, 10.0), math.radians(draw.between(20, 70))
    scene.sphere("ball", radius=radius, position=(long * math.sin(angle), 0, long - long * math.cos(angle)),
                 density=draw.density(2 * radius))  # fmt: skip
    scene.rope("rope", None, "ball", anchor_a=(0, 0, long))


@mechanism("gravity", "kinematic", "contact", "friction")
def pusher(scene: Scene, draw: Draw) -> None:
    """A part on a stated path pushes a block along the ground."""
    draw.gravity(scene, 1.2)
    size = draw.size()
    scene.ground()
    scene.box("block", size=(size, size, 0.6 * size), position=(0, 0, 0.3 * size), density=draw.density(size),
              friction=draw.between(0.2, 0.6))  # fmt: skip
    scene.box("pusher", size=(0.4 * size, size, 0.5 * size), position=(-0.75 * size, 0, 0.3 * size), kinematic=True)
    way = draw.between(0.5, 2.0) * size
    scene.path(
        "pusher", times=[0.0, 1.0], positions=[(-0.75 * size, 0, 0.3 * size), (way - 0.75 * size, 0, 0.3 * size)]
    )
