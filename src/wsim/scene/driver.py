"""A driver for a program's `control`: follows a line by pure pursuit, at a speed that bends and brakes allow.

    DRIVER = Driver("truck", "hmmwv", path=ROAD.line(), speed=8.0)

    def build(scene):
        scene.vehicle("truck", "hmmwv", ...)

    def control(world, t):
        DRIVER.drive(world, t)

What follows the line is the vehicle's position, the point between its axles, b = wheelbase / 2 ahead of the rear one.
The geometry of the steering is that of Coulter (Implementation of the Pure Pursuit Path Tracking Algorithm, CMU 1992),
seen from the rear axle's middle: a goal at a distance l that lies off the heading by alpha asks for the bicycle's angle
atan(2 wheelbase l sin(alpha) / (l^2 - b^2)). Its circle about the rear axle's turning centre leads the position to the
goal: with r the rear axle's radius, r^2 + b^2 = |goal - centre|^2 = l^2 - 2 r l sin(alpha) + r^2. (Coulter leads the
axle, b = 0.) NumPy alone.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wsim.defaults import GRAVITY
from wsim.limits import MAX_DRIVE_SPEED, MAX_WAY
from wsim.scene.brakes import Brake, Pressed
from wsim.scene.layers import polyline
from wsim.scene.validate import Call, shown
from wsim.scene.vehicle_spec import CORNERS, VehicleSpec, spec_of

Floats = NDArray[np.float64]

_PROPORTIONAL = 2.0  # [1/s]: acceleration asked for a lack of speed
_INTEGRAL = 0.8  # [1/s^2]: damped by 1.1 with the above
_LEAST_AHEAD = 1.2  # of the wheelbase, that the goal is ahead of the rear axle at least
_AHEAD = 0.7  # [s] of way that the goal is ahead of it
_BEFORE, _AFTER = 3.0, 8.0  # [m] of the line that are searched for the nearest place, behind and before the last one
_AS_CLOSE = 0.5  # [m] more than the nearest place, that a place where it sets out is away at most
_SLIP = (0.6, 0.12)  # [m/s], of the speed: a wheel that slips by more gets no torque until it grips
_LONGEST = 0.5  # [m] between points of the line for which a speed is planned
_TURNED = 60.0  # [deg/s] that the bicycle's angle changes by at most
_ARRIVED = 0.02  # [m] before a place where it waits, that it is there
_HOLDS = 0.2  # [m/s]: what is faster there is braked by all that it may
_BACK = 8.0  # [1/m]: what is farther off than the inverse of it is brought back by all that it may
_OFF = 0.1  # [m] of the path, that a place where it waits or brakes is away from it at most
_APART = 1e-6  # [m] that places are which are not the same
_MOST = 100_000  # points of a path: arcs of 1 m and more, as long as a path may be, have fewer


@dataclass(frozen=True)
class _Profile:
    """A line by arc length."""

    points: Floats  # (N, 2) [m]
    along: Floats  # (N,) [m]
    speed: Floats  # (N,) [m/s]
    gain: Floats  # (N,) of speed with time, from there to the next point [m/s^2]

    def speed_at(self, way: Floats) -> Floats:
        """Between points v² goes evenly."""
        return np.sqrt(np.interp(way, self.along, self.speed**2))


class Driver:
    """Steers, drives and brakes a vehicle along a line by its steering's targets and torques on its axles.

    Where it waits it comes to stand, and sets off again after so long; from its `brake` on it brakes for good. Its
    `vehicle` is driven by nothing else: `drive` and `brake` of it are not called. Torques are bounded by the spec's
    engine at the speed there is, and by its brakes; a wheel that slips by more than 0.6 m/s and 12 % of the speed gets
    none until it grips.
    """

    _way: Floats  # along the path in each world, (W,) [m]
    _waited: Floats  # at the place where it waits next [s]
    _left: NDArray[np.int64]  # places where it has waited
    _stands: NDArray[np.bool_]  # whether it is where it waits next, since it came there
    _before: Floats  # how far that is ahead [m]
    _lack: Floats  # of speed, added up over time [m]
    _angle: Floats  # of the bicycle [rad]
    _braked: NDArray[np.bool_]  # whether its brakes are pressed for good
    _fresh: bool
    _last: float  # when it was asked last [s]

    def __init__(
        self,
        vehicle: str,
        spec: VehicleSpec | str = "car",
        *,
        path: Sequence[Sequence[float]] | Floats,
        speed: float,
        start_speed: float = 0.0,
        acceleration: float = 2.0,
        braking: float = 3.0,
        lateral: float = 3.0,
        stop: bool = True,
        waits: Sequence[Sequence[float]] = (),
        brake: Brake | None = None,
    ) -> None:
        """Make a driver.

        Args:
            vehicle: The vehicle's name.
            spec: As `scene.vehicle` was given.
            path: Points (x, y) of the world that the vehicle's position, the point between its axles, is to go through
                in turn [m], close enough to stand for its bends; such as `Road.line()`.
            speed: That is held where nothing asks for less [m/s].
            start_speed: As `scene.vehicle` was given [m/s].
            acceleration: At most, speeding up [m/s^2].
            braking: At most, for bends and the end [m/s^2].
            lateral: At most, in bends: the speed there is sqrt(lateral x radius) [m/s^2].
            stop: Whether to stop at the end of the path, or to go on straight.
            waits: (x, y, seconds) in turn: places on the path [m] where it comes to stand, and for how long [s]: each
                time as the path first comes there after the one before. For 0 s it goes by: so one says which time.
            brake: When all brakes are pressed, for good. With one `at` a place it does not slow down for the end of
                the path; any other may never come, and it stops there.

        Raises:
            SceneError: If the path is none, or longer than 10 km, or a number is out of range.
        """
        call = Call("Driver", vehicle)
        if not isinstance(vehicle, str) or not vehicle:
            call.fail(f"vehicle = {shown(vehicle)} must be the name of a vehicle")
        self.vehicle, self.spec = vehicle, spec_of(call, spec)
        points = polyline(call, path, "path", most=_MOST)
        if (length := float(np.linalg.norm(np.diff(points, axis=0), axis=1).sum())) > MAX_WAY:
            call.fail(f"path is {length:.6g} m long; it must be {MAX_WAY:g} m at most")
        top = call.positive("speed", speed, MAX_DRIVE_SPEED, "m/s")
        begins = call.within("start_speed", start_speed, 0.0, MAX_DRIVE_SPEED, "m/s")
        limits = [call.positive(name, value, 20.0, "m/s^2") for name, value in
                  (("acceleration", acceleration), ("braking", braking), ("lateral", lateral))]  # fmt: skip
        self._waits, self._braking = _waits(call, points, waits), limits[1]
        self._brake, self._brakes_at = _brake(call, vehicle, points, brake)
        self._stop = call.flag("stop", stop) and math.isinf(self._brakes_at)
        stands = [place for place, _ in self._waits]
        self._profile = _profile(points, top, begins, *limits, stop=self._stop, stands=stands)
        self._begin(1)

    def drive(self, world: Any, t: float) -> None:
        """Set the steering's targets and the axles' torques in all worlds of a `control`'s `world`, at `t` [s]."""
        if t <= 0.0 or len(self._way) != world.world_count:
            self._begin(world.world_count)
        step = min(max(t - self._last, 0.0), 0.1)
        self._last = t
        body = world.body(self.vehicle)
        forward = _forward(np.asarray(body.rotation, dtype=np.float64))
        place = np.asarray(body.position, dtype=np.float64)
        rear = place - 0.5 * self.spec.wheelbase * forward
        speed = np.einsum("wi,wi->w", np.asarray(body.velocity, dtype=np.float64), forward)
        self._way = self._nearest(place[:, :2])
        self._wait(step)
        self._steer(world, rear[:, :2], forward, speed, step)
        self._braked |= self._brakes(world, place, speed, t, step)
        self._push(world, forward, speed, step)

    @property
    def distance(self) -> Floats:
        """How far along the path it is in each world, (W,) [m]."""
        return self._way

    @property
    def brakes_at(self) -> float:
        """How far along the path it brakes for good [m]; inf where its brake names no place."""
        return self._brakes_at

    def speed_at(self, distance: float) -> float:
        """What it is asked for after so much of the path [m/s]."""
        return float(self._profile.speed_at(np.array([float(distance)]))[0])

    def timetable(self) -> tuple[Floats, Floats]:
        """How far along the path it is [m] and when [s], (N,) each, by its own speeds and waits, as if unbraked."""
        along, speed = self._profile.along, self._profile.speed
        when = np.append(0.0, np.cumsum(np.diff(along) / np.maximum(0.5 * (speed[1:] + speed[:-1]), 1e-6)))
        for place, seconds in reversed(self._waits):
            k = int(np.searchsorted(along, place))
            along = np.insert(along, k, place)
            when = np.concatenate([when[: k + 1], when[k:] + seconds])
        return along, when

    def _begin(self, worlds: int) -> None:
        self._way = np.zeros(worlds)
        self._lack = np.zeros(worlds)
        self._waited, self._left = np.zeros(worlds), np.zeros(worlds, dtype=np.int64)
        self._stands, self._before = np.zeros(worlds, dtype=bool), np.full(worlds, np.inf)
        self._angle = np.zeros(worlds)
        self._braked, self._pressed = np.zeros(worlds, dtype=bool), Pressed(self.spec, worlds)
        self._fresh, self._last = True, 0.0

    def _brakes(self, world: Any, place: Floats, speed: Floats, t: float, step: float) -> NDArray[np.bool_]:
        """In which worlds something says that it is to brake, or says so before the next half of a call."""
        brake, now = self._brake, np.zeros(len(place), dtype=bool)
        if brake is None:
            return now
        if brake.time is not None:
            now |= t >= brake.time - 1e-6
        if brake.near is not None and brake.within is not None:
            off = np.asarray(world.body(brake.near).position, dtype=np.float64) - place
            now |= np.linalg.norm(off, axis=1) <= brake.within
        return now | (self._way + 0.5 * step * speed >= self._brakes_at)

    def _wait(self, step: float) -> None:
        """Come to where it waits next; count how long it has been there, and leave it after that."""
        places = np.array([*(place for place, _ in self._waits), np.inf])
        self._waited = np.where(self._stands, self._waited + step, 0.0)
        self._before = places[self._left] - self._way
        self._stands = self._stands | (self._before <= _ARRIVED)
        over = self._stands & (self._waited >= np.array([*(times for _, times in self._waits), np.inf])[self._left])
        self._left = self._left + over
        self._stands = self._stands & ~over

    def _nearest(self, at: Floats) -> Floats:
        """Along the path, the nearest place to each of (W, 2), near where it was; at first, the earliest close one.

        A lap's end lies at its start: the earliest of places that are as close is where it sets out.
        """
        points, along = self._profile.points, self._profile.along
        begin, way = points[:-1], np.diff(points, axis=0)
        length = np.diff(along)
        share = np.einsum("wni,ni->wn", at[:, None] - begin, way) / length**2
        foot = np.clip(share, 0.0, 1.0)
        away = np.linalg.norm(begin + foot[..., None] * way - at[:, None], axis=2)
        place = along[:-1] + foot * length
        row = np.arange(len(at))
        if self._fresh:
            self._way = place[row, (away <= away.min(axis=1, keepdims=True) + _AS_CLOSE).argmax(axis=1)]
        self._fresh = False
        far = (place < self._way[:, None] - _BEFORE) | (place > self._way[:, None] + _AFTER)
        far[:, -1] &= self._way < along[-1]  # which goes on past its end
        best = np.where(far, away + 1e6, away).argmin(axis=1)
        beyond = np.maximum(share[:, -1] - 1.0, 0.0) * length[-1]  # past its end
        found = place[row, best]
        return np.asarray(np.where(found >= along[-1] - 1e-9, along[-1] + beyond, found))

    def _steer(self, world: Any, rear: Floats, forward: Floats, speed: Floats, step: float) -> None:
        """Towards a goal ahead, by Ackermann's geometry for each wheel."""
        spec, line, lead = self.spec, self._profile, 0.5 * self.spec.wheelbase
        ahead = self._way + np.maximum(_LEAST_AHEAD * spec.wheelbase, _AHEAD * np.abs(speed)) - lead
        last = line.points[-1] - line.points[-2]
        over = np.maximum(ahead - line.along[-1], 0.0)[:, None] * last / np.linalg.norm(last)
        goal = np.stack([np.interp(ahead, line.along, line.points[:, k]) for k in (0, 1)], axis=1) + over
        off = goal - rear
        flat = forward[:, :2] / np.linalg.norm(forward[:, :2], axis=1, keepdims=True)
        aside = flat[:, 0] * off[:, 1] - flat[:, 1] * off[:, 0]
        asked = np.arctan(2.0 * spec.wheelbase * aside / np.maximum((off**2).sum(axis=1) - lead**2, 1e-6))
        most, change = math.radians(spec.steer_limit_deg), math.radians(_TURNED) * step
        if step > 0.0:
            asked = np.clip(asked, self._angle - change, self._angle + change)
        self._angle = np.clip(asked, -most, most)
        bend = np.tan(self._angle)
        for corner in CORNERS[:2]:
            y = spec.place(corner)[1]
            angle = np.arctan(spec.wheelbase * bend / (spec.wheelbase - y * bend))
            world.joint(f"{self.vehicle}_steer_{corner}").target = angle

    def _push(self, world: Any, forward: Floats, speed: Floats, step: float) -> None:
        """Torques on the axles: what speed, slope and rolling ask for, and what a lack of speed does, bounded."""
        spec, line = self.spec, self._profile
        # Planned for the position, which in a bend is led round a larger circle than the rear axle is.
        wanted = line.speed_at(self._way) / np.hypot(1.0, 0.5 * np.tan(self._angle))
        here = np.clip(np.searchsorted(line.along, self._way, side="right") - 1, 0, len(line.gain) - 1)
        gain, stands = line.gain[here], self._stands
        ended = (wanted <= 0.0) & self._stop & ~stands
        wanted = np.where(stands, 0.0, wanted)
        # To slow down from another speed within the same way takes (v / v_wanted)² of it.
        faster = np.minimum(np.abs(speed) / np.maximum(wanted, 1e-6), 1.5) ** 2
        gain = np.where(gain < 0.0, np.where(wanted > 0.0, gain * faster, 0.0), gain)
        slow = max(_HOLDS, 2.0 * self._braking * step)
        held = np.clip(_BACK * self._before, -1.0, 1.0) - np.clip(speed / slow, -1.0, 1.0)
        gain = np.where(stands, self._braking * held, gain)
        lack = wanted - speed
        weight = spec.mass * GRAVITY
        known = spec.effective_mass * gain + weight * (forward[:, 2] + spec.rolling * np.tanh(speed / 0.1))
        force = known + spec.effective_mass * (_PROPORTIONAL * lack + _INTEGRAL * self._lack)
        turns = np.maximum(np.abs(speed), 1e-3) / spec.wheel_radius
        engine = np.minimum(spec.engine_torque * spec.gear, spec.engine_power / turns) / spec.wheel_radius
        brakes = 4.0 * spec.brake_torque / spec.wheel_radius
        bounded = np.clip(force, -brakes, engine)
        # The integral waits while a bound holds: else it would overshoot when that lets go.
        # And what a way took is not what standing takes.
        self._lack = np.where(bounded == force, self._lack + step * lack, self._lack)
        self._lack = np.where(ended, 0.0, self._lack)
        for corner in CORNERS:
            axle = world.joint(f"{self.vehicle}_axle_{corner}")
            share = np.where(bounded >= 0.0, (corner in spec.driven_corners) / len(spec.driven_corners), 0.25)
            slip = np.asarray(axle.velocity, dtype=np.float64) * spec.wheel_radius - speed
            grips = slip * np.sign(bounded) < _SLIP[0] + _SLIP[1] * np.abs(speed)
            driven = np.where(grips, share * bounded * spec.wheel_radius, 0.0)
            if self._brake is not None:
                held = self._pressed.torque(corner, axle, speed, forward[:, 2], self._brake.share, step)
                driven = np.where(self._braked, held, driven)
            axle.force = driven
            self._pressed.note(corner, axle)


