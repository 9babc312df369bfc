"""What is checked on calls of the world that `control` is given."""

from __future__ import annotations

from typing import Any

from wsim.program.api.entry import Entry
from wsim.program.validator.problem import spelt
from wsim.program.validator.scratch import BODIES, JOINTS, SENSORS
from wsim.program.validator.state import State
from wsim.program.validator.values import UNKNOWN, Const, Instance, Items, Value

_NAMED = {"joint": ("joint", JOINTS), "sensor": ("sensor", SENSORS)}  # by the call: what it names; else a body


def check(reader: State, entry: Entry, owner: Value | None, bound: dict[str, Any]) -> None:
    """A name that `control` asks for, and the vectors that it gives."""
    for field in ("force", "torque"):
        vector, place = bound.get(field, (UNKNOWN, None))
        if isinstance(vector, Items) and vector.exact and len(vector.items) != 3 and _are_numbers(vector):
            text = f'"{field}" has {len(vector.items)} numbers; it must be 3: (x, y, z)'
            reader.problems.add(place, "value", text, entry.signature)
    world = owner.world if isinstance(owner, Instance) else None
    value, node = bound.get("name", (UNKNOWN, None))
    if world is None or world.open or world.others or not isinstance(value, Const):
        return
    if not isinstance(value.value, str) or "asset" in world.names.values():
        return
    what, wanted = _NAMED.get(entry.short, ("body", BODIES))
    known = {name for name, method in world.names.items() if method in wanted}
    name = value.value.removeprefix("/World/")
    if name not in known:
        reader.problems.add(node, "prim", f'no {what} "{value.value}" is built', spelt(name, known, 0.5))


def _are_numbers(items: Items) -> bool:
    return all(isinstance(each, Const) and isinstance(each.value, (int, float)) for each in items.items)
