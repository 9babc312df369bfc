"""A driver on a bicycle of its own, without slip: speeds, steering and stopping against closed forms."""

import math
from types import SimpleNamespace

import numpy as np
import pytest

from tests.ways import lane_change, ring
from wsim.scene import Arc, Brake, Driver, Legs, SceneError, VehicleSpec
from wsim.scene.vehicle_spec import CORNERS, preset

SPEC = preset("hmmwv")
HALF = 0.5 * SPEC.wheelbase
G = 9.81


class Bicycle:
    """The world that `control` sees, of one vehicle in two worlds: a rear axle that rolls, a front one that steers.

    theta' = v tan(delta) / L, (m + 4 I / r²) v' = sum(T) / r - m g (sin(slope) + f).
    """

    def __init__(self, speed=0.0, slope=0.0):
        self.world_count = 2
        self.x, self.y = np.full(2, -HALF * math.cos(slope)), np.zeros(2)  # of the rear axle: it is at the origin
        self.turn, self.speed, self.slope = np.zeros(2), np.full(2, speed), slope
        self.steering = {corner: SimpleNamespace(target=np.zeros(2)) for corner in CORNERS[:2]}
        self.axles = {corner: SimpleNamespace(force=np.zeros(2), velocity=np.zeros(2)) for corner in CORNERS}

    def body(self, name):
        assert name == "truck"
        yaw, nose = self.turn / 2.0, -self.slope / 2.0  # q = yaw * pitch
        cy, sy, cp, sp = np.cos(yaw), np.sin(yaw), math.cos(nose), math.sin(nose)
        rotation = np.stack([-sy * sp, cy * sp, sy * cp, cy * cp], axis=1)
        forward = np.stack([np.cos(self.turn), np.sin(self.turn)], axis=1) * math.cos(self.slope)
        position = np.column_stack([self.place, 0.0 * self.x])
        velocity = np.concatenate([forward, np.full((2, 1), math.sin(self.slope))], axis=1) * self.speed[:, None]
        return SimpleNamespace(position=position, rotation=rotation, velocity=velocity)

    @property
    def place(self):
        """Between its axles, (2, 2) [m]."""
        ahead = np.stack([np.cos(self.turn), np.sin(self.turn)], axis=1)
        return np.stack([self.x, self.y], axis=1) + HALF * math.cos(self.slope) * ahead

    def joint(self, name):
        kind, corner = name.removeprefix("truck_").split("_", 1)
        return (self.steering if kind == "steer" else self.axles)[corner]

    def step(self, h):
        left, right = (np.tan(self.steering[corner].target) for corner in CORNERS[:2])
        bend = (
            2.0 * left * right / np.maximum(np.abs(left + right), 1e-12) * np.sign(left + right)
        )  # Ackermann's middle
        force = sum(axle.force for axle in self.axles.values()) / SPEC.wheel_radius
        drag = SPEC.mass * G * (math.sin(self.slope) + SPEC.rolling * np.sign(np.round(self.speed, 3)))
        self.speed = self.speed + h * (force - drag) / SPEC.effective_mass
        self.turn = self.turn + h * self.speed * bend / SPEC.wheelbase
        self.x = self.x + h * self.speed * math.cos(self.slope) * np.cos(self.turn)
        self.y = self.y + h * self.speed * math.cos(self.slope) * np.sin(self.turn)
        for axle in self.axles.values():
            axle.velocity = self.speed / SPEC.wheel_radius


def driven(driver, seconds, **start):
    """(steps, 4): x, y between its axles [m], the rear one's speed [m/s], time [s]; the same in both worlds."""
    world, found = Bicycle(**start), []
    for k in range(round(seconds / 0.01)):
        driver.drive(world, 0.01 * k)
        for _ in range(10):
            world.step(0.001)
        assert world.x[0] == world.x[1] and world.speed[0] == world.speed[1]
        found.append([*world.place[0], world.speed[0], 0.01 * (k + 1)])
    return np.array(found)


