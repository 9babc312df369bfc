"""The plan's model: a pydantic schema in which nothing dangles."""

from wsim.plan.schema.actuation import ArcPlan, BrakePlan
from wsim.plan.schema.base import Name, Vec3
from wsim.plan.schema.clause import Clause
from wsim.plan.schema.constructions import (
    AreaPlan,
    Clearance,
    External,
    FromAsset,
    FromRobot,
    FromScatter,
    FromTerrain,
    FromVehicle,
    HillLayer,
    LevelLayer,
    Material,
    NoiseLayer,
    Proxy,
    RoadLayer,
)
from wsim.plan.schema.cords import Around, Cord
from wsim.plan.schema.draft import (
    Assumption,
    AssumptionKind,
    CameraPlan,
    Contact,
    ImageHints,
    Joint,
    JointDrive,
    Objective,
    Outputs,
    ReferenceImage,
    SensorPlan,
    SimulationPlan,
    Step,
)
from wsim.plan.schema.explain import explain
from wsim.plan.schema.objects import (
    Actuation,
    PlanObject,
    Pose,
    Registration,
)
from wsim.plan.schema.openings import OpeningPlan
from wsim.plan.schema.plan import PLAN_VERSION, Plan
from wsim.plan.schema.predicates import PREDICATES, TEMPLATES, Predicate
from wsim.plan.schema.relations import Region, Relation
from wsim.plan.schema.schedules import EventPlan, SchedulePlan

__all__ = [
    "PLAN_VERSION",
    "PREDICATES",
    "TEMPLATES",
    "Actuation",
    "ArcPlan",
    "AreaPlan",
    "Around",
    "Assumption",
    "AssumptionKind",
    "BrakePlan",
    "CameraPlan",
    "Clause",
    "Clearance",
    "Contact",
    "Cord",
    "EventPlan",
    "External",
    "FromAsset",
    "FromRobot",
    "FromScatter",
    "FromTerrain",
    "FromVehicle",
    "HillLayer",
    "ImageHints",
    "Joint",
    "JointDrive",
    "LevelLayer",
    "Material",
    "Name",
    "NoiseLayer",
    "Objective",
    "OpeningPlan",
    "Outputs",
    "Plan",
    "PlanObject",
    "Pose",
    "Predicate",
    "Proxy",
    "ReferenceImage",
    "Region",
    "Registration",
    "Relation",
    "RoadLayer",
    "SchedulePlan",
    "SensorPlan",
    "SimulationPlan",
    "Step",
    "Vec3",
    "explain",
]
