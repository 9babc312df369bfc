"""Check a stage before it is trusted: the border between what is generated and what simulates.

A problem is one line naming the prim, the attribute and the value. No stage makes this raise.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Iterator, Sequence
from itertools import chain, islice
from pathlib import Path
from typing import Any

import numpy as np
from pxr import Gf, Tf, Usd, UsdGeom, UsdPhysics, UsdValidation, Vt

from wsim.limits import (
    MAX_BYTES,
    MAX_COUNT,
    MAX_DENSITY,
    MAX_DURATION,
    MAX_FLOW_INDEX,
    MAX_FRAME_RATE,
    MAX_MASS,
    MAX_POINTS,
    MAX_POSITION,
    MAX_PRIMS,
    MAX_SIZE,
    MAX_SPEED,
    MAX_TIME_STEP,
    MAX_YIELD_STRESS,
    MIN_FLOW_INDEX,
    MIN_TIME_STEP,
)
from wsim.scene import schema
from wsim.scene.articulation import joints_of
from wsim.scene.check_assets import LAYER_SUFFIXES, check_assets
from wsim.scene.check_colliders import check_solid
from wsim.scene.check_contacts import contact_problems, surface_problems
from wsim.scene.check_cords import cord_problems
from wsim.scene.check_indices import check_indices
from wsim.scene.check_joints import joint_problems
from wsim.scene.check_leads import parted
from wsim.scene.check_motion import motion_problems
from wsim.scene.check_reach import overreached
from wsim.scene.check_targets import check_targets
from wsim.scene.errors import one_line
from wsim.scene.skeleton import is_free
from wsim.scene.usd_cameras import camera_problems
from wsim.scene.usd_fluids import fluid_problems
from wsim.scene.usd_openings import opening_problems
from wsim.scene.usd_policies import policy_problems
from wsim.scene.usd_reaches import reach_problems
from wsim.scene.usd_schedules import schedule_problems
from wsim.scene.usd_sensors import sensor_problems
from wsim.scene.usd_shapes import to_vec3

_NOW = Usd.TimeCode.Default()
# Where USD itself means "without limit" or "not given" by an infinity.
_MAY_BE_INFINITE = {
    "lowerLimit",
    "upperLimit",
    "low",
    "high",
    "maxForce",
    "breakForce",
    "breakTorque",
    "centerOfMass",
    "gravityMagnitude",
    "velocityLimit",
}
# What `_mass` tells with the value, which USD's validators leave out.
_OURS = ("MassInvalidValues", "DensityInvalidValues")
# Validators of files, types, connections, materials and skins.
_OF_SKELETONS = (
    "usdValidation:",
    "usdUtilsValidators:",
    "usdShadeValidators:",
    "usdSkelValidators:",
    "usdLuxValidators:",
)
_SPACES = ("physics", "drive", "limit", "newton")
_MAX_PROBLEMS = 50


def check_stage(path: str | Path, roots: Sequence[str | Path]) -> list[str]:
    """What is wrong with a stage; empty if nothing is.

    Args:
        path: A .usd, .usda or .usdc file.
        roots: Folders that everything it names must lie in: references, payloads, sublayers, textures.

    Returns:
        At most 50 problems, one line each.
    """
    return check_opened(path, roots)[0]


def check_opened(
    path: str | Path, roots: Sequence[str | Path], *, known: bool = False
) -> tuple[list[str], Usd.Stage | None]:
    """What is wrong with a stage, as `check_stage` has it, and the stage; None of one that is unsound.

    Args:
        path: A .usd, .usda or .usdc file.
        roots: Folders that everything it names must lie in.
        known: Whether a stage of the same skeleton (`wsim.scene.skeleton`) was found sound: only what hangs on numbers
            that a skeleton leaves out is looked at then.
    """
    path = Path(path)
    problems = _file_problems(path)
    if not problems and not known:
        problems = check_assets(path, [Path(root) for root in roots])
    if problems:
        return problems[:_MAX_PROBLEMS], None
    try:
        stage = Usd.Stage.Open(str(path))
        stage.Reload()
    except Tf.ErrorException as error:
        return [f"{path.name}: does not open: {one_line(error)}"], None
    try:
        problems = list(islice(_stage_problems(stage, known), _MAX_PROBLEMS))
    except Exception as error:  # noqa: BLE001 - a stage that no reader foresaw is refused, not a crash
        problems = [f"{path.name}: cannot be checked: {type(error).__name__}: {one_line(error)}"]
    return problems, None if problems else stage


def _file_problems(path: Path) -> list[str]:
    if not path.is_file():
        return [f"{path.name}: no such file"]
    if path.suffix.lower() not in LAYER_SUFFIXES:
        return [f"{path.name}: must end in one of {', '.join(LAYER_SUFFIXES)}"]
    size = path.stat().st_size
    if size > MAX_BYTES:
        return [f"{path.name}: {size} bytes; at most {MAX_BYTES}"]
    return []


def _stage_problems(stage: Usd.Stage, known: bool) -> Iterator[str]:
    prims = []
    for prim in stage.Traverse(Usd.TraverseInstanceProxies()):
        prims.append(prim)
        if len(prims) > MAX_PRIMS:
            yield f"{stage.GetRootLayer().GetDisplayName()}: more than {MAX_PRIMS} prims"
            return
    sound, ours = True, schema.ours(prims)
    for problem in chain(_metadata(stage), _values(stage, prims, set(ours), known), _validators(stage, known)):
        sound = False
        yield problem
    if sound:  # what follows reads shapes, and follows indices and paths
        for prim in prims:
            yield from check_solid(prim, known=known)
        for prim in ours:
            yield from cord_problems(prim)
        yield from joint_problems(stage)
        yield from policy_problems(ours)
        yield from reach_problems(ours)
        yield from schedule_problems(ours)
        yield from sensor_problems(ours)
        yield from fluid_problems(ours)
        yield from opening_problems(ours, prims)
        yield from camera_problems(prims)
        if any(schema.has(prim, schema.CONTACT) for prim in ours):
            yield from contact_problems(prims)
        wrong = list(motion_problems(stage))
        yield from wrong
        if not wrong and any(joints_of(stage)):  # of paths that can be followed
            yield from parted(stage)
            yield from overreached(stage)


def _values(stage: Usd.Stage, prims: list[Usd.Prim], ours: set[Usd.Prim], known: bool) -> Iterator[str]:
    """Numbers, indices and paths."""
    points = 0
    for prim in prims:
        yield from _numbers(prim, known)
        if not known:
            yield from check_indices(prim)
            yield from check_targets(prim)
        yield from _pose(prim)
        yield from _mass(prim)
        if prim in ours:
            yield from _wsim(prim)
            yield from surface_problems(prim)
        if prim.IsA(UsdGeom.Gprim):
            yield from _geometry(prim)
        if prim.IsA(UsdGeom.PointBased):
            points += len(UsdGeom.PointBased(prim).GetPointsAttr().Get() or ())
    if points > MAX_POINTS:
        yield f"{stage.GetRootLayer().GetDisplayName()}: {points} vertices; at most {MAX_POINTS}"


def _metadata(stage: Usd.Stage) -> Iterator[str]:
    name = stage.GetRootLayer().GetDisplayName()
    if not stage.GetDefaultPrim():
        yield f"{name}: no defaultPrim; name the prim that holds the world"
    for key, value in (
        ("metersPerUnit", UsdGeom.GetStageMetersPerUnit(stage)),
        ("kilogramsPerUnit", UsdPhysics.GetStageKilogramsPerUnit(stage)),
    ):
        if not math.isclose(value, 1.0):
            yield f"{name}: {key} = {value:g} must be 1"
    if UsdGeom.GetStageUpAxis(stage) != UsdGeom.Tokens.z:
        yield f"{name}: upAxis = {UsdGeom.GetStageUpAxis(stage)} must be Z"


@functools.cache
def _context(known: bool) -> UsdValidation.ValidationContext:
    """USD's own validators; where a skeleton is known, without those that ask for no number that it leaves out."""
    names = {v: v.GetMetadata().name for v in UsdValidation.ValidationRegistry().GetOrLoadAllValidators()}
    # Those of packages ask for what only a .usdz file has.
    return UsdValidation.ValidationContext(
        [v for v, name in names.items() if "Usdz" not in name and not (known and name.startswith(_OF_SKELETONS))]
    )


