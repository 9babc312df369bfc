"""Arguments of `scene.terrain` and `scene.scatter`, and the names that they take from `wsim.scene`."""

from __future__ import annotations

import json

from wsim.plan.schema import (
    AreaPlan,
    FromScatter,
    FromTerrain,
    HillLayer,
    LevelLayer,
    NoiseLayer,
    PlanObject,
    RoadLayer,
)
from wsim.program.compose.draft import Draft
from wsim.program.source import call, number, tuple_of

CELL = 0.5  # [m] of `scene.terrain` where nothing else is said


def terrain(draft: Draft, item: PlanObject, made: FromTerrain) -> list[str]:
    """The statements that make terrain: its layers, its areas, itself."""
    layers, handle = draft.variable(f"{item.name}_layers"), draft.variable(item.name)
    draft.handles[item.name] = handle
    lines = [f"    {layers} = [", *(f"        {_layer(draft, each)}," for each in made.layers), "    ]"]
    given = [f'"{item.name}"', f"size={tuple_of(made.extent)}", f"layers={layers}"]
    given += [f"cell={number(made.cell)}"] if made.cell != CELL else []
    if made.areas:
        areas = draft.variable(f"{item.name}_areas")
        lines += [f"    {areas} = ["]
        for area in made.areas:
            *first, last = call("Area", _area(draft, area), depth=2)
            lines += [*first, f"{last},"]
        lines += ["    ]"]
        given.append(f"areas={areas}")
    given.append(f"material={draft.material(item.material)}")
    return [*lines, *call(f"{handle} = scene.terrain", given)]


def _layer(draft: Draft, layer: NoiseLayer | HillLayer | LevelLayer | RoadLayer) -> str:
    if isinstance(layer, NoiseLayer):
        name = "Noise"
        given = [number(layer.amplitude), number(layer.wavelength), f"octaves={layer.octaves}", f"seed={layer.seed}"]
    elif isinstance(layer, HillLayer):
        name, given = "Hill", [tuple_of(layer.position), number(layer.radius), number(layer.height)]
    elif isinstance(layer, LevelLayer):
        name = "Level"
        given = [tuple_of(layer.position), number(layer.radius), f"blend={number(layer.blend)}"]
    else:
        name = "Road"
        given = [draft.way(layer.points), f"width={number(layer.width)}", f"shoulder={number(layer.shoulder)}"]
        given.append(f"smooth={number(layer.smooth)}")
    draft.imports.add(name)
    return f"{name}({', '.join(given)})"


def _area(draft: Draft, area: AreaPlan) -> list[str]:
    draft.imports |= {"Area", "Road"}
    road = f"road=Road({draft.way(area.points)}, width={number(area.width)})"
    return [json.dumps(area.name), road, f"material={draft.material(area.material)}"]


def scatter(draft: Draft, item: PlanObject, made: FromScatter) -> list[str]:
    """The statement that scatters."""
    given = [f'"{item.name}"']
    if item.rocks:
        given.append(f"size={tuple_of(made.size)}")
    else:
        given.append(json.dumps(made.what[0] if len(made.what) == 1 else list(made.what)))
    given += [f"on={draft.handles[made.on]}", f"count={made.count}"]
    if made.clear:
        kept = [
            f"({tuple_of(each.points[0]) if len(each.points) == 1 else draft.way(each.points)}, {number(each.by)})"
            for each in made.clear
        ]
        given.append(f"clear=[{', '.join(kept)}]")
    given += [f"seed={made.seed}"] if made.seed else []
    given += [f"material={draft.material(item.material)}"] if item.material is not None else []
    return call("scene.scatter", given)
