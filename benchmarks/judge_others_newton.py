"""Small worlds run by Newton's XPBD and Featherstone solvers, which wsim does not use: part of judge_others.py."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import newton
import numpy as np
import warp as wp

from wsim.geometry.shapes import Solid
from wsim.scene.world import Body, Give, Joint, Shape, Static, World

STEP, SECONDS, RATE = 1.0 / 1200.0, 1.5, 60
SOLVERS = ("SolverXPBD", "SolverFeatherstone")
DENSITY, FRICTION = 500.0, 0.5
BOX, RADIUS, ROD = (0.2, 0.16, 0.12), 0.1, (0.03, 0.4)
UP = (0.0, 0.0, 0.0, 1.0)
# Of each world its bodies: kind, place, spin about Y and speed along X, and whether a hinge holds it to the one before.
WORLDS: dict[str, list[tuple[str, tuple[float, float, float], float, float, bool]]] = {
    "a ball flies": [("sphere", (0.0, 0.0, 9.0), 3.0, 1.0, False)],
    "a box drops": [("box", (0.0, 0.0, 0.3), 0.0, 0.0, False)],
    "a box slides": [("box", (0.0, 0.0, 0.0605), 0.0, 2.0, False)],
    "a ball skids and rolls": [("sphere", (0.0, 0.0, 0.1005), 0.0, 2.0, False)],
    "a box stands on a box": [
        ("box", (0.0, 0.0, 0.0605), 0.0, 0.0, False),
        ("box", (0.0, 0.0, 0.182), 0.0, 0.0, False),
    ],
    "a pendulum": [("capsule", (0.0, 0.0, 2.0), 2.0, 0.0, True)],
    "a double pendulum": [("capsule", (0.0, 0.0, 2.0), 0.0, 0.0, True), ("capsule", (0.0, 0.0, 1.6), 3.0, 0.0, True)],
}


def runs() -> Iterator[tuple[str, World, dict[str, np.ndarray]]]:
    """Name, world and arrays of each."""
    for title, items in WORLDS.items():
        for solver in SOLVERS:
            world = _world(items, solver)
            yield f"newton {solver}: {title}", world, _arrays(items, world, solver)


def _world(items: list[Any], solver: str) -> World:
    bodies, joints = [], []
    for k, (kind, place, _, _, held) in enumerate(items):
        size = {"box": BOX, "sphere": (RADIUS,), "capsule": ROD}[kind]
        shape = Shape(prim=f"/World/b{k}/shape", kind=kind, size=size, friction=FRICTION)
        mass, inertia = _mass(kind)
        bodies.append(
            Body(
                prim=f"/World/b{k}", mass=mass, volume=float(Solid([shape]).volume), position=place, rotation=UP,
                inertia=tuple(inertia.reshape(-1).tolist()), shapes=[shape],
            )
        )  # fmt: skip
        if held:
            above = (place[0], place[1], place[2] + 0.2)
            joints.append(
                Joint(
                    prim=f"/World/b{k}/hinge", kind="revolute", axis="Y", parent=f"/World/b{k - 1}" if k else None,
                    child=f"/World/b{k}", parent_anchor=(0.0, 0.0, -0.2) if k else above, child_anchor=(0.0, 0.0, 0.2),
                )
            )  # fmt: skip
    ground = Shape(prim="/World/ground", kind="plane", size=(), friction=FRICTION)
    statics = [Static(prim="/World/ground", shapes=[ground])]
    give = Give()
    if solver == "SolverFeatherstone":  # its contacts are springs, and its friction a damper up to the cone
        surface, mass = newton.ModelBuilder.ShapeConfig(), max(body.mass for body in bodies)
        springs = 4 if any(kind == "box" for kind, *_ in items) else 1  # a box lands on its corners
        give = Give(time=math.sqrt(mass / (springs * surface.ke)), creep=mass / surface.kf)
    # As of other engines, whose contacts state no restitution.
    return World(bodies=bodies, joints=joints, statics=statics, time_step=STEP, give=give, combine="larger")


def _mass(kind: str) -> tuple[float, np.ndarray]:
    """As Newton weighs it."""
    body = _build([(kind, (0.0, 0.0, 1.0), 0.0, 0.0, False)])
    return float(body.body_mass.numpy()[0]), body.body_inertia.numpy()[0].astype(np.float64)


def _build(items: list[Any]) -> Any:
    builder = newton.ModelBuilder(gravity=(0.0, 0.0, -9.81))
    surface = newton.ModelBuilder.ShapeConfig(density=DENSITY, mu=FRICTION)
    bodies, chain = [], []
    for k, (kind, place, _, _, held) in enumerate(items):
        body = builder.add_link(xform=wp.transform(place, wp.quat_identity()))
        bodies.append(body)
        if kind == "box":
            builder.add_shape_box(body, hx=BOX[0] / 2, hy=BOX[1] / 2, hz=BOX[2] / 2, cfg=surface)
        elif kind == "sphere":
            builder.add_shape_sphere(body, radius=RADIUS, cfg=surface)
        else:
            builder.add_shape_capsule(body, radius=ROD[0], half_height=ROD[1] / 2, cfg=surface)
        if held:
            anchor = wp.transform((0.0, 0.0, -0.2) if k else (place[0], place[1], place[2] + 0.2), wp.quat_identity())
            joint = builder.add_joint_revolute(
                bodies[k - 1] if k else -1, body, parent_xform=anchor, axis=wp.vec3(0.0, 1.0, 0.0),
                child_xform=wp.transform((0.0, 0.0, 0.2), wp.quat_identity()),
            )  # fmt: skip
            chain.append(joint)
        else:
            builder.add_articulation([builder.add_joint_free(body)])
    if chain:
        builder.add_articulation(chain)
    builder.add_ground_plane(cfg=surface)
    return builder.finalize(device="cpu")


def _arrays(items: list[Any], world: World, solver: str) -> dict[str, np.ndarray]:
    model = _build(items)
    stepper = getattr(newton.solvers, solver)(model)
    states, control = [model.state(), model.state()], model.control()
    speeds = model.joint_qd.numpy()
    at = 0
    for _, _, spin, speed, held in items:
        if held:
            speeds[at] = spin
        else:
            speeds[at : at + 6] = [speed, 0.0, 0.0, 0.0, spin, 0.0]
        at += 1 if held else 6
    for state in states:
        state.joint_qd.assign(speeds)
        newton.eval_fk(model, model.joint_q, state.joint_qd, state)
    rows = []
    for step in range(round(SECONDS / STEP) + 1):
        if step % round(1.0 / RATE / STEP) == 0:
            rows.append((step * STEP, states[0].body_q.numpy().copy(), states[0].body_qd.numpy().copy()))
        states[0].clear_forces()
        contacts = model.collide(states[0])
        stepper.step(states[0], states[1], control, contacts, STEP)
        states.reverse()
    time, poses, rates = (np.array(column) for column in zip(*rows, strict=True))
    names = np.array([body.prim for body in world.bodies])
    return {"time": time, "body_names": names, "body_q": poses, "body_qd": rates}
