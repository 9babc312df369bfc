# Four-bar linkage (Grashof crank-rocker). Link lengths in metres.
from dataclasses import dataclass
from math import acos, atan2, cos, degrees, hypot, sin

from wsim.scene import Drive, Handle, Scene

GROUND, CRANK, COUPLER, ROCKER = 0.8, 0.2, 0.7, 0.5
Z0 = 0.4


@dataclass(frozen=True)
class Point:
    x: float
    z: float

    def __add__(self, other: "Point") -> "Point":
        return Point(self.x + other.x, self.z + other.z)

    def at(self, y: float = 0.0) -> tuple[float, float, float]:
        return (self.x, y, self.z)


def circle_intersection(a: Point, ra: float, b: Point, rb: float) -> Point:
    d = hypot(b.x - a.x, b.z - a.z)
    base = atan2(b.z - a.z, b.x - a.x)
    turn = acos((ra * ra + d * d - rb * rb) / (2 * ra * d))
    return Point(a.x + ra * cos(base + turn), a.z + ra * sin(base + turn))


def link(scene: Scene, name: str, a: Point, b: Point, y: float, color) -> Handle:
    length = hypot(b.x - a.x, b.z - a.z)
    pitch = -degrees(atan2(b.z - a.z, b.x - a.x))
    middle = Point((a.x + b.x) / 2, (a.z + b.z) / 2)
    return scene.box(name, size=(length, 0.02, 0.03), position=middle.at(y), rotation_deg=(0, pitch, 0), density=2700, color=color)


def build(scene: Scene) -> None:
    scene.simulation(duration=4.0, frame_rate=60)
    scene.ground()
    a = Point(-GROUND / 2, Z0)
    d = a + Point(GROUND, 0.0)
    b = a + Point(0.0, CRANK)
    c = circle_intersection(b, COUPLER, d, ROCKER)

    crank = link(scene, "crank", a, b, 0.00, (0.8, 0.2, 0.2))
    coupler = link(scene, "coupler", b, c, 0.03, (0.2, 0.6, 0.2))
    rocker = link(scene, "rocker", d, c, 0.06, (0.2, 0.3, 0.8))

    drive = Drive(velocity=180.0, damping=5.0)
    scene.joint_revolute("pivot_a", None, crank, anchor=a.at(), axis="Y", drive=drive)
    scene.joint_revolute("pin_b", crank, coupler, anchor=b.at(0.015), axis="Y")
    scene.joint_revolute("pin_c", coupler, rocker, anchor=c.at(0.045), axis="Y")
    scene.joint_revolute("pivot_d", None, rocker, anchor=d.at(0.06), axis="Y")
    scene.camera("front", eye=(0, -2.2, 0.7), target=(0, 0, 0.5))
