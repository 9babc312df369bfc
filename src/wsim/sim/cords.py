"""Springs and ropes as MuJoCo's spatial tendons: a force along a line, a length that is not exceeded."""

from __future__ import annotations

from typing import Any

import newton
import numpy as np
import warp as wp

from wsim.scene.world import Guide, Rope, Spring, World
from wsim.solvers.contact_config import ContactConfig

SITE, GEOM, SPATIAL = 0, 1, 1  # of the mujoco:tendon_wrap_type and mujoco:tendon_type attributes
SHORTEST = -1e4  # [m]: the limit below, which none reaches


def add_cords(builder: Any, world: World, config: ContactConfig) -> None:
    """Give a builder the tendons of a world's springs and ropes.

    Args:
        builder: The `newton.ModelBuilder` of one world, with MuJoCo's custom attributes registered.
        world: What the stage states.
        config: The law that a taut rope follows, as stops do.
    """
    bodies = {str(label): k for k, label in enumerate(builder.body_label)}
    shapes = {str(label): k for k, label in enumerate(builder.shape_label)}
    for cord in world.cords:
        wraps = []
        for k, guide in enumerate(cord.path):
            body = -1 if guide.body is None else bodies[guide.body]
            if guide.radius > 0.0:
                side = np.array(guide.position) + 2.0 * guide.radius * _across(guide)
                beside = _site(builder, body, side, f"{cord.prim}/side_{k}")
                wraps.append((GEOM, _round(builder, body, guide, f"{cord.prim}/pulley_{k}", shapes), beside))
            else:
                wraps.append((SITE, _site(builder, body, np.array(guide.position), f"{cord.prim}/point_{k}"), -1))
        _add_tendon(builder, cord, wraps, config)


def _round(builder: Any, body: int, guide: Guide, label: str, shapes: dict[str, int]) -> int:
    """The shape that a rope runs round: the stage's cylinder, or, for one with a groove, a ball in its middle.

    Round a ball the rope stays in the plane of its ends and the centre, as a pulley that swivels keeps it; along a bare
    cylinder it would slip to the end of a block that hangs in it.
    """
    if not guide.groove:
        return shapes[guide.shape or ""]
    config = newton.ModelBuilder.ShapeConfig(
        density=0.0, has_shape_collision=False, has_particle_collision=False, is_visible=False
    )
    place = wp.transform(wp.vec3(*guide.position), wp.quat_identity())
    return int(builder.add_shape_sphere(body, xform=place, radius=guide.radius, cfg=config, label=label))


def _across(guide: Guide) -> np.ndarray:
    """The direction of a pulley's side, across its axis."""
    side, axis = np.array(guide.side), np.array(guide.axis)
    flat = side - (side @ axis) * axis
    return np.asarray(flat / np.linalg.norm(flat))


def _site(builder: Any, body: int, position: np.ndarray, label: str) -> int:
    return int(builder.add_site(body, xform=wp.transform(wp.vec3(*position), wp.quat_identity()), label=label))


def _add_tendon(builder: Any, cord: Spring | Rope, wraps: list[tuple[int, int, int]], config: ContactConfig) -> None:
    first = len(builder.custom_attributes["mujoco:tendon_wrap_type"].values or ())
    for kind, shape, side in wraps:
        builder.add_custom_values(
            **{
                "mujoco:tendon_wrap_type": kind,
                "mujoco:tendon_wrap_shape": shape,
                "mujoco:tendon_wrap_sidesite": side,
            }
        )
    is_spring = isinstance(cord, Spring)
    rest, longest = (cord.rest_length, 0.0) if isinstance(cord, Spring) else (-1.0, cord.length)
    values: dict[str, Any] = {
        "world": builder.current_world,
        "label": cord.prim,
        "type": SPATIAL,
        "wrap_adr": first,
        "wrap_num": len(wraps),
        "joint_adr": 0,
        "joint_num": 0,
        "stiffness": cord.stiffness if isinstance(cord, Spring) else 0.0,
        "damping": cord.damping if isinstance(cord, Spring) else 0.0,
        "springlength": wp.vec2(rest, rest),
        "limited": int(not is_spring),
        "range": wp.vec2(SHORTEST, longest),
        "margin": 0.0 if is_spring else config.limit_reach,
        "solimp_limit": (config.impedance, config.impedance, 0.001, 0.5, 2.0),
    }
    builder.add_custom_values(**{f"mujoco:tendon_{name}": value for name, value in values.items()})
