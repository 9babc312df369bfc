"""What a planning model is told of robots: which there are, and of one that the prompt names what a plan calls."""

from __future__ import annotations

from collections.abc import Iterator

from pxr import Gf, Usd, UsdGeom, UsdPhysics

from wsim.assets.robots import robots
from wsim.assets.sources import sources
from wsim.scene import Scene
from wsim.scene.robot_drives import is_angular
from wsim.scene.robot_pose import followed, one_freedom


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
    """How large a robot is as it stands, facing +X; its links, grips, and joints with their limits [deg] or [m]."""
    scene = Scene()
    handle = scene.robot("robot", robot)
    root = scene.stage.GetPrimAtPath(handle.path)
    spans = _spans(_boxes().ComputeWorldBound(root))
    joints = ", ".join(_joint(prim) for prim in Usd.PrimRange(root) if one_freedom(prim))
    grips = "".join(f"; {grip}" for grip in _grips(root))
    return f" (stands at 0, 0, 0, reaches {spans} m; links {', '.join(handle.links)}; joints {joints}{grips})"


def _boxes() -> UsdGeom.BBoxCache:
    return UsdGeom.BBoxCache(Usd.TimeCode.Default(), ["default"])


def _spans(bounds: Gf.BBox3d) -> str:
    box = bounds.ComputeAlignedRange()
    return ", ".join(f"{axis} {a:.2f} to {b:.2f}" for axis, a, b in zip("xyz", box.GetMin(), box.GetMax(), strict=True))


def _joint(prim: Usd.Prim) -> str:
    """A joint and its limits, or whom it follows: that one alone is scheduled."""
    leader = followed(prim)
    if leader is not None:
        return f"{prim.GetName()} (follows {leader[0]}, and takes no schedule)"
    turns = is_angular(prim)
    joint = UsdPhysics.RevoluteJoint(prim) if turns else UsdPhysics.PrismaticJoint(prim)
    low, high = joint.GetLowerLimitAttr().Get(), joint.GetUpperLimitAttr().Get()
    return f"{prim.GetName()} ({low:.3g} to {high:.3g} {'deg' if turns else 'm'})"


def _grips(root: Usd.Prim) -> Iterator[str]:
    """Where a link's fingers are at the start, in its own frame: what a reach of it has to leave room for."""
    stage, fingers = root.GetStage(), dict[str, list[Usd.Prim]]()
    for prim in Usd.PrimRange(root):
        if prim.IsA(UsdPhysics.PrismaticJoint):
            hand, finger = (UsdPhysics.Joint(prim).GetBody0Rel(), UsdPhysics.Joint(prim).GetBody1Rel())
            if hand.GetTargets() and finger.GetTargets():
                held = stage.GetPrimAtPath(finger.GetTargets()[0])
                fingers.setdefault(str(hand.GetTargets()[0]), []).append(held)
    for hand, held in fingers.items():
        if len(held) > 1:
            at = "; ".join(
                f"{prim.GetName()} {_spans(_boxes().ComputeRelativeBound(prim, stage.GetPrimAtPath(hand)))}"
                for prim in held
            )
            yield f"fingers in the frame of {hand.rpartition('/')[2]} at the start: {at} m"
