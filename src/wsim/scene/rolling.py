"""The spin of what starts rolling: its lowest line or point stands still on what it rolls on."""

from __future__ import annotations

import math
from dataclasses import dataclass

from pxr import Gf

from wsim.scene.validate import Call, Vec3

_ACROSS = math.cos(math.radians(89.0))  # how far a velocity may lean towards the axis that it rolls about
_STEEPEST = math.cos(math.radians(85.0))


@dataclass(frozen=True)
class Round:
    """What can roll: its radius [m], and the axis that it can only roll about, in its own frame; None for a ball."""

    radius: float
    axis: str | None = None

    def spin(self, call: Call, velocity: Vec3, turn: Gf.Quatd) -> Vec3:
        """n x v / r [deg/s], in the world: v the start's velocity, n the normal of what it rolls on, r the radius.

        A ball is taken to roll on the level, or straight up or down a slope: n is as upright as v lets it be. What has
        an axis rolls across it, and n is square to both.

        Raises:
            SceneError: If that velocity is no rolling.
        """
        v = Gf.Vec3d(*velocity)
        speed = v.GetLength()
        if speed == 0.0:
            call.fail("rolling = True needs a velocity: what stands still has no spin")
        ahead = v / speed
        if self.axis is None:
            normal = Gf.Vec3d.ZAxis() - ahead * ahead[2]
        else:
            axis = turn.Transform(Gf.Vec3d(*(float(letter == self.axis) for letter in "XYZ")))
            if abs(Gf.Dot(axis, ahead)) > _ACROSS:
                call.fail(
                    f"rolling = True with velocity = {velocity}, not square to the {self.axis} axis that it rolls "
                    f"about, which points along {_shown(axis)}; give a velocity across that, or turn it"
                )
            normal = Gf.Cross(ahead, axis)
            normal *= math.copysign(1.0, normal[2])
        if normal.GetLength() < _STEEPEST or normal.GetNormalized()[2] < _STEEPEST:
            way = "" if self.axis is None or abs(ahead[2]) > 0.9 else f"; lay it down, its {self.axis} axis level"
            call.fail(f"rolling = True with velocity = {velocity} would roll on a wall{way}")
        spin = Gf.Cross(normal.GetNormalized(), v) * math.degrees(1.0 / self.radius)
        return call.spin(tuple(spin))


def _shown(vector: Gf.Vec3d) -> tuple[float, ...]:
    return tuple(round(float(x), 3) + 0.0 for x in vector)
