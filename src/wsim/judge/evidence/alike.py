"""Which copies of a world can be worked out at once: those whose descriptions differ in masses alone."""

from __future__ import annotations

from typing import TYPE_CHECKING

from wsim.scene.world import Body, World

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from wsim.judge.evidence.evidence import Evidence

# What a copy may have of its own is its masses, and what its checks read of its own world alone.
OF_WORLD = tuple(set(World.model_fields) - {"bodies", "parameters", "seed", "name"})
OF_BODY = tuple(set(Body.model_fields) - {"mass", "inertia"})


def alike(one: World, other: World) -> bool:
    """Whether two worlds have the same bodies, starts, shapes, surfaces, joints and gravity."""
    if one is other:
        return True
    if len(one.bodies) != len(other.bodies) or not _same(one, other, OF_WORLD):
        return False
    return all(_same(a, b, OF_BODY) for a, b in zip(one.bodies, other.bodies, strict=True))


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


def _same(one: World | Body, other: World | Body, names: Sequence[str]) -> bool:
    pairs = ((getattr(one, name), getattr(other, name)) for name in names)
    return all(a is b or a == b for a, b in pairs)
