"""Sound worlds of bodies that nothing holds: they slide, stand, fly, bounce, roll and hit each other."""

from __future__ import annotations

import math

from benchmarks.judge_families.drawn import Draw, Vector, mechanism
from wsim.scene import Scene


def _flat(scene: Scene, draw: Draw, name: str, size: float, at: Vector, **options: object) -> float:
    """A low box or disc whose lower side is at `at`; its height."""
    height = size * draw.between(0.2, 0.4)
    place = (at[0], at[1], at[2] + 0.5 * height)
    if draw.pick((True, True, False)):
        scene.box(name, size=(size, size * draw.between(0.6, 1.0), height), position=place, **options)
    else:
        scene.cylinder(name, radius=0.5 * size, height=height, position=place, **options)
    return height


@mechanism("friction", "gravity", "slides", "contact", "single")
def slide(scene: Scene, draw: Draw) -> None:
    """A box or a disc slides on the ground until friction has stopped it, or nearly."""
    g, size, mu = draw.gravity(scene, 1.0), draw.size(), draw.between(0.1, 0.9)
    scene.ground(friction=max(mu, draw.between(0.1, 1.0)))
    speed = draw.speed(mu * g * draw.between(0.3, 1.2), 0.2 * size)
    x, y = draw.heading()
    _flat(scene, draw, "slider", size, (0, 0, 0), velocity=(speed * x, speed * y, 0), friction=mu,
          density=draw.density(size))  # fmt: skip


@mechanism("friction", "gravity", "slides", "contact", "single")
def slope(scene: Scene, draw: Draw) -> None:
    """A box slides down a slope, or up and down again."""
    g, size, angle = draw.gravity(scene, 1.0), draw.size(), draw.between(10.0, 40.0)
    turn, mu = math.radians(angle), math.tan(math.radians(angle)) * draw.between(0.2, 0.8)
    height, length = size * draw.between(0.2, 0.4), 40.0 * size
    scene.box("slope", size=(length, 4 * size, size), position=(0, 0, 0), rotation_deg=(0, angle, 0), static=True,
              friction=1.0)  # fmt: skip
    out = 0.5 * (size + height)
    speed = draw.speed(draw.between(-0.5, 0.5) * g, 0.1 * size)
    scene.box("slider", size=(size, 0.8 * size, height), position=(out * math.sin(turn), 0, out * math.cos(turn)),
              rotation_deg=(0, angle, 0), friction=mu, density=draw.density(size),
              velocity=(speed * math.cos(turn), 0, -speed * math.sin(turn)))  # fmt: skip


@mechanism("gravity", "rest", "contact")
def stack(scene: Scene, draw: Draw) -> None:
    """Two to four blocks stand on each other, a little out of line."""
    draw.gravity(scene, 0.8)
    size, top = draw.size(), 0.0
    scene.ground(friction=draw.between(0.3, 1.0))
    for k in range(draw.whole(2, 4)):
        off = (draw.between(-0.1, 0.1) * size, draw.between(-0.1, 0.1) * size)
        top += _flat(scene, draw, f"block_{k}", size, (*off, top), friction=draw.between(0.3, 1.0),
                     density=draw.density(size))  # fmt: skip


@mechanism("gravity", "rest", "contact", "single")
def lying(scene: Scene, draw: Draw) -> None:
    """A block lies on a slope that friction holds it on, or on the ground."""
    draw.gravity(scene, 0.8)
    size, angle = draw.size(), draw.pick((0.0, draw.between(5.0, 20.0)))
    turn, height = math.radians(angle), size * draw.between(0.2, 0.6)
    scene.box("slope", size=(6 * size, 4 * size, size), position=(0, 0, 0), rotation_deg=(0, angle, 0), static=True)
    out = 0.5 * (size + height)
    scene.box("block", size=(size, 0.8 * size, height), position=(out * math.sin(turn), 0, out * math.cos(turn)),
              rotation_deg=(0, angle, 0), friction=draw.between(0.6, 1.0), density=draw.density(size))  # fmt: skip


def _solid(scene: Scene, draw: Draw, name: str, size: float, **options: object) -> None:
    """Any solid of about a size."""
    kind = draw.pick(("box", "sphere", "cylinder", "capsule"))
    if kind == "box":
        scene.box(name, size=(size, size * draw.between(0.4, 0.9), size * draw.between(0.2, 0.7)), **options)
    elif kind == "sphere":
        scene.sphere(name, radius=0.5 * size, **options)
    else:
        make = scene.cylinder if kind == "cylinder" else scene.capsule
        make(name, radius=size * draw.between(0.15, 0.3), height=size * draw.between(0.5, 1.0), **options)


