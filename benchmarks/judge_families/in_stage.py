"""Wrong physics: a stage with another number is simulated, and judged by the world that states the right one."""

from __future__ import annotations

import math
from collections.abc import Callable

from pxr import Gf, Usd, UsdPhysics

from benchmarks.judge_families.drawn import Draw, Sound
from benchmarks.judge_families.family import SHARE, Faulty, family, movers
from benchmarks.judge_families.record import simulated, world_of
from wsim.scene.world import World

SHARES = (0.03, 0.1, 0.2, 0.4, 0.8)
DEGREES = (1.0, 2.5, 5.0, 10.0, 20.0)


def changed(sound: Sound, change: Callable[[Usd.Stage], None]) -> Faulty:
    """A sound world, simulated with a change of its stage."""
    return Faulty(simulated(altered(sound.stage, change)), world_of(sound.stage))


def altered(text: str, change: Callable[[Usd.Stage], None]) -> str:
    """A stage's text after a change."""
    stage = Usd.Stage.CreateInMemory()
    stage.GetRootLayer().ImportFromString(text)
    change(stage)
    return str(stage.GetRootLayer().ExportToString())


def factor(size: float, draw: Draw) -> float:
    """More or less by a share; a share above a half only more or down to what is left of it."""
    return 1.0 + size if draw.sign() > 0 else 1.0 / (1.0 + size)


def scaled(sound: Sound, by: float, *attributes: str, prim: str = "") -> Faulty:
    """A sound world with attributes of all prims, or of one, scaled."""

    def change(stage: Usd.Stage) -> None:
        for each in [stage.GetPrimAtPath(prim)] if prim else stage.Traverse():
            for name in attributes:
                attribute = each.GetAttribute(name)
                if attribute and attribute.HasAuthoredValue():
                    attribute.Set(attribute.Get() * by)

    return changed(sound, change)


def _a_body(world: World, draw: Draw) -> int:
    return draw.pick(movers(world))


@family(SHARES, SHARE, ("friction",))
def friction(sound: Sound, size: float, draw: Draw) -> Faulty:
    """The surfaces rub more or less than they say."""
    return scaled(sound, factor(size, draw), "physics:dynamicFriction", "physics:staticFriction")


@family(SHARES, SHARE, ("bounce",))
def restitution(sound: Sound, size: float, draw: Draw) -> Faulty:
    """Bodies part faster or slower than their restitution says."""
    world = world_of(sound.stage)
    e = min(s.restitution for b in world.bodies for s in b.shapes if s.restitution is not None)
    by = 1.0 + size if draw.sign() > 0 and e * (1.0 + size) <= 1.0 else 1.0 / (1.0 + size)

    def change(stage: Usd.Stage) -> None:
        for prim in stage.Traverse():
            attribute = prim.GetAttribute("physics:restitution")
            if attribute and attribute.HasAuthoredValue() and attribute.Get() < 1.0:
                attribute.Set(attribute.Get() * by)

    return changed(sound, change)


@family((0.05, 0.1, 0.25, 0.5, 1.0), SHARE, ("mass",))
def mass(sound: Sound, size: float, draw: Draw) -> Faulty:
    """One body is heavier or lighter than the world says."""
    world = world_of(sound.stage)
    body = world.bodies[_a_body(world, draw)]
    return scaled(sound, factor(size, draw), "physics:mass", "physics:density", prim=body.prim)


@family((0.05, 0.1, 0.25, 0.5, 1.0), SHARE, ("inertia",))
def inertia(sound: Sound, size: float, draw: Draw) -> Faulty:
    """One body is harder or easier to turn than the world says; its mass is right."""
    world = world_of(sound.stage)
    body, by = world.bodies[_a_body(world, draw)], factor(size, draw)
    moments = [body.inertia[k] * by for k in (0, 4, 8)]
    if "spinner" in sound.name:  # one moment alone: all three together change nothing where nothing pushes
        moments = [body.inertia[k] * (by if k == 4 else 1.0) for k in (0, 4, 8)]
        moments = [min(m, sum(moments) - m) for m in moments]

    def change(stage: Usd.Stage) -> None:
        api = UsdPhysics.MassAPI(stage.GetPrimAtPath(body.prim))
        api.CreateMassAttr(body.mass)
        api.CreateDiagonalInertiaAttr(Gf.Vec3f(*moments))
        api.CreatePrincipalAxesAttr(Gf.Quatf(1.0))

    return changed(sound, change)


@family(SHARES, SHARE, ("gravity",))
def gravity(sound: Sound, size: float, draw: Draw) -> Faulty:
    """Gravity is stronger or weaker."""
    return scaled(sound, factor(size, draw), "physics:gravityMagnitude")


@family(DEGREES, "deg", ("gravity",))
def gravity_turned(sound: Sound, size: float, draw: Draw) -> Faulty:
    """Gravity is as strong, and points elsewhere."""
    (x, y), turn = draw.heading(), math.radians(size)

    def change(stage: Usd.Stage) -> None:
        for prim in stage.Traverse():
            if prim.IsA(UsdPhysics.Scene):
                way = Gf.Vec3f(x * math.sin(turn), y * math.sin(turn), -math.cos(turn))
                UsdPhysics.Scene(prim).GetGravityDirectionAttr().Set(way)

    return changed(sound, change)


DRIVEN = tuple(f"drive:{kind}:physics:{gain}" for kind in ("angular", "linear") for gain in
               ("stiffness", "damping", "maxForce"))  # fmt: skip


@family(SHARES, SHARE, ("drive",))
def drive(sound: Sound, size: float, draw: Draw) -> Faulty:
    """A drive is stronger or weaker: its gains, and its largest effort."""
    return scaled(sound, factor(size, draw), *DRIVEN)