def straight(length):
    return [(x, 0.0) for x in np.arange(0.0, length + 0.1, 0.5)]


def test_its_speeds_are_what_bends_and_brakes_allow():
    """sqrt(lateral R) in a bend; v² = 2 a s after a start and before the end."""
    path = np.concatenate([straight(40.0), ring(9.0, 0.5)[1:] + np.array([40.0, 0.0])])
    driver = Driver("truck", "hmmwv", path=path, speed=12.0, acceleration=1.5, braking=2.5, lateral=3.0)
    for way in (0.2, 3.0):
        assert driver.speed_at(way) == pytest.approx(math.sqrt(2.0 * 1.5 * way), rel=1e-6)
    assert driver.speed_at(55.0) == pytest.approx(math.sqrt(3.0 * 9.0), rel=0.01)
    bend = driver.speed_at(55.0)
    assert driver.speed_at(38.0) == pytest.approx(math.sqrt(bend**2 + 2.0 * 2.5 * 2.0), rel=0.03)
    end = 40.0 + math.pi * 9.0
    assert driver.speed_at(end - 1.0) == pytest.approx(math.sqrt(2.0 * 2.5 * 1.0), rel=0.01)
    assert driver.speed_at(end) == 0.0


@pytest.mark.parametrize("points", [2, 3, 14])
def test_a_straight_way_has_its_speeds_however_few_points_it_has(points):
    """From rest to rest over 6.5 m: v² = 2 a s, the speed asked for, and v² = 2 b s before the end."""
    path = [(x, 0.0) for x in np.linspace(-1.0, 5.5, points)]
    driver = Driver("truck", "hmmwv", path=path, speed=2.0, acceleration=2.0, braking=1.0)
    assert driver.speed_at(0.5) == pytest.approx(math.sqrt(2.0), rel=1e-6)
    assert driver.speed_at(2.5) == pytest.approx(2.0, rel=1e-6)
    assert driver.speed_at(6.0) == pytest.approx(1.0, rel=1e-6)
    assert driver.speed_at(0.0) == driver.speed_at(6.5) == 0.0


def test_on_a_circle_it_is_on_the_line():
    """A goal on the circle that it is on asks for just that circle, but for what steering needs to come about."""
    found = driven(
        Driver("truck", "hmmwv", path=ring(15.0, 1.5), speed=5.0, start_speed=5.0, stop=False), 15.0, speed=5.0
    )
    off = np.abs(np.hypot(found[:, 0], found[:, 1] - 15.0) - 15.0)
    assert off.max() < 0.06
    assert off[-500:].max() < 0.01
    lag = math.asin(HALF / 15.0)  # of its heading, as the rear axle goes round inside
    assert found[:, 2] == pytest.approx(5.0 * np.ones(len(found)), rel=0.01)
    assert found[-500:, 2] == pytest.approx(5.0 * math.cos(lag) * np.ones(500), rel=1e-3)


@pytest.mark.parametrize("radius", [7.2, 9.0, 20.0])
def test_the_point_between_its_axles_is_led_round_any_circle(radius):
    """Down to hypot(L / tan 26.5 deg, L / 2) = 6.98 m, the smallest: within 1 % of the radius; the axle is inside."""
    world, driver = Bicycle(speed=2.0), Driver("truck", "hmmwv", path=ring(radius, 0.7, 0.1), speed=2.0, stop=False,
                                               start_speed=2.0)  # fmt: skip
    for k in range(round(1.2 * math.pi * radius / 2.0 / 0.01)):
        driver.drive(world, 0.01 * k)
        for _ in range(10):
            world.step(0.001)
    assert math.dist(world.place[0], (0.0, radius)) == pytest.approx(radius, rel=0.01)
    assert math.dist((world.x[0], world.y[0]), (0.0, radius)) == pytest.approx(math.sqrt(radius**2 - HALF**2), rel=0.01)