def _spin(draw: Draw, most: float) -> Vector:
    x, y, z = draw.direction()
    rate = draw.between(0.2 * most, most)
    return rate * x, rate * y, rate * z


@mechanism("gravity", "air", "spins", "single")
def throw(scene: Scene, draw: Draw) -> None:
    """A solid flies and turns, and meets nothing."""
    g = draw.gravity(scene, 0.8)
    size = draw.size()
    x, y = draw.heading()
    v, up = draw.speed(draw.between(0.2, 0.8) * g, 0.2 * size), draw.speed(0.4 * g, 0.2 * size)
    _solid(scene, draw, "thrown", size, position=(0, 0, 0), velocity=(v * x, v * y, up), density=draw.density(size),
           angular_velocity_deg=_spin(draw, 400.0))  # fmt: skip


@mechanism("air", "spins", "inertia", "single")
def spinner(scene: Scene, draw: Draw) -> None:
    """A box with three different moments of inertia tumbles where there is no gravity."""
    scene.simulation(gravity=(0.0, 0.0, 0.0), duration=1.5, frame_rate=60.0)
    size = draw.size()
    edges = (size, size * draw.between(0.5, 0.8), size * draw.between(0.15, 0.4))
    scene.box("spinner", size=edges, angular_velocity_deg=_spin(draw, 500.0), density=draw.density(size),
              rotation_deg=(draw.between(0, 90), draw.between(0, 90), 0))  # fmt: skip


@mechanism("gravity", "bounce", "contact", "single")
def bounce(scene: Scene, draw: Draw) -> None:
    """A ball falls and bounces, straight up or onward."""
    g = draw.gravity(scene, 1.2, low=3.0)
    radius, e = 0.5 * draw.size(), draw.between(0.3, 0.9)
    scene.ground(restitution=1.0, friction=draw.between(0.0, 0.8))
    drop = draw.speed(draw.between(0.2, 0.4) * g, 2 * radius) ** 2 / (2 * g)
    scene.sphere("ball", radius=radius, position=(0, 0, radius + drop), restitution=e, density=draw.density(2 * radius),
                 velocity=(draw.pick((0.0, 0.3)) * math.sqrt(2 * g * drop), 0, 0))  # fmt: skip


@mechanism("gravity", "roll", "inertia", "contact", "single")
def roll(scene: Scene, draw: Draw) -> None:
    """A ball or a roller rolls on the ground."""
    g = draw.gravity(scene, 1.0)
    radius = 0.5 * draw.size()
    scene.ground(friction=draw.between(0.3, 1.0))
    speed = draw.speed(draw.between(0.2, 1.0) * math.sqrt(g * radius) * 3, 2 * radius)
    options = {
        "position": (0, 0, radius),
        "velocity": (speed, 0, 0),
        "rolling": True,
        "density": draw.density(2 * radius),
    }
    if draw.pick((True, False)):
        scene.sphere("roller", radius=radius, **options)
    else:
        scene.cylinder("roller", radius=radius, height=radius * draw.between(0.5, 3.0), axis="Y", **options)


@mechanism("gravity", "roll", "inertia", "contact", "single")
def roll_down(scene: Scene, draw: Draw) -> None:
    """A ball rolls down a slope."""
    draw.gravity(scene, 1.0)
    radius, angle = 0.5 * draw.size(), draw.between(5.0, 20.0)
    turn = math.radians(angle)
    scene.box("slope", size=(100 * radius, 8 * radius, radius), rotation_deg=(0, angle, 0), static=True, friction=1.0)
    scene.sphere("ball", radius=radius, position=(1.5 * radius * math.sin(turn), 0, 1.5 * radius * math.cos(turn)),
                 density=draw.density(2 * radius), friction=draw.between(0.5, 1.0))  # fmt: skip


@mechanism("friction", "gravity", "inertia", "contact", "slides", "single")
def skid(scene: Scene, draw: Draw) -> None:
    """A ball thrown level on the ground skids until it rolls."""
    g = draw.gravity(scene, 1.0)
    radius, mu = 0.5 * draw.size(), draw.between(0.1, 0.5)
    scene.ground()
    speed = draw.speed(3.5 * mu * g * draw.between(0.3, 0.9), 2 * radius)
    scene.sphere("ball", radius=radius, position=(0, 0, radius), velocity=(speed, 0, 0), friction=mu,
                 density=draw.density(2 * radius))  # fmt: skip


