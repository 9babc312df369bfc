"""Policies: networks that walk a robot, as commanded."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING

from pxr import Gf, Sdf, Usd, UsdGeom, UsdPhysics, Vt

from wsim.errors import UserError
from wsim.limits import MAX_KEYS
from wsim.scene import schema
from wsim.scene.authoring import Author, Handle, note_line, world_pose
from wsim.scene.robots import Robot
from wsim.scene.validate import Call, Vec3, shown

if TYPE_CHECKING:
    from wsim.assets.policies import Numbers, PolicySpec

_LARGEST, _UNITS = 100.0, "m/s and rad/s"  # of a command
_SAME = 1e-6  # [m]: a way as short as this has no heading


class Policies(Author):
    """The call that lets a policy drive a robot."""

    def policy(
        self,
        name: str,
        robot: Robot | str,
        policy: str | None = None,
        *,
        command: Sequence[float] = (0.0, 0.0, 0.0),
        times: Sequence[float] | None = None,
        commands: Sequence[Sequence[float]] | None = None,
        route: Sequence[Sequence[float]] | None = None,
        speed: float = 0.5,
    ) -> Handle:
        """Let a policy set where a robot's servos go, by what it sees of the robot, to go as it is commanded.

        It runs in the simulator, in every world, at its own rate; its gains become those of the servos. A command is
        (forward [m/s], to the left [m/s], turning to the left [rad/s]) in the robot's own frame; it comes on as quickly
        as the policy's description lets it, and is cut off at its limits.

        Args:
            name: Of its prim.
            robot: A robot that was placed before, or its name.
            policy: The id of one that `wsim assets pull` got or `wsim assets policy` took in; by default `name`.
            command: From the start to the end.
            times: When commands change [s], rising, the first one 0; in place of `command`, with `commands`.
            commands: From each of those times on.
            route: Way-points in the world, each (x, y) [m] or (x, y, heading_deg), gone to one after the other, in
                place of commands. It turns to a point's heading on the way there, by default that of the way, or the
                last one where there is none to go, and stays at the last.
            speed: Along the route [m/s].

        Raises:
            SceneError: If there is no such robot or policy, the robot lacks a joint of it or has a policy already, or
                a command is out of range.
        """
        call = Call("policy", name)
        path = self._path(call)
        prim = self._robot(call, robot)
        base = _base(call, prim)
        spec, network, digest = _policy(call, name if policy is None else policy)
        when, what = _commands(call, command, times, commands)
        way, fast = _route(call, base, route), call.positive("speed", speed, _LARGEST, "m/s")
        if way and (times is not None or any(what[0])):
            call.fail("route and a command are both given; give one")
        joints = [prim.GetPrimAtPath(f"joints/{joint}") for joint in spec.joints]
        for joint, each in zip(spec.joints, joints, strict=True):
            if not each:
                call.fail(f"robot = {shown(prim.GetName())} has no joint {joint}, which the policy sets")
        _servos(Robot(prim.GetName(), str(prim.GetPath()), "robot", self._stage), spec)
        made = self._stage.DefinePrim(path, "Scope")
        names = Sdf.ValueTypeNames
        schema.apply(made, schema.POLICY, {
            "network": (names.Asset, Sdf.AssetPath(str(network))), "sha256": (names.String, digest),
            "description": (names.String, spec.model_dump_json(exclude_defaults=True)),
            "times": (names.DoubleArray, Vt.DoubleArray(when)),
            "commands": (names.Vector3dArray, Vt.Vec3dArray([Gf.Vec3d(*each) for each in what])),
            **({"route": (names.Vector3dArray, Vt.Vec3dArray(way)), "speed": (names.Double, fast)} if way else {}),
        })  # fmt: skip
        made.CreateRelationship("wsim:base", custom=False).SetTargets([base.GetPath()])
        made.CreateRelationship("wsim:joints", custom=False).SetTargets([each.GetPath() for each in joints])
        note_line(made)
        return Handle(made.GetName(), path, "policy")

    def _robot(self, call: Call, robot: Robot | str) -> Usd.Prim:
        prim = self._find(call, "robot", robot)
        if not prim.GetChild("joints"):
            call.fail(f"robot = {shown(prim.GetName())} is no robot; place one by scene.robot")
        for other in self._stage.Traverse():
            if schema.has(other, schema.POLICY):
                (base,) = other.GetRelationship("wsim:base").GetTargets()
                if base.HasPrefix(prim.GetPath()):
                    call.fail(
                        f'robot = {shown(prim.GetName())} has the policy "{other.GetName()}" already; give it one'
                    )
        return prim


def _policy(call: Call, id: object) -> tuple[PolicySpec, Path, str]:
    from wsim.assets.policies import policy as known  # with pydantic: few programs have a policy

    if not isinstance(id, str) or not id:
        call.fail(f"policy = {shown(id)} must be the id of a policy")
    try:
        return known(id)
    except UserError as error:
        call.fail(f"policy: {error}")


def _route(call: Call, base: Usd.Prim, route: Sequence[Sequence[float]] | None) -> list[Gf.Vec3d]:
    """Way-points with a heading each [rad]."""
    if route is None:
        return []
    place, turn = world_pose(base)
    ahead = turn.Transform(Gf.Vec3d(1.0, 0.0, 0.0))
    heading = math.atan2(ahead[1], ahead[0])
    x, y, way = place[0], place[1], []
    for k, given in enumerate(call.listed("route", route, "(x, y) or (x, y, heading_deg)")):
        three = given if isinstance(given, (list, tuple)) and len(given) == 3 else None
        to = call.position(f"route[{k}]", three or _level(call, k, given))
        if three:
            heading = math.radians(to[2])
        elif math.hypot(to[0] - x, to[1] - y) > _SAME:
            heading = math.atan2(to[1] - y, to[0] - x)
        way.append(Gf.Vec3d(to[0], to[1], heading))
        x, y = to[0], to[1]
    if not 1 <= len(way) <= MAX_KEYS:
        call.fail(f"route has {len(way)} points; give 1 to {MAX_KEYS}")
    return way


def _level(call: Call, k: int, given: object) -> tuple[object, object, float]:
    if not isinstance(given, (list, tuple)) or len(given) != 2:
        call.fail(f"route[{k}] = {shown(given)} must be (x, y) [m] or (x, y, heading_deg)")
    return given[0], given[1], 0.0


def _commands(
    call: Call, command: Sequence[float], times: Sequence[float] | None, commands: Sequence[Sequence[float]] | None
) -> tuple[list[float], list[Vec3]]:
    """From when on each command holds."""
    if (times is None) != (commands is None):
        call.fail("times and commands go together; give both, or command alone")
    first = call.vector("command", command, _LARGEST, _UNITS)
    if times is None or commands is None:
        return [0.0], [first]
    when = [call.number(f"times[{k}]", each, "s") for k, each in enumerate(call.listed("times", times, "times [s]"))]
    what = [
        call.vector(f"commands[{k}]", each, _LARGEST, _UNITS)
        for k, each in enumerate(call.listed("commands", commands, "(forward, left, turning)"))
    ]
    if len(when) != len(what) or not 1 <= len(when) <= MAX_KEYS:
        call.fail(f"times has {len(when)} entries and commands {len(what)}; give 1 to {MAX_KEYS}, as many of both")
    if when[0] != 0.0 or any(two <= one for one, two in pairwise(when)):
        call.fail(f"times = {shown(when)} must begin with 0 and rise")
    return when, what


def _servos(robot: Robot, spec: PolicySpec) -> None:
    """Give the joints' servos the gains that the policy was made for; they hold their starts until it sets them."""
    for k, joint in enumerate(spec.joints):
        robot.drive(joint, stiffness=_of(spec.stiffness, k), damping=_of(spec.damping, k))


