"""The constructions of a plan as a model is told of them: what each takes, from the schema, and one example of each."""

from __future__ import annotations

import json
import re
from collections.abc import Collection
from typing import Any, get_args

from pydantic import BaseModel

from wsim.plan.schema.constructions import Built, External, Material
from wsim.plan.schema.objects import Role

_TOLD = (Material,)  # elsewhere in the prompt
_TRACK = [[-20, 0], [0, 3], [20, 0]]
_MUD = {"name": "mud", "density": 1600, "friction": 0.7}

# Each a whole object; together they are the objects of one plan. The first two have a shorthand besides.
EXAMPLES: dict[str, dict[str, Any]] = {
    "proxy": {
        "name": "cone", "role": "rigid_body", "position": [6, -6, 1], "material": {"name": "wood", "density": 600},
        "construction": {"kind": "proxy", "primitive": "cylinder", "size": [0.2, 0.6]},
    },
    "asset": {
        "name": "crate", "role": "rigid_body", "position": [4, -6, 1],
        "construction": {"kind": "asset", "asset": "crate"},
    },
    "robot": {
        "name": "arm", "role": "robot", "position": [0, -6, 0.5],
        "construction": {"kind": "robot", "robot": "desk_arm", "size": [0.2, 0.2, 0.6]},
    },
    "terrain": {
        "name": "land", "role": "terrain", "state": "static",
        "material": {"name": "soil", "density": 1600, "friction": 0.85},
        "construction": {
            "kind": "terrain", "extent": [60, 30],
            "layers": [
                {"kind": "noise", "amplitude": 0.3, "wavelength": 12, "seed": 4},
                {"kind": "hill", "position": [8, 0], "radius": 9, "height": 1.2},
                {"kind": "level", "position": [-20, 0], "radius": 4},
            ],
            "areas": [{"name": "track", "points": _TRACK, "width": 4, "material": _MUD}],
        },
    },
    "scatter": {
        "name": "rock", "role": "background", "state": "static",
        "construction": {
            "kind": "scatter", "on": "land", "count": 8, "size": [0.3, 1], "clear": [{"points": _TRACK, "by": 3}],
        },
    },
    "vehicle": {
        "name": "truck", "role": "vehicle", "position": [-20, 0, 0], "rotation_deg": [0, 0, 9],
        "construction": {"kind": "vehicle", "vehicle": "hmmwv"},
        "registration": {"actuation": [{"kind": "driver", "route": _TRACK[1:], "speed": 5}]},
    },
    "external": {
        "name": "statue", "role": "background", "state": "static", "position": [-4, -8, 1],
        "construction": {
            "kind": "external", "candidate": "a marble statue",
            "stand_in": {"primitive": "box", "size": [0.5, 0.5, 1.8]},
        },
    },
}  # fmt: skip


def roles() -> str:
    """The roles that objects may have."""
    return "|".join(f'"{role}"' for role in get_args(Role))


def constructions(kinds: Collection[str], without: bool = False) -> str:
    """Constructions of some kinds: what each is, its fields, those of its parts, an example; a line each.

    Args:
        kinds: Their names.
        without: All kinds but these.
    """
    lines = []
    for model in (*get_args(Built), External):
        kind = str(model.model_fields["kind"].default)
        if (kind in kinds) == without:
            continue
        parts = "".join(f"; {_named(part)}: {_fields(part)}" for part in _parts(model))
        example = json.dumps(EXAMPLES[kind], separators=(",", ":"))
        says = re.sub(r" \(docs/\S+\)", "", str(model.__doc__).splitlines()[0])
        lines.append(f"- {kind}: {says} {_fields(model)}{parts}\n  {example}")
    return "\n".join(lines)


def _fields(model: type[BaseModel]) -> str:
    """Its fields; with their values where they may be left out, or those that they may have."""
    told = []
    for name, field in model.model_fields.items():
        choices = get_args(field.annotation)
        if name == "kind":
            continue
        if choices and all(isinstance(choice, str) for choice in choices):
            told.append(f"{name} {'|'.join(choices)}")
        elif field.is_required():
            told.append(name)
        else:
            told.append(f"{name}={json.dumps(field.get_default(call_default_factory=True))}")
    return ", ".join(told)


def _named(part: type[BaseModel]) -> str:
    """What a part is called: its kind, or its class."""
    kind = part.model_fields.get("kind")
    return str(kind.default) if kind is not None else part.__name__.removesuffix("Plan").lower()


def _parts(model: type[BaseModel]) -> list[type[BaseModel]]:
    """The models that its fields hold, but for those that the prompt has told of."""
    held: list[type[BaseModel]] = []

    def look(annotation: Any) -> None:
        if isinstance(annotation, type) and issubclass(annotation, BaseModel):
            held.extend([annotation] if annotation not in (*_TOLD, *held) else [])
        for each in get_args(annotation):
            look(each)

    for field in model.model_fields.values():
        look(field.annotation)
    return held
