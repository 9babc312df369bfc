"""Check springs and ropes of a stage before they are simulated: their ends, their numbers and their way."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from pxr import Usd

from wsim.geometry.ropes import ON_RIM, path_length, strayed
from wsim.limits import FARTHEST, MAX_DAMPING, MAX_SIZE, MAX_STIFFNESS, MOST_STRETCH, TAUT
from wsim.scene import schema
from wsim.scene.check_leads import led
from wsim.scene.describe_cords import read_pulley, read_rope, read_spring, stops_at_start
from wsim.scene.usd_contacts import yields
from wsim.scene.world import Guide, Rope, Spring


def cord_problems(prim: Usd.Prim) -> Iterator[str]:
    """Problems of a prim that is a spring or a rope; none of any other."""
    if not {schema.SPRING, schema.ROPE}.intersection(schema.applied(prim)):
        return
    path = prim.GetPath()
    problems = list(_ends(prim))
    yield from problems
    if problems:
        return
    rope = schema.has(prim, schema.ROPE)
    cord = read_rope(prim) if rope else read_spring(prim)
    bodies = [prim.GetStage().GetPrimAtPath(end.body) for end in (cord.path[0], cord.path[-1]) if end.body]
    loose = [body for body in bodies if yields(body)]
    firm = led(prim.GetStage()) if loose else {}
    if not loose:
        yield f"{path}: neither wsim:a nor wsim:b is a body that it could move: each is static or kinematic"
    elif all(body.GetPath() in firm for body in loose):
        named = " and ".join(f"<{body.GetPath()}>" for body in loose)
        yield (
            f"{path}: neither wsim:a nor wsim:b is a body that it could move: fixed joints hold {named} to what is "
            "static or kinematic; leave out a joint, or give it a break_force (physics:breakForce)"
        )
    elif cord.path[0].body == cord.path[-1].body:
        yield f"{path}.wsim:b: <{cord.path[0].body}> is at its other end, too"
    elif not 0.0 < cord.radius <= MAX_SIZE:
        yield f"{path}.wsim:radius: {cord.radius:g} m must be > 0 and <= {MAX_SIZE:g} m"
    elif isinstance(cord, Rope):
        yield from _rope(cord, prim)
    else:
        yield from _spring(cord, prim)


def _ends(prim: Usd.Prim) -> Iterator[str]:
    for end in "ab":
        relation = prim.GetRelationship(f"wsim:{end}")
        if relation and len(relation.GetTargets()) > 1:
            yield f"{relation.GetPath()}: names {len(relation.GetTargets())} prims; one end is fixed to one"
    around = prim.GetRelationship("wsim:around")
    for target in around.GetTargets() if around else []:
        if read_pulley(prim.GetStage().GetPrimAtPath(target)) is None:
            yield f"{around.GetPath()}: <{target}> has no cylinder that collides; a rope runs round cylinders"


def _spring(spring: Spring, prim: Usd.Prim) -> Iterator[str]:
    for name, value, high, unit in (
        ("stiffness", spring.stiffness, MAX_STIFFNESS, "N/m"),
        ("damping", spring.damping, MAX_DAMPING, "N s/m"),
        ("restLength", spring.rest_length, MAX_SIZE, "m"),
    ):
        if not 0.0 <= value <= high:
            yield f"{spring.prim}.wsim:{name}: {value:g} must be >= 0 and <= {high:g} {unit}"
    stops = stops_at_start(spring.path, prim.GetStage())
    apart = float(path_length(stops)[0])
    if not TAUT <= apart <= FARTHEST:
        yield f"{spring.prim}: its ends are {apart:.4g} m apart; it must be {TAUT:g} to {FARTHEST:g} m"
    elif spring.stiffness > 0.0 and 0.0 < spring.rest_length * MOST_STRETCH < apart:
        yield (
            f"{spring.prim}.wsim:restLength: {spring.rest_length:g} m, and its ends are {apart:.4g} m apart; a spring "
            f"is stretched to {MOST_STRETCH:g} times its length at most"
        )


def _rope(rope: Rope, prim: Usd.Prim) -> Iterator[str]:
    stops = stops_at_start(rope.path, prim.GetStage())
    for k, (guide, stop) in enumerate(zip(rope.path, stops, strict=True)):
        if stop.radius == 0.0:
            continue
        assert stop.axis is not None
        assert stop.side is not None
        if np.linalg.norm(np.cross(stop.axis[0], stop.side[0])) < 1e-3:
            yield f"{rope.prim}.wsim:sides: the one of <{guide.owner}> must not be along its axis"
            return
        for near in (k - 1, k + 1):
            apart = stops[near].position[0] - stop.position[0]
            if np.linalg.norm(np.cross(apart, stop.axis[0])) < ON_RIM * stop.radius:
                where, out = _name(rope.path[near]), np.linalg.norm(np.cross(apart, stop.axis[0]))
                yield (
                    f"{rope.prim}: {where} lies inside the cylinder of <{guide.owner}> that it runs round, {out:.4g} m "
                    f"from its axis and not more than its radius, {stop.radius:.4g} m; anchor it outside"
                )
                return
    for k, angle in strayed(stops):
        if angle[0]:
            yield (
                f"{rope.prim}: it runs round <{rope.path[k].owner}> by {np.degrees(angle[0]):.0f} degrees, where its "
                "strands come together; half a turn can be simulated: move an end, or give another side"
            )
            return
    way = float(path_length(stops)[0])
    if not 0.0 < rope.length <= MAX_SIZE:
        yield f"{rope.prim}.wsim:length: {rope.length:g} m must be > 0 and <= {MAX_SIZE:g} m"
    elif rope.length < way - TAUT:
        yield f"{rope.prim}.wsim:length: {rope.length:g} m is shorter than its way at the start, {way:.4g} m"


def _name(guide: Guide) -> str:
    point = ", ".join(f"{x:.4g}" for x in guide.position)
    return f"the point ({point}) m" if guide.owner is None else f"its point on <{guide.owner}>"
