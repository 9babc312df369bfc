"""What the worlds of `judge_sound.py` are made of: mechanisms, each drawn at random and put beside the others."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.judge_families.drawn import Draw, Vector
from wsim.scene import Drive, Part, Scene

WEDGE = Path(__file__).parent / "validator_cases" / "correct" / "wedge.obj"


@dataclass(frozen=True)
class Place:
    """Where a mechanism goes: its name's beginning, its place along Y [m], its bodies' size [m], gravity [m/s^2]."""

    name: str
    y: float
    size: float
    g: float

    @property
    def speed(self) -> float:
        """What falls by a body's size gets [m/s]; on the Earth where there is no gravity."""
        return math.sqrt((self.g or 9.81) * self.size)

    def at(self, x: float, z: float, y: float = 0.0) -> Vector:
        """In bodies' sizes, from the place [m]."""
        return x * self.size, self.y + y * self.size, z * self.size


Fill = Callable[[Scene, Draw, Place], None]
KINDS: dict[str, Fill] = {}
DENSEST = 22_000.0  # [kg/m^3] of what is drawn: less than osmium


def kind(fill: Fill) -> Fill:
    """Register a mechanism by its name."""
    KINDS[fill.__name__] = fill
    return fill


def _solid(scene: Scene, draw: Draw, name: str, size: float, position: Vector, **options: Any) -> Any:
    """A box, a ball, a cylinder, a capsule, a hammer or a wedge."""
    what = draw.pick(("box", "sphere", "cylinder", "capsule", "hammer", "wedge"))
    options = {"position": position, **options}
    density = options.pop("density", None) or draw.density(size)
    if what == "box":
        return scene.box(name, size=(size, size * draw.between(0.3, 1), size * draw.between(0.3, 1)), density=density,
                         **options)  # fmt: skip
    if what == "sphere":
        return scene.sphere(name, radius=0.5 * size, density=density, **options)
    if what == "wedge":
        return scene.mesh(name, file=WEDGE, scale=1e-3 * size, up_axis="Y", density=density, **options)
    if what == "hammer":
        surface = {key: options.pop(key) for key in ("friction", "restitution") if key in options}
        head = Part("box", size=(0.3 * size, 0.6 * size, 0.3 * size), position=(0.4 * size, 0, 0), density=density,
                    **surface)  # fmt: skip
        grip = Part("capsule", radius=0.08 * size, height=0.6 * size, axis="X", density=density, **surface)
        return scene.compound(name, parts=[head, grip], **options)
    make = scene.cylinder if what == "cylinder" else scene.capsule
    return make(name, radius=0.3 * size, height=size * draw.between(0.3, 0.8), density=density, **options)


def _turned(draw: Draw) -> Vector:
    return draw.between(-180, 180), draw.between(-90, 90), draw.between(-180, 180)


def _axis(draw: Draw) -> Any:
    return draw.pick(("X", "Y", "Z", draw.direction()))


@kind
def springs(scene: Scene, draw: Draw, place: Place) -> None:
    """Light and heavy balls hang on each other by springs."""
    names: list[str | None] = [None]
    points, masses = [place.at(0, 0)], [math.inf]
    for k in range(draw.whole(2, 6)):
        on = draw.whole(max(len(names) - 2, 0), len(names) - 1) if place.g or k else 0
        points.append(points[on])
        while min(math.dist(points[-1], point) for point in points[:-1]) < place.size:
            x, y, z = draw.direction()
            way = draw.between(1.5, 4.0) * place.size
            points[-1] = tuple(p + way * d for p, d in zip(points[on], (x, y, -abs(z)), strict=True))
        mass = draw.log(20.0, 20000.0) * 4 / 3 * math.pi * (0.3 * place.size) ** 3
        name = f"{place.name}_{k}"
        scene.sphere(name, radius=0.3 * place.size, position=points[-1], mass=mass,
                     velocity=tuple(draw.between(0, 1) * place.speed * d for d in draw.direction()))  # fmt: skip
        links = {on, draw.whole(0, len(names) - 1)} if draw.pick((True, False)) else {on}
        for n in sorted(links):
            lighter, rate = min(mass, masses[n]), draw.log(3.0, 30.0)
            ends = {"anchor_a": points[n]} if names[n] is None else {}
            far = math.dist(points[n], points[-1])
            scene.spring(f"{name}_on_{n}", names[n], name, stiffness=lighter * rate**2, **ends,
                         rest_length=far * draw.between(0.7, 1.1),
                         damping=draw.pick((0.0, draw.between(0.02, 1.0))) * lighter * rate)  # fmt: skip
        names.append(name)
        masses.append(mass)


