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
# And where their geometry is taken at once, each of its own sizes (`wsim.judge.evidence.stacked`).
OF_SCENE = tuple(set(OF_ROOM) - {"cameras"})
OF_KIND = tuple(set(OF_FORM) - {"com", "volume"})
OF_PRIMITIVE = tuple(set(OF_SHAPE) - {"size", "position", "rotation"})


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
    return all(_each(*pair, OF_SHAPE) for pair in zip(_shapes(one), _shapes(other), strict=True))


def same_form(one: World, other: World) -> bool:
    """Whether two worlds have the same bodies, joints and gravity, of shapes that differ in size and place alone."""
    if one is other:
        return True
    if not (
        _same(one, other, OF_SCENE)
        and _each(one.bodies, other.bodies, OF_KIND)
        and _each(one.statics, other.statics, OF_STATIC)
    ):
        return False
    pairs = list(zip(_shapes(one), _shapes(other), strict=True))
    return all(len(own) == len(its) for own, its in pairs) and all(
        _same(a, b, OF_SHAPE if a.kind == "mesh" else OF_PRIMITIVE)
        for own, its in pairs
        for a, b in zip(own, its, strict=True)
    )


def _shapes(world: World) -> list[list[Shape]]:
    """Of each body and of all that stands still."""
    return [body.shapes for body in world.bodies] + [static.shapes for static in world.statics]


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
