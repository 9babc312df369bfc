"""Checks that hold for any world: energy bounds speeds, solids keep out of each other, fluid stays fluid."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from wsim.geometry.rotations import UP, lengths, rotate
from wsim.geometry.shapes import reach
from wsim.judge.books.driven import given_within
from wsim.judge.checks.check import Check, Checks
from wsim.judge.checks.deepest import Deepest, deepest_of, held_through
from wsim.judge.evidence.carriers import surface_speed
from wsim.judge.evidence.contact import given_way, overlaps
from wsim.judge.evidence.recorded import MissingError
from wsim.judge.evidence.squeezed import squeezed_speed
from wsim.judge.repair.lasting import leak
from wsim.judge.repair.place import overlapping_start
from wsim.judge.repair.rule import faster_sound, finer, shorter_step, sound_speed

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsim.judge.evidence.contact import Overlap
    from wsim.judge.evidence.evidence import Evidence
    from wsim.judge.verdict import Finding, RepairTarget
    from wsim.scene.world import Fluid, Shape

    Floats = NDArray[np.float64]

SOUND_OVER_SPEED = 10.0  # Monaghan (1994): density varies by about (v / c)^2, which is then 1 %


@dataclass
class CheckExplosion(Check):
    """Nothing moves faster than the energy that was there can make it."""

    body_factor: float = 2.0  # a light body that a heavy one hits leaves at up to twice its speed
    fluid_factor: float = 3.0  # a splash's jet is thinner, and faster, than what raised it
    least: float = 0.1  # no bound is below this [m/s]: a world where nothing can fall may still settle

    def evaluate(self, evidence: Evidence) -> list[Finding]:
        """The fastest body and the fastest particle of each fluid."""
        free = self._free_speed(evidence)
        found = []
        # What a kinematic body or a drive gives whose effort nobody states has no bound.
        led = any(body.kinematic for body in evidence.world.bodies)
        led |= any(joint.drive is not None and not joint.drive.told for joint in evidence.world.joints)
        if evidence.world.bodies and not led:
            found.append(self._bodies(evidence, free))
        for fluid in evidence.world.fluids:
            found.append(self._fluid(evidence, fluid, free))
        return found

    def _free_speed(self, evidence: Evidence) -> float:
        """sqrt(v0^2 + 2 g dz): the fastest point of a body at the start after the longest fall there is [m/s]."""
        world = evidence.world
        tops = [float(evidence.ends(i)[1][0]) for i in range(len(world.bodies))]
        up = evidence.up
        tops += [float(np.array(fluid.center) @ up + np.array(fluid.size) @ np.abs(up) / 2) for fluid in world.fluids]
        tops += [float(np.array(tap.position) @ up) for tap in world.taps]
        lowest = lows(evidence)
        bottoms = [float(evidence.ends(i)[0][0]) for i in range(len(world.bodies))]
        # Nothing to land on, or not for what hangs under it: particles fall for as long as the run lasts.
        if min(lowest, default=math.inf) > min(bottoms, default=math.inf) or not lowest:
            lowest = [float(np.nanmin(evidence.track(fluid).position @ up)) for fluid in world.fluids]
        lowest += [float(evidence.ends(i)[0].min()) for i in range(len(world.bodies))]
        fall = max(0.0, max(tops, default=0.0) - min(lowest, default=0.0))
        # What spins may hand on the speed of its rim: a joint there, or the ground, makes it another's.
        speeds = [(math.hypot(*body.velocity), math.hypot(*body.angular_velocity)) for body in world.bodies]
        rims = zip(speeds, evidence.motion.radius, strict=True)
        started = [math.hypot(*fluid.velocity) for fluid in world.fluids] + [tap.speed for tap in world.taps]
        start = max((*started, *(float(speed + spin * radius) for (speed, spin), radius in rims)), default=0.0)
        return math.sqrt(max(start, surface_speed(evidence)) ** 2 + 2 * evidence.gravity * fall)

    def _bodies(self, evidence: Evidence, free: float) -> Finding:
        motion, reported = evidence.motion, evidence.motion.speed
        moved = np.zeros_like(reported)
        moved[1:] = lengths(np.diff(motion.q[..., :3], axis=0)) / motion.h[:, None]
        # Where the origin is not the centre of mass, it also turns about it: that is not speed of the body.
        moved -= motion.rate * lengths(motion.arms)
        fastest = np.maximum(reported, moved)
        factor = self._handed_on(evidence)
        bound = np.sqrt(np.maximum(factor * free, self.least) ** 2 + self._driven(evidence))
        frame, i = np.unravel_index(int(np.argmax(fastest / bound)), fastest.shape)
        body = evidence.world.bodies[i]
        value, limit, time = float(fastest[frame, i]), float(bound[frame, i]), float(evidence.time[frame])
        how = "jumps at" if moved[frame, i] > reported[frame, i] and value > limit else "reaches"
        return self.measured(
            f"{body.prim} {how} {value:.3g} m/s at {time:.3f} s, the fastest for what moves it",
            value, limit, "m/s", prim=body.prim, time=self._first(evidence.time, fastest[:, i] > bound[:, i], time),
            limit_from=f"{factor[i]:.3g} sqrt(v0^2 + 2 g dz): the longest fall in the scene, then an elastic hit "
            "by a far heavier body, or all that its mechanism has in this body alone, and the work of drives, with "
            "what they held a frame before, control and springs",
        )  # fmt: skip

    def _handed_on(self, evidence: Evidence) -> Floats:
        """How many times the speed of a fall each body may get of others, (B,).

        What a far heavier one hits leaves with twice its speed, with thrice where both fell: a ball on a ball that
        bounces first goes up at 3 v (Harter, American Journal of Physics 39, 1971). What hangs together may pass all of
        its energy to a light link, as a whip does: of a mass m of M that falls at v, v sqrt(M / m).
        """
        motion = evidence.motion
        loose = int((~motion.kinematic & ~motion.jointed).sum())
        bouncy = any(shape.restitution for body in evidence.world.bodies for shape in body.shapes)
        factor = self.body_factor + 1.0 if loose > 1 and bouncy else self.body_factor
        together = (motion.unit[:, None] == motion.unit) @ np.where(motion.kinematic, 0.0, motion.mass)
        whipped = np.sqrt(together / motion.mass)
        return np.where(motion.jointed, np.maximum(factor, whipped), factor)

    @staticmethod
    def _driven(evidence: Evidence) -> Floats:
        """The square of the speed that drives, springs, control and fluid may have given, (T, B) [m^2/s^2]."""
        applied, motion = evidence.motion.applied_work, evidence.motion
        work = np.zeros(motion.speed.shape) if applied is None else applied.copy()
        drives = evidence.recording.scalars.get("work/drives")
        if drives is not None:
            work[:, motion.jointed] += np.nancumsum(drives)[:, None]
        elif any(joint.drive for joint in evidence.world.joints):
            work[:, motion.jointed] = np.inf  # what they gave is not known
        # What springs hold at the start may end in any of the bodies that they move.
        work[:, motion.jointed] += motion.elastic[0].sum()
        most = np.maximum.accumulate(work, axis=0)
        # A stiff one gives all that it holds within a frame, and has damped it at the end.
        within = most[:-1] + np.where(motion.jointed, given_within(evidence)[:, None], 0.0)
        most[1:] = np.maximum(most[1:], within)
        return np.asarray(2.0 * np.maximum(most, 0.0) / motion.mass)

    def _fluid(self, evidence: Evidence, fluid: Fluid, free: float) -> Finding:
        track = evidence.track(fluid)
        sound = evidence.sound(fluid) or math.inf
        limit = min(max(self.fluid_factor * free, squeezed_speed(evidence, fluid, free), self.least), sound)
        square = np.nan_to_num(np.einsum("tni,tni->tn", track.velocity, track.velocity))
        # What is under everything solid has left the world, and falls on and on: that is a leak, and counted as one.
        floor = min(lows(evidence), default=-math.inf) - fluid.spacing
        fastest = np.sqrt(np.where(track.position @ evidence.up < floor, 0.0, square).max(axis=1))
        frame = int(np.argmax(fastest))
        value, time = float(fastest[frame]), float(track.time[frame])
        return self.measured(
            f"{fluid.prim}: its fastest particle has {value:.3g} m/s, at {time:.3f} s",
            value, limit, "m/s", prim=fluid.prim, time=self._first(track.time, fastest > limit, time),
            limit_from=f"{self.fluid_factor:g} sqrt(v0^2 + 2 g dz), or what a body that lands drives out over its rim, "
            "v A / P h, h a quarter of a spacing; at most the speed of sound, beyond which it is none",
        )  # fmt: skip

    @staticmethod
    def _first(time: Floats, wrong: NDArray[np.bool_], otherwise: float) -> float:
        return float(time[np.argmax(wrong)]) if wrong.any() else otherwise

    def repair(self, finding: Finding, evidence: Evidence) -> RepairTarget:
        """A start inside another shape is pushed apart; sound must outrun a fluid; else the step is too long."""
        fluid = next((fluid for fluid in evidence.world.fluids if fluid.prim == finding.prim), None)
        if fluid is not None:
            sound = sound_speed(evidence, fluid)
            if sound and finding.limit is not None and finding.limit >= sound * (1 - 1e-9):
                return faster_sound(
                    evidence,
                    fluid,
                    SOUND_OVER_SPEED * (finding.value or sound),
                    "sound must be ten times as fast as the fluid",
                )
            return shorter_step(
                evidence,
                0.5,
                "particles that outrun gravity were thrown by the solver; half the step is the first to try",
            )
        start = overlapping_start(evidence, finding.prim)
        if start is not None:
            return start
        return shorter_step(
            evidence,
            0.5,
            "no fall in this scene gives that speed: the solver made it; half the step is the first to try",
        )


def lows(evidence: Evidence) -> list[float]:
    """Height of the lowest point of each static shape [m]; none where a plane goes down without end."""
    found = [_lowest(shape, evidence.up) for static in evidence.world.statics for shape in static.shapes]
    return found if all(math.isfinite(low) for low in found) else []


def _lowest(shape: Shape, up: Floats) -> float:
    """Height of a static shape's lowest point; a level plane's own height [m]."""
    if shape.kind == "plane":
        tilted = abs(rotate(np.array(shape.rotation, dtype=np.float64), UP) @ up) < 1.0 - 1e-6
        return -math.inf if tilted else float(np.array(shape.position) @ up)
    low, _ = reach(shape, np.array([[0.0, 0.0, 0.0, 1.0]]), up)
    return float(low[0])


@dataclass
class CheckPenetration(Check):
    """Solids are not in each other: not deeply at any time, not slightly for long."""

    lasting: float = 0.05  # of the body's smallest extent, for longer than `seconds`
    brief: float = 0.2  # at any frame
    seconds: float = 0.1

    def evaluate(self, evidence: Evidence) -> list[Finding]:
        """The worst pair by its poses, and the solver's own deepest contact if it is recorded."""
        if not evidence.world.bodies:
            return []
        pairs = overlaps(evidence)
        found = [self.passed("No body is in another, or in a static object")]
        if pairs:
            sizes, gives = zip(*(_of_pair(evidence, pair) for pair in pairs), strict=True)
            deep, shares = np.array([pair.depth for pair in pairs]), (self.lasting, self.brief)
            n = deepest_of(deep, np.array(sizes), np.array(gives), shares, self._frames(evidence))
            worst, pair = self._deepest(evidence, pairs[n].depth, sizes[n], gives[n]), pairs[n]
            found = [self._finding(worst, f"{pair.a.owner} in {pair.b.owner}", pair.a.owner)]
        depth = evidence.recording.scalars.get("contact/penetration")
        if depth is not None:
            # Of the bodies that ever had a contact: the solver does not say whose is the deepest.
            touched = np.flatnonzero(evidence.motion.touched.any(axis=0))
            rows = touched if len(touched) else range(len(evidence.world.bodies))
            smallest = min(evidence.solid(int(i)).smallest for i in rows)
            deepest = self._deepest(evidence, np.nan_to_num(depth, nan=0.0), smallest, np.zeros(len(depth)))
            found.append(self._finding(deepest, "the solver's contacts", None))
        return found

    def _frames(self, evidence: Evidence) -> int:
        """How many are longer than a moment."""
        return max(1, math.ceil(self.seconds / evidence.motion.dt_frames)) + 1

    def _deepest(self, evidence: Evidence, depth: Floats, size: float, give: Floats) -> Deepest:
        """By how much a depth (T,) is most, for long or for a moment, beside what soft contacts `give` (T,)."""
        depth = depth - give
        held = held_through(depth, self._frames(evidence))
        lasting, brief = (float(each.max()) for each in (held, depth))
        lasts = lasting / self.lasting > brief / self.brief
        at = int(np.argmax(held if lasts else depth))
        (value, most), soft = (lasting, self.lasting) if lasts else (brief, self.brief), float(give[at])
        return Deepest(value + soft, most * size + soft, float(evidence.time[at]), lasts, size, soft)

    def _finding(self, of: Deepest, what: str, prim: str | None) -> Finding:
        if of.lasts:
            span, source = f"for {self.seconds:g} s or longer", f"{self.lasting:g} of the smallest extent"
        else:
            span, source = "for a moment", f"{self.brief:g} of the smallest extent"
        source += f", {of.size:.3g} m{'' if of.lasts else ', at any time'}"
        if of.soft:
            source += f", and {of.soft:.2g} m that soft contacts yield"
        return self.measured(
            f"Deepest penetration, {what}: {max(of.value, 0.0) * 1e3:.2g} mm {span}, at {of.time:.3f} s",
            of.value, of.limit, "m", prim=prim, time=of.time, limit_from=source,
        )  # fmt: skip

    def repair(self, finding: Finding, evidence: Evidence) -> RepairTarget:
        """A start inside another shape, or a contact that gives way: its depth is speed times step."""
        start = overlapping_start(evidence, finding.prim)
        if start is not None:
            return start
        value, limit = finding.value or 0.0, finding.limit or 0.0
        share = limit / value if 0.0 < limit < value else 0.5
        return shorter_step(
            evidence, share, "a contact gives way by speed times step, so that depth shrinks with the step"
        )