@kind
def arms(scene: Scene, draw: Draw, place: Place) -> None:
    """Links on hinges and sliders, driven, rubbing, with stops or free."""
    parent: str | None = None
    point, heading = place.at(0, 0), draw.direction()
    count = draw.whole(1, 4)
    for k in range(count):
        x, y, z = draw.direction()
        heading = tuple(a + 0.7 * b for a, b in zip(heading, (x, y, z), strict=True))
        norm = math.hypot(*heading)
        long = place.size * draw.between(0.6, 1.5)
        end = tuple(p + long * d / norm for p, d in zip(point, heading, strict=True))
        middle = tuple(0.5 * (a + b) for a, b in zip(point, end, strict=True))
        yaw = math.degrees(math.atan2(heading[1], heading[0]))
        pitch = -math.degrees(math.asin(heading[2] / norm))
        name, densest = f"{place.name}_{k}", DENSEST * 0.015 * long**3  # its length was drawn by itself
        mass = min(draw.density(place.size) * 0.02 * place.size**3, densest)
        scene.box(name, size=(long, 0.15 * long, 0.1 * long), position=middle, rotation_deg=(0, pitch, yaw), mass=mass)
        beyond = (count - k) * place.size
        load = mass * (count - k)
        if draw.pick((True, True, False)):
            turned, rate = load * beyond**2 / 3, draw.log(2.0, 25.0)
            scene.joint_revolute(f"{name}_hinge", parent, name, anchor=point, axis=_axis(draw),
                                 drive=_motor(draw, place, turned, rate, 60.0, load * place.g * beyond),
                                 limits_deg=draw.pick((None, None, (-draw.between(5, 90), draw.between(5, 90)))),
                                 friction=draw.pick((0.0, 0.0, 0.1)) * load * (place.g or 9.81) * beyond)  # fmt: skip
        else:
            rate, s = draw.log(2.0, 25.0), place.size
            scene.joint_prismatic(f"{name}_slider", parent, name, anchor=point, axis=_axis(draw),
                                  drive=_motor(draw, place, load, rate, 0.7 * s, load * place.g),
                                  limits=draw.pick((None, None, (-draw.between(0.1, 1) * s, draw.between(0.1, 1) * s))),
                                  friction=draw.pick((0.0, 0.0, 0.2)) * load * (place.g or 9.81))  # fmt: skip
        parent, point = name, end


def _motor(draw: Draw, place: Place, load: float, rate: float, way: float, weight: float) -> Drive | None:
    """A drive of what it moves [kg or kg m^2], to a place, at a speed, or none."""
    turns = way > 5.0 * place.size
    most = draw.pick((None, None, (weight + load * place.speed / place.size) * draw.between(0.5, 3.0)))
    slips = most is not None
    what = draw.pick(("place", "place", "speed", "none"))
    if what == "place":
        return Drive(position=draw.between(-way, way), stiffness=load * rate**2, max_force=most, saturates=slips,
                     damping=2 * load * rate * draw.between(0.1, 1.5))  # fmt: skip
    if what == "speed":
        speed = draw.between(-300, 300) if turns else draw.between(-1, 1) * place.size
        return Drive(velocity=speed, damping=load * rate, max_force=most, saturates=slips)
    return None


