"""Motion that a stage states, before it is trusted: paths that can be followed, by bodies that are free to."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from pxr import Usd, UsdGeom, UsdPhysics

from wsim.geometry.paths import Curve
from wsim.limits import MAX_DURATION, MAX_KEYS, MAX_PATH_SPEED, MAX_PATH_SPIN, MAX_POSITION
from wsim.scene import schema
from wsim.scene.articulation import WORLD_END, joint_ends, joints_of
from wsim.scene.usd_motion import curve_of, path_of, sample_times
from wsim.scene.world import Path


def motion_problems(stage: Usd.Stage) -> Iterator[str]:
    """Problems of the paths of a stage, and of kinematic bodies on joints."""
    for prim in stage.Traverse(Usd.TraverseInstanceProxies()):
        rigid = prim.HasAPI(UsdPhysics.RigidBodyAPI)
        moved = schema.has(prim, schema.PATH)
        if not (rigid or moved):
            continue
        kinematic = _kinematic(prim)
        if moved and not kinematic:
            yield f"{prim.GetPath()}: only a kinematic rigid body has a path; give it physics:kinematicEnabled = 1"
        elif rigid and not kinematic and _sampled(prim):
            yield (
                f"{prim.GetPath()}.xformOp: time samples do nothing on a body that is not kinematic; remove them, "
                "or give it physics:kinematicEnabled = 1"
            )
        elif kinematic:
            yield from _path(prim)
    for joint in joints_of(stage):
        yield from _joint(stage, joint)


def _kinematic(prim: Usd.Prim) -> bool:
    return prim.HasAPI(UsdPhysics.RigidBodyAPI) and bool(UsdPhysics.RigidBodyAPI(prim).GetKinematicEnabledAttr().Get())


def _sampled(prim: Usd.Prim) -> bool:
    return prim.IsA(UsdGeom.Xformable) and len(sample_times(prim)) > 1


def _joint(stage: Usd.Stage, joint: UsdPhysics.Joint) -> Iterator[str]:
    if joint.GetExcludeFromArticulationAttr().Get():
        return  # a constraint holds on to any body
    _, child = joint_ends(joint)
    if child != WORLD_END and _kinematic(stage.GetPrimAtPath(child)):
        yield (
            f"{joint.GetPath()}.physics:body1: <{child}> is kinematic, and no joint can lead it; make it the joint's "
            "body0, or give the joint a drive and the body no physics:kinematicEnabled"
        )


def _path(prim: Usd.Prim) -> Iterator[str]:
    """Problems of a path, or of time samples."""
    where = f"{prim.GetPath()}.{'wsim:times' if schema.has(prim, schema.PATH) else 'xformOp'}"
    path = path_of(prim)
    if path is None:
        return
    count = len(path.times)
    if not 2 <= count <= MAX_KEYS:
        yield f"{where}: {count} keys; a path has 2 to {MAX_KEYS}"
    elif not len(path.positions) == len(path.rotations) == count:
        yield f"{where}: {count} times, {len(path.positions)} positions, {len(path.rotations)} rotations; give as many"
    elif not (np.diff(path.times) > 0.0).all() or max(map(abs, path.times)) > MAX_DURATION:
        yield f"{where}: times must rise, and lie within {MAX_DURATION:g} s"
    elif np.abs(path.positions).max() > MAX_POSITION:
        yield f"{where}: {np.abs(path.positions).max():g} m must be within {MAX_POSITION:g} m of the origin"
    elif np.linalg.norm(path.rotations, axis=1).min() < 0.5:
        yield f"{where}: a rotation of zero length is none"
    elif path.repeat and not _closes(path):
        yield f"{where}: a path that repeats must end as it begins"
    else:
        yield from _speed(where, curve_of(path))


def _closes(path: Path) -> bool:
    apart = np.subtract(path.positions[0], path.positions[-1])
    turned = np.dot(path.rotations[0], path.rotations[-1])
    sizes = np.linalg.norm(path.rotations[0]) * np.linalg.norm(path.rotations[-1])
    return bool(np.abs(apart).max() < 1e-6 and abs(turned) > (1.0 - 1e-6) * sizes)


def _speed(where: str, curve: Curve) -> Iterator[str]:
    for values, most, unit in zip(curve.speeds(), (MAX_PATH_SPEED, MAX_PATH_SPIN), ("m/s", "rad/s"), strict=True):
        k = int(np.argmax(values))
        if values[k] > most:
            yield (
                f"{where}: it would go at {values[k]:.4g} {unit} from {curve.times[k]:g} to {curve.times[k + 1]:g} s, "
                f"a jump; at most {most:g} {unit}"
            )
