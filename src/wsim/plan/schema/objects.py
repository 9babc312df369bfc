"""Objects of a plan: how each is made, of what, where it is, and how the simulator takes it."""

from __future__ import annotations

import math
from typing import Annotated, Any, Literal

from pydantic import Field, SerializerFunctionWrapHandler, model_serializer, model_validator

from wsim.defaults import FRICTION
from wsim.plan.schema.base import Color, Name, NotNegative, Number, Positive, Share, Sparse, Strict, Text, Vec3, Word
from wsim.plan.schema.relations import Relation

Role = Literal["rigid_body", "mechanism", "vehicle", "robot", "terrain", "fluid", "container", "sensor", "background"]
State = Literal["static", "dynamic", "kinematic", "fluid"]
Primitive = Literal["box", "sphere", "cylinder", "capsule", "tank", "fluid", "ground"]
SIZE_COUNT: dict[str, tuple[int, ...]] = {
    "box": (3,),
    "sphere": (1,),
    "cylinder": (2,),
    "capsule": (2,),
    "tank": (3,),
    "fluid": (0, 3),
    "ground": (0,),
}
SIZE_MEANING = {
    "box": "the edge lengths (x, y, z)",
    "sphere": "(radius,)",
    "cylinder": "(radius, height)",
    "capsule": "(radius, height without the caps)",
    "tank": "the inner edge lengths (x, y, z)",
    "fluid": "the edge lengths (x, y, z), or nothing when it fills a container",
    "ground": "nothing",
}
_SOLIDS = ("box", "sphere", "cylinder", "capsule")
_MOTIONS = ("angular_velocity_deg", "rolling", "surface_velocity")
ROLLS = ("sphere", "cylinder", "capsule")
ROLE_PRIMITIVES: dict[str, tuple[str, ...]] = {
    "rigid_body": _SOLIDS,
    "mechanism": _SOLIDS,
    "vehicle": _SOLIDS,
    "robot": (*_SOLIDS, "robot"),
    "sensor": _SOLIDS,
    "background": _SOLIDS,
    "container": ("tank", *_SOLIDS),
    "fluid": ("fluid",),
    "terrain": ("ground", *_SOLIDS),
}
ROLE_STATES: dict[str, tuple[str, ...]] = {
    "rigid_body": ("dynamic", "static", "kinematic"),
    "mechanism": ("dynamic", "static", "kinematic"),
    "vehicle": ("dynamic", "kinematic"),
    "robot": ("dynamic", "kinematic"),
    "sensor": ("static", "kinematic", "dynamic"),
    "background": ("static",),
    "container": ("static", "dynamic", "kinematic"),
    "fluid": ("fluid",),
    "terrain": ("static",),
}


class Proxy(Strict):
    """A primitive that stands for the object."""

    kind: Literal["proxy"] = "proxy"
    primitive: Primitive
    size: tuple[Positive, ...] = Field((), max_length=3)  # [m], as SIZE_MEANING has it

    @model_validator(mode="after")
    def _count(self) -> Proxy:
        counts = SIZE_COUNT[self.primitive]
        if len(self.size) not in counts:
            wanted = " or ".join(str(count) for count in counts)
            raise ValueError(
                f"size of a {self.primitive} has {wanted} numbers, {SIZE_MEANING[self.primitive]}, in metres; "
                f"it has {len(self.size)}"
            )
        return self


class FromAsset(Strict):
    """An entry of the catalogue."""

    kind: Literal["asset"] = "asset"
    asset: Word  # its id


class FromRobot(Strict):
    """A robot that was taken in or can be pulled (docs/robots.md): links and joints of its own."""

    kind: Literal["robot"] = "robot"
    robot: Word  # its id
    size: tuple[Positive, Positive, Positive]  # of the box round it as it stands [m]


class External(Strict):
    """Something to be found elsewhere; until it is, the stand-in is built."""

    kind: Literal["external"] = "external"
    candidate: Word  # what to look for
    stand_in: Proxy


Construction = Annotated[Proxy | FromAsset | FromRobot | External, Field(discriminator="kind")]


class Material(Sparse):
    """Bulk and surface properties."""

    name: Word
    density: Positive  # [kg/m^3]
    friction: NotNegative = FRICTION
    restitution: Share = 0.0  # 0 leaves it to what it touches; a contact's 0 is 0
    rolling: Share | None = None  # rolling resistance: a torque, of radius times push
    color: Color = (0.7, 0.7, 0.7)
    opacity: Share = 1.0


