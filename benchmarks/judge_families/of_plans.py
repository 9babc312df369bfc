"""What was built is not what was planned: sound motions of a world that the plan did not ask for."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from pxr import Gf, Usd, UsdGeom, UsdPhysics, UsdShade

from benchmarks.judge_families.drawn import Draw, Sound, planned_mechanism
from benchmarks.judge_families.family import SHARE, Faulty, family
from benchmarks.judge_families.in_stage import altered
from benchmarks.judge_families.record import simulated, world_of
from benchmarks.judge_worlds.world import planned, thing
from wsim.plan.schema import Objective, Plan, PlanObject


@planned_mechanism("planned")
def planned_slide(draw: Draw) -> Plan:
    """A block slides along the ground past a ball at rest."""
    size, speed = draw.between(0.1, 0.6), draw.between(1.0, 3.0)
    block = thing("block", "box", (size, 0.8 * size, 0.5 * size), (0, 0, 0.25 * size), velocity=(speed, 0, 0))
    ball = thing("ball", "sphere", (0.5 * size,), (0, 3 * size, 0.5 * size), "rubber")
    asked = Objective(kind="moves", object="block", direction="front", value=0.05, sentence="The block slides.")
    return planned("A block slides past a ball", [block, ball], [asked], 1.0, frame_rate=60.0)


@planned_mechanism("planned")
def planned_stack(draw: Draw) -> Plan:
    """A box stands on a block."""
    size = draw.between(0.1, 0.6)
    below = thing("block", "box", (size, size, 0.5 * size), (0, 0, 0.25 * size), "brick")
    above = thing("ball", "box", (0.5 * size, 0.5 * size, 0.4 * size), (0, 0, 0.7 * size), "pine")
    asked = Objective(kind="rests_on", object="ball", ref="block", sentence="The box rests on the block.")
    return planned("A box stands on a block", [below, above], [asked], 1.0, frame_rate=60.0)


def _asked(sound: Sound, change: Callable[[PlanObject], PlanObject], name: str = "block") -> Faulty:
    """A sound recording, and a plan that asks for another object than it holds."""
    assert sound.plan is not None
    objects = [change(each) if each.name == name else each for each in sound.plan.objects]
    plan = sound.plan.model_copy(update={"objects": objects})
    return Faulty(simulated(sound.stage), world_of(sound.stage), plan)


def _built(sound: Sound, change: Callable[[Usd.Stage], None]) -> Faulty:
    """A stage that has what the plan does not; the recording is of that, and says so."""
    stage = altered(sound.stage, change)
    return Faulty(simulated(stage), world_of(stage), sound.plan)


@family((0.03, 0.1, 0.2, 0.4, 0.8), SHARE, ("planned",), seen=False)
def plan_size(sound: Sound, size: float, draw: Draw) -> Faulty:
    """An object is larger or smaller than planned, in one direction."""
    by, way = 1.0 + draw.sign() * size, draw.whole(0, 2)

    def change(item: PlanObject) -> PlanObject:
        edges = tuple(edge * (by if k == way else 1.0) for k, edge in enumerate(item.size))
        return item.model_copy(update={"construction": item.construction.model_copy(update={"size": edges})})

    return _asked(sound, change)


@family((0.05, 0.1, 0.2, 0.4, 0.8), "of the range", ("planned",), seen=False, wrong=0.4)
def plan_colour(sound: Sound, size: float, draw: Draw) -> Faulty:
    """An object has another colour than planned."""

    def change(item: PlanObject) -> PlanObject:
        assert item.material is not None
        way = np.array(draw.direction())
        color = np.array(item.material.color)
        far = color + size * np.where(color + np.sign(way) * size > 1.0, -1.0, 1.0) * np.eye(3)[draw.whole(0, 2)]
        color = np.clip(far, 0.0, 1.0)
        return item.model_copy(update={"material": item.material.model_copy(update={"color": tuple(color.tolist())})})

    return _asked(sound, change)


@family((0.03, 0.1, 0.25, 0.5, 1.0), "of the body's size", ("planned",), seen=False, wrong=0.25)
def plan_place(sound: Sound, size: float, draw: Draw) -> Faulty:
    """An object starts elsewhere than planned."""
    x, y = draw.heading()

    def change(item: PlanObject) -> PlanObject:
        assert item.pose is not None
        far = size * max(item.size)
        a, b, c = item.pose.position
        return item.model_copy(
            update={"pose": item.pose.model_copy(update={"position": (a + far * x, b + far * y, c)})}
        )

    return _asked(sound, change)


@family((2.5, 5.0, 10.0, 20.0, 40.0), "deg", ("planned",), seen=False)
def plan_turn(sound: Sound, size: float, draw: Draw) -> Faulty:
    """An object starts turned otherwise than planned."""

    def change(item: PlanObject) -> PlanObject:
        assert item.pose is not None
        return item.model_copy(update={"pose": item.pose.model_copy(update={"rotation_deg": (0.0, 0.0, size)})})

    return _asked(sound, change)


@family((0.03, 0.1, 0.2, 0.4, 0.8), SHARE, ("planned",), seen=False)
def plan_velocity(sound: Sound, size: float, draw: Draw) -> Faulty:
    """An object starts faster or slower than planned; one that is planned to stand moves by a share of its size."""
    by = 1.0 + draw.sign() * size

    def change(item: PlanObject) -> PlanObject:
        x, y, z = item.velocity
        if x == 0.0:
            return item.model_copy(update={"velocity": (size * max(item.size), 0.0, 0.0)})
        return item.model_copy(update={"velocity": (by * x, y, z)})

    return _asked(sound, change)


@family((0.03, 0.1, 0.2, 0.4, 0.8), SHARE, ("planned",), seen=False)
def plan_friction(sound: Sound, size: float, draw: Draw) -> Faulty:
    """An object rubs more or less than planned."""
    by = 1.0 + size if draw.sign() > 0 else 1.0 / (1.0 + size)

    def change(item: PlanObject) -> PlanObject:
        assert item.material is not None
        less = item.material.model_copy(update={"friction": by * (item.material.friction or 0.5)})
        return item.model_copy(update={"material": less})

    return _asked(sound, change)


@family((0.01, 0.05, 0.1, 0.5, 1.0), "of the weight", ("planned",), seen=False)
def unplanned_drive(sound: Sound, size: float, draw: Draw) -> Faulty:
    """A rail with a motor, of a share of the weight, moves what the plan leaves alone."""
    mass = world_of(sound.stage).body("/World/block").mass

    def change(stage: Usd.Stage) -> None:
        _rail(stage)
        drive = UsdPhysics.DriveAPI.Apply(stage.GetPrimAtPath("/World/rail"), "linear")
        drive.CreateTypeAttr("force")
        drive.CreateTargetVelocityAttr(1.0)
        drive.CreateDampingAttr(10.0 * mass)
        drive.CreateMaxForceAttr(size * 9.81 * mass)

    return _built(sound, change)


@family((1.0,), "rails", ("planned",), seen=False, wrong=1.0)
def unplanned_joint(sound: Sound, size: float, draw: Draw) -> Faulty:
    """A rail guides what the plan leaves free."""
    return _built(sound, _rail)


def _rail(stage: Usd.Stage) -> None:
    rail = UsdPhysics.PrismaticJoint.Define(stage, "/World/rail")
    rail.CreateAxisAttr("X")
    rail.CreateBody1Rel().SetTargets(["/World/block"])
    place = UsdGeom.Xformable(stage.GetPrimAtPath("/World/block")).ComputeLocalToWorldTransform(Usd.TimeCode.Default())
    rail.CreateLocalPos0Attr(Gf.Vec3f(place.ExtractTranslation()))
    rail.CreateLocalPos1Attr(Gf.Vec3f(0.0))
    rail.CreateLocalRot0Attr(Gf.Quatf(1.0))
    rail.CreateLocalRot1Attr(Gf.Quatf(1.0))
    UsdPhysics.ArticulationRootAPI.Apply(rail.GetPrim())


@family((1.0,), "bodies", ("planned",), seen=False, wrong=1.0)
def unplanned_kinematic(sound: Sound, size: float, draw: Draw) -> Faulty:
    """What the plan leaves to the forces goes by its velocity, or hangs where it is."""

    def change(stage: Usd.Stage) -> None:
        UsdPhysics.RigidBodyAPI(stage.GetPrimAtPath("/World/block")).CreateKinematicEnabledAttr(True)

    return _built(sound, change)


@family((0.03, 0.1, 0.3, 0.6, 1.0), "of the body's size", ("planned",), seen=False)
def unplanned_collider(sound: Sound, size: float, draw: Draw) -> Faulty:
    """A body has a second, hidden shape that collides."""

    def change(stage: Usd.Stage) -> None:
        block = UsdGeom.Cube.Define(stage, "/World/block/hidden")
        edges = world_of(sound.stage).body("/World/block").shapes[0].size
        block.CreateSizeAttr(size * min(edges))
        block.AddTranslateOp().Set(Gf.Vec3d(0, 0.5 * edges[1] + 0.5 * size * min(edges), 0))
        UsdPhysics.CollisionAPI.Apply(block.GetPrim())
        outer = UsdShade.MaterialBindingAPI(stage.GetPrimAtPath("/World/block/geometry"))
        UsdShade.MaterialBindingAPI.Apply(block.GetPrim()).Bind(outer.ComputeBoundMaterial()[0])
        UsdGeom.Imageable(block).CreateVisibilityAttr("invisible")

    return _built(sound, change)
