"""What acts along a robot's joint, noted on its prim, and written as a `PhysicsDriveAPI`."""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass, replace

from pxr import Usd, UsdPhysics

ROBOT = "wsim:robot"  # customData of a robot, of its links and joints


@dataclass(frozen=True)
class JointLaw:
    """Spring, damper and motor of a hinge or a slider, in rad or m, N m or N.

    UsdPhysics has one drive a joint: what the file's spring and damper give is part of it, whatever its motor does.
    """

    damping: float = 0.0
    spring: float = 0.0
    spring_zero: float = 0.0
    effort: float | None = None  # the most that its motor gives
    zero: float = 0.0  # the coordinate in the file's reference pose
    motor_stiffness: float = 0.0
    motor_damping: float = 0.0
    motor: bool = False  # the file has one: a servo of those gains, or an effort that is set where both are 0

    @classmethod
    def of(cls, prim: Usd.Prim) -> JointLaw:
        """As it is noted on a joint."""
        noted = prim.GetCustomDataByKey(ROBOT) or {}
        return cls(**{key: value for key, value in noted.items() if key in cls.__dataclass_fields__})

    def note(self, prim: Usd.Prim) -> None:
        """Write it on a joint."""
        prim.SetCustomDataByKey(ROBOT, {key: value for key, value in asdict(self).items() if value is not None})

    def tuned(self, stiffness: float, damping: float, effort: float | None) -> JointLaw:
        """The same with another servo."""
        return replace(self, motor_stiffness=stiffness, motor_damping=damping, effort=effort, motor=True)


def is_angular(prim: Usd.Prim) -> bool:
    """Whether a joint's numbers are angles, which USD has in degrees."""
    return bool(prim.IsA(UsdPhysics.RevoluteJoint))


def write_drive(prim: Usd.Prim, law: JointLaw, position: float, velocity: float = 0.0) -> None:
    """Author the drive of a joint whose servo goes for a position [rad or m] and a velocity; none if nothing acts."""
    freedom = "angular" if is_angular(prim) else "linear"
    stiffness, damping = law.spring + law.motor_stiffness, law.damping + law.motor_damping
    if stiffness == 0.0 and damping == 0.0:
        prim.RemoveAPI(UsdPhysics.DriveAPI, freedom)
        return
    target = (law.motor_stiffness * position + law.spring * law.spring_zero) / stiffness if stiffness else 0.0
    speed = law.motor_damping * velocity / damping if damping else 0.0
    unit = 180.0 / math.pi if is_angular(prim) else 1.0
    api = UsdPhysics.DriveAPI.Apply(prim, freedom)
    api.CreateTypeAttr("force")
    api.CreateTargetPositionAttr(target * unit)
    api.CreateTargetVelocityAttr(speed * unit)
    api.CreateStiffnessAttr(stiffness / unit)  # USD counts an angular drive's gains per degree
    api.CreateDampingAttr(damping / unit)
    bounded = law.effort is not None and (law.motor_stiffness or law.motor_damping)
    api.CreateMaxForceAttr(law.effort if bounded else math.inf)