class Topology(Strict):
    """How the object stands to others."""

    relation: list[Relation] = Field(default_factory=list, max_length=100)


class Pose(Strict):
    """Where the layout put the object: its centre, and roll, pitch, yaw in degrees."""

    position: Vec3
    rotation_deg: Vec3 = (0.0, 0.0, 0.0)


WayPoint = tuple[Number, Number] | tuple[Number, Number, Number]  # x, y [m], and the heading there [deg] if it matters


class Actuation(Strict):
    """What drives the object, or a joint of it."""

    kind: Literal["position", "velocity", "force", "torque", "path", "policy"]
    joint: Name | None = None
    target: tuple[float, ...] = Field(
        (), max_length=10_000
    )  # of the kind's unit: rad or m, per second, N, N m; a path's points
    words: Text = ""
    policy: Word | None = None  # of the kind "policy": the id of the network that walks the robot
    route: tuple[WayPoint, ...] = Field((), max_length=1000)  # along which it walks it, one after the other
    speed: Positive | None = None  # along the route [m/s]

    @model_validator(mode="after")
    def _walks(self) -> Actuation:
        if self.kind != "policy" and (self.policy or self.route or self.speed):
            raise ValueError(f'policy, route and speed are of the kind "policy"; this is of {self.kind!r}')
        if (self.route or self.speed) and not self.policy:
            raise ValueError("route and speed are walked by a policy; name it, or leave them out")
        if self.speed and not self.route:
            raise ValueError(f"speed {self.speed:g} m/s is along a route; give one, or leave speed out")
        return self

    @model_serializer(mode="wrap")
    def _written(self, write: SerializerFunctionWrapHandler) -> dict[str, Any]:
        """Without what only a policy has where it has it not, so that a plan without it reads as it always did."""
        return {name: value for name, value in write(self).items() if value or name not in ("policy", "route", "speed")}


class Registration(Strict):
    """How the simulator takes the object."""

    collision: Literal["shape", "convex_hull", "mesh", "none"] = "shape"
    mass: Positive | None = None  # [kg]; comes before the material's density
    density: Positive | None = None  # [kg/m^3]
    spacing: Positive | None = None  # of a fluid's particles [m]
    viscosity: NotNegative | None = None  # of a fluid [Pa s]
    actuation: list[Actuation] = Field(default_factory=list, max_length=100)

    @model_validator(mode="after")
    def _one_mass(self) -> Registration:
        if self.mass is not None and self.density is not None:
            raise ValueError("mass and density are both given; keep one of them")
        return self