def _validators(stage: Usd.Stage, known: bool) -> Iterator[str]:
    """What USD's own validators say."""
    for error in _context(known).Validate(stage):
        if error.GetName() in _OURS:
            continue
        sites = [str(site.GetPrim().GetPath()) for site in error.GetSites() if site.IsPrim()]
        where = sites[0] if sites else stage.GetRootLayer().GetDisplayName()
        yield f"{where}: {error.GetMessage()} [{error.GetIdentifier()}]"


@functools.lru_cache(maxsize=1 << 12)
def _may_be_infinite(name: str) -> bool:
    parts = name.split(":")
    return parts[0] in _SPACES and parts[-1] in _MAY_BE_INFINITE


def _numbers(prim: Usd.Prim, known: bool) -> Iterator[str]:
    """Authored values and time samples that are not finite."""
    for attribute in prim.GetAuthoredAttributes():
        if known and not is_free(attribute.GetName()):
            continue
        for time in (_NOW,) if known else (_NOW, *attribute.GetTimeSamples()):
            value = attribute.Get(time)
            if isinstance(value, float) and math.isfinite(value):
                continue
            numbers = _as_array(value)
            if numbers is None:
                break
            bad = np.isnan(numbers) if _may_be_infinite(attribute.GetName()) else ~np.isfinite(numbers)
            if bad.any():
                yield f"{attribute.GetPath()}: {float(numbers[bad][0])} must be finite"
                break


