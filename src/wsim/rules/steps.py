"""The stages in which a plan's world is built, and what each must show."""

from __future__ import annotations

from wsim.plan.schema import Plan, PlanObject, Step


def steps(plan: Plan) -> list[Step]:
    """Ground, what stands still, fluid, bodies, joints, motion, cameras: those that the plan has."""
    still = [item for item in plan.objects if item.state == "static" and item.primitive not in ("ground", "terrain")]
    groups: tuple[tuple[str, list[PlanObject], str], ...] = (
        ("ground", [o for o in plan.objects if o.primitive == "ground"], "a level plane at z = 0"),
        ("ground", [o for o in plan.objects if o.primitive == "terrain"], "one surface, level where it is driven off"),
        ("containers", [o for o in still if o.role == "container"], "upright, open at the top, empty"),
        ("what stands still", [o for o in still if o.role != "container"], "each in its place, none in another"),
        ("fluid", [o for o in plan.objects if o.role == "fluid"], "at its level or over its vessel, inside no solid"),
        ("bodies", [o for o in plan.objects if o.state == "dynamic"], "each where its rows put it, touching no other"),
        ("joints", _jointed(plan), "bodies held together at their anchors"),
        (
            "motion",
            [o for o in plan.objects if _moves(o)],
            "each starts with its own velocity, and each belt runs at its own",
        ),
    )
    driven = [o for o in plan.objects if o.primitive == "vehicle"]
    groups = (*groups, ("drive", driven, "each follows its route by its own engine, steering and brakes"))
    made = [Step(title=title, objects=[o.name for o in items], shows=shows) for title, items, shows in groups if items]
    return [*made, Step(title="cameras", shows="the whole scene in every view")]


def _moves(item: PlanObject) -> bool:
    return any(item.velocity) or item.angular_velocity_deg is not None or item.surface_velocity is not None


def _jointed(plan: Plan) -> list[PlanObject]:
    names = {name for joint in plan.joints for name in (joint.child, joint.parent)}
    return [item for item in plan.objects if item.name in names]
