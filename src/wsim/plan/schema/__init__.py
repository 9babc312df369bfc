"""The plan's model: a pydantic schema in which nothing dangles."""

from wsim.plan.schema.base import Name, Vec3
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
    External,
    FromAsset,
    FromRobot,
    Material,
    PlanObject,
    Pose,
    Proxy,
    Registration,
)
from wsim.plan.schema.plan import PLAN_VERSION, Plan
from wsim.plan.schema.predicates import PREDICATES, TEMPLATES, Predicate
from wsim.plan.schema.relations import Region, Relation

__all__ = [
    "PLAN_VERSION",
    "PREDICATES",
    "TEMPLATES",
    "Actuation",
    "Assumption",
    "AssumptionKind",
    "CameraPlan",
    "Contact",
    "External",
    "FromAsset",
    "FromRobot",
    "ImageHints",
    "Joint",
    "JointDrive",
    "Material",
    "Name",
    "Objective",
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
    "SensorPlan",
    "SimulationPlan",
    "Step",
    "Vec3",
    "explain",
]
