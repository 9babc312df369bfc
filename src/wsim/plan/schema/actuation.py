"""What drives an object of a plan, or a joint of it."""

from __future__ import annotations

from itertools import pairwise
from typing import Annotated, Any, Literal

from pydantic import (
    Field,
    SerializerFunctionWrapHandler,
    TypeAdapter,
    ValidatorFunctionWrapHandler,
    WrapValidator,
    field_validator,
    model_serializer,
    model_validator,
)

from wsim.limits import MIN_BRAKING
from wsim.plan.schema.base import Name, NotNegative, Number, Positive, Share, Strict, Text, Vec3, Word

WayPoint = tuple[Number, Number] | tuple[Number, Number, Number]  # x, y [m], and the heading there [deg] if it matters
_PLACE, _HEADED = TypeAdapter(tuple[Number, Number]), TypeAdapter(tuple[Number, Number, Number])
MOST_TURN = 3600.0  # [deg] of one arc
_REACHES = ("reach", "follow", "schedule")  # kinds that say where a robot is by time
_OF_SOME = (  # kinds of actuation
    "policy", "route", "speed", "steer_deg", "waits", "brake", "link", "point", "path", "times", "rotation_deg",
    "start",
)  # fmt: skip


class ArcPlan(Strict):
    """A leg of a driver's route: part of a circle, which begins as what is before it ends."""

    radius: Positive  # [m]
    angle_deg: Number  # that it turns, to the left

    @field_validator("angle_deg")
    @classmethod
    def _turns(cls, angle_deg: float) -> float:
        if not 0.0 < abs(angle_deg) <= MOST_TURN:
            raise ValueError(f"angle_deg is {angle_deg:g}; an arc turns, by {MOST_TURN:g} deg at most")
        return angle_deg


def _leg(given: object, as_union: ValidatorFunctionWrapHandler) -> Any:
    """An object is an arc, three numbers have a heading, all else is a place: its errors are of one of these."""
    if isinstance(given, dict):
        return ArcPlan.model_validate(given)
    if isinstance(given, ArcPlan):
        return as_union(given)
    return (_HEADED if isinstance(given, list | tuple) and len(given) == len("xyt") else _PLACE).validate_python(given)


class BrakePlan(Strict):
    """When a driver presses all brakes, for good: at the first of these that comes."""

    at: tuple[Number, Number] | None = None  # a place on its way [m]
    time: NotNegative | None = None  # [s]
    near: Name | None = None  # what moves, as its origin comes
    within: Positive | None = None  # so near to the vehicle's [m]
    share: Annotated[Share, Field(ge=MIN_BRAKING)] = 1.0  # of the brakes' torque

    @model_validator(mode="after")
    def _says_when(self) -> BrakePlan:
        if self.at is None and self.time is None and self.near is None:
            raise ValueError('a brake says when: "at" a place, at a "time", or "near" a body, "within" so much')
        if (self.near is None) != (self.within is None):
            raise ValueError('"near" and "within" of a brake go together; give both')
        return self


