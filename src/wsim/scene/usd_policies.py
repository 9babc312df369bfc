"""Policies of a stage, read back, and held against what the simulator needs of them."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from itertools import pairwise

from pxr import Usd, UsdPhysics
from pydantic import ValidationError

from wsim.assets.policies import PolicySpec
from wsim.limits import MAX_KEYS, MAX_POSITION
from wsim.scene import schema
from wsim.scene.usd_shapes import to_vec3
from wsim.scene.usd_values import line_of, targets_of, value_of
from wsim.scene.world import Policy

_LARGEST = 1e4  # [m/s], [rad/s]


def read_policies(prims: Iterable[Usd.Prim]) -> Iterator[Policy]:
    """The policies among a stage's prims, which was checked."""
    for prim in prims:
        if not schema.has(prim, schema.POLICY):
            continue
        network = value_of(prim, "network", None)
        yield Policy(
            prim=str(prim.GetPath()),
            base=str(targets_of(prim, "base")[0].GetPath()),
            joints=[str(joint.GetPath()) for joint in targets_of(prim, "joints")],
            spec=PolicySpec.model_validate_json(value_of(prim, "description", "")),
            network=str(network.resolvedPath or network.path),
            sha256=value_of(prim, "sha256", ""),
            times=list(value_of(prim, "times", None) or [0.0]),
            commands=[to_vec3(each) for each in value_of(prim, "commands", None) or [(0.0, 0.0, 0.0)]],
            route=[to_vec3(each) for each in value_of(prim, "route", None) or ()],
            speed=value_of(prim, "speed", 0.0),
            line=line_of(prim),
        )


def policy_problems(prims: Iterable[Usd.Prim]) -> Iterator[str]:
    """Problems of the policies among a stage's prims: those that `read_policies` gets, in instances, too."""
    set_by: dict[str, str] = {}
    for prim in prims:
        if not schema.has(prim, schema.POLICY):
            continue
        for problem in _problems(prim):
            yield f"{prim.GetPath()}.wsim:{problem}"
        for joint in targets_of(prim, "joints"):
            other = set_by.setdefault(str(joint.GetPath()), str(prim.GetPath()))
            if other != str(prim.GetPath()):
                yield f"{prim.GetPath()}.wsim:joints: <{joint.GetPath()}> is set by <{other}>, too"


def _problems(prim: Usd.Prim) -> Iterator[str]:
    try:
        spec = PolicySpec.model_validate_json(value_of(prim, "description", ""))
    except ValidationError as error:
        yield f"description: {error.errors()[0]['msg']}"
        return
    bases, joints = targets_of(prim, "base"), targets_of(prim, "joints")
    if len(bases) != 1 or not bases[0].HasAPI(UsdPhysics.RigidBodyAPI):
        yield "base: it must be one rigid body"
    if len(joints) != len(spec.joints):
        yield f"joints: {len(joints)} are there, and the description has {len(spec.joints)}"
    for joint in joints:
        if not any(joint.IsA(kind) for kind in (UsdPhysics.RevoluteJoint, UsdPhysics.PrismaticJoint)):
            yield f"joints: <{joint.GetPath()}> is no revolute or prismatic joint"
            continue
        freedom = "angular" if joint.IsA(UsdPhysics.RevoluteJoint) else "linear"
        if not joint.HasAPI(UsdPhysics.DriveAPI, freedom):
            yield f"joints: <{joint.GetPath()}> has no drive, whose target it would set"
    if not getattr(value_of(prim, "network", None), "path", ""):
        yield "network: no file is named"
    times, commands = list(value_of(prim, "times", ())), list(value_of(prim, "commands", ()))
    if len(times) != len(commands) or len(times) > MAX_KEYS:
        yield f"times: {len(times)} are there, and {len(commands)} commands; at most {MAX_KEYS}, as many of both"
    elif times and (times[0] != 0.0 or not all(one < two < math.inf for one, two in pairwise(times))):
        yield "times: they must begin with 0 and rise"
    if not all(abs(x) <= _LARGEST for each in commands for x in each):
        yield f"commands: each must be at most {_LARGEST:g} in size"
    route, speed = list(value_of(prim, "route", ())), value_of(prim, "speed", 0.0)
    if len(route) > MAX_KEYS or not all(abs(x) <= MAX_POSITION for each in route for x in each):
        yield f"route: at most {MAX_KEYS} points, each at most {MAX_POSITION:g} m away"
    if route and not 0.0 < speed <= _LARGEST:
        yield f"speed: {speed:g} must be above 0 and at most {_LARGEST:g} m/s"