def test_it_changes_lanes_and_stops_at_the_end():
    x = np.arange(0.0, 42.1, 0.5)
    driver = Driver("truck", "hmmwv", path=np.stack([x, lane_change(x)], axis=1), speed=8.0, start_speed=8.0)
    found = driven(driver, 10.0, speed=8.0)
    assert np.abs(found[:, 1] - lane_change(found[:, 0])).max() < 0.2
    assert found[:250, 2] == pytest.approx(8.0 * np.ones(250), rel=0.01)
    assert found[-1, 0] == pytest.approx(42.0, abs=0.1)
    assert np.abs(found[-200:, 2]).max() < 0.02


@pytest.mark.parametrize("slope", [0.0, 12.0, -12.0])
def test_it_speeds_up_as_asked_on_any_slope(slope):
    """From rest v² = 2 a s, then the speed, within 2 %: it knows the slope."""
    lean = math.radians(slope)
    driver = Driver("truck", "hmmwv", path=straight(60.0), speed=5.0, acceleration=1.5, stop=False)
    found = driven(driver, 6.0, slope=lean)
    rising = (found[:, 0] > 0.2) & (found[:, 2] < 4.5)
    assert found[rising, 2] == pytest.approx(np.sqrt(2.0 * 1.5 * found[rising, 0]), rel=0.03)
    assert found[-100:, 2] == pytest.approx(5.0 * np.ones(100), rel=0.01)


def test_the_engine_bounds_what_it_asks():
    """Up 25 deg the engine's power gives v = P / (m g (sin + f)) at most, and the sum of what is lacking waits."""
    lean = math.radians(25.0)
    found = driven(Driver("truck", "hmmwv", path=straight(400.0), speed=20.0, stop=False), 40.0, slope=lean)
    most = SPEC.engine_power / (SPEC.mass * G * (math.sin(lean) + SPEC.rolling))
    assert found[-1, 2] == pytest.approx(most, rel=0.01)


def test_a_lap_begins_at_its_start_and_ends_at_its_end():
    """Behind the start by a hair, where the last piece is as near as the first; it stops after the lap."""
    lap = ring(10.0, 1.0)
    world, driver = Bicycle(), Driver("truck", "hmmwv", path=lap, speed=6.0)
    world.x -= 0.02
    across = 0.0
    for k in range(2000):
        driver.drive(world, 0.01 * k)
        across = max(across, world.place[0, 1])
        for _ in range(10):
            world.step(0.001)
    assert driver.distance == pytest.approx(2.0 * math.pi * 10.0, abs=0.15)
    assert np.abs(world.speed).max() < 0.02
    assert across == pytest.approx(20.0, abs=0.2)


def test_after_a_lap_it_goes_straight_on():
    """Along the last piece, whatever of the lap is near."""
    side = np.arange(0.0, 20.0, 0.5)
    there, back = np.stack([side, 0.0 * side], axis=1), np.stack([20.0 - side, 0.0 * side + 12.0], axis=1)
    bend = ring(6.0, 0.5)
    lap = np.concatenate([there, bend[:-1] + np.array([20.0, 0.0]), back, np.array([0.0, 12.0]) - bend])
    driver = Driver("truck", "hmmwv", path=lap, speed=5.0, stop=False)
    length = 40.0 + 12.0 * math.pi
    driver._fresh, driver._way = False, np.array([length - 1.0])
    for x in np.arange(-1.0, 19.0, 0.5):
        driver._way = driver._nearest(np.array([[x, 0.1]]))
    assert driver._way[0] == pytest.approx(length + 18.5, abs=0.2)