def _as_array(value: Any) -> np.ndarray | None:
    """The floating-point numbers of a USD value, in one row; None if it holds none."""
    if isinstance(value, float):
        return np.array([value])
    if type(value) in _QUATERNIONS:
        return np.append(np.array(value.GetImaginary(), dtype=np.float64), value.GetReal())
    if type(value) in _FLOATS:
        try:
            array = np.array(value, dtype=np.float64).reshape(-1)
        except (TypeError, ValueError):
            return None
        return array if array.size else None
    return None


_QUATERNIONS = frozenset((Gf.Quatd, Gf.Quatf, Gf.Quath))
_FLOATS = frozenset(
    getattr(module, name)
    for module in (Gf, Vt)
    for name in dir(module)
    if name.startswith(("Vec", "Matrix", "Quat", "Double", "Float", "Half", "DualQuat"))
    and (module is Gf or name.endswith("Array"))
    and not name.startswith(("Vec2i", "Vec3i", "Vec4i"))
    and isinstance(getattr(module, name), type)
)


def _pose(prim: Usd.Prim) -> Iterator[str]:
    if not prim.IsA(UsdGeom.Xformable):
        return
    matrix = UsdGeom.Xformable(prim).ComputeLocalToWorldTransform(_NOW)
    if not np.isfinite(np.array(matrix)).all():
        yield f"{prim.GetPath()}: its pose is not finite"
        return
    for axis, value in zip("xyz", to_vec3(matrix.ExtractTranslation()), strict=True):
        if abs(value) > MAX_POSITION:
            yield f"{prim.GetPath()}.xformOp: {axis} = {value:g} m must be within {MAX_POSITION:g} m of the origin"
    if abs(matrix.GetDeterminant3()) < 1e-15:
        yield f"{prim.GetPath()}.xformOp:scale: the scale is zero along an axis"


def _geometry(prim: Usd.Prim) -> Iterator[str]:
    """Sizes of a Gprim, scaled [m]."""
    matrix = UsdGeom.Xformable(prim).ComputeLocalToWorldTransform(_NOW)
    scales = [matrix.GetRow3(i).GetLength() for i in range(3)]
    largest = max(scales)
    for name in ("size", "radius", "height"):
        attribute = prim.GetAttribute(name)
        value = attribute.Get() if attribute else None
        if value is None or not math.isfinite(value):
            continue
        if value <= 0.0:
            yield f"{attribute.GetPath()}: {value:g} must be > 0 m"
        elif value * largest > MAX_SIZE:
            yield f"{attribute.GetPath()}: {value * largest:g} m must be <= {MAX_SIZE:g} m"
    if prim.IsA(UsdGeom.PointBased):
        points = np.asarray(UsdGeom.PointBased(prim).GetPointsAttr().Get() or [], dtype=np.float64)
        if len(points) and np.isfinite(points).all():
            placed = points @ np.array(matrix)[:3, :3] + np.array(matrix)[3, :3]
            reach, furthest = float(np.ptp(placed, axis=0).max()), float(np.abs(placed).max())
            if not 0.0 < reach <= MAX_SIZE:
                yield f"{prim.GetPath()}.points: {reach:g} m across must be > 0 and <= {MAX_SIZE:g} m"
            if furthest > MAX_POSITION:
                yield f"{prim.GetPath()}.points: {furthest:g} m must be within {MAX_POSITION:g} m of the origin"


def _mass(prim: Usd.Prim) -> Iterator[str]:
    """Masses and densities. USD reads a 0 as "not given", which is allowed where the other one is given."""
    if prim.HasAPI(UsdPhysics.MassAPI):
        api = UsdPhysics.MassAPI(prim)
        mass, density = api.GetMassAttr(), api.GetDensityAttr()
        given = any((attribute.Get() or 0.0) > 0.0 for attribute in (mass, density))
        yield from _bounded(mass, MAX_MASS, "kg", zero=given)
        yield from _bounded(density, MAX_DENSITY, "kg/m^3", zero=given)
    if prim.HasAPI(UsdPhysics.MaterialAPI):
        yield from _bounded(UsdPhysics.MaterialAPI(prim).GetDensityAttr(), MAX_DENSITY, "kg/m^3", zero=True)


