"""Write a robot as a USD layer: links as bodies, what is seen apart from what collides, joints, drives, limits.

/robot                Xform, an articulation
    <link>            a body; in it
        seen/         what is looked at
        collision/    what collides, purpose `guide`
    joints/<joint>    UsdPhysics joints, with `PhysicsDriveAPI`, and Newton's armature, friction and mimics
    materials/        how what collides rubs

`customData["wsim:robot"]` of the root has the file's poses and notes, of a joint its damper, spring and effort.
"""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
from pxr import Gf, Sdf, Usd, UsdGeom, UsdPhysics, UsdShade, Vt

from wsim.intake.robot_model import Form, Link, Robot, RobotJoint
from wsim.scene.principal import principal
from wsim.scene.robot_drives import ROBOT, JointLaw, write_drive

JOINTS = "joints"
_KINDS = {
    "revolute": UsdPhysics.RevoluteJoint, "prismatic": UsdPhysics.PrismaticJoint,
    "spherical": UsdPhysics.SphericalJoint,
}  # fmt: skip


def write_robot(path: Path, robot: Robot, source: str) -> None:
    """Write the layer; `source` says what it is from."""
    stage = Usd.Stage.CreateInMemory()
    UsdGeom.SetStageUpAxis(stage, UsdGeom.Tokens.z)
    UsdGeom.SetStageMetersPerUnit(stage, 1.0)
    UsdPhysics.SetStageKilogramsPerUnit(stage, 1.0)
    root = UsdGeom.Xform.Define(stage, "/robot").GetPrim()
    stage.SetDefaultPrim(root)
    UsdGeom.Scope.Define(stage, f"/robot/{JOINTS}")
    frictions = sorted({form.friction for link in robot.links for form in link.collides})
    rubs = {value: _material(stage, f"/robot/materials/friction_{k}", value) for k, value in enumerate(frictions)}
    for link in robot.links:
        _link(stage, link, rubs)
    links = {link.name: link for link in robot.links}
    for joint in robot.joints:
        _joint(stage, joint, links)
    for mimic in robot.mimics:
        prim = stage.GetPrimAtPath(f"/robot/{JOINTS}/{mimic.follower}")
        prim.AddAppliedSchema("NewtonMimicAPI")
        prim.CreateRelationship("newton:mimicJoint", False).SetTargets([f"/robot/{JOINTS}/{mimic.leader}"])
        unit = 180.0 / math.pi if prim.IsA(UsdPhysics.RevoluteJoint) else 1.0
        for key, value in (("newton:mimicCoef0", mimic.offset * unit), ("newton:mimicCoef1", mimic.ratio)):
            prim.CreateAttribute(key, Sdf.ValueTypeNames.Float, False).Set(value)
    for one, two in robot.apart:
        _part(stage, one, two)
    root.SetCustomDataByKey(ROBOT, {"source": source, "poses": robot.poses, "notes": Vt.StringArray(robot.notes)})
    stage.GetRootLayer().Export(str(path))


def _material(stage: Usd.Stage, path: str, friction: float) -> UsdShade.Material:
    material = UsdShade.Material.Define(stage, path)
    api = UsdPhysics.MaterialAPI.Apply(material.GetPrim())
    api.CreateStaticFrictionAttr(friction)
    api.CreateDynamicFrictionAttr(friction)
    api.CreateRestitutionAttr(0.0)
    return material


def _link(stage: Usd.Stage, link: Link, rubs: dict[float, UsdShade.Material]) -> None:
    path = f"/robot/{link.name}"
    xform = UsdGeom.Xform.Define(stage, path)
    _place(xform, link.at, link.turn)
    if link.mass > 0.0:
        UsdPhysics.RigidBodyAPI.Apply(xform.GetPrim())
        _mass(xform.GetPrim(), link)
    xform.GetPrim().SetCustomDataByKey(ROBOT, {"free": link.free})
    for scope, forms in (("seen", link.seen), ("collision", link.collides)):
        names: list[str] = []
        for form in forms:
            name = form.name
            while name in names:
                name += "_"
            names.append(name)
            gprim = _form(stage, f"{path}/{scope}/{name}", form)
            if scope == "collision":
                gprim.CreatePurposeAttr(UsdGeom.Tokens.guide)
                UsdPhysics.CollisionAPI.Apply(gprim.GetPrim())
                UsdShade.MaterialBindingAPI.Apply(gprim.GetPrim()).Bind(rubs[form.friction], materialPurpose="physics")
                if form.kind == "mesh":
                    api = UsdPhysics.MeshCollisionAPI.Apply(gprim.GetPrim())
                    api.CreateApproximationAttr(UsdPhysics.Tokens.convexHull)


def _place(xform: UsdGeom.Xformable, at: np.ndarray, turn: np.ndarray) -> None:
    xform.AddTranslateOp().Set(Gf.Vec3d(*at.tolist()))
    xform.AddOrientOp(UsdGeom.XformOp.PrecisionDouble).Set(_quatd(turn))


def _quatd(turn: np.ndarray) -> Gf.Quatd:
    x, y, z, w = (float(v) for v in turn)
    return Gf.Quatd(w, x, y, z).GetNormalized()


def _mass(prim: Usd.Prim, link: Link) -> None:
    moments, axes = principal(link.inertia)
    api = UsdPhysics.MassAPI.Apply(prim)
    api.CreateMassAttr(link.mass)
    api.CreateCenterOfMassAttr(Gf.Vec3f(*link.com.tolist()))
    api.CreateDiagonalInertiaAttr(Gf.Vec3f(*moments.tolist()))
    api.CreatePrincipalAxesAttr(axes)


