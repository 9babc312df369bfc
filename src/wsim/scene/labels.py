"""What a pixel of a picture is of: objects, by number."""

from __future__ import annotations

from wsim.scene.world import World


def object_of(prim: str) -> str:
    """/World/tank/floor -> /World/tank: the plan's objects are the children of the root."""
    return "/".join(prim.split("/")[:3])


def wholes(world: World) -> dict[str, str]:
    """Of each object that has bodies, the one that it is a part of: a truck of `truck_wheel_front_left`; or itself.

    A part is joined to something, and its name begins with that of the whole; or it is one of its wheels.
    """
    objects = {object_of(body.prim) for body in world.bodies}
    joined = {object_of(prim) for joint in world.joints for prim in (joint.child, joint.parent) if prim is not None}
    able = sorted(objects & joined, key=len)
    turns = {object_of(wheel): object_of(body) for wheel, body in wheels(world).items()}
    return {
        prim: next((whole for whole in able if prim in joined and prim.startswith(f"{whole}_")), turns.get(prim, prim))
        for prim in objects
    }


def wheels(world: World) -> dict[str, str]:
    """Round bodies, alike, two or more of which turn on hinges of the same heavier body; which that is, by their prims.

    Of these one is seen for all: from the side the far ones are behind the others.
    """
    bodies = {body.prim: body for body in world.bodies}
    alike: dict[tuple[str, float, tuple[float, ...]], list[str]] = {}
    for joint in world.joints:
        for one, other in ((joint.child, joint.parent or ""), (joint.parent or "", joint.child)):
            wheel, carrier = bodies.get(one), bodies.get(other)
            if joint.kind != "revolute" or wheel is None or carrier is None or wheel.mass >= carrier.mass:
                continue
            if len(wheel.shapes) == 1 and wheel.shapes[0].kind in ("cylinder", "sphere"):
                size = tuple(round(edge, 6) for edge in wheel.shapes[0].size)
                alike.setdefault((other, round(wheel.mass, 6), size), []).append(one)
    return {wheel: carrier for (carrier, _, _), found in alike.items() if len(found) > 1 for wheel in found}


def labels_of(world: World) -> list[str]:
    """Prims of the objects of a world by the number that a camera's segmentation has for them; 0 is nothing, ""."""
    prims = [each.prim for group in (world.bodies, world.statics, world.cords) for each in group]
    return list(dict.fromkeys(["", *map(object_of, prims)]))
