"""Where the weight of a pool lies: as high as its volume, and what displaces it, puts it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from wsim.geometry.rotations import rotate
from wsim.judge.checks.check import Check, Checks
from wsim.judge.evidence.containment import local, lone_pool

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsim.judge.evidence.evidence import Evidence
    from wsim.judge.verdict import Finding
    from wsim.scene.world import Container, Fluid

    Floats = NDArray[np.float64]

LAYERS = 40  # that the displaced volume is added up in
SPILLED = 0.001  # share of the particles, beyond which what is left in the tank is not a whole pool


@dataclass
class CheckFluidHeight(Check):
    """Twice the height of a pool's centre of mass is its level, less what bodies displace and waves lift.

    A wave holds as much energy in its height as in its motion (equipartition), so that waves of a mean square speed v^2
    lift the centre of mass by v^2 / 2 g.

    SPH water that comes to a dry wall stops short of it, by d. The floor so lifts the centre of mass by d, and the
    level that is told of it by 2 d; the walls around narrow the pool, and raise its level by d times its depth times
    their length over its area.
    """

    spacings: float = 0.1  # of the level
    skin: float = 0.25  # spacings that particles stand off a body's surface beyond their own half
    waves: float = 2.0  # times what waves of the recorded speed lift
    # Spacings that water stands off floor and walls which it came to dry (docs/sph.md), as seen by its centre of mass.
    dry: float = 0.5  # (found: 0.18 to 0.39, in drops, pours and a dam break, 0.75 to 6 spacings deep)

    def evaluate(self, evidence: Evidence) -> list[Finding]:
        """One finding for each fluid that is alone in an upright box, over the final window."""
        found: list[Finding] = []
        if evidence.gravity == 0.0 or len(evidence.world.fluids) > 1:
            return found
        for fluid in evidence.world.fluids:
            container = evidence.container_of(fluid)
            if container is None or not lone_pool(evidence.world, container, evidence.up):
                continue
            rows = self._within(evidence, container)
            if rows is not None:
                found += self._height(evidence, fluid, container, rows)
        return found

    @staticmethod
    def _within(evidence: Evidence, container: Container) -> list[int] | None:
        """The bodies in it; None where one reaches through a wall, or what it displaces is not told by its shape."""
        rows, half, motion = [], np.array(container.inner_size)[:2] / 2, evidence.motion
        rim = container.inner_center[2] + container.inner_size[2] / 2
        for i, body in enumerate(evidence.world.bodies):
            late = np.abs(local(container, motion.com[evidence.window, i])[:, :2])
            if (late > half + motion.radius[i]).any(axis=1).all() or evidence.ends(i)[0][evidence.window].min() > rim:
                continue
            position, rotation = evidence.resting_pose(i)
            points = np.concatenate([surface.vertices for surface in evidence.solid(i).surfaces])
            reach = np.abs(local(container, rotate(rotation, points) + position)[:, :2])
            if (reach > 1.001 * half).any() or len(body.shapes) > 1 or body.shapes[0].kind == "mesh":
                return None
            rows.append(i)
        return rows

    def _height(self, evidence: Evidence, fluid: Fluid, container: Container, rows: list[int]) -> list[Finding]:
        track = evidence.track(fluid)
        if track.present is not None:  # what still falls from a tap is not of the pool
            return []
        late = track.time >= evidence.window_start - 1e-9
        if evidence.outside(fluid)[late].max(initial=0.0) > SPILLED:
            return []
        level = evidence.level(fluid)
        depth, area = level.height - level.floor, container.inner_size[0] * container.inner_size[1]
        volume, moment, stands_off = area * depth, 0.5 * area * depth**2, 0.0
        heights = np.linspace(level.floor, level.height, LAYERS + 1)
        for i in rows:
            solid, (position, rotation) = evidence.solid(i), evidence.resting_pose(i)
            below = np.array([solid.volume_below(rotation, float(position[2]), float(z)) for z in heights])
            volume -= below[-1]
            moment -= float(np.trapezoid(below[-1] - below, heights))
            moved = float(np.ptp(evidence.body_q[evidence.window, i, 2]))
            skin = (1.0 + 2.0 * self.skin * fluid.spacing / solid.smallest) ** 3 - 1.0
            stands_off += below[-1] * (skin / area + 2.0 * moved / max(volume, 1e-12))
        points, velocity = track.position[late], track.velocity[late].astype(np.float64)
        seen = 2.0 * (float(points[..., 2].mean(dtype=np.float64)) - level.floor - moment / volume) + depth
        square = float(np.einsum("tni,tni->tn", velocity, velocity).mean())
        slack = self.spacings * fluid.spacing + self.waves * square / evidence.gravity + stands_off
        came = seen > depth and not self._filled(fluid, container)  # standing off, it is too high and never too low
        if came:
            slack += self.dry * fluid.spacing * (2.0 + depth * 2.0 * sum(container.inner_size[:2]) / area)
        return [
            self.measured(
                f"{fluid.prim} stands {seen:.4g} m high by its centre of mass, {depth:.4g} m by its volume",
                abs(seen - depth), slack, "m", prim=fluid.prim, time=evidence.window_start, expected=0.0,
                limit_from=f"{self.spacings:g} spacing, {self.waves:g} times what its waves lift (v^2 / g), and "
                f"{self.skin:g} spacing around bodies in it"
                + (f", and {self.dry:g} off walls that it came to dry" if came else ""),
            )
        ]  # fmt: skip

    @staticmethod
    def _filled(fluid: Fluid, container: Container) -> bool:
        """Whether it stood on the whole floor from the start, between all walls, to half a spacing."""
        low = np.array(fluid.center) - np.array(fluid.size) / 2 - container.inner_center
        high = np.array(fluid.center) + np.array(fluid.size) / 2 - container.inner_center
        half, near = np.array(container.inner_size) / 2, 0.5 * fluid.spacing
        return bool((low <= -half + near).all() and (high[:2] >= half[:2] - near).all())


CHECKS: Checks = (CheckFluidHeight,)
