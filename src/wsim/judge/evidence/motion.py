"""What bodies do between recorded frames: speeds, energies, what they hang on and whom they come near.

T frames, T - 1 intervals between them, B bodies in the order of `world.bodies`. SI units. Of W copies of a world, over
the same times, arrays have an axis of copies before that of time: (W, T, B, ...); masses and sizes are (W, 1, B).
"""

from __future__ import annotations

import math
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from wsim.geometry.rotations import conjugate, lengths, rotate
from wsim.geometry.shapes import kind_of
from wsim.judge.evidence.cords import spring_energy
from wsim.judge.evidence.scheduled import pushes

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from wsim.judge.evidence.placed import Placed
    from wsim.judge.evidence.recorded import Recorded

    Floats = NDArray[np.float64]
    Bools = NDArray[np.bool_]

OURS = "loose_order"  # what wsim's simulator says of itself: another engine's model may start anywhere
LEADS = 0.15  # half a change of an acceleration in a step, that a lead may account for [m/s^2]
CHUNK = 64  # frames whose distances between all bodies are held at once
OF_FRAMES = (
    "com", "speed", "rate", "surface_speed", "acceleration", "touched", "spin", "angular_momentum", "torque", "kinetic",
    "potential", "reach", "meets",
)  # fmt: skip
ROUNDED_SQUARES = 8.0  # of the largest square, that a squared distance of two may be off by, in their precision
FLOAT32 = float(np.finfo(np.float32).eps)  # a recording's rounding, relative