def _wsim(prim: Usd.Prim) -> Iterator[str]:
    """What wsim's own schemas say."""
    applied = schema.applied(prim)
    if schema.SCENE in applied:
        for name, limit, unit in (("duration", MAX_DURATION, "s"), ("frameRate", MAX_FRAME_RATE, "Hz")):
            yield from _bounded(prim.GetAttribute(f"wsim:{name}"), limit, unit)
        yield from _bounded(prim.GetAttribute("wsim:timeStep"), MAX_TIME_STEP, "s", zero=True, low=MIN_TIME_STEP)
        if (seed := prim.GetAttribute("wsim:seed").Get()) is not None and seed < 0:
            yield f"{prim.GetPath()}.wsim:seed: {seed} must be at least 0"
    if schema.FLUID in applied:
        yield from _fluid(prim)
    if schema.SURFACE_VELOCITY in applied:
        yield from _within(prim.GetAttribute("wsim:surfaceVelocity"), MAX_SPEED, "m/s")
    if schema.CONTAINER in applied:
        yield from _bounded(prim.GetAttribute("wsim:innerSize"), MAX_SIZE, "m")


def _fluid(prim: Usd.Prim) -> Iterator[str]:
    problems = [
        *_bounded(prim.GetAttribute("wsim:density"), MAX_DENSITY, "kg/m^3"),
        *_bounded(prim.GetAttribute("wsim:viscosity"), 1e6, "Pa s", zero=True),
        *_bounded(prim.GetAttribute("wsim:yieldStress"), MAX_YIELD_STRESS, "Pa", zero=True),
        *_bounded(prim.GetAttribute("wsim:flowIndex"), MAX_FLOW_INDEX, "", low=MIN_FLOW_INDEX),
        *_bounded(prim.GetAttribute("wsim:size"), MAX_SIZE, "m", zero=True),
        *_bounded(prim.GetAttribute("wsim:spacing"), MAX_SIZE, "m"),
        *_bounded(prim.GetAttribute("wsim:speedOfSound"), 1e4, "m/s", zero=True),
        *_bounded(prim.GetAttribute("wsim:attenuationLength"), MAX_SIZE, "m", zero=True),
        *_within(prim.GetAttribute("wsim:velocity"), MAX_SPEED, "m/s"),
        *_bounded(prim.GetAttribute("wsim:volume"), 1e9, "m^3", zero=True),
    ]
    yield from problems
    size, spacing = prim.GetAttribute("wsim:size").Get(), prim.GetAttribute("wsim:spacing").Get()
    if size is None or spacing is None:
        yield f"{prim.GetPath()}: a fluid needs wsim:size and wsim:spacing"
    elif min(size[0], size[1]) == 0.0:
        yield f"{prim.GetPath()}.wsim:size: {tuple(size)} m must be > 0 along x and y; its height alone may be 0"
    elif not problems:
        count = size[0] * size[1] * size[2] / spacing**3
        if count > MAX_COUNT:
            yield f"{prim.GetPath()}.wsim:spacing: {spacing:g} m gives {count:.3g} particles; at most {MAX_COUNT:.3g}"


def _bounded(
    attribute: Usd.Attribute, high: float, unit: str, *, zero: bool = False, low: float = 0.0
) -> Iterator[str]:
    """Problems of an authored number, or vector of numbers, that must be > 0 (or >= 0), >= low and <= high."""
    if not attribute or not attribute.HasAuthoredValue():
        return
    numbers = _as_array(attribute.Get())
    if numbers is None:
        return
    for number in numbers[np.isfinite(numbers)]:
        if number < 0.0 or (number == 0.0 and not zero):
            yield f"{attribute.GetPath()}: {number:g} must be {'>=' if zero else '>'} 0 {unit}"
        elif number > high:
            yield f"{attribute.GetPath()}: {number:g} must be <= {high:g} {unit}"
        elif 0.0 < number < low:
            yield f"{attribute.GetPath()}: {number:g} must be >= {low:g} {unit}{', or 0' if zero else ''}"


def _within(attribute: Usd.Attribute, limit: float, unit: str) -> Iterator[str]:
    """Problems of the numbers of an authored vector, each of which must lie in -limit..limit."""
    numbers = _as_array(attribute.Get()) if attribute and attribute.HasAuthoredValue() else None
    for number in () if numbers is None else numbers[np.isfinite(numbers)]:
        if abs(number) > limit:
            yield f"{attribute.GetPath()}: {number:g} must be within {limit:g} {unit} of 0"