def _forward(rotation: Floats) -> Floats:
    """The first axis of quaternions xyzw, (W, 3)."""
    x, y, z, w = rotation.T
    return np.stack([1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y + z * w), 2.0 * (x * z - y * w)], axis=1)


def _brake(call: Call, vehicle: str, points: Floats, given: Brake | None) -> tuple[Brake | None, float]:
    """When it brakes, and where along the line that is at the latest [m]."""
    if given is None:
        return None, math.inf
    if not isinstance(given, Brake):
        call.fail(f"brake = {shown(given)} must be a Brake")
    brake = given.checked(call)
    if brake.near == vehicle:
        call.fail(f"brake.near = {shown(vehicle)} is the vehicle itself; name another body")
    if brake.at is None:
        return brake, math.inf
    place, away = _along(points, brake.at)
    if away.min() > _OFF:
        call.fail(f"brake.at = {shown(given.at)} is {away.min():.3g} m beside the path; give a place on it")
    return brake, _passes(place, away)[-1]


def _passes(place: Floats, away: Floats) -> list[float]:
    """Each time that a line comes by a place: how far along it is nearest then [m]; as `_along` returns both."""
    close = np.flatnonzero(away <= _OFF)
    times = np.split(close, np.flatnonzero(np.diff(close) > 1) + 1)
    return [float(place[pieces[away[pieces].argmin()]]) for pieces in times if len(pieces)]


