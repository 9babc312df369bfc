"""What a pixel of a picture is of: objects, by number."""

from __future__ import annotations

from wsim.scene.world import World


def object_of(prim: str) -> str:
    """/World/tank/floor -> /World/tank: the plan's objects are the children of the root."""
    return "/".join(prim.split("/")[:3])


def wholes(world: World) -> dict[str, str]:
    """Of each object that has bodies, the one that it is a part of: a truck of `truck_wheel_front_left`; or itself.

    A part is joined to something, and its name begins with that of the whole.
    """
    objects = {object_of(body.prim) for body in world.bodies}
    joined = {object_of(prim) for joint in world.joints for prim in (joint.child, joint.parent) if prim is not None}
    able = sorted(objects & joined, key=len)
    return {
        prim: next((whole for whole in able if prim in joined and prim.startswith(f"{whole}_")), prim)
        for prim in objects
    }


def labels_of(world: World) -> list[str]:
    """Prims of the objects of a world by the number that a camera's segmentation has for them; 0 is nothing, ""."""
    prims = [each.prim for group in (world.bodies, world.statics, world.cords) for each in group]
    return list(dict.fromkeys(["", *map(object_of, prims)]))
