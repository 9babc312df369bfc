"""What a stage says, as plain data: the part of a world that simulator, recording and judge share.

SI units, Z up, quaternions xyzw. Nothing here imports pxr, so a recording can be read without USD.
"""

from __future__ import annotations

import math
from typing import Any, Literal

from pydantic import BaseModel, ConfigDict, Field

from wsim.assets.policies import PolicySpec
from wsim.defaults import DURATION, FIELD_OF_VIEW, FRAME_RATE, GRAVITY
from wsim.geometry.profiles import Profile
from wsim.quantities import Name as Quantity
from wsim.scene.world_openings import Drain, Tap
from wsim.scene.world_sensors import Sensor

Vec3 = tuple[float, float, float]
Quat = tuple[float, float, float, float]
ShapeKind = Literal["box", "sphere", "cylinder", "capsule", "mesh", "plane"]

SCHEMA_VERSION = 1


class _Model(BaseModel):
    model_config = ConfigDict(extra="forbid", allow_inf_nan=False)

    def __reduce_ex__(self, protocol: object) -> tuple[Any, ...]:
        """Pickled in half of Pydantic's time, and unpickled in two thirds: a sweep sends thousands of worlds."""
        given = self.__pydantic_fields_set__
        all_given = len(given) == len(type(self).__pydantic_fields__)
        return _unpickled, (type(self), self.__dict__, None if all_given else given)


def _unpickled(kind: type[_Model], values: dict[str, Any], given: set[str] | None) -> _Model:
    model = kind.__new__(kind)
    slots: dict[str, object] = {"__dict__": values, "__pydantic_extra__": None, "__pydantic_private__": None}
    slots["__pydantic_fields_set__"] = set(kind.__pydantic_fields__) if given is None else given
    for name, value in slots.items():
        object.__setattr__(model, name, value)
    return model


class Shape(_Model):
    """One geometric primitive.

    `size` by kind: box = full edge lengths (x, y, z); sphere = (radius,); cylinder and capsule = (radius, height)
    along local Z, a capsule's height without its caps; plane = (); mesh = extent of its bounding box.
    """

    prim: str
    kind: ShapeKind
    size: tuple[float, ...]  # [m]
    position: Vec3 = (0.0, 0.0, 0.0)  # [m], in the body's frame, or the world's for a static shape
    rotation: Quat = (0.0, 0.0, 0.0, 1.0)
    color: Vec3 = (0.7, 0.7, 0.7)  # linear RGB in 0..1
    opacity: float = 1.0
    collides: bool = True
    friction: float | None = None  # None leaves it to what it touches (`wsim.scene.contact`)
    restitution: float | None = None
    rolling: float | None = None  # torque that resists rolling, of radius times push
    margin: float = 0.0  # [m]: another engine's contacts may push from so far, and that of the other shape, away
    surface_velocity: Vec3 = (0.0, 0.0, 0.0)  # [m/s], in the frame of `position`: the surface moves as a belt does
    vertices: list[Vec3] = Field(default_factory=list)  # [m], meshes only
    triangles: list[tuple[int, int, int]] = Field(default_factory=list)
    normals: list[Vec3] = Field(default_factory=list)  # of each triangle's corners in turn, where it stands for a curve
    exact: bool = False  # its triangles collide; else, of a mesh, its convex hull or its convex parts
    convex: bool = False  # of a mesh: its convex hull collides for it
    pieces: list[list[Vec3]] = Field(default_factory=list)  # corners [m] of what a simulator let collide for a mesh


class Path(_Model):
    """Key frames of a kinematic body; `wsim.geometry.paths` says how it goes from one to the next."""

    times: list[float]  # [s], rising
    positions: list[Vec3]  # [m], of the body's origin, world
    rotations: list[Quat]  # world
    repeat: bool = False  # starts anew after the last key, or holds there


class Body(_Model):
    """A rigid body that the simulator moves."""

    prim: str
    mass: float  # [kg]
    volume: float  # [m^3], of its colliding shapes
    com: Vec3 = (0.0, 0.0, 0.0)  # [m], body frame
    inertia: tuple[float, ...]  # 9 numbers, row-major, about the centre of mass, body frame [kg m^2]
    position: Vec3  # [m], initial, world
    rotation: Quat  # initial, world
    velocity: Vec3 = (0.0, 0.0, 0.0)  # [m/s], initial, of the centre of mass
    angular_velocity: Vec3 = (0.0, 0.0, 0.0)  # [rad/s], initial, world
    kinematic: bool = False
    lift: float = 0.0  # share of its weight that something unseen carries, at its centre of mass
    path: Path | None = None  # of a kinematic body; None: it goes by its velocity
    shapes: list[Shape]
    line: str | None = None  # "program.py:12": who made it


