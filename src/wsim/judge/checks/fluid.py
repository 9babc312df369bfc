"""Checks of fluids: of the plan's density and level, all of it there, and pressing at rest as deep water does."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from wsim.defaults import FLUID_VISCOSITY
from wsim.geometry.shapes import into, kind_of
from wsim.judge.checks.check import Check, Checks, listed, share_about
from wsim.judge.verdict import RepairTarget
from wsim.scene.contact import within

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsim.judge.evidence.evidence import Evidence
    from wsim.judge.verdict import Finding
    from wsim.plan.schema import PlanObject
    from wsim.scene.world import Fluid, Shape

    Floats = NDArray[np.float64]


MOST_PLACES = 200_000  # at which a fluid's box is looked at


def _beside(shape: Shape, middle: Floats, reach: float) -> bool:
    """Whether no point of a shape is within a reach of a place [m]."""
    return math.dist(shape.position, middle) > reach + kind_of(shape).radius_about


@dataclass
class CheckFluidMass(Check):
    """The recording has as many particles as fill the fluid's box, less what bodies take up of it."""

    share: float = 0.05  # of the particles: those at a body's faces may count or not

    def evaluate(self, evidence: Evidence) -> list[Finding]:
        """One finding for each fluid: its mass [kg]."""
        return [self._mass(evidence, fluid) for fluid in evidence.world.fluids]

    def _mass(self, evidence: Evidence, fluid: Fluid) -> Finding:
        track = evidence.track(fluid)
        count = int(track.count[0]) if len(track.time) else 0
        volume = fluid.amount
        inside = sum(self._drowned(evidence, fluid, i) for i in range(len(evidence.world.bodies)))
        still, about = self._standing(evidence, fluid)
        value = fluid.density * fluid.cell * count
        expected = fluid.density * max(volume - inside - still, 0.0)
        # A body pushes out the particles whose centres are in it or near: up to a layer of half a spacing all round.
        skin = about - still + sum(self._skin(evidence, fluid, i) for i in range(len(evidence.world.bodies)))
        low, high = share_about(expected, self.share)
        target = RepairTarget(kind="fluid", prim=fluid.prim, parameter="spacing", direction="change")
        return self.between(
            f"{fluid.prim} has {value:.4g} kg in {count} particles; its box holds {expected:.4g} kg",
            value, (low - fluid.density * skin, high), "kg", expected=expected, prim=fluid.prim, time=0.0,
            limit_from=f"density times volume, to {self.share:g}, and a layer at what stands in it",
            target=target,
        )  # fmt: skip

    @staticmethod
    def _standing(evidence: Evidence, fluid: Fluid) -> tuple[float, float]:
        """How much of the fluid's box what stands still takes up, and with half a spacing around it [m^3]."""
        if fluid.volume is not None:  # a vessel's hollow is its own, and not the box
            return 0.0, 0.0
        size, middle = np.array(fluid.size), np.array(fluid.center)
        edge = max(0.5 * fluid.spacing, float((size.prod() / MOST_PLACES) ** (1.0 / 3.0)))
        counts = np.maximum(np.round(size / edge), 1).astype(int)
        axes = [((np.arange(n) + 0.5) / n - 0.5) * length for n, length in zip(counts, size, strict=True)]
        places = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3) + middle
        depth = np.full(len(places), -np.inf)
        for shape in (shape for static in evidence.world.statics for shape in static.shapes if shape.collides):
            reach = 0.5 * float(np.linalg.norm(size)) + fluid.spacing
            own = fluid.container is not None and within(shape.prim, fluid.container)  # it ends at its tank's walls
            if own or (shape.kind != "plane" and _beside(shape, middle, reach)):
                continue
            depth = np.maximum(depth, kind_of(shape).depth(into(shape, places)))
        cell = float(size.prod()) / len(places)
        return cell * float((depth > 0.0).sum()), cell * float((depth > -0.5 * fluid.spacing).sum())

    @staticmethod
    def _drowned(evidence: Evidence, fluid: Fluid, i: int) -> float:
        """The volume of body i that is in the fluid's box at the start, if it is over it [m^3]."""
        q = evidence.body_q[0, i]
        if evidence.world.bodies[i].prim == fluid.container:
            return 0.0
        if np.any(np.abs(q[:2] - np.array(fluid.center[:2])) > np.array(fluid.size[:2]) / 2):
            return 0.0
        low, high = fluid.center[2] - fluid.size[2] / 2, fluid.center[2] + fluid.size[2] / 2
        solid = evidence.solid(i)
        return solid.volume_below(q[3:], float(q[2]), high) - solid.volume_below(q[3:], float(q[2]), low)

    @classmethod
    def _skin(cls, evidence: Evidence, fluid: Fluid, i: int) -> float:
        drowned = cls._drowned(evidence, fluid, i)
        return drowned * ((1.0 + fluid.spacing / evidence.solid(i).smallest) ** 3 - 1.0)


