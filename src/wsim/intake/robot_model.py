"""What is read of a robot's file: links with what is seen and what collides, joints with what acts along them."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

import numpy as np

from wsim.intake.model import GREY, Array, Color, Faces

FormKind = Literal["box", "sphere", "cylinder", "capsule", "mesh"]
JointKind = Literal["revolute", "prismatic", "spherical"]


@dataclass(frozen=True)
class Form:
    """Geometry of a link, in its frame: a plain shape about `at` turned by `turn` (xyzw), or a mesh.

    `size` [m] as `wsim.scene.world.Shape` has it; `points` (V, 3) and `faces` (F, 3) of a mesh, about `at` likewise.
    """

    name: str
    kind: FormKind
    size: tuple[float, ...]
    at: Array
    turn: Array
    color: Color = GREY
    friction: float = 1.0
    points: Array = field(default_factory=lambda: np.zeros((0, 3)))
    faces: Faces = field(default_factory=lambda: np.zeros((0, 3), dtype=np.int64))


@dataclass
class Link:
    """A rigid part. Its pose is that in the file's reference pose, in the file's frame; a mass of 0 says none."""

    name: str
    at: Array  # (3,) [m]
    turn: Array  # xyzw
    mass: float  # [kg]
    com: Array  # (3,) [m], in its frame
    inertia: Array  # (3, 3) about it [kg m^2], along its frame's axes
    seen: list[Form] = field(default_factory=list)
    collides: list[Form] = field(default_factory=list)
    free: bool = False  # nothing holds it


@dataclass
class Motor:
    """What drives a joint: a servo of its gains, or with none an effort that is set [N m or N]."""

    stiffness: float = 0.0
    damping: float = 0.0
    most: float | None = None  # [N m] or [N]


@dataclass
class RobotJoint:
    """A joint of `child` on `parent` (None: the world), with all that acts along it, in rad or m.

    Its frame stands at `at` in the child's frame, its X turned onto the axis by `turn`; `zero` is the coordinate in
    the file's reference pose.
    """

    name: str
    kind: JointKind
    parent: str | None
    child: str
    at: Array
    turn: Array
    zero: float = 0.0
    low: float | None = None
    high: float | None = None
    damping: float = 0.0
    stiffness: float = 0.0  # of a spring
    spring_zero: float = 0.0
    friction: float = 0.0
    armature: float = 0.0
    motor: Motor | None = None
    effort: float | None = None  # the most that its motor may give
    fastest: float | None = None  # [rad/s] or [m/s] that its maker lets it go


@dataclass(frozen=True)
class Mimic:
    """`follower` is at `offset` + `ratio` times where `leader` is [rad or m]."""

    follower: str
    leader: str
    ratio: float
    offset: float


@dataclass
class Robot:
    """All of it; `apart` are pairs of links, or of a link's form and another, that never touch."""

    links: list[Link]
    joints: list[RobotJoint]
    mimics: list[Mimic] = field(default_factory=list)
    apart: list[tuple[str, str]] = field(default_factory=list)
    poses: dict[str, dict[str, float]] = field(default_factory=dict)  # by name, each joint's coordinate [rad or m]
    notes: list[str] = field(default_factory=list)