class Static(_Model):
    """An object that never moves: ground, tank, obstacle."""

    prim: str
    shapes: list[Shape]  # in the world's frame
    line: str | None = None


class Container(_Model):
    """The hollow of an open tank."""

    prim: str
    inner_size: Vec3  # [m]
    inner_center: Vec3  # [m], world
    rotation: Quat = (0.0, 0.0, 0.0, 1.0)


class Fluid(_Model):
    """A box of fluid as it stands at t = 0, or what is in that box of a vessel's hollow."""

    prim: str
    density: float  # [kg/m^3]
    viscosity: float  # dynamic [Pa s]; of what yields or thins the consistency [Pa s^n]
    spacing: float  # particle spacing [m]
    size: Vec3  # [m]
    center: Vec3  # [m], world
    velocity: Vec3 = (0.0, 0.0, 0.0)  # [m/s], world
    speed_of_sound: float = 0.0  # [m/s]; 0 lets the solver choose
    yield_stress: float = 0.0  # [Pa]
    flow_index: float = 1.0  # n of the law of Herschel and Bulkley
    container: str | None = None  # prim of the container it fills, or of the vessel
    volume: float | None = None  # [m^3], of what fills the hollow of a vessel up to the top of its box; else the box's
    color: Vec3 = (0.15, 0.4, 0.6)
    attenuation_length: float | None = (
        None  # [m], after which 1/e of the light is left; None: clear, as the box is large
    )
    line: str | None = None

    @property
    def newtonian(self) -> bool:
        """Whether it is as viscous however fast it is sheared."""
        return self.yield_stress == 0.0 and self.flow_index == 1.0

    @property
    def amount(self) -> float:
        """Its volume [m^3]."""
        return math.prod(self.size) if self.volume is None else self.volume

    @property
    def particles(self) -> int:
        """How many particles stand for it, where no body is in it and it is not of no height."""
        if self.volume is None:
            return math.prod(max(1, round(length / self.spacing)) for length in self.size)
        return max(1, round(self.volume / self.spacing**3))

    @property
    def cell(self) -> float:
        """Volume that a particle stands for [m^3]: a cell of the lattice that fills it, or a spacing's cube."""
        return self.amount / self.particles or self.spacing**3


class Motor(_Model):
    """A joint's drive: effort = stiffness (position - q) + damping (velocity - q'), at most `max_effort`."""

    stiffness: float = 0.0  # [N m/rad] or [N/m]
    damping: float = 0.0  # [N m s/rad] or [N s/m]
    position: float = 0.0  # [rad] or [m]
    velocity: float = 0.0  # [rad/s] or [m/s]
    max_effort: float | None = None  # [N m] or [N]; None: without bound
    saturates: bool = False  # it is meant to end at its greatest effort: it slips, or stalls
    told: bool = True  # False: something else sets its effort, and it may be any

    @property
    def leads(self) -> bool:
        """Whether it aims at a position and at a velocity."""
        return self.stiffness > 0.0 and self.damping > 0.0 and self.velocity != 0.0


class Give(_Model):
    """How soft contacts and stops of other engines yield: what meets them at v goes in by up to v time + depth."""

    time: float = 0.0  # [s]: in which they catch what meets them
    depth: float = 0.0  # [m] or [rad]: from which on they push in full
    creep: float = 0.0  # [s]: the slip that friction leaves to what it holds, over the acceleration that it takes


class Move(_Model):
    """One of the motions of a compound joint."""

    kind: Literal["revolute", "prismatic"]
    axis: Vec3  # unit, in the anchors' frame where the joint is at 0
    point: Vec3 = (0.0, 0.0, 0.0)  # [m] of a hinge, likewise; the last one goes through the anchor
    acts: bool = False  # a drive, a spring, a stop or friction may push along it


class Joint(_Model):
    """A joint between two bodies, or a body and the world (parent None).

    The anchors are one frame, seen from both ends: while the joint holds, they stay together but for its own motion.
    That of a compound joint is first along its sliders, then about one hinge after another.
    """

    prim: str
    kind: Literal["fixed", "revolute", "prismatic", "spherical", "compound"]
    moves: list[Move] = Field(default_factory=list)  # of a compound joint, from the parent on
    parent: str | None
    child: str
    fixture: str | None = None  # prim of the static object that stands for the world at its other end
    axis: Literal["X", "Y", "Z"] = "X"  # of the anchors
    parent_anchor: Vec3 | None = None  # [m], in the parent's frame, or the world's; None: not known
    parent_turn: Quat = (0.0, 0.0, 0.0, 1.0)
    child_anchor: Vec3 | None = None  # [m], in the child's frame
    child_turn: Quat = (0.0, 0.0, 0.0, 1.0)
    low: float | None = None  # [rad] or [m]; None: free
    high: float | None = None
    drive: Motor | None = None
    friction: float = 0.0  # dry, of a hinge [N m] or a slider [N]
    give: Give = Give()  # of its stops
    armature: float = 0.0  # [kg m^2] or [kg]: inertia that moves by the joint's own position alone, as a rotor does
    fastest: float | None = None  # [rad/s] or [m/s] that its maker lets it go; nothing holds it back
    closing: bool = False  # it closes a loop, or may break: a constraint, and none of the trees' joints
    break_force: float | None = None  # [N]; None: it holds any
    break_torque: float | None = None  # [N m]
    line: str | None = None

    @property
    def may_break(self) -> bool:
        """Whether there is a load at which it breaks."""
        return self.break_force is not None or self.break_torque is not None


