"""The plan and the program: every object of the one is an object of the other."""

from __future__ import annotations

from difflib import get_close_matches
from typing import TYPE_CHECKING

from wsim.program.validator.reader import Reader
from wsim.program.validator.scratch import JOINTS, OBJECTS

if TYPE_CHECKING:
    from wsim.plan.schema import Plan


def check(reader: Reader, plan: Plan) -> None:
    """Note objects of the plan that the program does not make, and those that it makes and the plan lacks.

    Where the program makes prims whose names cannot be read, what seems to be missing may be one of them.
    """
    world = reader.world
    made = set(world.names) | world.others
    build = reader.module.values.get("build")
    node = getattr(build, "node", reader.tree)
    wanted = {prim: "object" for item in plan.objects for prim in item.prims}
    wanted |= {joint.name: "joint" for joint in plan.joints} | {camera.name: "camera" for camera in plan.cameras}
    wanted |= {cord.name: cord.kind for cord in plan.cords if cord.kind != "cable"}
    if reader.whole and not world.open:
        for name, what in wanted.items():
            if name not in made:
                spare = [each for each in made if each not in wanted]
                close = get_close_matches(name, spare, n=1, cutoff=0.6)
                hint = f'"{close[0]}" is made' if close else ""
                reader.problems.add(
                    node, f"plan {name}", f'the plan has the {what} "{name}", and no prim has that name', hint
                )
    besides = {name: "box" for name in world.raw if name not in world.names}
    for name, method in (world.names | besides).items():
        if any(cord.owns(name) for cord in plan.cords):
            continue
        if method in (*OBJECTS, *JOINTS) and name not in wanted:
            place = (world.raw | world.places).get(name, node)
            what = "joint" if method in JOINTS else "object"
            missing = [each for each in wanted if each not in made]
            close = get_close_matches(name, missing, n=1, cutoff=0.6)
            hint = f'the plan has "{close[0]}"' if close else ""
            reader.problems.add(place, f"plan {name}", f'the plan has no {what} "{name}"', hint)