@kind
def chain(scene: Scene, draw: Draw, place: Place) -> None:
    """Two to four bodies hang on each other by joints of all kinds, or turn together in space; the last is heavy."""
    parent: str | None = None
    point = place.at(0, 0)
    count = draw.whole(2, 4)
    spin = (0.0, 0.0, 0.0) if place.g else tuple(draw.between(-3, 3) * place.speed / place.size for _ in "xyz")

    def motion(at: Vector) -> dict[str, Vector]:
        arm = [a - b for a, b in zip(at, place.at(0, 0), strict=True)]
        return {"velocity": tuple(map(float, np.cross(spin, arm))),
                "angular_velocity_deg": tuple(map(math.degrees, spin))}  # fmt: skip

    for k in range(count):
        name, (x, y, z) = f"{place.name}_{k}", draw.direction()
        long = place.size * draw.between(0.4, 1.2)
        end = tuple(p + long * d for p, d in zip(point, (x, y, -abs(z)), strict=True))
        if k == count - 1:
            scene.sphere(name, radius=0.3 * long, position=end, density=draw.log(1000.0, 8000.0),
                         **motion(end))  # fmt: skip
        else:
            middle = tuple(0.5 * (a + b) for a, b in zip(point, end, strict=True))
            turn = (0, -math.degrees(math.asin((end[2] - point[2]) / long)),
                    math.degrees(math.atan2(end[1] - point[1], end[0] - point[0])))  # fmt: skip
            scene.capsule(name, radius=0.06 * long, height=0.8 * long, axis="X", position=middle, rotation_deg=turn,
                          density=draw.log(100.0, 8000.0), **motion(middle))  # fmt: skip
        if not place.g and not k:
            parent, point = name, end
            continue
        what = draw.pick(("hinge", "hinge", "ball", "fixed" if k else "hinge"))
        if what == "hinge":
            scene.joint_revolute(f"{name}_hinge", parent, name, anchor=point, axis=_axis(draw))
        elif what == "ball":
            scene.joint_spherical(f"{name}_ball", parent, name, anchor=point)
        else:
            scene.joint_fixed(f"{name}_weld", parent, name, anchor=point)
        parent, point = name, end


@kind
def ropes(scene: Scene, draw: Draw, place: Place) -> None:
    """Bobs on ropes, one under another, slack or taut; or two weights on a rope over one or two posts."""
    name, s = place.name, place.size
    if draw.pick((True, False)) and place.g:
        posts = draw.whole(1, 2)
        apart = draw.between(2.0, 4.0) * (posts - 1)
        for k in range(posts):
            scene.cylinder(f"{name}_post_{k}", radius=0.6 * s, height=s, axis="Y", position=place.at(k * apart, 0),
                           static=True)  # fmt: skip
        # The heavier comes to the floor before the lighter comes to its post.
        scene.box(f"{name}_floor", size=(20 * s, 10 * s, s), position=place.at(0, -5.5), static=True)
        light, heavy = sorted(draw.density(s) for _ in "xx")
        free = -math.inf  # from where on the other leaves room
        for side, x, density, low in (("left", -0.6, light, draw.between(4.0, 4.5)),
                                      ("right", 0.6 + apart, heavy, draw.between(3.0, 4.0))):  # fmt: skip
            x = max(x + draw.pick((0.0, draw.between(-1.0, 1.0))), free)
            scene.sphere(f"{name}_{side}", radius=0.3 * s, position=place.at(x, -low), density=density)
            free = x + 0.7
        scene.rope(f"{name}_rope", f"{name}_left", f"{name}_right", around=[f"{name}_post_{k}" for k in range(posts)])
        return
    above: str | None = None
    point, velocity = place.at(0, 0), (0.0, 0.0, 0.0)
    for k in range(draw.whole(1, 3)):
        x, y, z = draw.direction()
        long = draw.log(0.8, 5.0) * s
        end = tuple(p + long * d for p, d in zip(point, (x, y, -abs(z)), strict=True))
        fast = draw.between(-1, 1) * place.speed  # across the rope, which may be taut
        velocity = (velocity[0] - fast * y, velocity[1] + fast * x, 0.0)
        scene.sphere(f"{name}_{k}", radius=0.25 * s, position=end, density=draw.density(s), velocity=velocity)
        slack = draw.pick((1.0, 1.0, draw.between(1.05, 1.5)))
        scene.rope(f"{name}_rope_{k}", above, f"{name}_{k}", length=long * slack,
                   **({"anchor_a": point} if above is None else {}))  # fmt: skip
        above, point = f"{name}_{k}", end


