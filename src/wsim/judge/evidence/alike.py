"""Which copies of a world can be worked out at once: by their descriptions, or by their geometry alone."""

from __future__ import annotations

from typing import TYPE_CHECKING

from wsim.scene.world import Body, Shape, Static, World

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from pydantic import BaseModel

    from wsim.judge.evidence.evidence import Evidence

# What a copy may have of its own is its masses, and what its checks read of its own world alone.
OF_WORLD = tuple(set(World.model_fields) - {"bodies", "parameters", "seed", "name"})
OF_BODY = tuple(set(Body.model_fields) - {"mass", "inertia"})
# And where geometry alone is asked for: surfaces, and how bodies start, which recordings show.
OF_ROOM = tuple(set(OF_WORLD) - {"statics", "contacts"})
OF_FORM = tuple(set(OF_BODY) - {"shapes", "position", "rotation", "velocity", "angular_velocity"})
OF_STATIC = tuple(set(Static.model_fields) - {"shapes"})
OF_SHAPE = tuple(set(Shape.model_fields) - {"friction", "restitution", "rolling", "color", "opacity"})


def alike(one: World, other: World) -> bool:
    """Whether two worlds have the same bodies, starts, shapes, surfaces, joints and gravity."""
    if one is other:
        return True
    return _same(one, other, OF_WORLD) and _each(one.bodies, other.bodies, OF_BODY)


def same_geometry(one: World, other: World) -> bool:
    """Whether two worlds have the same bodies, shapes, joints and gravity; surfaces and starts may differ."""
    if one is other:
        return True
    if not (
        _same(one, other, OF_ROOM)
        and _each(one.bodies, other.bodies, OF_FORM)
        and _each(one.statics, other.statics, OF_STATIC)
    ):
        return False
    own, its = (
        [each.shapes for each in world.bodies] + [each.shapes for each in world.statics] for world in (one, other)
    )
    return all(_each(a, b, OF_SHAPE) for a, b in zip(own, its, strict=True))


def groups(copies: Sequence[Evidence], together: Callable[[Evidence, Evidence], bool]) -> list[list[Evidence]]:
    """Those together of which the first says that they belong together."""
    found: list[list[Evidence]] = []
    for copy in copies:
        group = next((group for group in found if together(group[0], copy)), None)
        if group is None:
            found.append([copy])
        else:
            group.append(copy)
    return found


def _each(ones: Sequence[BaseModel], others: Sequence[BaseModel], names: Sequence[str]) -> bool:
    if len(ones) != len(others):
        return False
    return all(_same(a, b, names) for a, b in zip(ones, others, strict=True))


def _same(one: BaseModel, other: BaseModel, names: Sequence[str]) -> bool:
    own, its = one.__dict__, other.__dict__
    return all(own[name] is its[name] or own[name] == its[name] for name in names)
