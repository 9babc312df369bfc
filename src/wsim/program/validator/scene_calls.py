"""What is checked on calls that author the scene."""

from __future__ import annotations

from typing import Any

from wsim.program.api.entry import Entry
from wsim.program.validator.arguments import Arguments
from wsim.program.validator.problem import spelt
from wsim.program.validator.scratch import World
from wsim.program.validator.state import State
from wsim.program.validator.values import UNKNOWN, Const, Instance, Items, NotKnownError, Value, plain
from wsim.scene import Area, Drive, Hill, Image, Kerb, Level, Noise, Part, Ramp, Road, Step, Surface

# What says something to a call and makes no prim itself.
_PLAIN = (Drive, Part, Area, Hill, Image, Kerb, Level, Noise, Ramp, Road, Step, Surface)
PLAIN: dict[str, Any] = {f"wsim.scene.{each.__name__}": each for each in _PLAIN}


def check(
    reader: State, entry: Entry, owner: Value | None, bound: dict[str, Any], arguments: Arguments, *, fitting: bool
) -> Value | None:
    """Make a call that authors the scene on a scene of the validator's own; a problem where that refuses it.

    Returns:
        What the call gives; None where no more is known than its type.
    """
    method = entry.short
    world = owner.world if isinstance(owner, Instance) else None
    values: dict[str, Value] = {name: value for name, (value, _) in bound.items()}
    mine = world if world is not None else reader.aside
    certain = reader.certain and world is not None and not arguments.open
    name = values.get("name", UNKNOWN)
    if not entry.overloads or not fitting or method == "save":
        mine.note(method, getattr(name, "value", None), certain=certain and method != "save")
        mine.touched()
        return None
    if method == "ground" and "name" not in values:
        values["name"] = name = Const("ground")
    text = name.value if isinstance(name, Const) and isinstance(name.value, str) else None
    place = bound["name"][1] if "name" in bound else arguments.call
    if text is not None and certain and mine.taken(method, text):
        reader.problems.add(place, "prim", f'the name "{text}" is already used; give each prim a name of its own')
        mine.touched()
        return None
    if certain and mine.trusted and _refers_wrongly(reader, mine, bound):
        mine.note(method, text, certain=True)
        mine.touched()
        return None
    if text is not None:
        mine.places.setdefault(text, place)
    if world is not None and not world.trusted:
        _lacks_material(reader, world, bound)
    made, refusal, field = mine.call(method, values, certain=certain)
    if refusal:
        node = bound[field][1] if field in bound else arguments.call
        reader.problems.add(node, "value", f"{method}(): {refusal.partition(': ')[2]}", entry.signature)
    if method == "simulation":
        _gravity(reader, bound)
        return Const(None)
    return _default(values) if method == "param" and made is None else made


def _default(values: dict[str, Value]) -> Value:
    """What `scene.param` gives where the call is not known in full."""
    default = values.get("default", UNKNOWN)
    if isinstance(default, Const) and isinstance(default.value, (int, float)):
        return Const(float(default.value))
    return Instance("builtins.float")


def _refers_wrongly(reader: State, world: World, bound: dict[str, Any]) -> bool:
    """Whether an argument names a prim that is not there yet."""
    if world.open or world.others:
        return False
    for field in ("parent", "child", "a", "b", "fills", "container", "body", "follows"):
        value, node = bound.get(field, (UNKNOWN, None))
        text = value.value if isinstance(value, Const) else None
        if not isinstance(text, str):
            continue
        name = text.removeprefix("/World/")
        if "/" in name or name in world.names:
            continue
        later = reader.written.count(name) > 1
        why = "is made only later" if later else "is not in the scene"
        reader.problems.add(
            node, "order" if later else "prim", f'{field} = "{text}" {why}', spelt(name, world.names, 0.5)
        )
        return True
    return False


def _lacks_material(reader: State, world: World, bound: dict[str, Any]) -> None:
    """Whether a material is asked for that nothing makes; each object has one of its own name, too."""
    value, node = bound.get("material", (UNKNOWN, None))
    text = value.value if isinstance(value, Const) else None
    if not isinstance(text, str) or world.looks_open or text in world.names or text in world.others:
        return
    known = [name.partition(" ")[2] for name in world.looks if name.startswith("material ")]
    if text not in known:
        reader.problems.add(node, "prim", f'material = "{text}" is not in the scene', spelt(text, known, 0.5))


def _gravity(reader: State, bound: dict[str, Any]) -> None:
    value, node = bound.get("gravity", (UNKNOWN, None))
    if isinstance(value, Items) and value.exact and len(value.items) == 3:
        up = value.items[2]
        if isinstance(up, Const) and isinstance(up.value, (int, float)) and up.value > 0:
            reader.problems.add(node, "value", f"gravity points up: z = {up.value:g} m/s^2; down is (0.0, 0.0, -9.81)")


def made(name: str, bound: dict[str, Any]) -> Value:
    """A motor or a part of the validator's own, if all is known of it."""
    try:
        return Const(PLAIN[name](**{field: plain(value) for field, (value, _) in bound.items()}))
    except (NotKnownError, TypeError):
        return Instance(name)
