"""An office: two rooms with a door between, furniture of the catalogue along their walls, and the way round it."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Any

from wsim.assets import get
from wsim.errors import UserError
from wsim.plan.layout.bodies import around
from wsim.plan.schema import CameraPlan, FromAsset, Joint, Material, PlanObject, Pose, Vec3

LENGTH, DEPTH, HEIGHT, THICK = 10.0, 6.4, 2.2, 0.1  # of both rooms within the walls, and of these [m]
PARTITION, DOOR_Y = -0.4, -1.6  # x of the wall between, y of the middle of its door [m]
DOOR, DOOR_HEIGHT, FRAME, LEAF = 0.9, 2.0, 0.06, 0.04  # wide and high, its jambs, and how thick its leaf is [m]
OFF_WALL, TUCKED = 0.03, 0.06  # behind what stands against a wall; how far a chair is under its table [m]
FREE = 0.25  # beside a robot on its way, at least [m]
STEP = 0.01  # [m], at which its way is looked at
ON_TOP = 0.5  # [m]: what stands higher is passed under, or stands on something else

# Round the desks, to the door and through it, round the table, and back to where it began: x, y [m].
ROUTE = (
    (-2.9, -1.6), (-2.9, 1.0), (-1.2, 1.0), (-1.2, -1.6), (0.9, -1.6), (3.5, -1.6), (3.5, 1.7), (0.9, 1.7), (0.9, -1.6),
    (-1.2, -1.6), (-2.9, -1.6),
)  # fmt: skip
# Against a wall of the room of desks (True) or of the meeting room: where along it [m].
ALONG_WALLS = {
    "desk_1": ("desk", True, "back", 1.5),
    "desk_2": ("desk", True, "back", -0.6),
    "desk_3": ("desk", True, "left", -2.3),
    "waste_basket": ("waste_basket", True, "back", 0.45),
    "plant_1": ("plant", True, "back", -2.8),
    "shelf_1": ("shelf", True, "right", -2.4),
    "shelf_2": ("shelf", True, "right", -3.3),
    "cabinet_1": ("cabinet", True, "front", 2.6),
    "whiteboard": ("whiteboard", False, "front", 0.2),
    "plant_2": ("plant", False, "front", 2.8),
    "sofa": ("sofa", False, "left", 2.2),
    "floor_lamp": ("floor_lamp", False, "left", 0.3),
    "cabinet_2": ("cabinet", False, "right", 2.6),
}
FREE_STANDING = {"table": ("table", (2.2, 0.2), 90.0)}
ON = {"monitor_1": ("monitor", "desk_1"), "monitor_2": ("monitor", "desk_2"), "monitor_3": ("monitor", "desk_3"),
      "printer": ("printer", "cabinet_1"), "lamp": ("lamp", "cabinet_2")}  # fmt: skip
# At the front of a desk or table (1) or behind it (-1), and how far along it [m].
CHAIRS = {
    "chair_1": ("desk_1", 1, 0.0), "chair_2": ("desk_2", 1, 0.0), "chair_3": ("desk_3", 1, 0.0),
    "chair_4": ("table", -1, 0.35), "chair_5": ("table", -1, -0.35),
    "chair_6": ("table", 1, 0.35), "chair_7": ("table", 1, -0.35),
}  # fmt: skip
_YAW = {"back": 0.0, "right": 90.0, "front": 180.0, "left": -90.0}  # of what has its back to that wall [deg]
_PLASTER = Material(name="plaster", density=900.0, friction=0.6, color=(0.72, 0.71, 0.67))
_OAK = Material(name="oak frame", density=600.0, friction=0.5, color=(0.24, 0.12, 0.05))
_LEAF = Material(name="door leaf", density=450.0, friction=0.5, color=(0.5, 0.33, 0.18))


@dataclass
class Office:
    """Its parts, each with a pose."""

    objects: list[PlanObject] = field(default_factory=list)
    joints: list[Joint] = field(default_factory=list)

    @property
    def pieces(self) -> int:
        """How many of them are of the catalogue."""
        return sum(item.primitive == "asset" for item in self.objects)


def office() -> Office:
    """The rooms, and what stands in them."""
    made = Office([*_walls(), *_door()])
    hinge = next(item for item in made.objects if item.name == "door")
    made.joints.append(Joint(name="hinge", kind="hinge", child="door", anchor=(-hinge.size[0] / 2, 0.0, 0.0), axis="Z"))
    placed = {name: _at_wall(name, *where) for name, where in ALONG_WALLS.items()}
    placed |= {name: _asset(name, id, (*at, 0.0), yaw) for name, (id, at, yaw) in FREE_STANDING.items()}
    placed |= {name: _on(name, id, placed[under]) for name, (id, under) in ON.items()}
    placed |= {name: _chair(name, placed[before], side, along) for name, (before, side, along) in CHAIRS.items()}
    made.objects += placed.values()
    return made


def cameras() -> list[CameraPlan]:
    """From above, and into each room from a corner; there is no ceiling."""
    inside, top = DEPTH / 2 - 0.3, HEIGHT - 0.1
    return [
        CameraPlan(name="above", eye=(0.0, -3.6, 12.0), target=(0.0, -0.1, 0.0)),
        CameraPlan(name="desks", eye=(PARTITION - 0.3, -inside, top), target=(-3.1, 0.5, 0.2)),
        CameraPlan(name="meeting", eye=(LENGTH / 2 - 0.3, -inside, top), target=(1.4, 0.2, 0.2)),
    ]


def check_way(made: Office, width: float) -> None:
    """See that a robot has room on its way.

    Args:
        made: The office.
        width: Of the robot [m].

    Raises:
        UserError: If something stands nearer to the way than half its width and `FREE`; it names it.
    """
    need = width / 2 + FREE
    for item in made.objects:
        box = around(item)
        if box.low[2] > ON_TOP:
            continue
        gap, x, y = min(
            (math.hypot(max(box.low[0] - x, 0.0, x - box.high[0]), max(box.low[1] - y, 0.0, y - box.high[1])), x, y)
            for x, y in _along(ROUTE)
        )
        if gap < need - 1e-9:
            raise UserError(
                f"the office's {item.name} is {gap:.2f} m from the robot's way at ({x:.2f}, {y:.2f}) m, "
                f"which needs {need:.2f} m: is that asset larger than the shipped one? Remove it with "
                "`wsim assets remove`, or write the plan yourself"
            )


def _along(route: tuple[tuple[float, float], ...]) -> Iterator[tuple[float, float]]:
    for (ax, ay), (bx, by) in pairwise(route):
        count = max(1, math.ceil(math.hypot(bx - ax, by - ay) / STEP))
        yield from ((ax + (bx - ax) * k / count, ay + (by - ay) * k / count) for k in range(count + 1))


# ---- walls and the door
def _box(name: str, size: Vec3, at: Vec3, material: Material, **more: Any) -> PlanObject:
    given: dict[str, Any] = {"role": "background", "state": "static", **more}
    return PlanObject.proxy(
        name=name, primitive="box", size=_tidy(size), material=material, pose=Pose(position=_tidy(at)), **given
    )


def _tidy(values: Vec3) -> Vec3:
    """To a tenth of a millimetre."""
    return (round(values[0], 4), round(values[1], 4), round(values[2], 4))


def _walls() -> list[PlanObject]:
    out_x, out_y, up = (LENGTH + THICK) / 2, (DEPTH + THICK) / 2, HEIGHT / 2
    low, high = _hole()
    across, along = (THICK, DEPTH, HEIGHT), (LENGTH + 2 * THICK, THICK, HEIGHT)
    right, left = low + DEPTH / 2, DEPTH / 2 - high
    return [
        _box("wall_back", across, (-out_x, 0.0, up), _PLASTER),
        _box("wall_front", across, (out_x, 0.0, up), _PLASTER),
        _box("wall_left", along, (0.0, out_y, up), _PLASTER),
        _box("wall_right", along, (0.0, -out_y, up), _PLASTER),
        _box("partition_right", (THICK, right, HEIGHT), (PARTITION, low - right / 2, up), _PLASTER),
        _box("partition_left", (THICK, left, HEIGHT), (PARTITION, high + left / 2, up), _PLASTER),
    ]


def _hole() -> tuple[float, float]:
    """From and to which y the partition is open for the door and its frame [m]."""
    return DOOR_Y - DOOR / 2 - FRAME, DOOR_Y + DOOR / 2 + FRAME


def _door() -> list[PlanObject]:
    """Its frame, and its leaf, which stands open on its hinge, square to the partition."""
    low, high = _hole()
    deep, over = THICK + 0.04, HEIGHT - DOOR_HEIGHT
    jamb = (deep, FRAME, DOOR_HEIGHT)
    leaf = (DOOR - 0.02, LEAF, DOOR_HEIGHT - 0.03)
    edge = PARTITION + deep / 2 + 0.03
    return [
        _box("jamb_right", jamb, (PARTITION, low + FRAME / 2, DOOR_HEIGHT / 2), _OAK),
        _box("jamb_left", jamb, (PARTITION, high - FRAME / 2, DOOR_HEIGHT / 2), _OAK),
        _box("lintel", (deep, high - low, over), (PARTITION, DOOR_Y, DOOR_HEIGHT + over / 2), _OAK),
        _box("door", leaf, (edge + leaf[0] / 2, low + FRAME - LEAF / 2, DOOR_HEIGHT / 2 + 0.005), _LEAF,
             role="mechanism", state="dynamic", words="a door that stands open"),
    ]  # fmt: skip


# ---- furniture
def _asset(name: str, id: str, at: Vec3, yaw: float) -> PlanObject:
    turn = (0.0, 0.0, (yaw + 180.0) % 360.0 - 180.0)
    place = Pose(position=_tidy(at), rotation_deg=turn)
    return PlanObject(name=name, role="background", construction=FromAsset(asset=id), state="static", pose=place)


def _at_wall(name: str, id: str, desks: bool, wall: str, along: float) -> PlanObject:
    """With its back to a wall of its room."""
    off = OFF_WALL + get(id).size[0] / 2
    low, high = (-LENGTH / 2, PARTITION - THICK / 2) if desks else (PARTITION + THICK / 2, LENGTH / 2)
    at = {
        "back": (low + off, along), "front": (high - off, along),
        "right": (along, -DEPTH / 2 + off), "left": (along, DEPTH / 2 - off),
    }[wall]  # fmt: skip
    return _asset(name, id, (*at, 0.0), _YAW[wall])


def _on(name: str, id: str, under: PlanObject) -> PlanObject:
    """On the middle of another's top, turned as that is."""
    assert under.pose is not None
    x, y, _ = under.pose.position
    return _asset(name, id, (x, y, around(under).high[2]), under.pose.rotation_deg[2])


def _chair(name: str, before: PlanObject, side: int, along: float) -> PlanObject:
    """At a long side of a desk or table, looking at it, a little under it."""
    assert before.pose is not None and isinstance(before.built, FromAsset)
    yaw = math.radians(before.pose.rotation_deg[2])
    out = side * (get(before.built.asset).size[0] / 2 + get("chair").size[0] / 2 - TUCKED)
    x, y, _ = before.pose.position
    at = (x + out * math.cos(yaw) - along * math.sin(yaw), y + out * math.sin(yaw) + along * math.cos(yaw), 0.0)
    return _asset(name, "chair", at, before.pose.rotation_deg[2] + (180.0 if side > 0 else 0.0))
