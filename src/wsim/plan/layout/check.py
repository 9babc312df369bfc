"""What a laid-out plan must be: nothing in another thing, everything carried, every row so."""

from __future__ import annotations

from wsim.defaults import FLUID_DENSITY
from wsim.plan import templates
from wsim.plan.layout.bodies import convex, solids
from wsim.plan.layout.boxes import TOUCH, depth
from wsim.plan.layout.errors import LayoutError
from wsim.plan.layout.measure import unsatisfied
from wsim.plan.layout.space import exempt
from wsim.plan.layout.world import World
from wsim.plan.schema import Plan, PlanObject


def check_clear(plan: Plan) -> None:
    """Refuse a plan whose objects overlap by more than a millimetre, or lie below the ground.

    Raises:
        LayoutError: names the two objects and how deep they overlap.
    """
    may = _may_overlap(plan)
    ground = next((item for item in plan.objects if item.primitive == "ground"), None)
    base = ground.pose.position[2] if ground is not None and ground.pose is not None else 0.0
    shown = [item for item in plan.objects if item.registration.collision != "none"]
    filled = [(item, solid, solid.box()) for item in shown for solid in convex(item)]
    filled.sort(key=lambda one: one[2].low[0])
    for index, (item, solid, box) in enumerate(filled):
        if ground is not None and box.low[2] < base - TOUCH:
            raise LayoutError(f"{item.name} starts {base - box.low[2]:.3g} m below the ground; raise it")
        for other, other_solid, other_box in filled[index + 1 :]:
            if other_box.low[0] > box.high[0]:
                break
            if item.name == other.name or box.overlap(other_box) <= TOUCH:
                continue
            if frozenset((item.name, other.name)) in may:
                continue
            deep = depth(solid, other_solid)
            if deep > TOUCH:
                raise _overlap(plan, item, other, deep)


def _overlap(plan: Plan, a: PlanObject, b: PlanObject, deep: float) -> LayoutError:
    order = [item.name for item in plan.objects]
    first, second = sorted((a.name, b.name), key=order.index)
    return LayoutError(
        f"{first} and {second} overlap by {deep:.3g} m where they start; "
        "move one of them, or relate one to the other with a gap"
    )


def _may_overlap(plan: Plan) -> set[frozenset[str]]:
    world = World(plan, templates.expand(plan))
    placed = {item.name for item in plan.objects if item.pose is not None and item.name in world.bodies}
    for name in placed:
        pose = world.items[name].pose
        box = solids(world.items[name])
        if pose is not None and box:
            world.yaw[name] = pose.rotation_deg[2]
            world.bottom[name] = min(one.low[2] for one in box)
    return exempt(world, placed & set(world.bottom))


def check_rows(plan: Plan) -> None:
    """Refuse a plan with a row that its poses do not keep.

    Raises:
        LayoutError: names the rows and by how much they are off.
    """
    found = unsatisfied(plan)
    if found:
        raise LayoutError("; ".join(found[:8]) + "; another row rules it out: change one of them")


def check_floats(plan: Plan) -> list[str]:
    """What is asked to float and is too dense for it: one line each, with the numbers.

    The layout takes such a plan as it is: what must happen is the user's to say, and whether it does the judge's.

    Args:
        plan: With or without poses.
    """
    items = {item.name: item for item in plan.objects}
    found = []
    for item in plan.objects:
        for relation in item.relations:
            for row in templates.expand_row(item, relation, items):
                if row.predicate != "FLOATS-AT-SURFACE" or row.ref is None:
                    continue
                fluid, own = items[row.ref], item.density
                liquid = fluid.density or FLUID_DENSITY
                if own is not None and own >= liquid:
                    found.append(
                        f"{row}: {item.name} has {own:g} kg/m^3 and {fluid.name} {liquid:g} kg/m^3, it sinks; "
                        "give it a lighter material, or SUBMERGED"
                    )
    return found
