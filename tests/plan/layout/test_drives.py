"""Which drivers' ways a plan may have: corners, waits, brakes, lengths; and that one drives what is accepted."""

import math
import re

import numpy as np
import pytest

from tests.scene.test_driver import driven as on_a_bicycle
from wsim.plan.layout import LayoutError
from wsim.plan.layout.drives import line_of, stops
from wsim.plan.layout.land import set_down
from wsim.plan.schema import Plan
from wsim.program.compose import compose
from wsim.scene import Driver

G = 9.81
GROUND = {"name": "ground", "role": "terrain", "state": "static",
          "material": {"name": "a", "density": 1, "friction": 0.9},
          "construction": {"kind": "proxy", "primitive": "ground"}}  # fmt: skip
LAND = {"name": "land", "role": "terrain", "state": "static",
        "material": {"name": "soil", "density": 1600, "friction": 0.85},
        "construction": {"kind": "terrain", "extent": [40.0, 30.0], "layers": [
            {"kind": "level", "position": [0.0, 0.0], "radius": 30.0}]}}  # fmt: skip
BALL = {"name": "ball", "role": "rigid_body", "pose": {"position": [0.0, 13.0, 1.0]},
        "material": {"name": "rubber", "density": 900},
        "construction": {"kind": "proxy", "primitive": "sphere", "size": [0.5]}}  # fmt: skip
WHERE = "objects.1.registration.actuation.0"


def arc(radius, angle_deg):
    return {"radius": radius, "angle_deg": angle_deg}


def planned(*route, ground=GROUND, start=(0.0, 0.0), yaw=0.0, kind="car", velocity=0.0, duration=3000.0, **actuation):
    car = {"name": "car", "role": "vehicle", "construction": {"kind": "vehicle", "vehicle": kind},
           "pose": {"position": [*start, 0.0], "rotation_deg": [0.0, 0.0, yaw]}, "velocity": [velocity, 0.0, 0.0],
           "registration": {"actuation": [{"kind": "driver", "speed": 5.0, "route": route, **actuation}]}}  # fmt: skip
    objects = [ground, car, BALL]
    data = {"title": "", "prompt": "", "objects": objects, "simulation": {"duration": duration}}
    return set_down(Plan.model_validate(data))


def driver_of(plan):
    """As its program makes it."""
    space = {}
    exec(compose(plan), space)
    return next(each for each in space.values() if isinstance(each, Driver))


@pytest.mark.parametrize(
    ("route", "says"),
    [
        ([arc(8, 90), [8, 20], [8, 5]], "route.2: car is to turn by 180 deg on the spot where this leg begins; 45 deg"),
        ([[15, 0], [5, 2], arc(8, 90)], "route.1: car is to turn by 169 deg on the spot"),
        ([arc(8, 90), [20, 8]], "route.1: car is to turn by 90 deg on the spot where this leg begins; 45 deg at most: "
                                "put an arc of 4.36 m or more there"),
        ([[0, 9], arc(8, 90)], "route.0: car is to turn by 90 deg on the spot where this leg begins; 45 deg at most: "
                               "start it along its way, or put an arc first"),
        ([[9, 0], [10, 1], [10, 2], arc(8, 90)], "route.1: car takes 5.42 m to turn by the corners at the ends of this "
                                                 "leg, which is 1.41 m long; make it longer, or put an arc of"),
        ([arc(4.3, 90)], "route.0.radius: car is to drive round an arc of 4.3 m"),
        ([arc(10, 1e-6)], "route: Legs(): legs[0].angle_deg = 1e-06 makes an arc of"),
        ([arc(2000, 90)], "route: Legs(): legs[0].radius = 2000 must be <= 1000 m"),
        ([arc(500, 2000)], "route: Legs(): legs[0] ends 17453.3 m along the line, which is 10000 m long at most"),
        ([[9e3, 0], [0, 9]], "route: 18000 m long; it must be 10000 m at most: leave points out"),
    ],
)  # fmt: skip
def test_a_way_that_cannot_be_driven_is_refused(route, says):
    with pytest.raises(LayoutError, match=re.escape(f"{WHERE}.{says}")):
        planned(*route)


