"""Springs and ropes as MuJoCo's spatial tendons: a force along a line, a length that is not exceeded."""

from __future__ import annotations

from typing import Any

import newton
import numpy as np
import warp as wp

from wsim.geometry.ropes import path_length
from wsim.scene.cord_paths import moving_stops
from wsim.scene.world import Guide, Rope, Spring, World
from wsim.solvers.contact_config import ContactConfig

SITE, GEOM, SPATIAL = 0, 1, 1  # of the mujoco:tendon_wrap_type and mujoco:tendon_type attributes
SHORTEST = -1e4  # [m]: the limit below, which none reaches
# Of a wheel's radius, as MuJoCo has it. A rope that just touches it, or ends on its rim, is then beside it: by rounding
# MuJoCo would take its arc of none for a whole turn, or its end to be inside.
THIN = 1.0 - 1e-5


def add_cords(builder: Any, world: World, config: ContactConfig) -> None:
    """Give a builder the tendons of a world's springs and ropes.

    Args:
        builder: The `newton.ModelBuilder` of one world, with MuJoCo's custom attributes registered.
        world: What the stage states.
        config: The law that a taut rope follows, as stops do.
    """
    bodies = {str(label): k for k, label in enumerate(builder.body_label)}
    for cord in world.cords:
        wraps = []
        for k, guide in enumerate(cord.path):
            body = -1 if guide.body is None else bodies[guide.body]
            if guide.radius > 0.0:
                side = np.array(guide.position) + 2.0 * guide.radius * _across(guide)
                beside = _site(builder, body, side, f"{cord.prim}/side_{k}")
                wraps.append((GEOM, _round(builder, body, guide, f"{cord.prim}/pulley_{k}"), beside))
            else:
                wraps.append((SITE, _site(builder, body, np.array(guide.position), f"{cord.prim}/point_{k}"), -1))
        _add_tendon(builder, cord, wraps, _longest(cord, world), config)


def _round(builder: Any, body: int, guide: Guide, label: str) -> int:
    """The shape that a rope runs round, beside the stage's own: a cylinder, or, for one with a groove, a ball.

    Round a ball the rope stays in the plane of its ends and the centre, as a pulley that swivels keeps it; along a bare
    cylinder it would slip to the end of a block that hangs in it.
    """
    config = newton.ModelBuilder.ShapeConfig(
        density=0.0, has_shape_collision=False, has_particle_collision=False, is_visible=False
    )
    place, radius = wp.vec3(*guide.position), _thin(guide).radius
    if guide.groove:
        ball = wp.transform(place, wp.quat_identity())
        return int(builder.add_shape_sphere(body, xform=ball, radius=radius, cfg=config, label=label))
    turn = wp.quat_between_vectors(wp.vec3(0.0, 0.0, 1.0), wp.vec3(*guide.axis))
    post = wp.transform(place, turn)
    return int(builder.add_shape_cylinder(body, xform=post, radius=radius, half_height=radius, cfg=config, label=label))


def _thin(guide: Guide) -> Guide:
    return guide.model_copy(update={"radius": THIN * guide.radius})


def _longest(cord: Spring | Rope, world: World) -> float:
    """How long a rope's way may be [m], as its wheels are THIN, so that it is taut at the start where it should be."""
    if not isinstance(cord, Rope):
        return 0.0
    poses = {body.prim: np.array([[*body.position, *body.rotation]]) for body in world.bodies}
    held = {guide.body: poses[guide.body] for guide in cord.path if guide.body is not None}
    way, thin = (path_length(moving_stops(path, held))[0] for path in (cord.path, [_thin(g) for g in cord.path]))
    return float(cord.length - (way - thin))


def _across(guide: Guide) -> np.ndarray:
    """The direction of a pulley's side, across its axis."""
    side, axis = np.array(guide.side), np.array(guide.axis)
    flat = side - (side @ axis) * axis
    return np.asarray(flat / np.linalg.norm(flat))


def _site(builder: Any, body: int, position: np.ndarray, label: str) -> int:
    return int(builder.add_site(body, xform=wp.transform(wp.vec3(*position), wp.quat_identity()), label=label))


def _add_tendon(
    builder: Any, cord: Spring | Rope, wraps: list[tuple[int, int, int]], longest: float, config: ContactConfig
) -> None:
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
    rest = cord.rest_length if isinstance(cord, Spring) else -1.0
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
