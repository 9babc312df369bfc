"""The plan: what must be in the world, where, and what must happen."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field

PLAN_VERSION = 1
Vec3 = tuple[float, float, float]
Name = Annotated[str, Field(pattern=r"^[A-Za-z_][A-Za-z0-9_]*$")]
Positive = Annotated[float, Field(gt=0.0, allow_inf_nan=False)]


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

    predicate: str
    ref: str | None = None
    gap: float | None = None  # [m]
    value: float | None = None  # [m]: a height or a depth


class Pose(_Model):
    """Where the layout put the object: its centre, and roll, pitch, yaw in degrees."""

    position: Vec3
    rotation_deg: Vec3 = (0.0, 0.0, 0.0)


class PlanObject(_Model):
    """One thing in the world; its name is its prim's name."""

    name: Name
    role: Literal["rigid_body", "container", "fluid", "terrain"]
    primitive: Literal["box", "sphere", "cylinder", "capsule", "tank", "fluid", "ground"]
    size: tuple[Positive, ...] = ()  # as in wsim.scene: box (x, y, z); sphere (radius,); cylinder/capsule (radius, height)
    material: Material | None = None
    state: Literal["static", "dynamic", "fluid"] = "dynamic"
    relations: list[Relation] = Field(default_factory=list)
    pose: Pose | None = None
    velocity: Vec3 = (0.0, 0.0, 0.0)  # [m/s], initial
    words: str = ""  # the words of the prompt that asked for it


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