def _form(stage: Usd.Stage, path: str, form: Form) -> UsdGeom.Gprim:
    if form.kind == "mesh":
        mesh = UsdGeom.Mesh.Define(stage, path)
        mesh.CreatePointsAttr(Vt.Vec3fArray.FromNumpy(np.round(form.points, 6).astype(np.float32)))
        mesh.CreateFaceVertexCountsAttr(Vt.IntArray.FromNumpy(np.full(len(form.faces), 3, dtype=np.int32)))
        mesh.CreateFaceVertexIndicesAttr(Vt.IntArray.FromNumpy(form.faces.reshape(-1).astype(np.int32)))
        mesh.CreateSubdivisionSchemeAttr(UsdGeom.Tokens.none)
        gprim: UsdGeom.Gprim = mesh
    elif form.kind == "box":
        gprim = UsdGeom.Cube.Define(stage, path)
        gprim.CreateSizeAttr(1.0)
    else:
        gprim = {"sphere": UsdGeom.Sphere, "cylinder": UsdGeom.Cylinder, "capsule": UsdGeom.Capsule}[form.kind].Define(
            stage, path
        )
        gprim.CreateRadiusAttr(form.size[0])
        if form.kind != "sphere":
            gprim.CreateHeightAttr(form.size[1])
            gprim.CreateAxisAttr(UsdGeom.Tokens.z)
    gprim.CreateExtentAttr(UsdGeom.Boundable.ComputeExtentFromPlugins(gprim, Usd.TimeCode.Default()))
    gprim.CreateDisplayColorAttr([Gf.Vec3f(*form.color)])
    _place(gprim, form.at, form.turn)
    if form.kind == "box":
        gprim.AddScaleOp(UsdGeom.XformOp.PrecisionDouble).Set(Gf.Vec3d(*form.size))
    return gprim


def _joint(stage: Usd.Stage, joint: RobotJoint, links: dict[str, Link]) -> None:
    made = _KINDS[joint.kind].Define(stage, f"/robot/{JOINTS}/{joint.name}")
    child = links[joint.child]
    unit = 180.0 / math.pi if joint.kind == "revolute" else 1.0
    back = Gf.Quatd(1.0)  # so that the coordinate is the file's: the ends' frames meet where it is 0
    shift = Gf.Vec3d(0.0)
    if joint.kind == "revolute":
        back = Gf.Rotation(Gf.Vec3d.XAxis(), -joint.zero * unit).GetQuat()
    elif joint.kind == "prismatic":
        shift = Gf.Vec3d(-joint.zero, 0.0, 0.0)
    turn = _quatd(joint.turn)
    frame = Gf.Matrix4d().SetRotate(turn).SetTranslateOnly(Gf.Vec3d(*joint.at.tolist()))
    ahead = Gf.Matrix4d().SetRotate(back).SetTranslateOnly(shift) * frame * _pose(child)
    if joint.parent is not None:
        made.CreateBody0Rel().SetTargets([f"/robot/{joint.parent}"])
        ahead *= _pose(links[joint.parent]).GetInverse()
    made.CreateBody1Rel().SetTargets([f"/robot/{joint.child}"])
    made.CreateLocalPos0Attr(Gf.Vec3f(ahead.ExtractTranslation()))
    made.CreateLocalRot0Attr(Gf.Quatf(ahead.ExtractRotationQuat().GetNormalized()))
    made.CreateLocalPos1Attr(Gf.Vec3f(*joint.at.tolist()))
    made.CreateLocalRot1Attr(Gf.Quatf(turn))
    made.CreateAxisAttr("X")
    if joint.kind == "spherical":
        return
    if joint.low is not None:
        made.CreateLowerLimitAttr(joint.low * unit)
    if joint.high is not None:
        made.CreateUpperLimitAttr(joint.high * unit)
    prim = made.GetPrim()
    prim.AddAppliedSchema("NewtonJointAPI")
    for key, value in (
        ("newton:armature", joint.armature),
        ("newton:friction", joint.friction),
        ("newton:velocityLimit", (joint.fastest or 0.0) * unit),
    ):
        if value:
            prim.CreateAttribute(key, Sdf.ValueTypeNames.Float, False).Set(value)
    motor = joint.motor
    law = JointLaw(
        joint.damping, joint.stiffness, joint.spring_zero, joint.effort, joint.zero,
        motor.stiffness if motor else 0.0, motor.damping if motor else 0.0, motor is not None,
    )  # fmt: skip
    law.note(prim)
    write_drive(prim, law, joint.zero)


def _pose(link: Link) -> Gf.Matrix4d:
    return Gf.Matrix4d().SetRotate(_quatd(link.turn)).SetTranslateOnly(Gf.Vec3d(*link.at.tolist()))


def _part(stage: Usd.Stage, one: str, two: str) -> None:
    """State that two links, or shapes, never touch."""
    ends = []
    for name in (one, two):
        link, _, shape = name.partition("/")
        ends.append(f"/robot/{link}/collision/{shape}" if shape else f"/robot/{link}")
    prim = stage.GetPrimAtPath(ends[0])
    api = UsdPhysics.FilteredPairsAPI.Apply(prim)
    api.CreateFilteredPairsRel().AddTarget(ends[1])
