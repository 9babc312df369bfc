"""The plan: what must be in the world, where, and what must happen.

A plan that validates is whole: names are unique, every reference exists, sizes fit their primitives. SI units, Z up;
FRONT = +X, BACK = -X, LEFT = +Y, RIGHT = -Y. A pose is the object's centre, except for a tank, whose pose is the
centre of its outer bottom face, and a fluid in a container, which has none.
"""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError, model_validator

PLAN_VERSION = 1
Vec3 = tuple[float, float, float]
Name = Annotated[str, Field(pattern=r"^[A-Za-z_][A-Za-z0-9_]*$")]
Positive = Annotated[float, Field(gt=0.0, allow_inf_nan=False)]
Role = Literal["rigid_body", "container", "fluid", "terrain"]
Primitive = Literal["box", "sphere", "cylinder", "capsule", "tank", "fluid", "ground"]
Predicate = Literal[
    "PLACE-ON-BASE",  # bottom on the world's base plane, z = 0
    "PLACE-ON",  # bottom on the top of `ref`, centred on it where no side relation places it
    "PLACE-IN",  # inside the container `ref`, above its inner floor
    "LEFT-OF",  # beside `ref` on its +Y side, faces `gap` apart
    "RIGHT-OF",  # -Y
    "FRONT-OF",  # +X
    "BACK-OF",  # -X
    "FREE-SURFACE-AT",  # the fluid's still surface stands `value` above the inner floor of its container
    "FLOATS-AT-SURFACE",  # starts with its bottom face `gap` above the still surface of the fluid `ref`
    "SUBMERGED",  # starts with its top face `value` below the still surface of the fluid `ref`
    "SPAWNED-ABOVE",  # starts with its bottom face `value` above `ref`: a fluid's surface, a top, or the base if no ref
    "LIES-ALONG-X",  # a cylinder or capsule on its side
    "LIES-ALONG-Y",
]
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
ROLE_PRIMITIVES: dict[str, tuple[str, ...]] = {
    "rigid_body": ("box", "sphere", "cylinder", "capsule"),
    "container": ("tank",),
    "fluid": ("fluid",),
    "terrain": ("ground", "box", "sphere", "cylinder", "capsule"),
}
ROLE_STATES: dict[str, tuple[str, ...]] = {
    "rigid_body": ("dynamic", "static"),
    "container": ("static",),
    "fluid": ("fluid",),
    "terrain": ("static",),
}
_NEEDS_REF = {"PLACE-ON", "PLACE-IN", "LEFT-OF", "RIGHT-OF", "FRONT-OF", "BACK-OF", "FLOATS-AT-SURFACE", "SUBMERGED"}
_NEEDS_VALUE = {"FREE-SURFACE-AT", "SUBMERGED", "SPAWNED-ABOVE"}
_NEEDS_OBJECTIVE_REF = {"floats", "rests_on", "submerged", "stays_on", "stays_inside"}


class _Model(BaseModel):
    model_config = ConfigDict(extra="forbid", allow_inf_nan=False)


class Material(_Model):
    """Bulk and surface properties."""

    name: str
    density: Positive  # [kg/m^3]
    friction: float = Field(0.5, ge=0.0)
    restitution: float = Field(0.0, ge=0.0, le=1.0)
    color: Vec3 = (0.7, 0.7, 0.7)
    opacity: float = Field(1.0, ge=0.0, le=1.0)


class Relation(_Model):
    """One row of the topology: `predicate` applied to the object, with its arguments."""

    predicate: Predicate
    ref: str | None = None
    gap: float | None = Field(None, ge=0.0)  # [m], between faces
    value: float | None = Field(None, ge=0.0)  # [m]: a height or a depth

    @model_validator(mode="after")
    def _arguments(self) -> Relation:
        if self.predicate in _NEEDS_REF and self.ref is None:
            raise ValueError(f'{self.predicate} needs "ref", the name of another object')
        if self.predicate in _NEEDS_VALUE and self.value is None:
            raise ValueError(f'{self.predicate} needs "value", a height or depth in metres')
        return self


class Pose(_Model):
    """Where the layout put the object: its centre, and roll, pitch, yaw in degrees."""

    position: Vec3
    rotation_deg: Vec3 = (0.0, 0.0, 0.0)


class PlanObject(_Model):
    """One thing in the world; its name is its prim's name."""

    name: Name
    role: Role
    primitive: Primitive
    size: tuple[
        Positive, ...
    ] = ()  # as in wsim.scene: box (x, y, z); sphere (radius,); cylinder/capsule (radius, height)
    material: Material | None = None
    state: Literal["static", "dynamic", "fluid"] = "dynamic"
    relations: list[Relation] = Field(default_factory=list)
    pose: Pose | None = None
    velocity: Vec3 = (0.0, 0.0, 0.0)  # [m/s], initial
    words: str = ""  # the words of the prompt that asked for it

    def relation(self, predicate: str) -> Relation | None:
        """The object's first relation of that predicate, if it has one."""
        return next((relation for relation in self.relations if relation.predicate == predicate), None)

    @model_validator(mode="after")
    def _shape(self) -> PlanObject:
        counts = SIZE_COUNT[self.primitive]
        if len(self.size) not in counts:
            wanted = " or ".join(str(count) for count in counts)
            raise ValueError(
                f"{self.name}: size of a {self.primitive} has {wanted} numbers, {SIZE_MEANING[self.primitive]}, "
                f"in metres; it has {len(self.size)}"
            )
        if self.primitive not in ROLE_PRIMITIVES[self.role]:
            known = ", ".join(ROLE_PRIMITIVES[self.role])
            raise ValueError(f"{self.name}: primitive of a {self.role} is {known}; it is a {self.primitive}")
        if self.state not in ROLE_STATES[self.role]:
            raise ValueError(
                f'{self.name}: state of a {self.role} is {" or ".join(ROLE_STATES[self.role])}; it is "{self.state}"'
            )
        if self.role == "rigid_body" and self.state == "dynamic" and self.material is None:
            raise ValueError(f'{self.name}: a dynamic body needs "material" with a name and a density in kg/m^3')
        return self