def _along(points: Floats, at: Sequence[float]) -> tuple[Floats, Floats]:
    """The nearest place to another on each piece of a line: how far along the line, and how far away [m]."""
    begin, way = points[:-1], np.diff(points, axis=0)
    length = np.linalg.norm(way, axis=1)
    along = np.concatenate([[0.0], np.cumsum(length)])
    foot = np.clip(np.einsum("ni,ni->n", np.subtract(at, begin), way) / length**2, 0.0, 1.0)
    return along[:-1] + foot * length, np.linalg.norm(begin + foot[:, None] * way - at, axis=1)


def _waits(call: Call, points: Floats, given: Sequence[Sequence[float]]) -> list[tuple[float, float]]:
    """Places along a line [m], and how long it stands at each [s]."""
    found: list[tuple[float, float]] = []
    last = 0.0
    if not isinstance(given, list | tuple):
        call.fail(f"waits = {shown(given)} must be a list of (x, y, seconds)")
    for k, each in enumerate(given):
        if not isinstance(each, list | tuple) or len(each) != len("xyt"):
            call.fail(f"waits[{k}] = {shown(each)} must be (x, y, seconds)")
        x, y = (call.number(f"waits[{k}]", value) for value in each[:2])
        seconds = call.within(f"waits[{k}]", each[2], 0.0, 3600.0, "s")
        after = [along for along in _passes(*_along(points, (x, y))) if along > last + _APART]
        if not after:
            call.fail(f"waits[{k}] = {shown(each)} is not on the path, after where it starts and waits before")
        last = after[0]
        found += [(last, seconds)] if seconds > 0.0 else []
    return found