class Gear(_Model):
    """Two joints coupled without play: the second goes `ratio` times as far as the first."""

    prim: str
    first: str  # prim of a joint
    second: str
    ratio: float  # [rad/rad], [m/rad], [rad/m] or [m/m]
    offset: float = 0.0  # [rad] or [m], of the second where the first is at 0
    line: str | None = None


class Policy(_Model):
    """A network that sets where a robot's servos go, by what it sees of it and as it is commanded."""

    prim: str
    base: str  # prim of the body whose motion it feels
    joints: list[str]  # prims, in the order of the description's
    spec: PolicySpec
    network: str  # path of the ONNX file
    sha256: str  # of that file
    times: list[float] = [0.0]  # [s], from 0 on, rising: when each command begins
    commands: list[Vec3] = [(0.0, 0.0, 0.0)]  # forward, to the left [m/s], turning to the left [rad/s]
    route: list[Vec3] = Field(default_factory=list)  # x, y [m], heading [rad]: gone along instead of the commands
    speed: float = 0.0  # [m/s] along the route
    line: str | None = None


class Event(_Model):
    """What starts the clock of a schedule: the first time that it is so.

    `first` and `second` are prims by kind: touch = two objects that touch; place = a body, whose origin is beyond
    `value` [m] along a world's axis; joint = a joint that is beyond `value` [rad or m]; start, end = a schedule whose
    first or last key comes.
    """

    kind: Literal["touch", "place", "joint", "start", "end"]
    first: str
    second: str | None = None
    axis: Literal["X", "Y", "Z"] | None = None
    value: float = 0.0
    above: bool = True  # beyond: above the value, or below
    delay: float = 0.0  # [s] from it to the clock's zero


class Schedule(_Model):
    """A quantity of something by time (`wsim.quantities`): what it is at key frames; before the first it is as stated.

    The times are those of its own clock, which goes from the start of the run, or from an event on.
    """

    prim: str
    target: str  # prim of a joint, a body, a static object or a pair's `Contact`
    quantity: Quantity
    times: list[float]  # [s], rising
    values: list[tuple[float, ...]]  # SI, radians
    linear: bool = False  # straight from key to key; else each is kept until the next
    point: Vec3 | None = None  # [m] in the body's frame, where its force acts; None: the centre of mass
    after: Event | None = None
    line: str | None = None

    @property
    def profile(self) -> Profile:
        """Its values by its own clock."""
        return Profile.of(self.times, self.values, self.linear)


class JointPath(_Model):
    """Where a joint's servo goes by time: at each position at its time, smoothly from one to the next."""

    prim: str  # of the joint
    times: list[float]  # [s], rising
    positions: list[float]  # [rad] or [m]
    line: str | None = None


class Reach(_Model):
    """Where a point of a robot's link is to be by time; the simulator finds how its joints must stand for it.

    At each of its times it is at the place of that time. It sets out at `start`, from where what came before has left
    it. Straight, it goes along lines; else the joints go evenly, and the point where that leads it.
    """

    prim: str
    link: str  # prim of a body
    point: Vec3 = (0.0, 0.0, 0.0)  # [m], in the link's frame
    start: float = 0.0  # [s]
    times: list[float]  # [s], rising
    positions: list[Vec3]  # [m], world
    rotations: list[Quat] = Field(default_factory=list)  # of the link, world; none: it may turn as it likes
    straight: bool = True
    line: str | None = None


class Contact(_Model):
    """The law of one pair of objects, before what their surfaces combine to; None leaves a coefficient to them."""

    prim: str
    first: str  # prim of a body or a static object
    second: str
    friction: float | None = None
    restitution: float | None = None
    rolling: float | None = None
    line: str | None = None


class Guide(_Model):
    """A point that a spring or a rope is fixed to or runs through; with a radius a cylinder that it runs round."""

    body: str | None = None  # None: the world
    owner: str | None = None  # prim of the body or the static object, where there is one
    position: Vec3  # [m], in the body's frame, or the world's; a cylinder's centre
    radius: float = 0.0  # [m]
    axis: Vec3 = (0.0, 1.0, 0.0)  # of the cylinder, in the same frame
    side: Vec3 = (0.0, 0.0, 1.0)  # from its axis to where the rope passes it, in the same frame
    groove: bool = False  # the rope stays in the plane of the cylinder's middle: a pulley, which turns with its rope
    shape: str | None = None  # prim of the cylinder


