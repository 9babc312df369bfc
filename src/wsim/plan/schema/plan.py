"""The plan: what must be in the world, where, what must happen, and what was assumed.

A plan that validates is whole: names are unique, every reference exists, sizes fit their primitives. SI units, Z up;
FRONT = +X, BACK = -X, LEFT = +Y, RIGHT = -Y. A pose is the object's centre, except for a tank or an asset, whose pose
is the centre of its bottom face, and a fluid in a container, which has none.
"""

from __future__ import annotations

from pydantic import model_validator

from wsim.plan.schema.draft import Draft
from wsim.plan.schema.problems import problems

PLAN_VERSION = 2
SHOWN = 20  # problems in a message


class Plan(Draft):
    """A draft that holds together."""

    @model_validator(mode="after")
    def _whole(self) -> Plan:
        found = problems(self)
        if found:
            raise ValueError("; ".join(found[:SHOWN]))
        return self
