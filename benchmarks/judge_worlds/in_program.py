"""Faults of the program: of what it is composed, or of its text."""

from __future__ import annotations

from collections.abc import Callable

from wsim.plan.schema import Plan, PlanObject, Pose, Vec3
from wsim.plan.schema.objects import Proxy

PlanChange = Callable[[Plan], Plan]
TextChange = Callable[[str], str]


def _with(plan: Plan, name: str, change: Callable[[PlanObject], PlanObject]) -> Plan:
    if all(item.name != name for item in plan.objects):
        raise KeyError(f"no object {name!r}; the plan has {[item.name for item in plan.objects]}")
    return plan.model_copy(update={"objects": [change(o) if o.name == name else o for o in plan.objects]})


def material(name: str, **fields: object) -> PlanChange:
    """Another density, friction, restitution or colour; what weighs a body comes from its material then."""

    def change(item: PlanObject) -> PlanObject:
        assert item.material is not None
        changed = item.material.model_copy(update={**fields, "name": f"{item.material.name} {name}"})
        return item.model_copy(update={"material": changed})

    return lambda plan: _with(plan, name, change)


def heavier(name: str, factor: float) -> PlanChange:
    """Another mass, through the density."""

    def change(item: PlanObject) -> PlanObject:
        kept = item.registration
        assert item.material is not None
        if kept.mass is not None:
            return item.model_copy(update={"registration": kept.model_copy(update={"mass": factor * kept.mass})})
        density = factor * (kept.density or item.material.density)
        return item.model_copy(update={"registration": kept.model_copy(update={"density": density})})

    return lambda plan: _with(plan, name, change)


def scaled(name: str, factor: float, lift: bool = True) -> PlanChange:
    """Another size; what stands on something is lifted so that it still does."""

    def change(item: PlanObject) -> PlanObject:
        assert isinstance(item.construction, Proxy) and item.pose is not None
        size = tuple(factor * length for length in item.size)
        half = item.size[2] / 2 if item.primitive == "box" else item.size[0] if item.primitive == "sphere" else 0.0
        x, y, z = item.pose.position
        pose = item.pose.model_copy(update={"position": (x, y, z + lift * (factor - 1.0) * half)})
        return item.model_copy(
            update={"construction": Proxy(primitive=item.construction.primitive, size=size), "pose": pose}
        )

    return lambda plan: _with(plan, name, change)


def moved(name: str, offset: Vec3) -> PlanChange:
    """Another place."""

    def change(item: PlanObject) -> PlanObject:
        assert item.pose is not None
        position = tuple(a + b for a, b in zip(item.pose.position, offset, strict=True))
        return item.model_copy(update={"pose": item.pose.model_copy(update={"position": position})})

    return lambda plan: _with(plan, name, change)


def turned(name: str, rotation_deg: Vec3) -> PlanChange:
    """Another heading."""

    def change(item: PlanObject) -> PlanObject:
        assert item.pose is not None
        return item.model_copy(update={"pose": item.pose.model_copy(update={"rotation_deg": rotation_deg})})

    return lambda plan: _with(plan, name, change)


def launched(name: str, factor: float) -> PlanChange:
    """Another velocity at the start."""

    def change(item: PlanObject) -> PlanObject:
        return item.model_copy(update={"velocity": tuple(factor * v for v in item.velocity)})

    return lambda plan: _with(plan, name, change)


def without(name: str) -> PlanChange:
    """An object and its joints are left out."""

    def change(plan: Plan) -> Plan:
        objects = [item for item in plan.objects if item.name != name]
        joints = [joint for joint in plan.joints if name not in (joint.child, joint.parent)]
        return plan.model_copy(update={"objects": objects, "joints": joints})

    return change


def without_joint(name: str) -> PlanChange:
    """A joint is left out."""
    return lambda plan: plan.model_copy(update={"joints": [joint for joint in plan.joints if joint.name != name]})


def hinged_elsewhere(name: str, axis: str) -> PlanChange:
    """A joint turns about another axis."""
    return lambda plan: plan.model_copy(
        update={"joints": [j.model_copy(update={"axis": axis}) if j.name == name else j for j in plan.joints]}
    )


