"""What MuJoCo's elements are called in a world."""

from __future__ import annotations

import re
from typing import Any

import mujoco

OBJECTS = {
    "body": mujoco.mjtObj.mjOBJ_BODY, "joint": mujoco.mjtObj.mjOBJ_JOINT, "geom": mujoco.mjtObj.mjOBJ_GEOM,
    "tendon": mujoco.mjtObj.mjOBJ_TENDON, "actuator": mujoco.mjtObj.mjOBJ_ACTUATOR, "pair": mujoco.mjtObj.mjOBJ_PAIR,
    "equality": mujoco.mjtObj.mjOBJ_EQUALITY, "flex": mujoco.mjtObj.mjOBJ_FLEX,
}  # fmt: skip


def element(model: Any, kind: str, number: int) -> str:
    """An element's name; its kind and number where it has none."""
    return str(mujoco.mj_id2name(model, OBJECTS[kind], int(number)) or f"{kind}_{number}")


def body_name(model: Any, body: int) -> str:
    """A body's name; its number where it has none."""
    return element(model, "body", body)


def prim_of(name: str) -> str:
    """The prim of an object of a name."""
    return f"/World/{clean(name)}"


def clean(name: str) -> str:
    """A name as a prim may have it."""
    word = re.sub(r"\W", "_", name, flags=re.ASCII)
    return f"_{word}" if word[:1].isdigit() else word
