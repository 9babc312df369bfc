"""Arguments of the scene's shapes: ground, box, sphere, cylinder, capsule and tank."""

from __future__ import annotations

from wsim.plan.schema import PlanObject
from wsim.program.compose.draft import Draft
from wsim.program.compose.poses import position, rotation
from wsim.program.source import number, tuple_of


def arguments(draft: Draft, item: PlanObject, at: str | None = None) -> list[str]:
    """All arguments but the name.

    Args:
        draft: The program.
        item: A solid object that is no asset.
        at: The position as the program spells it, where that is not the object's own in numbers.
    """
    found = _size(item)
    stands = item.primitive in ("ground", "tank")  # it is neither turned nor moved
    if item.primitive == "ground":
        if item.pose is not None and item.pose.position[2]:
            found.append(f"height={number(item.pose.position[2])}")
    elif item.primitive != "tank" or any(position(item)):
        found.append(f"position={at or tuple_of(position(item))}")
    if not stands:
        found += rotation(item)
    if any(item.velocity) and item.state in ("dynamic", "kinematic"):
        found.append(f"velocity={tuple_of(item.velocity)}")
    if item.angular_velocity_deg is not None and item.state in ("dynamic", "kinematic"):
        found.append(f"angular_velocity_deg={tuple_of(item.angular_velocity_deg)}")
    if item.rolling:
        found.append("rolling=True")
    if item.state == "static" and not stands:
        found.append("static=True")
    if item.state == "kinematic":
        found.append("kinematic=True")
    if item.state == "dynamic":
        found += weight(item)
    if item.material is not None:
        found.append(f"material={draft.materials[item.material.model_dump_json()]}")
    return found


def _size(item: PlanObject) -> list[str]:
    size = item.size
    if item.primitive == "box":
        return [f"size={tuple_of(size)}"]
    if item.primitive == "tank":
        return [f"inner_size={tuple_of(size)}"]
    if item.primitive == "sphere":
        return [f"radius={number(size[0])}"]
    if item.primitive in ("cylinder", "capsule"):
        return [f"radius={number(size[0])}", f"height={number(size[1])}"]
    return []


def weight(item: PlanObject) -> list[str]:
    """A mass or a density of its own, which comes before its material's."""
    registration = item.registration
    if registration.mass is not None:
        return [f"mass={number(registration.mass)}"]
    return [f"density={number(registration.density)}"] if registration.density is not None else []
