"""Short ways to write plans, shared by the layout's tests."""

from wsim.plan.layout import layout
from wsim.plan.schema import FromAsset, Material, Plan, PlanObject, Relation, SimulationPlan

WOOD = Material(name="wood", density=600.0)
GROUND = PlanObject.proxy(name="ground", role="terrain", primitive="ground", state="static")


def box(name: str, *relations: Relation, size=(0.2, 0.4, 0.1), **fields) -> PlanObject:
    role = fields.pop("role", "rigid_body")
    return PlanObject.proxy(
        name=name, role=role, primitive="box", size=size, material=WOOD, relations=list(relations), **fields
    )


def rel(predicate: str, ref: str | None = None, **arguments) -> Relation:
    return Relation(predicate=predicate, ref=ref, **arguments)


def asset(name: str, id: str, *relations: Relation, role: str = "rigid_body") -> PlanObject:
    item = PlanObject(name=name, role=role, construction=FromAsset(asset=id), material=WOOD)
    return item.related(list(relations))


def tank(*relations: Relation) -> PlanObject:
    return PlanObject.proxy(
        name="tank", role="container", primitive="tank", size=(1.0, 0.6, 0.5), state="static", relations=list(relations)
    )


def water(*relations: Relation) -> PlanObject:
    rows = list(relations) or [rel("PLACE-IN", "tank"), rel("FREE-SURFACE-AT", value=0.3)]
    return PlanObject.proxy(name="water", role="fluid", primitive="fluid", state="fluid", relations=rows)


def make(*objects: PlanObject, seed: int = 0, **fields) -> Plan:
    return Plan(title="t", prompt="p", objects=list(objects), simulation=SimulationPlan(seed=seed), **fields)


def solve(*objects: PlanObject, seed: int = 0, **fields) -> Plan:
    return layout(make(*objects, seed=seed, **fields))


def at(plan: Plan, name: str) -> tuple[float, float, float]:
    pose = plan.object(name).pose
    assert pose is not None
    return pose.position


def yaw(plan: Plan, name: str) -> float:
    pose = plan.object(name).pose
    assert pose is not None
    return pose.rotation_deg[2]