def without_limits(name: str) -> PlanChange:
    """A joint has no limits."""
    return lambda plan: plan.model_copy(
        update={"joints": [j.model_copy(update={"limits": None}) if j.name == name else j for j in plan.joints]}
    )


def extra(of: str, name: str, offset: Vec3) -> PlanChange:
    """A second object like one that is there."""

    def change(plan: Plan) -> Plan:
        item = moved(of, offset)(plan).object(of).model_copy(update={"name": name})
        return plan.model_copy(update={"objects": [*plan.objects, item]})

    return change


def swapped(first: str, second: str) -> PlanChange:
    """Two objects stand in each other's place."""

    def change(plan: Plan) -> Plan:
        a, b = plan.object(first).pose, plan.object(second).pose
        assert a is not None and b is not None

        def to(pose: Pose) -> Callable[[PlanObject], PlanObject]:
            return lambda item: item.model_copy(update={"pose": pose})

        return _with(_with(plan, first, to(b)), second, to(a))

    return change


def looking(direction: Vec3) -> PlanChange:
    """Every camera looks elsewhere, from where it stands, and is meant to: another would be corrected."""

    def change(plan: Plan) -> Plan:
        turned_away = [
            camera.model_copy(
                update={
                    "target": tuple(a + b for a, b in zip(camera.eye or (0, 0, 0), direction, strict=True)),
                    "words": "away",
                }
            )
            for camera in plan.cameras
        ]
        return plan.model_copy(update={"cameras": turned_away})

    return change


def seen_from(eye: Vec3, target: Vec3) -> PlanChange:
    """Every camera stands elsewhere, and is meant to."""
    there = {"eye": eye, "target": target, "words": "there"}
    return lambda plan: plan.model_copy(
        update={"cameras": [camera.model_copy(update=there) for camera in plan.cameras]}
    )


def shorter(seconds: float) -> PlanChange:
    """The run ends early."""
    return lambda plan: plan.model_copy(
        update={"simulation": plan.simulation.model_copy(update={"duration": plan.simulation.duration - seconds})}
    )


def filled(name: str, factor: float) -> PlanChange:
    """A tank is filled to another level."""

    def change(item: PlanObject) -> PlanObject:
        rows = [
            row.model_copy(update={"value": round(factor * (row.value or 0.0), 4)})
            if row.predicate == "FREE-SURFACE-AT"
            else row
            for row in item.relations
        ]
        return item.related(rows)

    return lambda plan: _with(plan, name, change)


def replaced(old: str, new: str) -> TextChange:
    """Other words in the program; ValueError where the old ones are not."""

    def change(program: str) -> str:
        if old not in program:
            raise ValueError(f"the program has no {old!r}")
        return program.replace(old, new)

    return change


def appended(*lines: str) -> TextChange:
    """Further lines at the end of `build`."""

    def change(program: str) -> str:
        body, mark, rest = program.partition("\nif __name__ ==")
        return body.rstrip() + "\n" + "".join(f"    {line}\n" for line in lines) + "\n" + mark + rest

    return change


def weak_gravity(strength: float) -> TextChange:
    """Gravity of another strength [m/s^2]."""
    return replaced("scene.simulation(", f"scene.simulation(gravity=(0.0, 0.0, {-strength}), ")


def no_collision(name: str) -> TextChange:
    """An object's geometry collides with nothing."""
    return appended(
        "from pxr import Usd, UsdPhysics",
        f'for prim in Usd.PrimRange(scene.stage.GetPrimAtPath("/World/{name}")):',
        "    if prim.HasAPI(UsdPhysics.CollisionAPI):",
        "        UsdPhysics.CollisionAPI(prim).CreateCollisionEnabledAttr(False)",
    )


def invisible(name: str) -> TextChange:
    """An object is there, and is not drawn."""
    return appended(
        "from pxr import UsdGeom",
        f'UsdGeom.Imageable(scene.stage.GetPrimAtPath("/World/{name}")).MakeInvisible()',
    )
