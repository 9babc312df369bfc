"""Cameras."""

from __future__ import annotations

from wsim.errors import UserError
from wsim.plan.schema import CameraPlan, Plan
from wsim.program.source import call, tuple_of


def statements(plan: Plan) -> list[str]:
    """A call for each camera.

    Raises:
        UserError: If one has no eye or no target.
    """
    return [line for camera in plan.cameras for line in call("scene.camera", _arguments(camera))]


def _arguments(camera: CameraPlan) -> list[str]:
    if camera.eye is None or camera.target is None:
        raise UserError(f"camera {camera.name} has no eye or no target; lay the plan out before composing it")
    follows = [f'follows="{camera.follows}"'] if camera.follows is not None else []
    fixed = ["fixed=True"] if camera.words else []
    return [f'"{camera.name}"', f"eye={tuple_of(camera.eye)}", f"target={tuple_of(camera.target)}", *follows, *fixed]