@kind
def cables(scene: Scene, draw: Draw, place: Place) -> None:
    """A cable swings by one end, with a weight, or hangs between two points."""
    name, s = place.name, place.size
    x, y, z = draw.direction()
    span = draw.between(2.0, 5.0) * s
    end = tuple(p + span * d for p, d in zip(place.at(0, 0), (x, y, -0.3 * abs(z)), strict=True))
    links, slender = draw.whole(5, 12), int(math.dist(place.at(0, 0), end) / (4.0 * 0.03 * s) * (1.0 - 1e-6))
    options = {"radius": 0.03 * s, "links": min(links, slender), "mass_per_length": draw.density(s) * 0.003 * s**2}
    if draw.pick((True, False)):
        beyond = tuple(e + 0.33 * s * (e - a) / span for e, a in zip(end, place.at(0, 0), strict=True))
        scene.sphere(f"{name}_weight", radius=0.3 * s, position=beyond, density=draw.density(s))
        scene.cable(name, None, f"{name}_weight", anchor_a=place.at(0, 0), anchor_b=end, **options)
    else:
        scene.cable(name, None, None, anchor_a=place.at(0, 0), anchor_b=end, loose=True, **options)


@kind
def belts(scene: Scene, draw: Draw, place: Place) -> None:
    """Two belts side by side, at speeds and frictions of their own, and what lies on them or across, or rolls."""
    s = place.size
    for k, y in enumerate((-1.0, 1.0)):
        belt = scene.box(f"{place.name}_belt_{k}", size=(40 * s, 2 * s, s), position=place.at(0, -0.5, y), static=True,
                         friction=draw.between(0.2, 1.0))  # fmt: skip
        scene.surface_velocity(belt, velocity=(draw.between(-2.0, 2.0) * place.speed, 0, 0))
    for k in range(draw.whole(1, 4)):
        name, y = f"{place.name}_{k}", draw.pick((-1.0, 0.0, 1.0))
        high, options = draw.pick((0.0, draw.between(0.0, 0.5))), {"density": draw.density(s)}
        options["friction"] = draw.between(0.1, 1.0)
        what = draw.pick(("box", "disc", "ball", "roller"))
        x = 2.5 * k - 3.0
        if what == "box":
            height = draw.between(0.2, 1.0)
            scene.box(name, size=(s, 0.9 * s, height * s), position=place.at(x, 0.5 * height + high, y),
                      rotation_deg=(0, 0, draw.between(-180, 180)), **options)  # fmt: skip
        elif what == "disc":
            scene.cylinder(name, radius=0.5 * s, height=0.4 * s, position=place.at(x, 0.2 + high, y), **options)
        elif what == "ball":
            scene.sphere(name, radius=0.4 * s, position=place.at(x, 0.4 + high, y),
                         rolling_friction=draw.pick((0.0, draw.between(0.0, 0.05))), **options)  # fmt: skip
        else:
            scene.cylinder(name, radius=0.4 * s, height=0.8 * s, axis="Y", position=place.at(x, 0.4 + high, y),
                           **options)  # fmt: skip


@kind
def turntables(scene: Scene, draw: Draw, place: Place) -> None:
    """A table turns by itself or by a motor, with things on it."""
    s, name = place.size, f"{place.name}_table"
    spin = draw.between(0.1, 0.8) * place.speed / s
    friction = {"friction": draw.between(0.2, 1.0)}
    if draw.pick((True, False)):
        scene.cylinder(name, radius=3 * s, height=0.3 * s, position=place.at(0, -0.15), kinematic=True,
                       angular_velocity_deg=(0, 0, math.degrees(spin)), **friction)  # fmt: skip
    else:
        density = draw.density(6 * s)
        scene.cylinder(name, radius=3 * s, height=0.3 * s, position=place.at(0, -0.15), density=density, **friction)
        turned = 0.5 * density * math.pi * 9 * s**2 * 0.3 * s * 9 * s**2
        scene.joint_revolute(f"{name}_axle", None, name, axis="Z",
                             drive=Drive(velocity=math.degrees(spin), damping=turned * draw.log(1, 20)))  # fmt: skip
    for k in range(draw.whole(1, 3)):
        turn, out = 2 * math.pi * k / 3, draw.between(0.8, 2.2)
        x, y, options = out * math.cos(turn), out * math.sin(turn), {"density": draw.density(s)}
        options["friction"] = draw.between(0.2, 1.0)
        if draw.pick((True, False)):
            scene.box(f"{place.name}_{k}", size=(0.8 * s, 0.5 * s, 0.5 * s), position=place.at(x, 0.25, y), **options)
        else:
            scene.sphere(f"{place.name}_{k}", radius=0.4 * s, position=place.at(x, 0.4, y), **options)