def test_the_corners_of_a_smooth_way_are_its_own():
    """Without an arc a natural spline goes through the points, and has none."""
    assert planned([15, 0], [15, 15])


@pytest.mark.parametrize("seed", range(6))
def test_what_is_accepted_is_driven_to_its_end(seed):
    """Random legs and arcs, headings aside of the first, drawn until one is accepted: it ends at the last way-point."""
    rng = np.random.default_rng(seed)
    while True:
        at, turn, route = np.zeros(2), 0.0, []
        for _ in range(3):
            if rng.random() < 0.4:
                route.append(arc(rng.uniform(7.0, 12.0), rng.choice([-1, 1]) * rng.uniform(20.0, 120.0)))
            else:
                route.append(None)
        for k, leg in enumerate(route):  # points aside of where the way goes by up to 45 deg
            if leg is None:
                turn += math.radians(rng.uniform(-45.0, 45.0))
                at = at + rng.uniform(3.0, 12.0) * np.array([math.cos(turn), math.sin(turn)])
                route[k] = [float(at[0]), float(at[1])]
            else:
                side, angle = math.copysign(leg["radius"], leg["angle_deg"]), math.radians(leg["angle_deg"])
                ahead, left = math.sin(angle) * side, (1.0 - math.cos(angle)) * side
                at = (
                    at
                    + ahead * np.array([math.cos(turn), math.sin(turn)])
                    + left * np.array([-math.sin(turn), math.cos(turn)])
                )
                turn += angle
        try:
            plan = planned(*route, arc(8.0, 30.0), yaw=0.0, kind="hmmwv")
        except LayoutError:
            continue
        break
    item = plan.objects[1]
    line = line_of(item, item.registration.actuation[0])
    driver = Driver("truck", "hmmwv", path=line, speed=5.0)
    found = on_a_bicycle(driver, driver.timetable()[1][-1] + 4.0)
    assert math.dist(found[-1, :2], line[-1]) < 0.3 and abs(found[-1, 2]) < 0.02


@pytest.mark.parametrize(
    ("angle", "laps"), [(360.0, 1.0), (720.0, 2.0), (500.0, 500.0 / 360.0), (-1100.0, 1100.0 / 360.0)]
)
def test_it_waits_at_the_end_of_an_arc_of_many_turns(angle, laps):
    plan = planned([4, 0], arc(10.0, angle), arc(10.0, 90.0), waits=[0, 2])
    assert driver_of(plan)._waits == [(pytest.approx(4.0 + laps * 20.0 * math.pi, rel=1e-3), 2.0)]


def test_after_a_lap_it_brakes_at_its_end():
    plan = planned(arc(10.0, 360.0), brake={"at": [0.0, 0.0]})
    assert driver_of(plan).brakes_at == pytest.approx(20.0 * math.pi, rel=1e-3)


@pytest.mark.parametrize("route", [[arc(100, 3600)], [[1500, 0], arc(10, 90)], [[4000.0, 1.0]]])
def test_long_ways_are_accepted(route):
    assert driver_of(planned(*route)).timetable()[0][-1] > 1000.0


@pytest.mark.parametrize("friction", [0.1, 0.9, 2.0])
def test_its_stop_takes_as_long_as_the_smaller_friction_says(friction):
    """From 12 m/s, 20 m on: 20 / 12 s, and v / (g min(mu, 0.9))."""
    ground = {**GROUND, "material": {**GROUND["material"], "friction": friction}}
    given = {"ground": ground, "velocity": 12.0, "speed": 12.0, "brake": {"at": [20, 0]}}
    takes = 20.0 / 12.0 + 12.0 / (G * min(friction, 0.9))
    with pytest.raises(LayoutError, match=rf"simulation\.duration: {takes - 0.01:g} s: car takes {takes:.3g} s along"):
        planned([20, 0], **given, duration=round(takes - 0.01, 5))
    assert planned([20, 0], **given, duration=takes + 0.01)