def _of_pair(evidence: Evidence, pair: Overlap) -> tuple[float, Floats]:
    """The smallest extent of two shapes, of those that move [m], and how deep soft contacts let them in, (T,) [m]."""
    size = min(shape.kind.thinnest for shape in (pair.a, pair.b) if shape.body >= 0)
    return size, given_way(evidence, [pair.a.body, pair.b.body])


@dataclass
class CheckFluidContained(Check):
    """The fluid stays in its container: not through the walls, not through the floor, hardly over the rim."""

    share: float = 0.01  # of the particles

    def evaluate(self, evidence: Evidence) -> list[Finding]:
        """The largest share outside, for each fluid that has a container."""
        return [contained(self, evidence, fluid, self.share) for fluid in evidence.world.fluids if fluid.container]

    def repair(self, finding: Finding, evidence: Evidence) -> RepairTarget:
        """Over the rim, or through a wall."""
        return leak(finding, evidence)


def contained(check: Check, evidence: Evidence, fluid: Fluid, share: float) -> Finding:
    """A finding about the largest share of a fluid's particles outside its container at any time."""
    if evidence.container_of(fluid) is None and fluid.volume is None:
        raise MissingError(f"{fluid.prim} has no container in the world: {fluid.container}")
    outside = evidence.outside(fluid)
    times = evidence.track(fluid).time
    value = float(outside.max())
    time = float(times[np.argmax(outside > share)] if value > share else times[np.argmax(outside)])
    return check.measured(
        f"{value:.2%} of {fluid.prim} is outside {fluid.container}",
        value, share, "share of particles", prim=fluid.prim, time=time, expected=0.0,
        limit_from=f"{share:g} of the particles, farther out than a spacing of {fluid.spacing:g} m",
    )  # fmt: skip


