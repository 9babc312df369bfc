"""A world of one ball that is to fly half a metre, in too short a time; edits of its program, good and bad."""

from __future__ import annotations

import json
from typing import Any

from wsim.agents.planner import read_plan
from wsim.plan.schema import Plan

PROMPT = "A thrown ball flies half a metre."
WOOD = {"name": "wood", "density": 600}
GROUND = {"name": "ground", "role": "terrain", "primitive": "ground", "state": "static", "material": WOOD}
BALL = {
    "name": "ball", "role": "rigid_body", "primitive": "sphere", "size": [0.1], "state": "dynamic", "material": WOOD,
    "position": [0, 0, 2], "velocity": [1.5, 0, 0],
}  # fmt: skip
MOVES = {"kind": "moves", "object": "ball", "value": 0.5}
CLAUSES = [{"words": "A thrown ball", "by": ["ball.velocity"]}, {"words": "flies half a metre", "by": [0]}]
CAMERA = {"name": "side", "eye": [0, -4, 1.5], "target": [0, 0, 1.2]}


def answer(**change: Any) -> dict[str, Any]:
    """A planner's plan of it, in shorthand, in which it comes 0.3 m far."""
    data = {
        "title": "A ball flies",
        "objects": [GROUND, BALL],
        "cameras": [CAMERA],
        "objectives": [MOVES],
        "clauses": CLAUSES,
        "simulation": {"duration": 0.2, "frame_rate": 10},
        **change,
    }
    return {key: value for key, value in data.items() if value is not None}


def flies(**change: Any) -> Plan:
    return read_plan(answer(**change), PROMPT)


def edit(search: str, replace: str, why: str = "It is too short.") -> str:
    """A coder's answer."""
    return f"{why}\n\n<<<<<<< SEARCH\n{search}\n=======\n{replace}\n>>>>>>> REPLACE\n"


def lasts(seconds: float, before: float = 0.2) -> str:
    """The edit that lets it run so long [s]: 0.4 is right, 0.3 is nearly, 0.1 is worse."""
    return edit(f"duration={before}", f"duration={seconds}")


def opinion(accept: bool = True, **more: Any) -> str:
    return json.dumps({"accept": accept, "why": "so", **more})


def review(**more: Any) -> str:
    return json.dumps({"summary": "A ball flies.", **more})


REPAIR = {"kind": "program", "object": "ball", "parameter": "duration", "why": "there is no time to fly"}
