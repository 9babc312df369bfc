"""Arguments of `scene.asset`."""

from __future__ import annotations

import json

from wsim.errors import UserError
from wsim.plan.schema import FromAsset, PlanObject
from wsim.program.compose.poses import position, rotation
from wsim.program.source import tuple_of


def arguments(item: PlanObject) -> list[str]:
    """All arguments but the name; what the asset has of its own cannot be given.

    Raises:
        UserError: If the plan gives it.
    """
    weighed = item.registration.mass is not None or item.registration.density is not None
    for what, given in (
        ("velocity", any(item.velocity)),
        ("material", item.material is not None),
        ("registration.mass or .density", weighed),
        ('state "kinematic"', item.state == "kinematic"),
    ):
        if given:
            raise UserError(
                f"{item.name}: an asset of the catalogue keeps its own {what}; remove it, or give the object a "
                'construction of kind "proxy"'
            )
    found = [json.dumps(item.built.asset) if isinstance(item.built, FromAsset) else ""]
    found += [f"position={tuple_of(position(item))}", *rotation(item)]
    return [*found, *(["static=True"] if item.state == "static" else [])]