def test_waits_after_a_brake_take_no_time():
    """Until 10 m, from 5 m/s, and the stop; of the wait before it, its time and that from 5 m/s to rest and back."""
    stop, given = 5.0 / (0.9 * G), {"velocity": 5.0, "brake": {"at": [10, 0]}}
    after = 10.0 / 5.0 + stop
    assert planned([15, 0], [20, 0], waits=[50.0], **given, duration=after + 0.3)  # it slows down for that wait
    # Back to v at 10 m: v² = 2 a 5, so 5 m at 5 m/s but braking, a standstill, and v / a.
    fast = math.sqrt(2.0 * 2.0 * 5.0)
    before = (5.0 - 25.0 / 6.0) / 5.0 + 5.0 / 3.0 + 50.0 + fast / 2.0 + fast / (0.9 * G)
    with pytest.raises(LayoutError, match=rf"car takes {before:.3g} s along"):
        planned([5, 0], [10, 0], [20, 0], waits=[50.0], **given, duration=20.0)


def test_a_brake_that_comes_too_late_is_named():
    with pytest.raises(
        LayoutError, match=rf"^{WHERE}\.brake\.time: 2 s: car then stands at 2\.57 s, and the run ends at 2"
    ):
        planned([90, 0], velocity=5.0, brake={"time": 2.0}, duration=2.5)
    with pytest.raises(LayoutError, match=r"brake\.time: 50 s: car then stands at 50 s, and the run ends at 40 s"):
        planned([20, 0], brake={"time": 50.0}, duration=40.0)


@pytest.mark.parametrize(
    ("brake", "says"),
    [
        ({"at": [19, 0]}, r"brake: car is driven to \(22\.84, 0\) m, where land is not; brake earlier"),
        ({"time": 5.0}, None),  # it is at the end by then
        ({"near": "ball", "within": 0.5}, None),  # never; it stops at the end
        ({"at": [16, 0]}, None),
    ],
)
def test_where_it_stops_is_on_terrain(brake, says):
    """From 8 m/s: 64 / (2 mu g) = 3.84 m, mu = 0.85 the ground's; the edge is at 20 m."""
    given = {"ground": LAND, "start": (-10.0, 0.0), "velocity": 8.0, "speed": 8.0, "duration": 30.0}
    if says is None:
        assert planned([19, 0], brake=brake, **given)
        return
    with pytest.raises(LayoutError, match=says):
        planned([19, 0], brake=brake, **given)


def test_it_slides_straight_on_where_it_brakes_in_a_bend():
    """At 0.9 rad of 13 m, 2.9 m from the edge: 39 / (2 mu g) = 5 m from sqrt(3 x 13) m/s, 3.1 m of it along +X."""
    ground = {**LAND, "material": {**LAND["material"], "friction": 0.4}}
    given = {"ground": ground, "start": (6.9, -13.0), "velocity": 5.0, "speed": 8.0, "duration": 30.0}
    assert planned(arc(13.0, 150.0), **given)
    for angle, off in ((0.2, False), (0.9, True), (1.7, False)):
        brake = {"at": [6.9 + 13.0 * math.sin(angle), -13.0 * math.cos(angle)]}
        if not off:
            assert planned(arc(13.0, 150.0), brake=brake, **given)
            continue
        with pytest.raises(LayoutError, match=rf"^{WHERE}\.brake: car is driven to \(20\.\d+, -4\.\d+\) m, where"):
            planned(arc(13.0, 150.0), brake=brake, **given)


def test_zero_waits_say_which_pass_is_meant():
    item = planned(arc(10.0, 720.0), waits=[2.0]).objects[1]
    assert [seconds for *_, seconds in stops(item, item.registration.actuation[0])] == [0.0, 2.0]
