"""The spin of what starts rolling: its lowest line or point stands still on what it rolls on."""

from __future__ import annotations

import math
from dataclasses import dataclass

from pxr import Gf, Usd

from wsim.scene.validate import Call, Vec3

_ACROSS = math.cos(math.radians(89.0))  # how far a velocity may lean towards the axis that it rolls about
_STEEPEST = math.cos(math.radians(85.0))


@dataclass(frozen=True)
class Round:
    """What can roll: its radius [m], and the axis that it can only roll about, in its own frame; None for a ball."""

    radius: float
    axis: str | None = None

    def spin(self, call: Call, velocity: Vec3, turn: Gf.Quatd, up: Gf.Vec3d) -> Vec3:
        """n x v / r [deg/s], in the world: v the start's velocity, n the normal of what it rolls on, r the radius.

        A ball is taken to roll on the level, or straight up or down a slope: n is as upright as v lets it be, against
        gravity, along the unit vector `up`. What has an axis rolls across it, and n is square to both.

        Raises:
            SceneError: If that velocity is no rolling.
        """
        v = Gf.Vec3d(*velocity)
        speed = v.GetLength()
        if speed == 0.0:
            call.fail("rolling = True needs a velocity: what stands still has no spin")
        ahead = v / speed
        if self.axis is None:
            normal = up - ahead * Gf.Dot(ahead, up)
        else:
            axis = turn.Transform(Gf.Vec3d(*(float(letter == self.axis) for letter in "XYZ")))
            if abs(Gf.Dot(axis, ahead)) > _ACROSS:
                call.fail(
                    f"rolling = True with velocity = {velocity}, not square to the {self.axis} axis that it rolls "
                    f"about, which points along {_shown(axis)}; give a velocity across that, or turn it"
                )
            normal = Gf.Cross(ahead, axis)
            normal *= math.copysign(1.0, Gf.Dot(normal, up))
        if normal.GetLength() < _STEEPEST or Gf.Dot(normal.GetNormalized(), up) < _STEEPEST:
            laid = (
                ""
                if self.axis is None or abs(Gf.Dot(ahead, up)) > 0.9
                else f"; lay it down, its {self.axis} axis level"
            )
            call.fail(
                f"rolling = True with velocity = {velocity} would roll on a wall{laid}; up, against the gravity stated "
                f"so far, is {_shown(up)}"
            )
        spin = Gf.Cross(normal.GetNormalized(), v) * math.degrees(1.0 / self.radius)
        return call.spin(tuple(spin))


@dataclass(frozen=True)
class RollingStart:
    """A body that starts rolling, whose spin hangs on which way is up."""

    call: Call
    prim: Usd.Prim
    rolls: Round
    velocity: Vec3
    turn: Gf.Quatd

    def spin(self, up: Gf.Vec3d) -> Gf.Vec3f:
        """What UsdPhysics states of it, in the body's own axes [deg/s]; raises as `Round.spin`."""
        spin = self.rolls.spin(self.call, self.velocity, self.turn, up)
        return Gf.Vec3f(self.turn.GetInverse().Transform(Gf.Vec3d(*spin)))


def _shown(vector: Gf.Vec3d) -> tuple[float, ...]:
    return tuple(round(float(x), 3) + 0.0 for x in vector)