class _Cord(_Model):
    prim: str
    path: list[Guide]  # from end to end; of two cylinders in a row one has a point before the other
    radius: float  # [m], drawn: of a spring's coil, of a rope
    color: Vec3 = (0.7, 0.7, 0.7)
    line: str | None = None


class Spring(_Cord):
    """A force stiffness (length - rest_length) + damping (rate of length) along the line between two points."""

    stiffness: float = 0.0  # [N/m]
    damping: float = 0.0  # [N s/m]
    rest_length: float  # [m]


class Rope(_Cord):
    """A rope without mass and friction that cannot be stretched: it pulls where it is taut, and never pushes."""

    length: float  # [m]


class Foreign(_Model):
    """What acts in another engine's world and has no place in this description: such a world cannot be judged."""

    prim: str
    feature: str  # "the tendon split": what it is, and its name there


class Camera(_Model):
    """A pinhole camera that looks from `eye` to `target`, as the world starts (`wsim.scene.following`)."""

    prim: str
    eye: Vec3
    target: Vec3
    up: Vec3 = (0.0, 0.0, 1.0)
    fov: float = FIELD_OF_VIEW  # horizontal [deg]
    width: int = 640
    height: int = 360
    follows: str | None = None  # prim of the body from whose place it keeps its offset
    turns: bool = False  # with that body, as if it was fixed to it
    fixed: bool = False  # it was asked for: it stays, whatever it shows


class Light(_Model):
    """A light; `direction` points from the light into the scene, for a distant one."""

    prim: str
    kind: Literal["distant", "dome", "sphere"]
    intensity: float
    color: Vec3 = (1.0, 1.0, 1.0)
    direction: Vec3 = (0.0, 0.0, -1.0)
    position: Vec3 = (0.0, 0.0, 0.0)


class Parameter(_Model):
    """A number of the program that a sweep may change."""

    name: str
    value: float
    default: float
    low: float | None = None
    high: float | None = None
    unit: str = ""


class World(_Model):
    """All that a stage states."""

    version: int = SCHEMA_VERSION
    name: str = "world"
    gravity: Vec3 = (0.0, 0.0, -GRAVITY)  # [m/s^2]
    duration: float = DURATION  # [s]
    frame_rate: float = FRAME_RATE  # recorded frames a second
    time_step: float = 0.0  # [s]; 0: chosen by the simulator
    stepped: Literal["bodies", "joints", "neither"] = (
        "bodies"  # what steps of first order move: places, joints, or none
    )
    seed: int = 0
    combine: Literal["smaller", "larger"] = "smaller"  # of two surfaces' coefficients (`wsim.scene.contact`)
    cone: Literal["round", "pyramid"] = "round"  # of friction: one of four sides is weaker across its edges
    give: Give = Give()  # of its contacts
    bodies: list[Body] = Field(default_factory=list)
    statics: list[Static] = Field(default_factory=list)
    containers: list[Container] = Field(default_factory=list)
    fluids: list[Fluid] = Field(default_factory=list)
    taps: list[Tap] = Field(default_factory=list)
    drains: list[Drain] = Field(default_factory=list)
    joints: list[Joint] = Field(default_factory=list)
    contacts: list[Contact] = Field(default_factory=list)
    gears: list[Gear] = Field(default_factory=list)
    springs: list[Spring] = Field(default_factory=list)
    ropes: list[Rope] = Field(default_factory=list)
    policies: list[Policy] = Field(default_factory=list)
    schedules: list[Schedule] = Field(default_factory=list)
    joint_paths: list[JointPath] = Field(default_factory=list)
    reaches: list[Reach] = Field(default_factory=list)
    sensors: list[Sensor] = Field(default_factory=list)
    apart: list[tuple[str, str]] = Field(default_factory=list)  # objects or shapes that never touch
    foreign: list[Foreign] = Field(default_factory=list)
    cameras: list[Camera] = Field(default_factory=list)
    lights: list[Light] = Field(default_factory=list)
    parameters: list[Parameter] = Field(default_factory=list)

    @property
    def cords(self) -> list[Spring | Rope]:
        """The springs, then the ropes."""
        return [*self.springs, *self.ropes]

    def body(self, prim: str) -> Body:
        """The body at a prim path; KeyError naming the known ones."""
        for body in self.bodies:
            if body.prim == prim:
                return body
        raise KeyError(f"no body {prim!r}; the world has {[b.prim for b in self.bodies]}")