class PlanObject(Strict):
    """One thing in the world; its name is its prim's name."""

    name: Name
    role: Role
    construction: Construction
    dimensions: Vec3 | None = None  # bounding box before it is turned [m]; what gives it is the construction, or HEIGHT
    material: Material | None = None
    state: State = "dynamic"
    topology: Topology = Field(default_factory=Topology)
    pose: Pose | None = None
    velocity: Vec3 = (0.0, 0.0, 0.0)  # [m/s], initial; of what is kinematic, for good
    angular_velocity_deg: Vec3 | None = None  # likewise [deg/s], about the world's axes
    rolling: bool | None = None  # it starts with the spin that fits its velocity
    surface_velocity: Vec3 | None = None  # of a belt's surface, along the object's own axes [m/s]
    registration: Registration = Field(default_factory=Registration)
    words: Text = ""  # the words of the prompt that asked for it

    @classmethod
    def proxy(
        cls,
        *,
        primitive: Primitive,
        size: tuple[float, ...] = (),
        relations: list[Relation] | None = None,
        **fields: Any,
    ) -> PlanObject:
        """An object that a primitive stands for, with its rows; the other fields are the object's own."""
        return cls(
            construction=Proxy(primitive=primitive, size=size),
            topology=Topology(relation=list(relations or [])),
            **fields,
        )

    @property
    def built(self) -> Proxy | FromAsset | FromRobot:
        """What is built: the stand-in of what is external."""
        return self.construction.stand_in if isinstance(self.construction, External) else self.construction

    @property
    def primitive(self) -> str:
        """The primitive that is built, or "asset" or "robot"."""
        return self.built.primitive if isinstance(self.built, Proxy) else self.built.kind

    @property
    def size(self) -> tuple[float, ...]:
        """The primitive's size, or that of the box round a robot [m]; empty for an asset."""
        return () if isinstance(self.built, FromAsset) else self.built.size

    @property
    def volume(self) -> float | None:
        """What the primitive fills [m^3]; None where the plan does not say: an asset, a hollow tank, fluid in one."""
        size = self.size
        if self.primitive == "sphere":
            return 4 / 3 * math.pi * size[0] ** 3
        if self.primitive == "cylinder":
            return math.pi * size[0] ** 2 * size[1]
        if self.primitive == "capsule":
            return math.pi * size[0] ** 2 * (size[1] + 4 / 3 * size[0])
        return math.prod(size) if self.primitive in ("box", "fluid") and size else None

    @property
    def density(self) -> float | None:
        """Mean density [kg/m^3], as far as the plan says: its own, that of its mass, or its material's."""
        given, volume = self.registration, self.volume
        if given.density is not None:
            return given.density
        if given.mass is not None and volume is not None:
            return given.mass / volume
        return self.material.density if self.material is not None else None

    @property
    def mass(self) -> float | None:
        """Its own mass, or that of its density and volume [kg]; None where the plan does not say."""
        if self.registration.mass is not None:
            return self.registration.mass
        density, volume = self.density, self.volume
        return density * volume if density is not None and volume is not None else None

    @property
    def assembled(self) -> bool:
        """Whether what stands for it may have parts and joints of its own: an asset of the catalogue, or a robot."""
        return self.primitive in ("asset", "robot")

    @property
    def relations(self) -> list[Relation]:
        """Its rows of the topology."""
        return self.topology.relation

    def related(self, rows: list[Relation]) -> PlanObject:
        """A copy with these rows."""
        return self.model_copy(update={"topology": Topology(relation=rows)})

    def relation(self, predicate: str) -> Relation | None:
        """The object's first relation of that predicate, if it has one."""
        return next((relation for relation in self.relations if relation.predicate == predicate), None)

    @model_validator(mode="after")
    def _fits(self) -> PlanObject:
        if self.primitive != "asset" and self.primitive not in ROLE_PRIMITIVES[self.role]:
            known = ", ".join(ROLE_PRIMITIVES[self.role])
            raise ValueError(f"{self.name}: primitive of a {self.role} is {known}; it is a {self.primitive}")
        if self.primitive == "asset" and self.role == "fluid":
            raise ValueError(f'{self.name}: a fluid is no asset; its construction is a proxy with primitive "fluid"')
        if self.state not in ROLE_STATES[self.role]:
            raise ValueError(
                f'{self.name}: state of a {self.role} is {" or ".join(ROLE_STATES[self.role])}; it is "{self.state}"'
            )
        weighed = self.material or self.registration.mass or self.registration.density or self.assembled
        if self.state == "dynamic" and not weighed:
            raise ValueError(f'{self.name}: a dynamic body needs "material" with a name and a density in kg/m^3')
        if self.dimensions is not None and min(self.dimensions) <= 0.0:
            raise ValueError(f"{self.name}: dimensions {self.dimensions} must be > 0")
        return self

    @model_serializer(mode="wrap")
    def _written(self, write: SerializerFunctionWrapHandler) -> dict[str, Any]:
        """Without the motions that it has not, so that a plan without them reads as it always did."""
        return {name: value for name, value in write(self).items() if value is not None or name not in _MOTIONS}

    @model_validator(mode="after")
    def _moves(self) -> PlanObject:
        if self.rolling and (self.primitive not in ROLLS or self.state != "dynamic"):
            raise ValueError(
                f"{self.name}: rolling is of a dynamic {', '.join(ROLLS)}; it is a {self.state} {self.primitive}"
            )
        if self.rolling and not any(self.velocity):
            raise ValueError(f"{self.name}: rolling needs a velocity; give one, or leave rolling out")
        policies = [each.policy for each in self.registration.actuation if each.policy]
        if policies and self.primitive != "robot":
            raise ValueError(
                f'{self.name}: policy {policies[0]!r} walks a robot; it is no construction of kind "robot"'
            )
        if len(policies) > 1:
            raise ValueError(
                f"{self.name}: it has the policies {', '.join(policies)}; one walks it, leave the others out"
            )
        if self.rolling and self.angular_velocity_deg is not None:
            raise ValueError(f"{self.name}: rolling gives the spin; remove angular_velocity_deg, or rolling")
        if self.surface_velocity is not None and self.primitive in ("fluid", "tank", "asset", "robot"):
            raise ValueError(f"{self.name}: surface_velocity is of a solid; it is a {self.primitive}")
        return self
