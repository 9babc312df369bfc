"""The parts of a plan, and the plan that they make before it is held against itself."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import Field, SerializerFunctionWrapHandler, model_serializer, model_validator

from wsim.defaults import DURATION, FRAME_RATE
from wsim.limits import NO_BOUND
from wsim.plan.schema.base import Name, NotNegative, Number, Positive, Share, Sparse, Strict, Text, Vec3, Word
from wsim.plan.schema.clause import Clause
from wsim.plan.schema.cords import Cord
from wsim.plan.schema.formula import Formula
from wsim.plan.schema.objects import PlanObject
from wsim.plan.schema.openings import OpeningPlan
from wsim.plan.schema.schedules import SchedulePlan

VIEWS = ("side_minus_x", "side_plus_x", "side_minus_y", "side_plus_y", "top_down")
View = Literal[
    "side_minus_x", "side_plus_x", "side_minus_y", "side_plus_y", "top_down",
    "side_minus_x_room", "side_plus_x_room", "side_minus_y_room", "side_plus_y_room", "top_down_room",
]  # fmt: skip


class ImageHints(Strict):
    """What a reference picture says."""

    visible_objects: list[Word] = Field(default_factory=list, max_length=1000)
    scale: Text = ""
    support: list[Text] = Field(default_factory=list, max_length=1000)
    layout: list[Text] = Field(default_factory=list, max_length=1000)
    scene_type: Text = ""
    action_intent: Text = ""
    constraints: list[Text] = Field(default_factory=list, max_length=1000)


class ReferenceImage(Strict):
    """A picture that came with the prompt."""

    path: Word
    sha256: Annotated[str, Field(pattern=r"^[0-9a-f]{64}$")] | None = None
    hints: ImageHints = Field(default_factory=ImageHints)


class JointDrive(Strict):
    """A motor or spring on a joint: force = stiffness (position - q) + damping (velocity - q'), at most `max_force`.

    A hinge: [deg], [deg/s], [N m/rad], [N m s/rad], [N m]. A slider: [m], [m/s], [N/m], [N s/m], [N].
    """

    position: Number = 0.0
    velocity: Number = 0.0
    stiffness: NotNegative = 0.0
    damping: NotNegative = 0.0
    max_force: Positive | None = None
    saturates: bool = False  # it is meant to end at its full max_force: a winch that slips, a motor that stalls

    @model_validator(mode="after")
    def _acts(self) -> JointDrive:
        if self.stiffness == 0.0 and self.damping == 0.0:
            raise ValueError("a drive needs stiffness to hold a position, or damping to hold a velocity")
        if self.saturates and self.max_force is None:
            raise ValueError(f"saturates: true {NO_BOUND}")
        return self

    @model_serializer(mode="wrap")
    def _written(self, write: SerializerFunctionWrapHandler) -> dict[str, Any]:
        """Without `saturates` where it does not, so that a plan without it reads as it always did."""
        return {name: value for name, value in write(self).items() if name != "saturates" or value}


class Joint(Strict):
    """What holds two bodies together; without `parent` the child is held by the world."""

    name: Name
    kind: Literal["fixed", "hinge", "slider", "ball"]
    child: Name
    parent: Name | None = None
    anchor: Vec3 | None = None  # [m], from the child's centre, before it is turned; its centre if left out
    axis: Literal["X", "Y", "Z"] = "Y"
    limits: tuple[Number, Number] | None = None  # [deg] of a hinge, [m] of a slider
    drive: JointDrive | None = None

    @model_validator(mode="after")
    def _can_be_driven(self) -> Joint:
        if self.drive is not None and self.kind not in ("hinge", "slider"):
            raise ValueError(f"joint {self.name}: a {self.kind} joint has no drive; a hinge or a slider has")
        return self


class Contact(Sparse):
    """How one pair of objects rubs, bounces and rolls on each other; what is left out their materials decide."""

    object: Name
    ref: Name
    friction: NotNegative | None = None
    restitution: Share | None = None
    rolling: Share | None = None  # rolling resistance: a torque, of radius times push

    @model_validator(mode="after")
    def _says_something(self) -> Contact:
        if self.friction is None and self.restitution is None and self.rolling is None:
            raise ValueError(
                f"the contact of {self.object} and {self.ref} states nothing; give friction, restitution or rolling"
            )
        return self


class CameraPlan(Strict):
    """A camera: from `eye` at `target`, or by a `view` of the scene or of one object, which the layout resolves.

    One that the prompt asks for has its words, and is kept. Others are corrected where they do not show what happens.
    """

    name: Name
    eye: Vec3 | None = None  # [m]
    target: Vec3 | None = None  # [m]
    view: View | None = None
    of: Name | None = None
    follows: Name | None = None  # an object that moves: it keeps its offset from that, which is where it starts
    words: Text = ""  # of the prompt, that ask for this very view

    @model_serializer(mode="wrap")
    def _written(self, write: SerializerFunctionWrapHandler) -> dict[str, Any]:
        """Without `follows` and `words` that it lacks, so that a plan without them reads as it always did."""
        return {name: value for name, value in write(self).items() if name not in ("follows", "words") or value}

    @model_validator(mode="after")
    def _one_way(self) -> CameraPlan:
        placed = self.eye is not None and self.target is not None
        if not placed and self.view is None:
            raise ValueError(f'camera {self.name}: give "eye" and "target", or a "view"')
        if placed and self.eye == self.target:
            raise ValueError(f"camera {self.name}: eye and target are both {self.eye}; move one of them")
        return self


class SensorPlan(Strict):
    """Something that measures, on a body or in the world."""

    name: Name
    kind: Literal["camera", "imu", "contact", "force", "lidar", "pose"]
    mount: Name | None = None
    rate: Positive = 30.0  # [1/s]


class Step(Sparse):
    """One stage of the implementation, and what it must show when it is done."""

    title: Word
    objects: list[Name] = Field(default_factory=list, max_length=10_000)
    shows: Text
    controls: bool | None = None  # whether the program's control acts here; open: if the words name it

    @property
    def asks_for_control(self) -> bool:
        """Whether the program must have a `control`. Plans without the field say so in words: "control turns ..."."""
        return "control" in f"{self.title} {self.shows}".lower() if self.controls is None else self.controls


# The kinds of objective that the judge knows: those that need another object, `ref`, and those that do not.
KindOfTwo = Literal[
    "floats", "rests_on", "submerged", "stays_on", "stays_inside", "rolls_down", "collides_with", "tilts", "fills",
]  # fmt: skip
KindOfOne = Literal["topples", "settles", "swings", "slides", "moves", "flies"]


class Objective(Strict):
    """What must happen. `kind` is a name of the judge's closed list, or "formula", which says it in full."""

    kind: Literal[KindOfTwo, KindOfOne, "formula"]
    object: Name
    ref: Name | None = None
    tolerance: NotNegative | None = None
    value: Positive | None = None  # the least distance [m] of what moves, slides or rolls
    direction: Literal["front", "back", "left", "right"] | None = None  # of what moves
    sentence: Text = ""
    formula: Formula | None = None  # of the kind "formula": docs/objectives.md

    @model_validator(mode="after")
    def _says_it_once(self) -> Objective:
        if (self.kind == "formula") != (self.formula is not None):
            lacks = "it has none" if self.formula is None else f"this is {self.kind!r}"
            raise ValueError(f'"formula" goes with the kind "formula" and with no other; {lacks}')
        return self


class SimulationPlan(Strict):
    """How long, how fine, where."""

    duration: Positive = DURATION  # [s]
    time_step: NotNegative = 0.0  # upper bound [s]; 0 = none
    spacing: NotNegative = 0.0  # SPH particle spacing [m]
    frame_rate: Positive = FRAME_RATE
    device: Word = "auto"
    seed: Annotated[int, Field(ge=0, lt=2**31)] = 0


class Outputs(Strict):
    """What a run leaves beside the recording and the verdict."""

    video: bool = True
    stills: list[Name] = Field(default_factory=list, max_length=100)  # cameras; all if empty


AssumptionKind = Literal["count", "height", "material", "end"]


class Assumption(Sparse):
    """A choice that the prompt left open, with the default taken.

    Attributes:
        subject: The prompt's words for what it is about.
        choice: In words.
        why: Why this was open.
        kind: What was chosen, where another choice may change the outcome: how many, from how high, of what; or the end
            that is expected.
        value: The choice alone, of that kind: "3", "0.5 m", "wood"; "float" or "sink".
    """

    subject: Text
    choice: Text
    why: Text
    kind: AssumptionKind | None = None
    value: Word | None = None

    @model_validator(mode="after")
    def _kind_and_value(self) -> Assumption:
        if (self.kind is None) != (self.value is None):
            raise ValueError('"kind" and "value" go together; give both, or neither')
        return self


_UNWRITTEN = ("contacts", "cords", "schedules", "openings", "clauses", "stands_in_for")  # where they are empty


class Draft(Strict):
    """Everything that is to be built and judged: each part valid by itself."""

    version: Literal[2] = 2
    title: Text
    prompt: Text
    image: ReferenceImage | None = None
    objects: list[PlanObject] = Field(max_length=10_000)
    joints: list[Joint] = Field(default_factory=list, max_length=10_000)
    cords: list[Cord] = Field(default_factory=list, max_length=1000)
    contacts: list[Contact] = Field(default_factory=list, max_length=10_000)
    schedules: list[SchedulePlan] = Field(default_factory=list, max_length=1000)
    openings: list[OpeningPlan] = Field(default_factory=list, max_length=100)
    cameras: list[CameraPlan] = Field(default_factory=list, max_length=100)
    sensors: list[SensorPlan] = Field(default_factory=list, max_length=1000)
    steps: list[Step] = Field(default_factory=list, max_length=1000)
    objectives: list[Objective] = Field(default_factory=list, max_length=10_000)
    clauses: list[Clause] = Field(default_factory=list, max_length=1000)  # of the prompt; none: nothing is held to it
    stands_in_for: Text | None = None  # what was asked for and cannot be simulated, where this world is the nearest
    simulation: SimulationPlan = Field(default_factory=SimulationPlan)
    outputs: Outputs = Field(default_factory=Outputs)
    assumptions: list[Assumption] = Field(default_factory=list, max_length=10_000)

    @model_serializer(mode="wrap")
    def _written(self, write: SerializerFunctionWrapHandler) -> dict[str, Any]:
        """Without what it has none of, so that a plan without it reads as it always did."""
        return {name: value for name, value in write(self).items() if name not in _UNWRITTEN or value}

    def object(self, name: str) -> PlanObject:
        """The object of that name; KeyError naming the known ones."""
        for candidate in self.objects:
            if candidate.name == name:
                return candidate
        raise KeyError(f"no object {name!r}; the plan has {[o.name for o in self.objects]}")