@dataclass
class CheckDensity(Check):
    """The fluid keeps its density: a weakly compressible solver that does not is not simulating a liquid."""

    mean: float = 0.02  # mean error of the particles' densities
    percentile: float = 0.06  # error that 99 % of them keep to
    times: float = 0.95  # at this share of the frames: an impact may compress the fluid for a moment

    def evaluate(self, evidence: Evidence) -> list[Finding]:
        """Mean and 99th percentile of the relative error, for each fluid."""
        found = []
        for fluid in evidence.world.fluids:
            track = evidence.track(fluid)
            if track.density.shape[:1] != track.position.shape[:1] or track.density.size == 0:
                found += self._from_scalars(evidence, fluid)
                continue
            error = np.abs(track.density / fluid.density - 1.0)
            tail = track.percentile(error, 0.99)
            found.append(self._held(fluid, track.mean(error), track.time, self.mean, "mean density error"))
            found.append(self._held(fluid, tail, track.time, self.percentile, "99th percentile of the density error"))
        return found

    def _from_scalars(self, evidence: Evidence, fluid: Fluid) -> list[Finding]:
        values = evidence.recording.scalars.get("fluid/density_error_mean")
        if values is None:
            message = f"{fluid.prim}: its density is not in the recording"
            return [self.failed(message, prim=fluid.prim, line=None)]  # no line of the program is to blame
        return [self._held(fluid, np.abs(values), evidence.time, self.mean, "mean density error")]

    def _held(self, fluid: Fluid, error: Floats, time: Floats, limit: float, what: str) -> Finding:
        # Not interpolated, so that the value is one that was recorded; NaN sorts last, and fails.
        value = float(np.sort(error)[max(0, math.ceil(self.times * len(error)) - 1)])
        return self.measured(
            f"{fluid.prim}: {what} {value:.2%}, at {self.times:.0%} of the times or better",
            value, limit, "1", prim=fluid.prim,
            time=float(time[np.argmax(error > limit)] if value > limit else time[np.nanargmax(error)]), expected=0.0,
            limit_from="a weakly compressible liquid stays within about 1 %; as much again for splashes",
        )  # fmt: skip

    def repair(self, finding: Finding, evidence: Evidence) -> RepairTarget:
        """Density errors fall with the square of the speed of sound."""
        fluid = evidence.fluid(finding.prim or "")
        sound = sound_speed(evidence, fluid)
        if not sound or not finding.value or not finding.limit or finding.value <= finding.limit:
            return shorter_step(
                evidence, 0.5, "the density drifts with the step's error; half the step is the first to try"
            )
        wanted = sound * math.sqrt(finding.value / finding.limit)
        return faster_sound(
            evidence, fluid, wanted, "the density error of a weakly compressible fluid goes as (v / c)^2"
        )