class Motion:
    """Arrays worked out when they are first asked for."""

    def __init__(self, recorded: Recorded) -> None:
        self._recorded = recorded
        bodies = recorded.world.bodies
        self.gravity: Floats = np.array(recorded.world.gravity)
        self.mass: Floats = np.array([body.mass for body in bodies])
        self.inertia: Floats = np.array([body.inertia for body in bodies]).reshape(-1, 3, 3)
        self.kinematic: Bools = np.array([body.kinematic for body in bodies], dtype=bool)
        self.q: Floats = recorded.body_q
        self.v: Floats = recorded.body_qd[..., :3]
        self.w: Floats = recorded.body_qd[..., 3:]
        self.h: Floats = np.maximum(np.diff(recorded.time), 1e-9)  # length of each interval (T - 1,) [s]
        self.contact_force = np.asarray(recorded.recording.contact_force)

    @classmethod
    def join(cls, copies: Sequence[Motion]) -> Motion:
        """The motion of all copies at once; what was worked out of it is theirs, too (`part`)."""
        joined = cls(copies[0]._recorded)
        joined.mass, joined.inertia = (
            np.stack([getattr(each, name) for each in copies])[:, None] for name in ("mass", "inertia")
        )
        joined.radius, joined.smallest, joined.arms = (
            np.stack([getattr(each, name) for each in copies])[:, None] for name in ("radius", "smallest", "arms")
        )
        joined.q, joined.v, joined.w, joined.contact_force = (
            np.stack([getattr(each, name) for each in copies]) for name in ("q", "v", "w", "contact_force")
        )
        return joined

    def part(self, n: int, motion: Motion) -> None:
        """Let a copy have what is worked out of all of them, but for what is of no frame."""
        for name in OF_FRAMES:
            motion.__dict__[name] = getattr(self, name)[n]

    # ---- where and how fast
    @cached_property
    def com(self) -> Floats:
        """Centres of mass, (T, B, 3) [m]."""
        q = self.q
        moved: Floats = q[..., :3] if not self.arms.any() else q[..., :3] + rotate(q[..., 3:], self.arms)
        return moved

    @cached_property
    def arms(self) -> Floats:
        """Centres of mass in the bodies' frames, (B, 3) [m]."""
        return np.array([body.com for body in self._recorded.world.bodies]).reshape(-1, 3)

    @cached_property
    def smallest(self) -> Floats:
        """Smallest extent of the largest shape of each body, (B,) [m]."""
        return np.array([self._recorded.solid(i).smallest for i in range(len(self.mass))])

    @cached_property
    def speed(self) -> Floats:
        """Of each centre of mass, (T, B) [m/s]."""
        return lengths(self.v)

    @cached_property
    def rate(self) -> Floats:
        """Of each body's turning, (T, B) [rad/s]."""
        return lengths(self.w)

    @cached_property
    def radius(self) -> Floats:
        """Radius of a ball about each centre of mass that holds the body's colliding shapes, (B,) [m]."""
        found = []
        for i, body in enumerate(self._recorded.world.bodies):
            reaches = [
                math.dist(shape.position, body.com) + kind_of(shape).radius_about
                for shape in self._recorded.solid(i).shapes
            ]
            found.append(max(reaches, default=0.0))
        return np.array(found)

    @cached_property
    def step(self) -> float:
        """The simulator's time step, or 0 where it is not known [s]."""
        return float(self._recorded.recording.metadata.get("time_step") or self._recorded.world.time_step or 0.0)

    @cached_property
    def dt(self) -> float:
        """The simulator's time step, or where it is not known the time between frames [s]."""
        return float(self.step or (np.median(self.h) if len(self.h) else 1.0))

    @cached_property
    def late(self) -> Floats:
        """How far behind their velocities places may be, (B,) [s]: a time step, of first order.

        Nothing of what gravity and contacts alone move, where the simulator says that its steps are of second order.
        """
        world, metadata = self._recorded.world, self._recorded.recording.metadata
        if metadata.get(OURS) != 2 or world.fluids or metadata.get("controlled") or pushes(world):
            return np.full(len(self.jointed), self.dt)
        return np.where(self.jointed | self.kinematic, self.dt, 0.0)

    @cached_property
    def dt_frames(self) -> float:
        """The time between frames [s]."""
        return float(np.median(self.h)) if len(self.h) else 1.0

    @cached_property
    def surface_speed(self) -> Floats:
        """The most that any point of a body may have, (T, B) [m/s]."""
        return np.asarray(self.speed + self.rate * self.radius)

    @cached_property
    def acceleration(self) -> Floats:
        """Mean acceleration over each interval less what fluid and control gave, (T - 1, B, 3) [m/s^2].

        So much of it as contacts, ties and gravity gave: what velocities are ahead of those is no force's.
        """
        impulse, lead = self._recorded.recording.applied_impulse, self.lead
        gained = np.diff(self.v, axis=-3)
        if lead is not None:
            gained = gained - lead[..., :3] / self.mass[:, None]
        if impulse is not None:
            gained = gained - np.asarray(impulse[1:], dtype=np.float64) / self.mass[:, None]
        found: Floats = gained / self.h[:, None, None]
        return found

    @cached_property
    def lead(self) -> Floats | None:
        """Momentum and angular momentum that velocities gained in each interval beside all impulses, (T - 1, B, 6).

        Where a body goes by steps of the first order, its velocity is told half a step after that which impulses have
        given it. This is what that grew by, where it is recorded, but no more than an acceleration makes of it that
        changes by 2 `LEADS` in a step.
        """
        recorded = self._recorded.recording.lead
        if recorded is None:
            return None
        most = LEADS * self.h[:, None] * self.mass
        found = np.asarray(recorded[1:], dtype=np.float64)
        for part, limit in ((slice(3), most), (slice(3, 6), most * self.radius)):
            size = lengths(found[..., part])
            found[..., part] *= np.minimum(1.0, limit / np.maximum(size, 1e-300))[..., None]
        return found

    @cached_property
    def touched(self) -> Bools:
        """Whether the solver had a contact of the body, (T, B)."""
        return np.asarray(np.any(self.contact_force != 0.0, axis=-1))

    # ---- angular momentum and energy
    @cached_property
    def spin(self) -> Floats:
        """Angular velocity in the body's frame, (T, B, 3) [rad/s]."""
        return rotate(conjugate(self.q[..., 3:]), self.w)

    @cached_property
    def angular_momentum(self) -> Floats:
        """Angular momentum about each centre of mass, (T, B, 3) [kg m^2/s]."""
        return rotate(self.q[..., 3:], np.einsum("...ij,...j->...i", self.inertia, self.spin))

    @cached_property
    def torque(self) -> Floats:
        """Mean torque over each interval less what fluid and control gave, where that was recorded, (T - 1, B, 3)."""
        turn, lead = self._recorded.recording.applied_turn, self.lead
        gained = np.diff(self.angular_momentum, axis=-3)
        if lead is not None:
            gained = gained - lead[..., 3:]
        if turn is not None:
            gained = gained - np.asarray(turn[1:], dtype=np.float64)
        found: Floats = gained / self.h[:, None, None]
        return found

    @cached_property
    def kinetic(self) -> Floats:
        """Kinetic energy, (T, B) [J]."""
        turning = np.einsum("...i,...ij,...j->...", self.spin, self.inertia, self.spin)
        found: Floats = 0.5 * (self.mass * self.speed**2 + turning)
        return found

    @cached_property
    def potential(self) -> Floats:
        """Potential energy in gravity, relative to the origin, (T, B) [J]."""
        found: Floats = -self.mass * (self.com @ self.gravity)
        return found

    @cached_property
    def applied_work(self) -> Floats | None:
        """Work of fluid and control on each body since the start, (T, B) [J]; None where it is not recorded."""
        work = self._recorded.recording.applied_work
        return None if work is None else np.cumsum(np.asarray(work, dtype=np.float64), axis=0)

    # ---- what hangs together
    @cached_property
    def unit(self) -> NDArray[np.intp]:
        """The number of the mechanism that each body is part of, (B,); a loose body is one of its own."""
        bodies = self._recorded.world.bodies
        row = {body.prim: i for i, body in enumerate(bodies)}
        unit = np.arange(len(bodies))
        world = self._recorded.world
        child = {joint.prim: joint.child for joint in world.joints}
        pairs: list[tuple[str | None, str | None]] = [(joint.parent, joint.child) for joint in world.joints]
        pairs += [(child.get(gear.first), child.get(gear.second)) for gear in world.gears]
        pairs += [(tied[0], other) for tied in self._tied for other in tied[1:]]
        for first, second in pairs:
            if first in row and second in row:
                unit[unit == unit[row[second]]] = unit[row[first]]
        return unit

    @property
    def _tied(self) -> list[list[str]]:
        """The bodies that each spring and rope is fixed to or runs round."""
        world = self._recorded.world
        return [[guide.body for guide in cord.path if guide.body] for cord in world.cords]

    @cached_property
    def elastic(self) -> Floats:
        """Energy that springs hold, shared by the bodies at their ends, (T, B) [J]."""
        return spring_energy(self._recorded)

    @cached_property
    def jointed(self) -> Bools:
        """Whether a joint, a spring or a rope holds the body, (B,)."""
        held = {end for joint in self._recorded.world.joints for end in (joint.parent, joint.child)}
        held |= {prim for tied in self._tied for prim in tied}
        return np.array([body.prim in held for body in self._recorded.world.bodies], dtype=bool)

    # ---- whom it may meet
    @cached_property
    def reach(self) -> Floats:
        """How far any point of a body can get within each interval, (T - 1, B) [m]: its speed and gravity's pull."""
        fastest = np.maximum(self.surface_speed[..., :-1, :], self.surface_speed[..., 1:, :])
        found: Floats = (fastest + np.linalg.norm(self.gravity) * self.h[:, None]) * self.h[:, None]
        return found

    @cached_property
    def meets(self) -> Bools:
        """Whether a body may touch one of another mechanism within each interval, (T - 1, B)."""
        met = np.zeros(self.reach.shape, dtype=bool)
        other = self.unit[:, None] != self.unit[None, :]
        if not other.any():
            return met
        for start in range(0, len(self.h), CHUNK):
            part = slice(start, min(start + CHUNK, len(self.h)))
            # From their middle: a square of a kilometre in single precision is known to 0.1 m^2.
            com = self.com[..., part, :, :]
            c = (com - com.mean(axis=-2, keepdims=True)).astype(np.float32)
            square = np.einsum("...i,...i->...", c, c)
            distance2 = square[..., None] + square[..., None, :] - 2.0 * c @ c.swapaxes(-1, -2)
            rounding = ROUNDED_SQUARES * FLOAT32 * square.max(axis=-1)[..., None, None]
            range_ = (self.radius + self.reach[..., part, :]).astype(np.float32)
            bound = range_[..., None] + range_[..., None, :]
            met[..., part, :] = np.any((distance2 < bound * bound + rounding) & other, axis=-1)
        return met

    def near(self, i: int, intervals: NDArray[np.intp]) -> Bools:
        """Whether anything solid is so near body i that the two may touch within the intervals, (len(intervals),).

        Surfaces are nearer to each other than the other's surface is to the ball about body i: never less than true.
        """
        near = np.zeros(len(intervals), dtype=bool)
        bodies = self._recorded.world.bodies
        margins = np.array([max((shape.margin for shape in body.shapes), default=0.0) for body in bodies])
        reach = self.reach[intervals] + self.radius + margins
        far = reach + reach[:, i, None]
        apart = [lengths(self.com[frames] - self.com[frames, i, None]) for frames in (intervals, intervals + 1)]
        may = np.append(np.any(np.minimum(*apart) <= far, axis=0), True)  # of the others' bodies, and the world
        for shape in self._recorded.placed:
            if shape.body != i and may[shape.body]:
                near |= self.approaches(shape, i, intervals)
        return near

    def approaches(self, shape: Placed, i: int, intervals: NDArray[np.intp]) -> Bools:
        """Whether body i and a shape may touch within the intervals, (len(intervals),)."""
        near = np.zeros(len(intervals), dtype=bool)
        reach = self.reach[intervals, i] + (self.reach[intervals, shape.body] if shape.body >= 0 else 0.0)
        reach = reach + shape.shape.margin + max(own.margin for own in self._recorded.solid(i).shapes)
        for frames in (intervals, intervals + 1):
            local = rotate(conjugate(shape.rotation[frames]), self.com[frames, i] - shape.position[frames])
            if shape.shape.kind == "mesh":
                gap = np.linalg.norm(local, axis=1) - shape.radius
            else:
                gap = -shape.kind.depth(local)
            near |= gap <= self.radius[i] + reach
        return near

    def wet(self, i: int, intervals: NDArray[np.intp]) -> Bools:
        """Whether a particle is so near body i that the fluid may push it within the intervals, (len(intervals),)."""
        wet = np.zeros(len(intervals), dtype=bool)
        for fluid in self._recorded.world.fluids:
            track = self._recorded.track(fluid)
            for n, k in enumerate(intervals):
                frame = int(np.argmin(np.abs(track.time - self._recorded.time[k])))
                apart = track.position[frame] - self.com[k, i].astype(np.float32)
                reach = self.radius[i] + self.reach[k, i] + 3.0 * fluid.spacing
                wet[n] |= bool(np.any(np.einsum("ni,ni->n", apart, apart) < reach * reach))
        return wet