def _profile(
    points: Floats, top: float, begins: float, acceleration: float, braking: float, lateral: float, *, stop: bool,
    stands: Sequence[float],
) -> _Profile:  # fmt: skip
    """The fastest speeds along a line within bounds: of bends first, then forwards, then backwards.

    At places along it where it `stands` [m] they are none.
    Bends are those of the given points; between two that are far apart more are put, where speed may rise and fall.
    """
    gaps = np.linalg.norm(np.diff(points, axis=0), axis=1)
    given = np.concatenate([[0.0], np.cumsum(gaps)])
    heading = np.unwrap(np.arctan2(*np.diff(points, axis=0).T[::-1]))
    bend = np.zeros(len(points))
    bend[1:-1] = np.abs(np.diff(heading)) / (0.5 * (gaps[1:] + gaps[:-1]))
    zero = [0.0, *stands, float(given[-1])]  # between any two of these there is a place where it goes
    places = [np.linspace(a, b, math.ceil((b - a) / _LONGEST) + 1) for a, b in pairwise(given)]
    along = np.unique(np.concatenate([*places, stands, [0.5 * (a + b) for a, b in pairwise(zero)]]))
    points = np.stack([np.interp(along, given, points[:, k]) for k in (0, 1)], axis=1)
    speed, gaps = np.full(len(along), top), np.diff(along)
    speed[np.searchsorted(along, given)] = np.minimum(top, np.sqrt(lateral / np.maximum(bend, 1e-9)))
    speed[np.searchsorted(along, stands)] = 0.0
    speed[0] = min(speed[0], begins)
    for k, gap in enumerate(gaps):
        speed[k + 1] = min(speed[k + 1], math.sqrt(speed[k] ** 2 + 2.0 * acceleration * gap))
    if stop:
        speed[-1] = 0.0
    for k in range(len(gaps) - 1, -1, -1):
        speed[k] = min(speed[k], math.sqrt(speed[k + 1] ** 2 + 2.0 * braking * gaps[k]))
    rise = np.diff(speed**2) / (2.0 * gaps)  # v dv/ds
    return _Profile(points, along, speed, np.append(rise, 0.0))
