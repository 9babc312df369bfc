"""What schedules set by time: of what, in which units, within which bounds. One table for plans, calls and stages."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, get_args

from wsim.limits import MAX_FRICTION, MAX_SPEED, MAX_SPIN

What = Literal["joint", "body", "kinematic", "solid", "pair"]
Name = Literal[
    "position", "velocity", "effort", "release", "force", "torque", "angular_velocity", "surface_velocity", "friction"
]
NAMES: tuple[str, ...] = get_args(Name)
MAX_EFFORT = 1e7  # [N] or [N m], as of a program's control


@dataclass(frozen=True)
class Quantity:
    """One of them.

    Attributes:
        of: What has it.
        count: Numbers of a value.
        most: Size of each at most.
        unit: Of each; of a joint's a slider's.
        turning: A hinge's unit, of which `most` is, too; none where it is no joint's, or has one.
        least: Each at least.
        linear: Whether it goes straight from key to key where a schedule does not say, or keeps a key's value until the
            next.
    """

    of: What
    count: int
    most: float
    unit: str
    turning: str = ""
    least: float | None = None
    linear: bool = False

    @property
    def low(self) -> float:
        """The least that each number may be."""
        return -self.most if self.least is None else self.least


JOINT = {
    "position": Quantity("joint", 1, 36000.0, "m", "deg", linear=True),
    "velocity": Quantity("joint", 1, MAX_SPIN, "m/s", "deg/s"),
    "effort": Quantity("joint", 1, MAX_EFFORT, "N", "N m"),
    "release": Quantity("joint", 0, 0.0, ""),
}
BODY = {
    "force": Quantity("body", 3, MAX_EFFORT, "N"),
    "torque": Quantity("body", 3, MAX_EFFORT, "N m"),
}
KINEMATIC = {
    "velocity": Quantity("kinematic", 3, MAX_SPEED, "m/s"),
    "angular_velocity": Quantity("kinematic", 3, MAX_SPIN, "deg/s"),
}
SOLID = {"surface_velocity": Quantity("solid", 3, MAX_SPEED, "m/s")}
PAIR = {"friction": Quantity("pair", 1, MAX_FRICTION, "", least=0.0)}
OF: dict[What, dict[str, Quantity]] = {
    "joint": JOINT, "body": BODY, "kinematic": KINEMATIC, "solid": SOLID, "pair": PAIR,
}  # fmt: skip
CALLED: dict[What, str] = {
    "joint": "joint", "body": "loose body", "kinematic": "kinematic body", "solid": "thing that never moves",
    "pair": "pair",
}  # fmt: skip


def said(what: What) -> str:
    """The quantities of a kind of thing, as a message has them."""
    return ", ".join(OF[what])


def beyond_the_end(clock: float, last: float, end: float) -> str | None:
    """What of a schedule no run comes to; None where all of it is within one.

    Args:
        clock: When its times begin to count, at the earliest [s].
        last: The last of them [s].
        end: When the run ends [s].
    """
    if clock > end:
        return (
            f"its delay, and what it counts from, put its start at {clock:g} s or later, after the end at {end:g} s; "
            "make the delay shorter, or the run longer"
        )
    if clock + last > end:
        after = "" if clock == 0.0 else f", which count from {clock:g} s or later,"
        return f"{last:g} s{after} is after the end, at {end:g} s; leave that key out, or make the run longer"
    return None