@kind
def rolling(scene: Scene, draw: Draw, place: Place) -> None:
    """Balls, wheels and logs roll on the level and on a slope, resisted or not, at a post or into each other."""
    s, name = place.size, place.name
    tilt = draw.pick((0.0, draw.between(3, 25)))
    turn = math.radians(tilt)
    scene.box(f"{name}_floor", size=(60 * s, 8 * s, s), rotation_deg=(0, tilt, 0), position=place.at(0, 0), static=True,
              friction=draw.between(0.3, 1.0), rolling_friction=draw.pick((0.0, draw.log(1e-3, 5e-2))))  # fmt: skip
    bounce = draw.pick((0.0, draw.between(0.0, 1.0)))
    for k in range(draw.whole(1, 4)):
        radius, along = draw.between(0.2, 0.6), 2.0 * k - 4.0
        out, y = 0.5 + radius, draw.pick((0.0, draw.between(-0.3, 0.3)))
        speed = draw.speed(draw.between(-2, 2) * place.speed, s)
        options = {
            "position": place.at(along * math.cos(turn) + out * math.sin(turn),
                                 out * math.cos(turn) - along * math.sin(turn), y),
            "velocity": (speed * math.cos(turn), 0.0, -speed * math.sin(turn)), "density": draw.density(s),
            "rolling": draw.pick((True, True, False)), "friction": draw.between(0.3, 1.0), "restitution": bounce,
        }  # fmt: skip
        if draw.pick((True, False)):
            scene.sphere(f"{name}_{k}", radius=radius * s, **options)
        else:
            make = draw.pick((scene.cylinder, scene.capsule))
            make(f"{name}_{k}", radius=radius * s, height=draw.between(0.4, 1.5) * s, axis="Y", **options)
    if draw.pick((True, False)):
        far = 6.0
        scene.cylinder(f"{name}_post", radius=0.5 * s, height=4 * s, static=True,
                       position=place.at(far * math.cos(turn), -far * math.sin(turn)), restitution=1.0)  # fmt: skip


@kind
def gears(scene: Scene, draw: Draw, place: Place) -> None:
    """Wheels in mesh, driven, with a rack, or with a weight on a rim."""
    s, name, x, last = place.size, place.name, 0.0, 0.0
    for k in range(draw.whole(2, 4)):
        radius = draw.between(0.4, 1.2)
        x += radius + last if k else 0.0
        mass = draw.density(s) * radius**2 * 0.3 * s**3
        wheel = scene.cylinder(f"{name}_{k}", radius=radius * s, height=0.2 * s, axis="Y", position=place.at(x, 0),
                               mass=mass)  # fmt: skip
        inertia = 0.5 * mass * (radius * s) ** 2
        drive = None if k else _motor(draw, place, 3 * inertia, draw.log(2.0, 15.0), 180.0, mass * place.g * s)
        scene.joint_revolute(f"{name}_axle_{k}", None, wheel, axis="Y", drive=drive,
                             friction=draw.pick((0.0, 0.02)) * mass * (place.g or 9.81) * s)  # fmt: skip
        if k:
            scene.gear(f"{name}_mesh_{k}", f"{name}_axle_{k - 1}", f"{name}_axle_{k}", ratio=-last / radius)
        if draw.pick((True, False)):
            scene.sphere(f"{name}_peg_{k}", radius=0.1 * s, position=place.at(x, 0.7 * radius, -0.3),
                         density=draw.density(s))  # fmt: skip
            scene.joint_fixed(f"{name}_rivet_{k}", wheel, f"{name}_peg_{k}")
        last = radius
    if draw.pick((True, False)):
        rack = scene.box(f"{name}_rack", size=(4 * s, 0.2 * s, 0.2 * s), position=place.at(x, last + 0.1, 0.5),
                         mass=mass)  # fmt: skip
        scene.joint_prismatic(f"{name}_guide", None, rack, axis="X")
        scene.gear(f"{name}_teeth", f"{name}_axle_{k}", f"{name}_guide", ratio=last * s)


