"""Objects of a plan: how each is made, of what, where it is, and how the simulator takes it."""

from __future__ import annotations

import math
from typing import Any, Literal

from pydantic import Field, SerializerFunctionWrapHandler, model_serializer, model_validator

from wsim.plan.schema.actuation import Actuation
from wsim.plan.schema.base import Name, NotNegative, Positive, Strict, Text, Vec3
from wsim.plan.schema.constructions import (
    CORNERS,
    ROCKS,
    Built,
    Construction,
    External,
    FromRobot,
    FromScatter,
    FromVehicle,
    Material,
    Primitive,
    Proxy,
)
from wsim.plan.schema.relations import Relation

Role = Literal["rigid_body", "mechanism", "vehicle", "robot", "terrain", "fluid", "container", "sensor", "background"]
State = Literal["static", "dynamic", "kinematic", "fluid"]
_SOLIDS = ("box", "sphere", "cylinder", "capsule")
_OWN = ("asset", "robot", "vehicle", "terrain", "scatter")  # kinds of construction that are no primitives
SPREAD = ("terrain", "scatter")  # they lie about the world's origin, and have no pose
_MOTIONS = ("angular_velocity_deg", "rolling", "surface_velocity")
ROLLS = ("sphere", "cylinder", "capsule")
ROLE_PRIMITIVES: dict[str, tuple[str, ...]] = {
    "rigid_body": _SOLIDS,
    "mechanism": _SOLIDS,
    "vehicle": (*_SOLIDS, "vehicle"),
    "robot": (*_SOLIDS, "robot"),
    "sensor": _SOLIDS,
    "background": (*_SOLIDS, "scatter"),
    "container": ("tank", *_SOLIDS),
    "fluid": ("fluid",),
    "terrain": ("ground", *_SOLIDS, "terrain", "scatter"),
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


class Topology(Strict):
    """How the object stands to others."""

    relation: list[Relation] = Field(default_factory=list, max_length=100)


class Pose(Strict):
    """Where the layout put the object: its centre, and roll, pitch, yaw in degrees."""

    position: Vec3
    rotation_deg: Vec3 = (0.0, 0.0, 0.0)


class Registration(Strict):
    """How the simulator takes the object."""

    collision: Literal["shape", "convex_hull", "mesh", "none"] = "shape"
    mass: Positive | None = None  # [kg]; comes before the material's density
    density: Positive | None = None  # [kg/m^3]
    spacing: Positive | None = None  # of a fluid's particles [m]
    viscosity: NotNegative | None = None  # of a fluid [Pa s]
    volume: Positive | None = None  # of a fluid in a vessel, where no level is said [m^3]
    yield_stress: NotNegative | None = None  # of a fluid [Pa]: mud, paint, toothpaste
    flow_index: Positive | None = None  # of a fluid: below 1 it thins when sheared
    actuation: list[Actuation] = Field(default_factory=list, max_length=100)

    @model_validator(mode="after")
    def _one_mass(self) -> Registration:
        if self.mass is not None and self.density is not None:
            raise ValueError("mass and density are both given; keep one of them")
        return self

    @model_serializer(mode="wrap")
    def _written(self, write: SerializerFunctionWrapHandler) -> dict[str, Any]:
        """Without a volume where there is none, so that a plan without one reads as it always did."""
        return {name: value for name, value in write(self).items() if value is not None or name != "volume"}


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
    def built(self) -> Built:
        """What is built: the stand-in of what is external."""
        return self.construction.stand_in if isinstance(self.construction, External) else self.construction

    @property
    def primitive(self) -> str:
        """The primitive that is built, or the kind of its construction: "asset", "robot", "vehicle", "terrain", ..."""
        return self.built.primitive if isinstance(self.built, Proxy) else self.built.kind

    @property
    def size(self) -> tuple[float, ...]:
        """The primitive's size, or that of the box round a robot [m]; empty for what has its own, or none."""
        return self.built.size if isinstance(self.built, (Proxy, FromRobot)) else ()

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
        """Whether what stands for it may have parts and joints of its own: an asset, a robot or a vehicle."""
        return self.primitive in ("asset", "robot", "vehicle")

    @property
    def rocks(self) -> bool:
        """Whether it is rocks that are scattered, which have its material."""
        return isinstance(self.built, FromScatter) and self.built.what == (ROCKS,)

    @property
    def prims(self) -> tuple[str, ...]:
        """Names of the prims that it is: its own, of a vehicle also its parts', of what is scattered each one's."""
        if isinstance(self.built, FromScatter):
            return tuple(f"{self.name}_{k}" for k in range(self.built.count))
        if isinstance(self.built, FromVehicle):
            knuckles = (f"knuckle_{corner}" for corner in CORNERS[:2])
            parts = (*knuckles, *(f"{part}_{corner}" for part in ("hub", "wheel") for corner in CORNERS))
            return (self.name, *(f"{self.name}_{part}" for part in parts))
        return (self.name,)

    @property
    def hinges(self) -> tuple[str, ...]:
        """Names of the joints that a vehicle has of its own."""
        if not isinstance(self.built, FromVehicle):
            return ()
        steers = (f"steer_{corner}" for corner in CORNERS[:2])
        joints = (*steers, *(f"{joint}_{corner}" for joint in ("axle", "spring") for corner in CORNERS))
        return tuple(f"{self.name}_{joint}" for joint in joints)

    @property
    def ahead(self) -> Vec3:
        """Its own +X at the start, in the world, of length 1."""
        _, pitch, yaw = map(math.radians, self.pose.rotation_deg if self.pose is not None else (0.0, 0.0, 0.0))
        return math.cos(yaw) * math.cos(pitch), math.sin(yaw) * math.cos(pitch), -math.sin(pitch)

    @property
    def speed_ahead(self) -> float:
        """Of its start, along its heading [m/s]."""
        return sum(v * way for v, way in zip(self.velocity, self.ahead, strict=True))

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
        timed = [each.kind for each in self.registration.actuation if each.kind in ("reach", "follow", "schedule")]
        if timed and self.primitive != "robot":
            raise ValueError(f'{self.name}: a {timed[0]} is of a robot; it is no construction of kind "robot"')
        if len(policies) > 1:
            raise ValueError(
                f"{self.name}: it has the policies {', '.join(policies)}; one walks it, leave the others out"
            )
        if self.rolling and self.angular_velocity_deg is not None:
            raise ValueError(f"{self.name}: rolling gives the spin; remove angular_velocity_deg, or rolling")
        if self.surface_velocity is not None and self.primitive in ("fluid", "tank", *_OWN):
            raise ValueError(f"{self.name}: surface_velocity is of a solid; it is a {self.primitive}")
        return self

    @model_validator(mode="after")
    def _is_driven(self) -> PlanObject:
        driven = [each.kind for each in self.registration.actuation if each.kind in ("driver", "drive")]
        if driven and self.primitive != "vehicle":
            raise ValueError(f'{self.name}: a {driven[0]} is of a vehicle; it is no construction of kind "vehicle"')
        if len(driven) > 1:
            raise ValueError(f"{self.name}: it has {', '.join(driven)}; one drives it, leave the others out")
        self._is_its_own()
        if self.primitive in SPREAD and (self.pose is not None or self.relations):
            raise ValueError(f"{self.name}: {self.primitive} lies about the origin; remove its pose and its rows")
        if self.primitive == "terrain" and self.material is None:
            raise ValueError(f'{self.name}: terrain needs a "material", whose friction it has')
        if self.material is not None and (
            self.primitive == "vehicle" or (self.primitive == "scatter" and not self.rocks)
        ):
            raise ValueError(f"{self.name}: a {self.primitive} has materials of its own; remove this one")
        return self

    def _is_its_own(self) -> None:
        """What vehicles, terrain and scatters are of themselves is given in no other way.

        Raises:
            ValueError: It is.
        """
        if self.primitive not in ("vehicle", *SPREAD):
            return
        moves = self.primitive == "vehicle"
        for field, value, given in (
            ("registration.mass", self.registration.mass, self.registration.mass is not None),
            ("registration.density", self.registration.density, self.registration.density is not None),
            ("registration.collision", self.registration.collision, self.registration.collision != "shape"),
            ("angular_velocity_deg", self.angular_velocity_deg, any(self.angular_velocity_deg or ())),
            ("state", self.state, moves and self.state == "kinematic"),
        ):
            if given:
                raise ValueError(f"{self.name}: {field} {value!r}: a {self.primitive} has its own; leave it out")