@dataclass
class CheckPlanFluid(Check):
    """Each fluid has the plan's density, viscosity and velocity, and stands where the plan has its free surface."""

    share: float = 0.05  # of the density
    spacings: float = 0.5  # of the level: half of what the particles resolve

    def evaluate(self, evidence: Evidence) -> list[Finding]:
        """One finding for each fluid that differs, or one for none; nothing where a parameter was changed."""
        if evidence.plan is None or evidence.varied:
            return []
        fluids = {fluid.prim: fluid for fluid in evidence.world.fluids}
        pairs = [(item, fluids.get(evidence.prim(item.name))) for item in evidence.plan.objects]
        known = [(item, fluid) for item, fluid in pairs if item.primitive == "fluid" and fluid is not None]
        found: list[Finding] = []
        for item, fluid in known:
            found += [*self._density(fluid, item), *self._viscosity(fluid, item), *self._level(evidence, fluid, item)]
            found += [*self._block(fluid, item), *self._velocity(fluid, item), *self._vessel(evidence, fluid, item)]
            found += self._law(fluid, item)
        return found or ([self.passed("Fluids are of the plan's density, viscosity and level")] if known else [])

    def _viscosity(self, fluid: Fluid, item: PlanObject) -> list[Finding]:
        planned = item.registration.viscosity
        if planned is None and (item.material is None or "water" in item.material.name):
            planned = FLUID_VISCOSITY
        if planned is None or abs(fluid.viscosity - planned) <= max(self.share * planned, 1e-9):
            return []
        target = RepairTarget(kind="fluid", prim=fluid.prim, parameter="viscosity", suggested=planned, unit="Pa s")
        return [
            self.between(
                f"{fluid.prim} has a viscosity of {fluid.viscosity:.4g} Pa s; the plan has {planned:.4g} Pa s",
                fluid.viscosity, share_about(planned, self.share), "Pa s", expected=planned, prim=fluid.prim, time=0.0,
                limit_from=f"the plan's, or water's where it has none, to {self.share:.0%}", target=target
            )
        ]  # fmt: skip

    def _law(self, fluid: Fluid, item: PlanObject) -> list[Finding]:
        """What yields or thins does so as the plan has it."""
        found = []
        for name, unit in (("yield_stress", "Pa"), ("flow_index", "1")):
            planned, own = getattr(item.registration, name), getattr(fluid, name)
            if planned is None or abs(own - planned) <= max(self.share * planned, 1e-9):
                continue
            target = RepairTarget(kind="fluid", prim=fluid.prim, parameter=name, suggested=planned, unit=unit)
            words = name.replace("_", " ")
            found.append(
                self.between(
                    f"{fluid.prim} has a {words} of {own:.4g} {unit}; the plan has {planned:.4g} {unit}",
                    own, share_about(planned, self.share), unit, expected=planned, prim=fluid.prim, time=0.0,
                    limit_from=f"the plan's, to {self.share:.0%}", target=target,
                )
            )  # fmt: skip
        return found

    def _block(self, fluid: Fluid, item: PlanObject) -> list[Finding]:
        """What stands as a block of its own is as large and where the plan has it."""
        if not item.size or item.pose is None:
            return []
        off = max(
            abs(a - b) for a, b in zip((*fluid.size, *fluid.center), (*item.size, *item.pose.position), strict=True)
        )
        limit = max(fluid.spacing, self.share * max(item.size))
        if off <= limit:
            return []
        target = RepairTarget(
            kind="fluid", prim=fluid.prim, parameter="size, position", direction="change", unit="m",
            vector=(*item.size, *item.pose.position),
        )  # fmt: skip
        return [
            self.measured(
                f"{fluid.prim} stands as a block of {listed(fluid.size)} m at {listed(fluid.center)} m; the plan has "
                f"{listed(item.size)} m at {listed(item.pose.position)} m",
                off, limit, "m", expected=0.0, prim=fluid.prim, time=0.0,
                limit_from=f"a particle spacing, or {self.share:.0%} of its longest edge", target=target,
            )
        ]  # fmt: skip

    def _velocity(self, fluid: Fluid, item: PlanObject) -> list[Finding]:
        off, limit = math.dist(fluid.velocity, item.velocity), self.share * math.hypot(*item.velocity)
        if off <= limit:
            return []
        target = RepairTarget(
            kind="fluid", prim=fluid.prim, parameter="velocity", direction="change", unit="m/s",
            suggested=math.hypot(*item.velocity), vector=item.velocity,
        )  # fmt: skip
        return [
            self.measured(
                f"{fluid.prim} starts at {listed(fluid.velocity)} m/s; the plan has {listed(item.velocity)} m/s",
                off, limit, "m/s", expected=0.0, prim=fluid.prim, time=0.0,
                limit_from=f"{self.share:.0%} of the plan's speed", target=target,
            )
        ]  # fmt: skip

    def _density(self, fluid: Fluid, item: PlanObject) -> list[Finding]:
        planned = item.density
        if planned is None or abs(fluid.density / planned - 1.0) <= self.share:
            return []
        target = RepairTarget(kind="fluid", prim=fluid.prim, parameter="density", suggested=planned, unit="kg/m^3")
        return [
            self.between(
                f"{fluid.prim} has a density of {fluid.density:.4g} kg/m^3; the plan has {planned:.4g} kg/m^3",
                fluid.density, share_about(planned, self.share), "kg/m^3", expected=planned, prim=fluid.prim, time=0.0,
                limit_from=f"the plan's material, to {self.share:.0%}", target=target
            )
        ]  # fmt: skip

    def _vessel(self, evidence: Evidence, fluid: Fluid, item: PlanObject) -> list[Finding]:
        """It is in what the plan has it in, and as much of it as the plan says."""
        row, volume = item.relation("PLACE-IN"), item.registration.volume
        found = []
        prim = evidence.prim(row.ref) if row is not None and row.ref is not None else None
        if prim is not None and not f"{fluid.container}/".startswith(f"{prim}/"):  # of an asset the body that is hollow
            target = RepairTarget(kind="program", prim=fluid.prim, parameter="fills", why="the plan's")
            message = f"{fluid.prim} is in {fluid.container or 'no vessel'}; the plan has it in {prim}"
            found.append(self.failed(message, prim=fluid.prim, target=target))
        if volume is not None and abs(fluid.amount / volume - 1.0) > self.share:
            target = RepairTarget(kind="fluid", prim=fluid.prim, parameter="volume", suggested=volume, unit="m^3")
            found.append(
                self.between(
                    f"{fluid.prim} is {fluid.amount:.4g} m^3; the plan has {volume:.4g} m^3",
                    fluid.amount, share_about(volume, self.share), "m^3", expected=volume, prim=fluid.prim, time=0.0,
                    limit_from=f"the plan's volume, to {self.share:.0%}", target=target,
                )
            )  # fmt: skip
        return found

    def _level(self, evidence: Evidence, fluid: Fluid, item: PlanObject) -> list[Finding]:
        row, container = item.relation("FREE-SURFACE-AT"), evidence.container_of(fluid)
        if row is None or row.value is None or (container is None and fluid.volume is None):
            return []
        level = fluid.size[2]  # of a vessel the box's floor is the lowest point of its hollow
        if container is not None:
            floor = container.inner_center[2] - container.inner_size[2] / 2
            level = fluid.center[2] + fluid.size[2] / 2 - floor
        if abs(level - row.value) <= self.spacings * fluid.spacing:
            return []
        off = self.spacings * fluid.spacing
        target = RepairTarget(kind="fluid", prim=fluid.prim, parameter="level", suggested=row.value, unit="m")
        return [
            self.between(
                f"{fluid.prim} is filled to {level:.4g} m above the floor of {fluid.container}; "
                f"the plan has {row.value:.4g} m",
                level, (row.value - off, row.value + off), "m", expected=row.value, prim=fluid.prim, time=0.0,
                limit_from=f"the plan's level, to {self.spacings:g} particle spacings", target=target
            )
        ]  # fmt: skip


