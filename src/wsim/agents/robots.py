"""What a planning model is told of robots: which there are, and of one that the prompt names what a plan calls."""

from __future__ import annotations

from pxr import Usd, UsdGeom, UsdPhysics

from wsim.assets.robots import robots
from wsim.assets.sources import sources
from wsim.scene import Scene


def robots_for(prompt: str) -> str:
    """The robots that are here or can be pulled, with their sizes and policies, or what a plan names of them."""
    told, said = [], prompt.lower()
    for robot in sorted({*robots(), *sources()}):
        source = sources().get(robot)
        size = f", {' x '.join(f'{edge:g}' for edge in source.size)} m" if source is not None and source.size else ""
        walks = f", policies {', '.join(source.policies)}" if source is not None and source.policies else ""
        named = source is None and any(word in said for word in robot.lower().split("_"))
        told.append(f"{robot}{size}{walks}{_parts(robot) if named else ''}")
    return f"Robots: {'; '.join(told) or 'none'}"


def _parts(robot: str) -> str:
    """How large a robot is as it stands, facing +X; its links, and its joints with their limits [deg] or [m]."""
    scene = Scene()
    handle = scene.robot("robot", robot)
    root = scene.stage.GetPrimAtPath(handle.path)
    bounds = UsdGeom.BBoxCache(Usd.TimeCode.Default(), ["default"]).ComputeWorldBound(root).ComputeAlignedRange()
    low, high = bounds.GetMin(), bounds.GetMax()
    spans = ", ".join(f"{axis} {a:.2f} to {b:.2f}" for axis, a, b in zip("xyz", low, high, strict=True))
    joints = []
    for prim in Usd.PrimRange(root):
        for kind, unit in ((UsdPhysics.RevoluteJoint, "deg"), (UsdPhysics.PrismaticJoint, "m")):
            if prim.IsA(kind):
                least, most = kind(prim).GetLowerLimitAttr().Get(), kind(prim).GetUpperLimitAttr().Get()
                joints.append(f"{prim.GetName()} ({least:.3g} to {most:.3g} {unit})")
    return f" (stands at 0, 0, 0, reaches {spans} m; links {', '.join(handle.links)}; joints {', '.join(joints)})"