@kind
def linkages(scene: Scene, draw: Draw, place: Place) -> None:
    """A crank turns, by a motor or by itself, and rocks an arm or shoves a ram by a rod: a loop of joints."""
    s, name = place.size, place.name
    crank, rod, rocker = 0.5, draw.between(1.6, 2.2), draw.between(1.2, 1.6)
    base = math.sqrt(rod**2 - rocker**2) + crank + 0.2
    tip = (crank, 0.0)
    wide = base - crank
    foot = math.sqrt(max((rod**2 - rocker**2 + wide**2) / (2 * wide), 0.0) ** 2)
    knee = (crank + foot, math.sqrt(max(rod**2 - foot**2, 0.0)))
    mass = draw.density(s) * 0.02 * s**3

    def link(which: str, a: tuple[float, float], b: tuple[float, float], y: float) -> str:
        long = math.dist(a, b)
        scene.box(f"{name}_{which}", size=(long * s, 0.1 * s, 0.12 * s),
                  mass=min(mass * long * draw.log(0.5, 2.0), DENSEST * 0.012 * long * s**3),
                  position=place.at(0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1]), y),
                  rotation_deg=(0, -math.degrees(math.atan2(b[1] - a[1], b[0] - a[0])), 0))  # fmt: skip
        return f"{name}_{which}"

    first, second, third = (link("crank", (0, 0), tip, 0.0), link("rod", tip, knee, 0.15),
                            link("rocker", (base, 0), knee, 0.3))  # fmt: skip
    turned = mass * s**2 * 2
    drive = _motor(draw, place, turned, draw.log(2.0, 15.0), 180.0, mass * place.g * s)
    scene.joint_revolute(f"{name}_motor", None, first, anchor=place.at(0, 0), axis="Y", drive=drive)
    scene.joint_revolute(f"{name}_pin", first, second, anchor=place.at(*tip), axis="Y")
    scene.joint_revolute(f"{name}_knee", second, third, anchor=place.at(*knee), axis="Y")
    scene.joint_revolute(f"{name}_foot", None, third, anchor=place.at(base, 0), axis="Y")


@kind
def thrown(scene: Scene, draw: Draw, place: Place) -> None:
    """Solids of all kinds are thrown on the ground, at each other, or fly."""
    scene.box(f"{place.name}_floor", size=(60 * place.size, 18 * place.size, place.size), position=place.at(0, -0.5),
              static=True, friction=draw.between(0.1, 1.0), restitution=draw.pick((0.0, 1.0)))  # fmt: skip
    for k in range(draw.whole(1, 3)):
        ball_only = draw.pick((0.0, 0.0, draw.between(0.0, 1.0)))
        common = {"friction": draw.between(0.1, 1.0), "rotation_deg": _turned(draw),
                  "velocity": tuple(draw.between(-1, 1) * place.speed for _ in "xyz"),
                  "angular_velocity_deg": tuple(draw.between(-200, 200) for _ in "xyz")}  # fmt: skip
        where = place.at(2.0 * k, draw.between(1.2, 2.5))
        if ball_only:
            scene.sphere(f"{place.name}_{k}", radius=0.4 * place.size, position=where, restitution=ball_only,
                         density=draw.density(place.size), **common)  # fmt: skip
        else:
            _solid(scene, draw, f"{place.name}_{k}", place.size, where, restitution=0.0, **common)


@kind
def hills(scene: Scene, draw: Draw, place: Place) -> None:
    """Balls and boxes on ground that rises and falls."""
    s = place.size
    wave, high = draw.between(4.0, 8.0) * s, draw.between(0.2, 0.6) * s
    scene.height_field(f"{place.name}_land", size=(16 * s, 10 * s), cells=(48, 30), position=place.at(0, 0),
                       friction=draw.between(0.2, 1.0), thickness=s,
                       heights=lambda x, y: high * math.sin(2 * math.pi * x / wave))  # fmt: skip
    for k in range(draw.whole(1, 3)):
        where = place.at(2.0 * k - 2.0, 0.5 + draw.between(0.6, 0.8) + high / s, draw.between(-2, 2))
        options = {"density": draw.density(s), "friction": draw.between(0.2, 1.0)}
        if draw.pick((True, False)):
            scene.sphere(f"{place.name}_{k}", radius=0.5 * s, position=where, **options)
        else:
            scene.box(f"{place.name}_{k}", size=(s, 0.8 * s, 0.5 * s), position=where, **options)