@dataclass
class CheckHydrostatic(Check):
    """In a fluid at rest the pressure grows with depth as rho g; it is read from the density, p = c^2 (rho - rho0)."""

    share: float = 0.2  # of rho g
    still: float = 0.1  # of sqrt(g H): slower (rms) is at rest
    layers: float = 4.0  # of particles, fewer of which have no slope worth the name
    frames: int = 10  # of the final window

    def evaluate(self, evidence: Evidence) -> list[Finding]:
        """One finding for each fluid that is at rest in a container over the final window: the slope [Pa/m]."""
        found = []
        for fluid in evidence.world.fluids:
            sound = evidence.sound(fluid)
            track = evidence.track(fluid)
            if sound <= 0.0 or track.density.size == 0 or evidence.gravity <= 0.0:
                continue
            frames = np.flatnonzero(track.time >= evidence.window_start - 1e-9)
            frames = np.unique(frames[np.linspace(0, len(frames) - 1, min(self.frames, len(frames))).astype(int)])
            slope = self._slope(evidence, fluid, sound, frames)
            if slope is not None:
                found.append(self._finding(evidence, fluid, slope))
        return found

    def _slope(self, evidence: Evidence, fluid: Fluid, sound: float, frames: NDArray[np.intp]) -> float | None:
        """The pressure's growth with depth [Pa/m]; None where the fluid moves, or is shallow or nowhere at rest."""
        track, container = evidence.track(fluid), evidence.container_of(fluid)
        if container is None or not len(frames):
            return None
        level = evidence.level(fluid)
        height = level.height - level.bottom
        speed = math.sqrt(float(track.mean(np.einsum("tni,tni->tn", track.velocity, track.velocity))[frames].mean()))
        if height < self.layers * fluid.spacing or speed > self.still * evidence.velocity_scale(height):
            return None
        depth = level.height - np.asarray(track.position[frames, :, 2], dtype=np.float64)
        pressure = sound**2 * (np.asarray(track.density[frames], dtype=np.float64) - fluid.density)
        # Away from the surface, where a particle's density is cut off at nothing, and what has left the container.
        used = (depth > fluid.spacing) & (depth < height)
        if int(used.sum()) < 10:
            return None
        return float(np.polyfit(depth[used], pressure[used], 1)[0])

    def _finding(self, evidence: Evidence, fluid: Fluid, slope: float) -> Finding:
        expected = fluid.density * evidence.gravity
        target = RepairTarget(
            kind="fluid", prim=fluid.prim, parameter="speed_of_sound", direction="raise",
            why="its pressure does not carry its weight",
        )  # fmt: skip
        return self.between(
            f"{fluid.prim}: its pressure grows by {slope:.4g} Pa a metre of depth at rest; rho g is {expected:.4g}",
            slope, share_about(expected, self.share), "Pa/m", expected=expected, prim=fluid.prim,
            time=evidence.window_start, limit_from=f"{self.share:g} of rho g", target=target,
        )  # fmt: skip


CHECKS: Checks = (CheckPlanFluid, CheckFluidMass, CheckHydrostatic)