@family(SHARES, SHARE, ("spring",))
def spring(sound: Sound, size: float, draw: Draw) -> Faulty:
    """A spring is stiffer or softer."""
    return scaled(sound, factor(size, draw), "wsim:stiffness")


@family(SHARES, SHARE, ("spring",))
def spring_length(sound: Sound, size: float, draw: Draw) -> Faulty:
    """A spring is at rest at another length."""
    return scaled(sound, factor(size, draw), "wsim:restLength")


@family(SHARES, SHARE, ("surface",))
def belt_speed(sound: Sound, size: float, draw: Draw) -> Faulty:
    """A surface moves faster or slower than it says."""
    return scaled(sound, factor(size, draw), "wsim:surfaceVelocity")


def _joints(stage: Usd.Stage) -> list[UsdPhysics.Joint]:
    return [UsdPhysics.Joint(prim) for prim in stage.Traverse() if prim.IsA(UsdPhysics.Joint)]


@family((0.02, 0.05, 0.1, 0.2, 0.4), "of the body's size", ("hinge",))
def joint_elsewhere(sound: Sound, size: float, draw: Draw) -> Faulty:
    """A hinge sits elsewhere on its bodies than the world says, a share of the child's size away."""
    world = world_of(sound.stage)
    joint = draw.pick(world.joints)
    child = world.body(joint.child)
    longest = max(child.shapes[0].size)
    along = max(range(3), key=lambda k: abs((joint.child_anchor or (0, 0, 0))[k]))
    shift = Gf.Vec3f(*(size * longest * draw.sign() if k == along else 0.0 for k in range(3)))

    def change(stage: Usd.Stage) -> None:
        api = UsdPhysics.Joint(stage.GetPrimAtPath(joint.prim))
        api.GetLocalPos1Attr().Set(api.GetLocalPos1Attr().Get() + shift)
        turn = _turn_of(stage, joint.child)
        back = _turn_of(stage, joint.parent).GetInverse() if joint.parent else Gf.Quatf(1.0)
        api.GetLocalPos0Attr().Set(api.GetLocalPos0Attr().Get() + (back * turn).Transform(shift))

    return changed(sound, change)


def _turn_of(stage: Usd.Stage, prim: str) -> Gf.Quatf:
    from pxr import UsdGeom

    matrix = UsdGeom.Xformable(stage.GetPrimAtPath(prim)).ComputeLocalToWorldTransform(Usd.TimeCode.Default())
    return Gf.Quatf(matrix.RemoveScaleShear().ExtractRotationQuat())


@family(DEGREES, "deg", ("hinge", "slider"))
def axis_turned(sound: Sound, size: float, draw: Draw) -> Faulty:
    """A hinge or a rail has another direction than the world says."""

    def change(stage: Usd.Stage) -> None:
        for joint in _joints(stage)[:1]:
            parents = joint.GetLocalRot0Attr()
            axis = Gf.Quatf(parents.Get())
            ends = [axis.Transform(Gf.Vec3f(*e)) for e in ((1, 0, 0), (0, 1, 0), (0, 0, 1))]
            letter = joint.GetPrim().GetAttribute("physics:axis").Get()
            along = Gf.Vec3d(ends["XYZ".index(letter)])
            side = Gf.Vec3d(ends[("XYZ".index(letter) + 1 + int(draw.whole(0, 1))) % 3])
            about = Gf.Quatf(Gf.Rotation(Gf.Cross(along, side), size).GetQuat())
            body = joint.GetBody1Rel().GetTargets()[0]
            own = _turn_of(stage, str(body))
            parent = joint.GetBody0Rel().GetTargets()
            up = _turn_of(stage, str(parent[0])) if parent else Gf.Quatf(1.0)
            world_turn = about * (up * axis)
            parents.Set(up.GetInverse() * world_turn)
            joint.GetLocalRot1Attr().Set(own.GetInverse() * world_turn)

    return changed(sound, change)


@family((1.0, 2.5, 5.0, 10.0, 20.0), "deg", ("limit",))
def limit_passed(sound: Sound, size: float, draw: Draw) -> Faulty:
    """A joint goes beyond its stop before something holds it."""

    def change(stage: Usd.Stage) -> None:
        for joint in _joints(stage):
            for name, sign in (("physics:lowerLimit", -1), ("physics:upperLimit", 1)):
                attribute = joint.GetPrim().GetAttribute(name)
                attribute.Set(attribute.Get() + sign * size)

    return changed(sound, change)


@family((0.05, 0.1, 0.25, 0.5, 1.0), "of the body's size", ("wall",), wrong=0.05)
def tunnelling(sound: Sound, size: float, draw: Draw) -> Faulty:
    """A ball goes through a sheet, of a share of its size in thickness."""
    world = world_of(sound.stage)
    sheet, thick = world.statics[0].shapes[0], size * 2.0 * world.bodies[0].shapes[0].size[0]
    face = world.statics[0].shapes[0].position[0] - 0.5 * sheet.size[0]
    _, y, z = sheet.position

    def thinner(stage: Usd.Stage) -> None:
        stage.GetPrimAtPath("/World/sheet").GetAttribute("xformOp:translate").Set(Gf.Vec3d(face + 0.5 * thick, y, z))
        stage.GetPrimAtPath("/World/sheet/geometry").GetAttribute("xformOp:scale").Set(Gf.Vec3d(thick, *sheet.size[1:]))

    def passable(stage: Usd.Stage) -> None:
        thinner(stage)
        stage.GetPrimAtPath("/World/sheet/geometry").RemoveAPI(UsdPhysics.CollisionAPI)

    return Faulty(simulated(altered(sound.stage, passable)), world_of(altered(sound.stage, thinner)))
