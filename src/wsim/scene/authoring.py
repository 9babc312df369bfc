"""What every call of a scene needs: the stage, names, poses, and the line of the program that called."""

from __future__ import annotations

import functools
import os
import sys
from dataclasses import dataclass
from pathlib import Path

from pxr import Gf, Sdf, Usd, UsdGeom, UsdPhysics, Vt

from wsim.scene.specs import put, spec_of
from wsim.scene.validate import Call, Vec3, shown, suggestion

WORLD = "/World"
LOOKS = "/World/Looks"
PARAMETERS = "/World/Parameters"
CONTACTS = "/World/Contacts"
SCHEDULES = "/World/Schedules"
PHYSICS_SCENE = "/World/PhysicsScene"

_PACKAGE = str(Path(__file__).parent) + os.sep


@dataclass(frozen=True)
class Handle:
    """What a call made: usable wherever another call asks for a `parent`, `child`, `fills` or `material`."""

    name: str
    path: str
    kind: str

    def __str__(self) -> str:
        return self.path


class Author:
    """An empty stage in SI units, Z up, and the ways to add a prim to it."""

    def __init__(self) -> None:
        stage = Usd.Stage.CreateInMemory("scene.usda")
        UsdGeom.SetStageUpAxis(stage, UsdGeom.Tokens.z)
        UsdGeom.SetStageMetersPerUnit(stage, 1.0)
        UsdPhysics.SetStageKilogramsPerUnit(stage, 1.0)
        stage.SetDefaultPrim(UsdGeom.Xform.Define(stage, WORLD).GetPrim())
        self._stage = stage

    @property
    def stage(self) -> Usd.Stage:
        """The stage itself, for all that the calls do not cover."""
        return self._stage

    def _path(self, call: Call, parent: str = WORLD) -> str:
        """The path of the prim that `call` is to make; a `SceneError` if its name is illegal or taken."""
        root = self._stage.GetPrimAtPath(parent)
        name = call.identifier(root.GetAllChildrenNames() if root else ())
        return f"{parent}/{name}"

    def _find(self, call: Call, field: str, what: object) -> Usd.Prim:
        """The prim that an argument means: a handle, a name or a path."""
        if isinstance(what, Handle):
            path = what.path
        elif isinstance(what, Usd.Prim):
            path = str(what.GetPath())
        elif isinstance(what, Sdf.Path):
            path = str(what)
        elif isinstance(what, str) and what:
            path = what if what.startswith("/") else f"{WORLD}/{what}"
        else:
            call.fail(f"{field} = {shown(what)} must be what a call returned, or its name")
        if path in ("/", WORLD):
            call.fail(f"{field} = {shown(what)} is the whole world; name an object in it")
        prim = self._stage.GetPrimAtPath(path) if Sdf.Path.IsValidPathString(path) else None
        if not prim:
            name = path.rsplit("/", 1)[-1]
            call.fail(f"{field} = {shown(name)} is not in the scene; {suggestion(name, self._object_names())}")
        return prim

    def _rigid_body(self, call: Call, field: str, what: object, otherwise: str = "") -> Usd.Prim:
        """The body that an argument means."""
        prim = self._find(call, field, what)
        if not prim.HasAPI(UsdPhysics.RigidBodyAPI):
            call.fail(
                f"{field} = {shown(prim.GetName())} is nothing that moves; name a body, or of a robot or a vehicle one "
                f"of its links{otherwise}"
            )
        return prim

    def _object_names(self) -> list[str]:
        reserved = {LOOKS, PARAMETERS, CONTACTS, SCHEDULES, PHYSICS_SCENE}
        children = self._stage.GetPrimAtPath(WORLD).GetAllChildren()
        return [prim.GetName() for prim in children if str(prim.GetPath()) not in reserved]


@functools.cache
def _file_name(path: str) -> str:
    return Path(path).name


def calling_line() -> str:
    """Which line of the program calls: "program.py:12"."""
    frame = sys._getframe(1)
    while frame.f_back is not None and frame.f_code.co_filename.startswith(_PACKAGE):
        frame = frame.f_back
    return f"{_file_name(frame.f_code.co_filename)}:{frame.f_lineno}"


def note_line(prim: Usd.Prim) -> None:
    """Write on a prim which line of the program made it, as customData `wsim:line` = "program.py:12"."""
    prim.SetCustomDataByKey("wsim:line", calling_line())


def calling_folder() -> Path | None:
    """The folder of the program that calls, if it is a file."""
    frame = sys._getframe(1)
    while frame.f_back is not None and frame.f_code.co_filename.startswith(_PACKAGE):
        frame = frame.f_back
    file = Path(frame.f_code.co_filename)
    return file.resolve().parent if file.is_file() else None


def rotation(degrees: Vec3) -> Gf.Quatd:
    """Roll about X, then pitch about Y, then yaw about Z, all fixed axes [deg]."""
    turns = [
        Gf.Rotation(axis, angle).GetQuat()
        for axis, angle in zip((Gf.Vec3d.XAxis(), Gf.Vec3d.YAxis(), Gf.Vec3d.ZAxis()), degrees, strict=True)
    ]
    return (turns[2] * turns[1] * turns[0]).GetNormalized()


def set_pose(prim: Usd.Prim, position: Vec3, turn: Gf.Quatd | None = None, scale: Vec3 | None = None) -> None:
    """Author translate, orient and scale, leaving out what does nothing."""
    kinds = Sdf.ValueTypeNames
    ops: list[tuple[str, Sdf.ValueTypeName, object]] = []
    if position != (0.0, 0.0, 0.0) or (turn is None and scale is None):
        ops.append(("xformOp:translate", kinds.Double3, Gf.Vec3d(*position)))
    if turn is not None and turn != Gf.Quatd(1.0):
        ops.append(("xformOp:orient", kinds.Quatd, turn))
    if scale is not None:
        ops.append(("xformOp:scale", kinds.Double3, Gf.Vec3d(*scale)))
    with Sdf.ChangeBlock():
        spec = spec_of(prim)
        for name, kind, value in ops:
            put(spec, name, kind, value)
        order = Vt.TokenArray([name for name, _, _ in ops])
        put(spec, "xformOpOrder", kinds.TokenArray, order, Sdf.VariabilityUniform)


def world_pose(prim: Usd.Prim) -> tuple[Gf.Vec3d, Gf.Quatd]:
    """Position [m] and rotation of a prim in the world, its scale left out."""
    matrix = UsdGeom.Xformable(prim).ComputeLocalToWorldTransform(Usd.TimeCode.Default())
    return matrix.ExtractTranslation(), matrix.RemoveScaleShear().ExtractRotationQuat().GetNormalized()


def set_extent(prim: Usd.Prim) -> None:
    """Author the bounding box of a prim, as USD asks of geometry."""
    boundable = UsdGeom.Boundable(prim)
    extent = UsdGeom.Boundable.ComputeExtentFromPlugins(boundable, Usd.TimeCode.Default())
    if extent is not None:
        boundable.CreateExtentAttr(extent)
