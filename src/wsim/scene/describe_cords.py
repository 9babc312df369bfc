"""Springs and ropes of a stage, read back: where their ends are, and which cylinders a rope runs round."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
from pxr import Gf, Usd, UsdGeom, UsdPhysics

from wsim.geometry.ropes import Stop, common_tangent
from wsim.scene import schema
from wsim.scene.articulation import WORLD_END, body_above, body_frame
from wsim.scene.usd_shapes import read_shape, to_vec3
from wsim.scene.usd_values import line_of, value_of
from wsim.scene.world import Guide, Rope, Spring

_SIDE = Gf.Vec3d(0.0, 0.0, 1.0)


def springs(prims: list[Usd.Prim]) -> list[Spring]:
    """The springs among a stage's prims."""
    return [read_spring(prim) for prim in prims if schema.has(prim, schema.SPRING)]


def ropes(prims: list[Usd.Prim]) -> list[Rope]:
    """The ropes among a stage's prims."""
    return [read_rope(prim) for prim in prims if schema.has(prim, schema.ROPE)]


def read_spring(prim: Usd.Prim) -> Spring:
    """What a prim with the spring schema states."""
    return Spring(
        path=[_end(prim, "a"), _end(prim, "b")],
        stiffness=value_of(prim, "stiffness", 0.0),
        damping=value_of(prim, "damping", 0.0),
        rest_length=value_of(prim, "restLength", 0.0),
        **_common(prim),
    )


def read_rope(prim: Usd.Prim) -> Rope:
    """What a prim with the rope schema states."""
    around = prim.GetRelationship("wsim:around")
    targets = around.GetTargets() if around else []
    sides = list(value_of(prim, "sides", None) or [])
    rounds = []
    for k, path in enumerate(targets):
        side = Gf.Vec3d(sides[k]) if k < len(sides) else _SIDE
        guide = read_pulley(prim.GetStage().GetPrimAtPath(path), side)
        if guide is not None:
            rounds.append(guide)
    path = [_end(prim, "a"), *rounds, _end(prim, "b")]
    return Rope(path=list(_with_eyes(path, prim.GetStage())), length=value_of(prim, "length", 0.0), **_common(prim))


def read_pulley(prim: Usd.Prim, side: Gf.Vec3d = _SIDE) -> Guide | None:
    """The first cylinder that a body or a static object is made of, as a rope runs round it; None without one."""
    body = body_above(prim)
    frame = body_frame(prim)
    for part in Usd.PrimRange(prim):
        if not part.IsA(UsdGeom.Cylinder) or not part.HasAPI(UsdPhysics.CollisionAPI):
            continue
        shape = read_shape(part, frame)
        if shape is None or shape.kind != "cylinder":
            continue
        x, y, z, w = shape.rotation
        return Guide(
            body=None if body == WORLD_END else str(body),
            owner=str(prim.GetPath()),
            position=shape.position,
            radius=shape.size[0],
            axis=to_vec3(Gf.Rotation(Gf.Quatd(w, x, y, z)).TransformDir(Gf.Vec3d(0.0, 0.0, 1.0))),
            side=to_vec3(frame.GetInverse().TransformDir(side).GetNormalized()),
            groove=shape.size[1] <= 2.0 * shape.size[0],
            shape=shape.prim,
        )
    return None


def stops_at_start(path: list[Guide], stage: Usd.Stage) -> list[Stop]:
    """The guides where they are in the world as the stage stands, one moment."""
    return [_stop(guide, stage) for guide in path]


def _stop(guide: Guide, stage: Usd.Stage) -> Stop:
    frame = Gf.Matrix4d(1.0) if guide.body is None else body_frame(stage.GetPrimAtPath(guide.body))
    position = np.array([frame.Transform(Gf.Vec3d(*guide.position))])
    if guide.radius == 0.0:
        return Stop(position)
    axis, side = (np.array([frame.TransformDir(Gf.Vec3d(*way))]) for way in (guide.axis, guide.side))
    return Stop(position, guide.radius, axis, side, guide.groove)


def _with_eyes(path: list[Guide], stage: Usd.Stage) -> Iterator[Guide]:
    """The path with a point between any two cylinders in a row: there the rope runs through an eye, as solvers ask."""
    stops = stops_at_start(path, stage)
    for k, guide in enumerate(path):
        yield guide
        if guide.radius > 0.0 and path[k + 1].radius > 0.0:
            before, after = stops[k - 1].position[0], stops[k + 2].position[0]
            point = Gf.Vec3d(*common_tangent(before, stops[k], stops[k + 1], after).tolist())
            # On the one that stays where it is, if one does.
            holder = guide if guide.body is None or path[k + 1].body is not None else path[k + 1]
            frame = Gf.Matrix4d(1.0) if holder.body is None else body_frame(stage.GetPrimAtPath(holder.body))
            place = to_vec3(frame.GetInverse().Transform(point))
            yield Guide(body=holder.body, owner=holder.owner, position=place)


def _end(prim: Usd.Prim, end: str) -> Guide:
    relation = prim.GetRelationship(f"wsim:{end}")
    targets = relation.GetTargets() if relation else []
    body = body_above(prim.GetStage().GetPrimAtPath(targets[0])) if targets else WORLD_END
    return Guide(
        body=None if body == WORLD_END else str(body),
        owner=str(targets[0]) if targets else None,
        position=to_vec3(Gf.Vec3d(value_of(prim, f"anchor{end.upper()}", Gf.Vec3d(0.0)))),
    )


def _common(prim: Usd.Prim) -> dict[str, Any]:
    return {
        "prim": str(prim.GetPath()),
        "radius": value_of(prim, "radius", 0.01),
        "color": to_vec3(value_of(prim, "color", Gf.Vec3f(0.7))),
        "line": line_of(prim),
    }