def _of(values: Numbers | None, k: int) -> float | None:
    return values[k] if isinstance(values, list) else values


def _base(call: Call, robot: Usd.Prim) -> Usd.Prim:
    base = base_of(robot)
    if base is None:
        call.fail(f"robot = {shown(robot.GetName())} has no one base that is free to move, by which a policy feels it")
    return base


def base_of(robot: Usd.Prim) -> Usd.Prim | None:
    """The one link of a robot that no joint hangs on another, if it is free to move."""
    bases = _bases_of(robot)
    return bases[0] if len(bases) == 1 and bases[0].HasAPI(UsdPhysics.RigidBodyAPI) else None


def is_held(robot: Usd.Prim) -> bool:
    """Whether a robot begins with links that are part of the world."""
    bases = _bases_of(robot)
    return bool(bases) and not any(base.HasAPI(UsdPhysics.RigidBodyAPI) for base in bases)


def _bases_of(robot: Usd.Prim) -> list[Usd.Prim]:
    hung = {path for joint in robot.GetChild("joints").GetChildren() for path in _ends(joint)}
    return [child for child in robot.GetChildren() if child.IsA(UsdGeom.Xform) and child.GetPath() not in hung]


def _ends(joint: Usd.Prim) -> list[Sdf.Path]:
    return list(UsdPhysics.Joint(joint).GetBody1Rel().GetTargets()) if joint.IsA(UsdPhysics.Joint) else []