@dataclass
class CheckWaterLevel(Check):
    """The surface that the particles show is where their volume says it is: a sum over both solver and recording."""

    spacings: float = 1.0

    def evaluate(self, evidence: Evidence) -> list[Finding]:
        """The difference, for each fluid in a container whose surface can be seen."""
        found = []
        for fluid in evidence.world.fluids:
            if evidence.container_of(fluid) is None or self._changes(evidence, fluid):
                continue
            level = evidence.level(fluid)
            if level.seen is None:
                continue
            height = max(level.height - level.floor, 0.0)
            slosh = self._speed(evidence, fluid) * math.sqrt(height / max(evidence.gravity, 1e-9))
            where = f"{level.seen - level.floor:.4g} m above the floor, by volume {level.height - level.floor:.4g} m"
            found.append(
                self.measured(
                    f"{fluid.prim}: its surface stands {where}",
                    abs(level.seen - level.height), self.spacings * fluid.spacing + slosh, "m", prim=fluid.prim,
                    time=evidence.window_start, expected=0.0,
                    limit_from=f"{self.spacings:g} particle spacing, which they resolve, and v sqrt(H / g): as high as "
                    "it still sloshes",
                )
            )  # fmt: skip
        return found

    @staticmethod
    def _changes(evidence: Evidence, fluid: Fluid) -> bool:
        """Whether there is more or less of it over the final window: then it has no level."""
        track = evidence.track(fluid)
        return bool(np.ptp(track.count[track.time >= evidence.window_start - 1e-9]) if len(track.time) else 0)

    @staticmethod
    def _speed(evidence: Evidence, fluid: Fluid) -> float:
        """The particles' root mean square speed over the final window [m/s]."""
        track = evidence.track(fluid)
        v = track.mean(np.einsum("tni,tni->tn", track.velocity, track.velocity))
        late = v[track.time >= evidence.window_start - 1e-9]
        return math.sqrt(float(late.mean())) if late.size else 0.0

    def repair(self, finding: Finding, evidence: Evidence) -> RepairTarget:
        """Particles that stand higher or lower than their volume: finer ones keep the volume better."""
        fluid = evidence.fluid(finding.prim or "")
        return finer(evidence, fluid, 0.5, "particles that do not fill their volume are too coarse for this vessel")


CHECKS: Checks = (CheckExplosion, CheckPenetration, CheckFluidContained, CheckDensity, CheckWaterLevel)
