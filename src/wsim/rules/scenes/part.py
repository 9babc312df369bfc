"""What each scene contributes to a plan, and the physics that its defaults come from."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace

from wsim.defaults import GRAVITY
from wsim.plan.layout.bodies import around
from wsim.plan.layout.boxes import Box
from wsim.plan.schema import CameraPlan, Contact, Cord, Joint, Objective, OpeningPlan, PlanObject, SchedulePlan, Vec3

MOST_SPEED = 50.0  # that the prompt may give [m/s]
DIRECTIONS: dict[str, Vec3] = {
    "front": (1.0, 0.0, 0.0),
    "back": (-1.0, 0.0, 0.0),
    "left": (0.0, 1.0, 0.0),
    "right": (0.0, -1.0, 0.0),
}


@dataclass
class Part:
    """Part of a plan.

    Attributes:
        objects: To be laid out by their rows, or kept where their pose says.
        posed: With poses that no row could give, such as on an incline: added once the rest is laid out.
        joints: Between any of them.
        cords: What ties them.
        schedules: What happens by time.
        openings: Where fluid comes in or leaves.
        contacts: Of pairs whose friction follows from none of their materials.
        objectives: What must happen to them.
        duration: That it takes [s].
        names: Of each thing's objects, lowest first, by the thing's identity.
        spacing: Of its fluid's particles [m]; 0 without a fluid.
        surface: Height that the side camera looks across [m].
        cameras: Its own, where the usual two do not show it.
        frame_rate: That it is to be recorded at [1/s]; 0 where it does not matter.
        vessels: What is to catch something, by the thing's identity, without a place.
        caught: The same, with the rows that say where, as what it catches goes.
        hung: Parts that are set beside all the rest once that is laid out.
        goes: From its start to where else an object comes, which the cameras are to show, too [m].
    """

    objects: list[PlanObject] = field(default_factory=list)
    posed: list[PlanObject] = field(default_factory=list)
    joints: list[Joint] = field(default_factory=list)
    cords: list[Cord] = field(default_factory=list)
    schedules: list[SchedulePlan] = field(default_factory=list)
    openings: list[OpeningPlan] = field(default_factory=list)
    contacts: list[Contact] = field(default_factory=list)
    objectives: list[Objective] = field(default_factory=list)
    duration: float = 0.0
    names: dict[int, list[str]] = field(default_factory=dict)
    spacing: float = 0.0
    surface: float | None = None
    goes: dict[str, list[Vec3]] = field(default_factory=dict)
    cameras: list[CameraPlan] = field(default_factory=list)
    frame_rate: float = 0.0
    hung: list[Part] = field(default_factory=list)
    vessels: dict[int, PlanObject] = field(default_factory=dict)
    caught: list[PlanObject] = field(default_factory=list)

    def add(self, other: Part) -> None:
        """Take in another part."""
        self.objects += other.objects
        self.posed += other.posed
        self.joints += other.joints
        self.cords += other.cords
        self.schedules += other.schedules
        self.openings += other.openings
        self.contacts += other.contacts
        self.objectives += other.objectives
        self.duration = max(self.duration, other.duration)
        self.names |= other.names
        self.goes |= other.goes
        self.cameras += other.cameras
        self.frame_rate = max(self.frame_rate, other.frame_rate)
        self.spacing = self.spacing or other.spacing
        self.surface = self.surface if self.surface is not None else other.surface

    def shifted(self, y: float) -> Part:
        """The part moved along Y [m]: all of it that has a pose."""
        return self._by((0.0, y, 0.0))

    def above(self, box: Box) -> Part:
        """The part moved onto the middle of a box's top, which is then its ground."""
        return self._by(((box.low[0] + box.high[0]) / 2, (box.low[1] + box.high[1]) / 2, box.high[2]))

    def _by(self, way: Vec3) -> Part:
        return replace(
            self,
            objects=[_moved(o, way) for o in self.objects],
            posed=[_moved(o, way) for o in self.posed],
            cords=[_tied(cord, way) for cord in self.cords],
        )

    @property
    def span(self) -> tuple[float, float]:
        """From and to where along Y its objects with a pose reach [m]."""
        boxes = [around(item) for item in (*self.objects, *self.posed) if item.pose is not None]
        return min((box.low[1] for box in boxes), default=0.0), max((box.high[1] for box in boxes), default=0.0)


def _tied(cord: Cord, way: Vec3) -> Cord:
    ends = {name: getattr(cord, name) for name in ("anchor_a", "anchor_b")}
    moved = {name: tuple(tidy(a + b) for a, b in zip(at, way, strict=True)) for name, at in ends.items() if at}
    return cord.model_copy(update=moved)


def _moved(item: PlanObject, way: Vec3) -> PlanObject:
    if item.pose is None or not any(way):
        return item
    x, y, z = item.pose.position
    at = (tidy(x + way[0]), tidy(y + way[1]), tidy(z + way[2]))
    return item.model_copy(update={"pose": item.pose.model_copy(update={"position": at})})


def times(direction: Vec3, speed: float) -> Vec3:
    """A velocity along a direction."""
    return (direction[0] * speed + 0.0, direction[1] * speed + 0.0, direction[2] * speed + 0.0)


def tall(item: PlanObject) -> float:
    """Height of a thing as it stands, without a capsule's ends [m]."""
    return item.size[-1] if len(item.size) > 1 else 2 * item.size[0]


def pair_friction(a: PlanObject, b: PlanObject, said: float | None = None) -> float:
    """Friction between two things: what the prompt says of the pair, else the smaller of the two's own."""
    if said is not None:
        return said
    return min((item.material.friction for item in (a, b) if item.material is not None), default=0.5)


def stopping_distance(speed: float, friction: float) -> float:
    """How far something slides on the level: v^2 / (2 mu g) [m]; without friction it has no end."""
    if friction == 0.0:
        return math.inf
    return speed**2 / (2 * friction * GRAVITY)


def fall_time(height: float) -> float:
    """Of a free fall [s]."""
    return math.sqrt(2 * height / GRAVITY)


def tidy(value: float) -> float:
    """Rounded to a micrometre, without a negative zero: plans are read by people."""
    return round(value, 6) + 0.0