@mechanism("gravity", "contact", "impacts", "single")
def tumble(scene: Scene, draw: Draw) -> None:
    """A box falls on the ground on a corner or an edge, and tumbles."""
    g = draw.gravity(scene, 1.2, low=3.0)
    size = draw.size()
    scene.ground(friction=draw.between(0.2, 0.8))
    drop = draw.speed(draw.between(0.1, 0.3) * g, 0.4 * size) ** 2 / (2 * g)
    scene.box("box", size=(size, 0.7 * size, 0.5 * size), position=(0, 0, 0.75 * size + drop),
              density=draw.density(size), rotation_deg=(draw.between(10, 60), draw.between(10, 60), 0),
              velocity=(draw.between(0, 1) * math.sqrt(g * size), 0, 0))  # fmt: skip


@mechanism("gravity", "bounce", "mass", "contact", "pair")
def hit(scene: Scene, draw: Draw) -> None:
    """A ball hits another, head on or off centre, in the air or where there is no gravity."""
    scene.simulation(gravity=(0, 0, -draw.pick((0.0, draw.between(1.0, 10.0)))), duration=0.8, frame_rate=60.0)
    radius, e = 0.5 * draw.size(), draw.between(0.2, 0.95)
    off = draw.pick((0.0, draw.between(0.2, 1.2))) * radius
    speed = draw.speed(draw.log(2.0, 40.0) * radius, 2 * radius)
    gap = speed * draw.between(0.2, 0.4)
    common = {"restitution": e, "friction": draw.pick((0.0, 0.3))}
    scene.sphere("striker", radius=radius, position=(-2 * radius - gap, 0, 0), velocity=(speed, 0, 0),
                 density=draw.density(2 * radius), **common)  # fmt: skip
    scene.sphere("struck", radius=radius, position=(0, off, 0), density=draw.density(2 * radius), **common)


@mechanism("gravity", "bounce", "wall", "contact", "single")
def wall(scene: Scene, draw: Draw) -> None:
    """A ball flies at a sheet and bounces off."""
    g = draw.gravity(scene, 0.6)
    radius = 0.5 * draw.size()
    thin = radius * draw.log(0.1, 1.0)
    speed = draw.speed(draw.between(5.0, 20.0) * radius, 0.5 * thin)
    gap = speed * draw.between(0.15, 0.3)
    scene.box("sheet", size=(thin, 20 * radius, 40 * radius), position=(gap + radius + 0.5 * thin, 0, 0), static=True,
              restitution=1.0)  # fmt: skip
    scene.sphere("ball", radius=radius, velocity=(speed, 0, min(0.2 * g, speed)), restitution=draw.between(0.3, 0.9),
                 friction=0.0, density=draw.density(2 * radius))  # fmt: skip


@mechanism("friction", "gravity", "surface", "contact", "slides", "single")
def belt(scene: Scene, draw: Draw) -> None:
    """A box that is set on a belt is taken along."""
    g = draw.gravity(scene, 1.0)
    size, mu = draw.size(), draw.between(0.15, 0.7)
    speed = draw.speed(mu * g * draw.between(0.2, 0.7), 0.2 * size)
    carrier = scene.box("belt", size=(60 * size, 3 * size, size), position=(0, 0, -0.5 * size), static=True)
    scene.surface_velocity(carrier, velocity=(speed, 0, 0))
    _flat(scene, draw, "load", size, (0, 0, 0), friction=mu, density=draw.density(size))


@mechanism("friction", "gravity", "contact", "mass", "pair")
def shove(scene: Scene, draw: Draw) -> None:
    """A sliding block runs into another, and both go on."""
    g = draw.gravity(scene, 1.0)
    size, mu = draw.size(), draw.between(0.1, 0.4)
    scene.ground()
    speed = draw.speed(mu * g * draw.between(0.6, 1.5), 0.3 * size)
    gap = draw.between(0.05, 0.3) * speed**2 / (2 * mu * g)
    for name, x, v in (("striker", 0.0, speed), ("target", size + gap, 0.0)):
        scene.box(name, size=(size, size, 0.5 * size), position=(x, 0, 0.25 * size), velocity=(v, 0, 0), friction=mu,
                  density=draw.density(size))  # fmt: skip