class CameraPlan(_Model):
    """A camera by name."""

    name: Name
    eye: Vec3
    target: Vec3


class Objective(_Model):
    """What must happen. `kind` is a name of the judge's closed list."""

    kind: Literal["floats", "rests_on", "submerged", "stays_on", "topples", "stays_inside", "settles"]
    object: Name
    ref: Name | None = None
    tolerance: float | None = None
    sentence: str = ""


class SimulationPlan(_Model):
    """How long, how fine, where."""

    duration: Positive = 5.0  # [s]
    time_step: float = Field(0.0, ge=0.0)  # [s]; 0 = chosen by the simulator
    spacing: float = Field(0.0, ge=0.0)  # SPH particle spacing [m]
    frame_rate: Positive = 30.0
    device: str = "auto"
    seed: int = 0


class Assumption(_Model):
    """A choice that the prompt left open, with the default taken."""

    subject: str
    choice: str
    why: str


class Plan(_Model):
    """Everything that is to be built and judged."""

    version: Literal[1] = 1
    title: str
    prompt: str
    objects: list[PlanObject]
    cameras: list[CameraPlan] = Field(default_factory=list)
    objectives: list[Objective] = Field(default_factory=list)
    simulation: SimulationPlan = Field(default_factory=SimulationPlan)
    assumptions: list[Assumption] = Field(default_factory=list)

    def object(self, name: str) -> PlanObject:
        """The object of that name; KeyError naming the known ones."""
        for candidate in self.objects:
            if candidate.name == name:
                return candidate
        raise KeyError(f"no object {name!r}; the plan has {[o.name for o in self.objects]}")

    @model_validator(mode="after")
    def _whole(self) -> Plan:
        problems = [*_name_problems(self), *_reference_problems(self), *_fluid_problems(self)]
        if problems:
            raise ValueError("; ".join(problems))
        return self


def _name_problems(plan: Plan) -> list[str]:
    problems = []
    for kind, names in (
        ("objects", [item.name for item in plan.objects]),
        ("cameras", [item.name for item in plan.cameras]),
    ):
        for index, name in enumerate(names):
            if name in names[:index]:
                problems.append(
                    f"{kind}.{index}.name: {name!r} is taken by {kind}.{names.index(name)}; give it another name"
                )
    object_names = {item.name for item in plan.objects}
    for index, camera in enumerate(plan.cameras):
        if camera.name in object_names:
            problems.append(f"cameras.{index}.name: {camera.name!r} is the name of an object; give it another name")
    return problems


def _reference_problems(plan: Plan) -> list[str]:
    roles = {item.name: item.role for item in plan.objects}
    known = ", ".join(roles) or "no objects"
    problems = []
    for i, item in enumerate(plan.objects):
        for j, relation in enumerate(item.relations):
            where = f"objects.{i}.relations.{j}.ref"
            if relation.ref is None:
                continue
            if relation.ref == item.name:
                problems.append(f"{where}: {item.name} cannot be placed by itself; name another object")
            elif relation.ref not in roles:
                problems.append(f"{where}: no object {relation.ref!r}; the plan has {known}")
            elif relation.predicate in ("FLOATS-AT-SURFACE", "SUBMERGED") and roles[relation.ref] != "fluid":
                problems.append(
                    f"{where}: {relation.predicate} needs a fluid; {relation.ref} is a {roles[relation.ref]}"
                )
            elif relation.predicate == "PLACE-IN" and roles[relation.ref] != "container":
                problems.append(f"{where}: PLACE-IN needs a container; {relation.ref} is a {roles[relation.ref]}")
    for i, objective in enumerate(plan.objectives):
        if objective.object not in roles:
            problems.append(f"objectives.{i}.object: no object {objective.object!r}; the plan has {known}")
        if objective.ref is None and objective.kind in _NEEDS_OBJECTIVE_REF:
            problems.append(f'objectives.{i}.ref: "{objective.kind}" needs "ref", the name of the other object')
        if objective.ref is not None and objective.ref not in roles:
            problems.append(f"objectives.{i}.ref: no object {objective.ref!r}; the plan has {known}")
    return problems


def _fluid_problems(plan: Plan) -> list[str]:
    problems = []
    for i, item in enumerate(plan.objects):
        if item.role != "fluid":
            continue
        contained = item.relation("PLACE-IN") is not None
        if not contained and not item.size:
            problems.append(
                f"objects.{i}: the fluid {item.name} needs PLACE-IN with a container, or a size (x, y, z) in metres"
            )
        if contained and item.relation("FREE-SURFACE-AT") is None:
            problems.append(
                f'objects.{i}.relations: the fluid {item.name} needs FREE-SURFACE-AT with "value", its level above the '
                "inner floor in metres"
            )
    return problems


def explain(error: ValidationError) -> str:
    """One line for a person: each problem with its path in the plan."""
    lines = []
    for item in error.errors():
        where = ".".join(str(part) for part in item["loc"])
        text = str(item["msg"]).removeprefix("Value error, ")
        lines.append(f"{where}: {text}" + _way_out(item) if where else text)
    return "; ".join(lines)


def _way_out(item: Any) -> str:
    if item["type"] == "extra_forbidden":
        return "; remove it, or look for a spelling mistake"
    if item["type"] == "missing":
        return "; add it"
    return ""