class Actuation(Strict):
    """What drives the object, or a joint of it."""

    kind: Literal[
        "position", "velocity", "force", "torque", "path", "policy", "driver", "drive", "reach", "follow", "schedule"
    ]
    joint: Name | None = None
    target: tuple[float, ...] = Field(
        (), max_length=10_000
    )  # of the kind's unit: rad or m, per second, N, N m; a path's points; a schedule's [deg] or [m]
    words: Text = ""
    policy: Word | None = None  # of the kind "policy": the id of the network that walks the robot
    # Of a policy or a driver, one after the other. A driver with an arc goes straight from one point to the next.
    route: tuple[Annotated[WayPoint | ArcPlan, WrapValidator(_leg)], ...] = Field((), max_length=1000)
    speed: Positive | None = None  # along the route, or of what is driven straight on [m/s]
    steer_deg: Number | None = None  # of the kind "drive": of the front wheels, to the left
    waits: tuple[NotNegative, ...] = Field((), max_length=1000)  # of a driver: at each point of the route, in turn [s]
    brake: BrakePlan | None = None  # of a driver

    link: Name | None = None  # of a robot, of the kinds "reach" and "follow"
    point: Vec3 | None = None  # of the link, in its own frame [m]
    path: tuple[Vec3, ...] = Field((), max_length=1000)  # where that point is to be [m]; one place of a reach
    times: tuple[NotNegative, ...] = Field((), max_length=1000)  # when it is at each, or a joint at each target [s]
    start: NotNegative | None = None  # when it sets out [s]; by default when what it does before is done
    rotation_deg: Vec3 | None = None  # how the link is turned there: roll, pitch, yaw in the world [deg]

    @model_validator(mode="after")
    def _reaches(self) -> Actuation:
        given = [name for name in ("link", "point", "path", "rotation_deg", "start") if getattr(self, name)]
        if self.kind not in ("reach", "follow") and given:
            raise ValueError(f'{given[0]} is of the kinds "reach" and "follow"; this is of {self.kind!r}')
        if self.kind not in _REACHES:
            if self.times:
                raise ValueError(f"times are of the kinds {', '.join(_REACHES)}; this is of {self.kind!r}")
            return self
        if self.kind == "schedule":
            count, name = len(self.target), "target"
            if not self.joint:
                raise ValueError('a "schedule" is of a "joint" of the robot; name it')
        else:
            count, name = len(self.path), "path"
            if not self.link or self.joint or self.target:
                raise ValueError(f'a "{self.kind}" is of a "link" of the robot; it takes no joint and no target')
            if self.kind == "reach" and len(self.path) != 1:
                raise ValueError(
                    f'a "reach" goes to one place, and path has {len(self.path)}; a "follow" goes along it'
                )
        if not count or count != len(self.times) or any(b <= a for a, b in pairwise(self.times)):
            raise ValueError(f"{name} has {count} entries and times {len(self.times)}; give one for each, rising")
        return self

    @model_validator(mode="after")
    def _drives(self) -> Actuation:
        if self.steer_deg is not None and self.kind != "drive":
            raise ValueError(f'steer_deg is of the kind "drive"; this is of {self.kind!r}')
        if self.waits and self.kind != "driver":
            raise ValueError(f'waits are of the kind "driver"; this is of {self.kind!r}')
        if self.brake and self.kind != "driver":
            raise ValueError(f'a brake is of the kind "driver"; this is of {self.kind!r}')
        if len(self.waits) > len(self.route):
            raise ValueError(f"waits has {len(self.waits)} times for the route's {len(self.route)} points")
        if self.kind not in ("driver", "drive"):
            return self
        if self.speed is None or self.joint or self.target or self.policy:
            raise ValueError(f'a {self.kind} is a vehicle\'s, with its "speed"; it takes no joint, target or policy')
        if self.kind == "driver" and not self.route:
            raise ValueError('a driver follows a "route" from where the vehicle starts; it has none')
        if self.kind == "driver" and any(isinstance(leg, tuple) and len(leg) > 2 for leg in self.route):
            raise ValueError("a driver passes a route's points as its way goes; leave their headings out")
        if self.kind == "drive" and self.route:
            raise ValueError('what is driven straight on, or in a circle, has no route; a "driver" follows one')
        return self

    @model_validator(mode="after")
    def _walks(self) -> Actuation:
        if self.kind in ("driver", "drive"):
            return self
        if self.kind != "policy" and (self.policy or self.route or self.speed):
            raise ValueError(f'policy, route and speed are of the kind "policy"; this is of {self.kind!r}')
        if any(isinstance(leg, ArcPlan) for leg in self.route):
            raise ValueError("a policy walks from point to point; an arc is of a vehicle's driver")
        if (self.route or self.speed) and not self.policy:
            raise ValueError("route and speed are walked by a policy; name it, or leave them out")
        if self.speed and not self.route:
            raise ValueError(f"speed {self.speed:g} m/s is along a route; give one, or leave speed out")
        return self

    @model_serializer(mode="wrap")
    def _written(self, write: SerializerFunctionWrapHandler) -> dict[str, Any]:
        """Without what only some kinds have where it has it not, so that a plan without it reads as it always did."""
        return {name: value for name, value in write(self).items() if value or name not in _OF_SOME}
