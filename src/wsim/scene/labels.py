"""What a pixel of a picture is of: objects, by number."""

from __future__ import annotations

from wsim.scene.world import World


def object_of(prim: str) -> str:
    """/World/tank/floor -> /World/tank: the plan's objects are the children of the root."""
    return "/".join(prim.split("/")[:3])


def labels_of(world: World) -> list[str]:
    """Prims of the objects of a world by the number that a camera's segmentation has for them; 0 is nothing, ""."""
    prims = [each.prim for group in (world.bodies, world.statics, world.cords) for each in group]
    return list(dict.fromkeys(["", *map(object_of, prims)]))