def test_it_waits_where_it_is_to_and_goes_on():
    """It comes to stand at 10 m and at 14 m, for 2 s and 1 s, and gets to the end as one that starts there does."""
    driver = Driver("truck", "hmmwv", path=straight(30.0), speed=4.0, waits=[(10.0, 0.0, 2.0), (14.0, 0.0, 1.0)])
    assert [driver.speed_at(place) for place in (10.0, 14.0, 30.0)] == [0.0, 0.0, 0.0]
    found = driven(driver, 25.0)
    step = 25.0 / len(found)
    for place, seconds in ((10.0, 2.0), (14.0, 1.0)):
        near = np.abs(found[:, 0] - place) < 0.1
        assert step * np.count_nonzero(near & (np.abs(found[:, 2]) < 0.02)) == pytest.approx(seconds, abs=0.35)
    assert found[-1, 0] == pytest.approx(30.0, abs=0.1) and abs(found[-1, 2]) < 0.02
    assert found[:, 2].max() == pytest.approx(4.0, rel=0.02)


def test_where_a_way_passes_twice_it_brakes_the_last_time_and_waits_each_time_in_turn():
    """Two laps of 10 m, 2 pi 10 m each: the pieces of the second lie beside those of the first, up to R / 1000 off."""
    lap = 20.0 * math.pi
    two = Legs((0.0, 0.0), 0.0, [Arc(10.0, 360.0), Arc(10.0, 200.0)]).line()
    given = {"path": two, "speed": 5.0}
    assert Driver("truck", "hmmwv", **given, brake=Brake(at=(0.0, 0.0))).brakes_at == pytest.approx(lap, rel=1e-3)
    once = Driver("truck", "hmmwv", **given, brake=Brake(at=(10.0, 10.0))).brakes_at
    assert once == pytest.approx(1.25 * lap, rel=1e-3)
    times = Driver("truck", "hmmwv", **given, waits=[(10.0, 10.0, 2.0), (0.0, 0.0, 0.0), (10.0, 10.0, 1.0)])._waits
    assert times == [(pytest.approx(0.25 * lap, rel=1e-3), 2.0), (pytest.approx(1.25 * lap, rel=1e-3), 1.0)]


def test_after_a_lap_it_brakes_where_it_began():
    """It sets off, and stands v² / (2 a) after the lap, a = 4 T / r and rolling."""
    lap = ring(10.0, 1.0)
    driver = Driver("truck", "hmmwv", path=lap, speed=4.0, brake=Brake(at=tuple(lap[0]), share=0.5))
    world = WithABall(0.0)
    for k in range(2500):
        driver.drive(world, 0.01 * k)
        for _ in range(10):
            world.step(0.001)
    slows = (0.5 * 4.0 * SPEC.brake_torque / SPEC.wheel_radius + SPEC.rolling * SPEC.mass * G) / SPEC.effective_mass
    fast = 4.0 * math.sqrt(1.0 - (HALF / 10.0) ** 2)  # of the rear axle, inside
    assert driver.distance == pytest.approx(20.0 * math.pi + fast**2 / (2.0 * slows), abs=0.2)
    assert np.abs(world.speed).max() < 0.02


@pytest.mark.parametrize("length", [0.01, 0.1, 0.4, 0.5, 0.51, 1.0])
def test_it_goes_a_short_way_from_rest_to_rest(length):
    driver = Driver("truck", "hmmwv", path=[(0.0, 0.0), (length, 0.0)], speed=3.0)
    found = driven(driver, 4.0)
    assert found[-1, 0] == pytest.approx(length, abs=max(0.02, 0.1 * length)) and abs(found[-1, 2]) < 0.02


