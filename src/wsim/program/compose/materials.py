"""Materials: `scene.material`, and `scene.param` for the density of what moves."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from wsim.plan.schema import FromTerrain, Material, PlanObject
from wsim.program.compose.draft import Draft
from wsim.program.source import call, number, tuple_of


def statements(draft: Draft) -> list[str]:
    """Each material of a solid object once, in the order of their first objects."""
    lines: list[str] = []
    objects = draft.plan.objects
    for item, material in _used(objects):
        if material is None or item.primitive == "fluid" or material.model_dump_json() in draft.materials:
            continue
        variable = draft.variable(material.name)
        draft.materials[material.model_dump_json()] = variable
        moving = any(other.material == material and other.state == "dynamic" for other in objects)
        lines += _statement(draft, material, variable, moving=moving)
    return [*lines, ""] if lines else []


def _used(objects: Sequence[PlanObject]) -> Iterator[tuple[PlanObject, Material | None]]:
    """Each object's material, and those of terrain's areas."""
    for item in objects:
        yield item, item.material
        if isinstance(item.built, FromTerrain):
            yield from ((item, area.material) for area in item.built.areas)


def _statement(draft: Draft, material: Material, variable: str, *, moving: bool) -> list[str]:
    density = number(material.density)
    lines = []
    if moving:
        bounds = [f"low={number(0.5 * material.density)}", f"high={number(1.5 * material.density)}"]
        name = draft.variable(f"{variable}_density")
        lines += call(f"{name} = scene.param", [f'"{name}"', density, *bounds, 'unit="kg/m^3"'])
        density = name
    arguments = [f'"{variable}"', *([f"density={density}"] if moving else [])]
    arguments.append(f"friction={number(material.friction)}")
    if material.restitution:
        arguments.append(f"restitution={number(material.restitution)}")
    if material.rolling is not None:
        arguments.append(f"rolling={number(material.rolling)}")
    arguments.append(f"color={tuple_of(material.color)}")
    if material.opacity != 1.0:
        arguments.append(f"opacity={number(material.opacity)}")
    return lines + call(f"{variable} = scene.material", arguments)