@pytest.mark.parametrize("length", [0.2, 3.0, 40.0, 3000.0])
def test_its_timetable_is_that_of_its_speeds(length):
    """From rest to rest at 2 and 3 m/s²: s / v + v (1/2 + 1/3) / 2 where it comes to v, else sqrt(2 s (1/2 + 1/3))."""
    driver = Driver("truck", "hmmwv", path=[(0.0, 0.0), (length, 0.0)], speed=5.0)
    along, when = driver.timetable()
    least = 5.0 / 6.0
    theory = length / 5.0 + 2.5 * least if length > 12.5 * least else math.sqrt(2.0 * length * least)
    assert along[-1] == pytest.approx(length) and when[-1] == pytest.approx(theory, rel=0.1 if length < 1.0 else 0.02)
    waiting = Driver("truck", "hmmwv", path=[(0.0, 0.0), (length, 0.0)], speed=5.0, waits=[(0.5 * length, 0.0, 7.0)])
    along, when = waiting.timetable()
    k = int(np.argmax(np.diff(when)))
    assert np.diff(when)[k] == pytest.approx(7.0) and along[k] == along[k + 1] == pytest.approx(0.5 * length)
    half = 0.5 * length
    part = half / 5.0 + 2.5 * least if half > 12.5 * least else math.sqrt(2.0 * half * least)
    assert when[-1] == pytest.approx(7.0 + 2.0 * part, rel=0.1 if length < 1.0 else 0.02)


@pytest.mark.parametrize("seed", range(5))
def test_it_waits_anywhere_on_its_path(seed):
    """At up to four places, however near the start, the end or each other, and comes to the end."""
    rng = np.random.default_rng(seed)
    places = np.sort(rng.choice([0.01, 0.3, 0.49, 0.5, 5.0, 5.05, 5.4, 5.5, 9.7, 9.99, rng.uniform(1, 9)], 4, False))
    places = places[np.concatenate([[True], np.diff(places) > 0.02])]
    seconds = rng.uniform(0.5, 2.0, len(places))
    waits = [(x, 0.0, t) for x, t in zip(places, seconds, strict=True)]
    driver = Driver("truck", "hmmwv", path=straight(10.0), speed=float(rng.uniform(0.5, 6.0)), waits=waits)
    found = driven(driver, 90.0)
    assert found[-1, 0] == pytest.approx(10.0, abs=0.1)
    for place, time in zip(places, seconds, strict=True):
        near = (np.abs(found[:, 0] - place) < 0.05) & (np.abs(found[:, 2]) < 0.05)
        assert 0.01 * np.count_nonzero(near) > time - 0.4
    assert (driver._left == len(places)).all()


@pytest.mark.parametrize(("lean", "more"), [(15.0, 1.2), (20.0, 1.1), (-15.0, 1.2), (10.0, 0.8)])
def test_it_waits_on_a_slope_whatever_it_carries(lean, more):
    """It knows its own weight alone, and stands to some centimetres."""
    world, slope = Bicycle(slope=math.radians(lean)), math.radians(lean)
    driver = Driver("truck", "hmmwv", path=straight(12.0), speed=2.0, waits=[(4.0, 0.0, 4.0)])
    way = []
    for k in range(3000):
        driver.drive(world, 0.01 * k)
        for _ in range(10):
            world.step(0.001)
            world.speed -= 0.001 * (more - 1.0) * SPEC.mass * G * math.sin(slope) / SPEC.effective_mass
        way.append(world.place[0, 0] / math.cos(slope))
    way = np.array(way)
    assert way[-1] > 11.0
    stood = np.abs(way * math.cos(slope) - 4.0) < 0.1
    assert 3.5 < 0.01 * np.count_nonzero(stood) < 9.0  # what it does not know of takes the sum of its lack some seconds


@pytest.mark.parametrize(
    ("wrong", "says"),
    [
        ({"waits": [5.0]}, "waits[0] = 5.0 must be (x, y, seconds)"),
        ({"waits": 5.0}, "waits = 5.0 must be a list of (x, y, seconds)"),
        ({"waits": [(5.0, 0.0)]}, "waits[0] = (5.0, 0.0) must be (x, y, seconds)"),
        ({"waits": [(5.0, 0.5, 1.0)]}, "is not on the path"),
        ({"waits": [(5.0, 0.0, 1.0), (3.0, 0.0, 1.0)]}, "waits[1] = (3.0, 0.0, 1.0) is not on the path, after"),
        ({"waits": [(5.0, 0.0, -1.0)]}, "waits[0] = -1 must be >= 0 s"),
        ({"brake": 5.0}, "brake = 5.0 must be a Brake"),
        ({"brake": Brake()}, "brake says neither at, nor time, nor near"),
        ({"brake": Brake(near="ball")}, "near and within go together"),
        ({"brake": Brake(near=4, within=1.0)}, "brake.near = 4 must be the name of a body"),
        ({"brake": Brake(at=(5.0, 1.0))}, "brake.at = (5.0, 1.0) is 1 m beside the path; give a place on it"),
        ({"brake": Brake(time=-1.0)}, "brake.time = -1 must be >= 0 s"),
        ({"brake": Brake(time=1.0, share=2.0)}, "brake.share = 2 must be <= 1"),
        ({"brake": Brake(time=1.0, share=0.0)}, "brake.share = 0 must be >= 0.01"),
        ({"brake": Brake(near="truck", within=3.0)}, 'brake.near = "truck" is the vehicle itself'),
        ({"path": [(-6e3, 0.0), (6e3, 0.0)]}, "path is 12000 m long; it must be 10000 m at most"),
        ({"path": [(0.0, 0.0)]}, "path has 1 points; it must be 2"),
        ({"path": [(0.0, 0.0), (0.0, math.nan)]}, "path[1][1] = nan must be finite"),
        ({"speed": 0.0}, "speed = 0 must be > 0"),
        ({"speed": "fast"}, 'speed = "fast" must be a number'),
        ({"spec": "hmwv"}, 'did you mean "hmmwv"?'),
        ({"spec": VehicleSpec(mass=-1.0)}, "spec.mass = -1"),
        ({"vehicle": 3}, "vehicle = 3 must be the name of a vehicle"),
        ({"lateral": -1.0}, "lateral = -1 must be > 0"),
        ({"stop": 1}, "stop = 1 must be True or False"),
        ({"start_speed": -1.0}, "start_speed = -1 must be >= 0"),
    ],
)
def test_a_bad_number_of_a_driver_is_named(wrong, says):
    with pytest.raises(SceneError) as caught:
        Driver(**({"vehicle": "truck", "spec": "hmmwv", "path": straight(10.0), "speed": 3.0} | wrong))
    assert says in str(caught.value) and str(caught.value).startswith("Driver(")


class WithABall(Bicycle):
    """A ball 10 m ahead in the first world, and out of the way in the second."""

    def __init__(self, speed):
        super().__init__(speed)
        for axle in self.axles.values():
            axle.position = np.zeros(2)

    def body(self, name):
        if name == "ball":
            return SimpleNamespace(position=np.array([[10.0, 0.0, 0.0], [10.0, 50.0, 0.0]]))
        return super().body(name)


def test_it_brakes_for_a_body_that_is_near_in_the_world_where_it_is():
    """From 4 m/s at 5 m of it: torque alone, 4 T / r and rolling, stops it in v² / (2 a).

    The other world, where it never comes, goes to the path's end and stops there.
    """
    brake = Brake(near="ball", within=5.0, share=0.5)
    driver = Driver("truck", "hmmwv", path=straight(12.0), speed=4.0, start_speed=4.0, brake=brake)
    world = WithABall(4.0)
    for k in range(500):
        driver.drive(world, 0.01 * k)
        for _ in range(10):
            world.step(0.001)
    slows = 0.5 * 4.0 * SPEC.brake_torque / SPEC.wheel_radius + SPEC.rolling * SPEC.mass * G
    assert world.place[0, 0] == pytest.approx(5.0 + 4.0**2 / (2.0 * slows / SPEC.effective_mass), abs=0.1)
    assert abs(world.speed[0]) < 0.02
    assert world.place[1, 0] == pytest.approx(12.0, abs=0.1) and abs(world.speed[1]) < 0.02
