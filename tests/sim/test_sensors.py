"""Sensors in the simulator, against closed forms: what an IMU and a joint sensor tell."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from wsim.errors import UserError
from wsim.recording import Recording, read
from wsim.recording.sensors import SensorTrack
from wsim.scene import Drive, Scene
from wsim.scene.world_sensors import channels
from wsim.sim import Simulation
from wsim.sim.alike import alike

G = 9.81
Build = Callable[[Scene], object]


def stage(folder: Path, build: Build, duration: float = 0.5, name: str = "stage") -> Path:
    scene = Scene()
    scene.simulation(duration=duration, frame_rate=50.0, time_step=0.00125)
    build(scene)
    return scene.save(folder / f"{name}.usda")


def recorded(folder: Path, build: Build, duration: float = 0.5) -> Recording:
    result = Simulation(stage(folder, build, duration), device="cpu").run(folder / "recording.rrd")
    assert result.problems == []
    return read(folder / "recording.rrd")


def told(folder: Path, build: Build, duration: float = 0.5) -> SensorTrack:
    (track,) = recorded(folder, build, duration).sensors.values()
    return track


def test_at_rest_it_feels_the_floor_push_up(tmp_path: Path) -> None:
    def build(scene: Scene) -> None:
        scene.ground()
        box = scene.box("box", size=(0.2, 0.2, 0.2), position=(0.0, 0.0, 0.1))
        scene.sensor_imu("imu", box, position=(0.05, 0.0, 0.02), rotation_deg=(90.0, 0.0, 0.0))

    track = told(tmp_path, build)  # its Y is up
    np.testing.assert_allclose(track.time, np.arange(1, 51) * 0.01, atol=1e-9)
    np.testing.assert_allclose(track["accelerometer"], [(0.0, G, 0.0)] * 50, atol=2e-3)
    np.testing.assert_allclose(track["gyroscope"], 0.0, atol=1e-3)


def test_in_free_fall_it_feels_nothing(tmp_path: Path) -> None:
    def build(scene: Scene) -> None:
        ball = scene.sphere("ball", radius=0.1, position=(0.0, 0.0, 9.0), velocity=(1.0, 2.0, 3.0))
        scene.sensor_imu("imu", ball, position=(0.05, 0.0, 0.0))

    np.testing.assert_allclose(told(tmp_path, build)["accelerometer"], 0.0, atol=1e-3)


@pytest.mark.parametrize("deg_per_second", [180.0, 1800.0])
def test_on_a_turntable_it_feels_the_pull_to_the_axis(tmp_path: Path, deg_per_second: float) -> None:
    """w^2 r inwards, as the mean over the arc of an interval has it: times sin(a) / a of half its angle a."""
    radius, spin = 0.4, math.radians(deg_per_second)

    def build(scene: Scene) -> None:
        disc = scene.cylinder(
            "disc", radius=0.5, height=0.1, position=(6.0, 0.0, 1.0), angular_velocity_deg=(0.0, 0.0, deg_per_second)
        )
        scene.joint_revolute("axle", None, disc, axis="Z")
        scene.sensor_imu("imu", disc, position=(0.0, radius, 0.0), rotation_deg=(0.0, 0.0, 90.0))  # its X is outwards

    track, half = told(tmp_path, build), 0.5 * spin * 0.01
    wanted = -(spin**2) * radius * math.sin(half) / half
    np.testing.assert_allclose(track["accelerometer"], [(wanted, 0.0, G)] * 50, atol=2e-5 * abs(wanted) + 1e-3)
    np.testing.assert_allclose(track["gyroscope"], [(0.0, 0.0, spin)] * 50, atol=1e-5 * spin)


def test_a_body_that_tumbles_freely_feels_what_turning_adds(tmp_path: Path) -> None:
    """About its centre of mass: w x (w x r), whatever else it does."""
    spin, arm = np.radians((0.0, 0.0, 360.0)), np.array((0.1, 0.0, 0.05))

    def build(scene: Scene) -> None:
        box = scene.box(
            "box", size=(0.4, 0.4, 0.4), position=(0.0, 0.0, 9.0), velocity=(3.0, 0.0, 0.0),
            angular_velocity_deg=tuple(np.degrees(spin)),
        )  # fmt: skip
        scene.sensor_imu("imu", box, position=tuple(arm), rate=400.0)

    wanted = np.cross(spin, np.cross(spin, arm))
    np.testing.assert_allclose(told(tmp_path, build)["accelerometer"], [wanted] * 200, atol=1e-3)


def test_on_a_pendulum_it_feels_the_rod_pull(tmp_path: Path) -> None:
    """Along the rod g cos(theta) + v^2 / l, and nothing across it: the bob falls freely that way."""
    length, start = 1.0, 0.5

    def build(scene: Scene) -> None:
        bob = scene.sphere(
            "bob", radius=0.01, position=(-length * math.sin(start), 0.0, 5.0 - length * math.cos(start))
        )
        scene.joint_revolute("pivot", None, bob, axis="Y", anchor=(0.0, 0.0, 5.0))
        scene.sensor_imu("imu", bob, rotation_deg=(0.0, math.degrees(start), 0.0), rate=200.0)  # Z to the pivot
        scene.sensor_joints("angle", "pivot", rate=400.0)

    recording = recorded(tmp_path, build, 1.0)
    imu, angle = recording.sensors["/World/imu"], recording.sensors["/World/angle"]
    swung = start + np.interp(imu.time - 0.0025, angle.time, angle["position"][:, 0])
    speed = np.interp(imu.time - 0.0025, angle.time, angle["velocity"][:, 0]) * length
    assert np.ptp(swung) > 0.9
    wanted = G * np.cos(swung) + speed**2 / length
    np.testing.assert_allclose(imu["accelerometer"][:, 2], wanted, atol=2e-3)
    np.testing.assert_allclose(imu["accelerometer"][:, :2], 0.0, atol=5e-3)
    # The energy gives the speed as well: v^2 = 2 g l (cos(theta) - cos(start)).
    np.testing.assert_allclose(
        imu["accelerometer"][:, 2], 3.0 * G * np.cos(swung) - 2.0 * G * math.cos(start), atol=6e-3
    )


def test_its_noise_has_the_density_that_it_is_given(tmp_path: Path) -> None:
    """A sample's deviation is the density times the root of the rate; each sensor has noise of its own."""
    bias = {"accelerometer": (0.1, 0.0, -0.2), "gyroscope": (0.0, 0.5, 0.0)}

    def build(scene: Scene) -> None:
        ball = scene.sphere("ball", radius=0.1, position=(0.0, 0.0, 90.0))
        for name in ("one", "two"):
            scene.sensor_imu(
                name, ball, accelerometer_noise=0.02, gyroscope_noise=0.003, accelerometer_bias=bias["accelerometer"],
                gyroscope_bias=bias["gyroscope"], seed=7, rate=400.0,
            )  # fmt: skip

    first, again = (recorded(tmp_path, build, 2.0).sensors for _ in range(2))
    for channel, density in (("accelerometer", 0.02), ("gyroscope", 0.003)):
        one, two = (first[f"/World/{name}"][channel] - bias[channel] for name in ("one", "two"))
        interval = np.diff(first["/World/one"].time).mean()  # of whole steps: 1 / 400 s if those fit in
        deviation, few = density / math.sqrt(interval), 4.0 / math.sqrt(one.size)  # four standard errors
        assert one.size > 2000 and one.std() == pytest.approx(deviation, rel=few)
        assert np.abs(one.mean(axis=0)).max() < math.sqrt(3.0) * few * deviation
        assert abs(np.corrcoef(one.ravel(), two.ravel())[0, 1]) < few
        np.testing.assert_array_equal(first["/World/one"][channel], again["/World/one"][channel])


def arm(scene: Scene, **drive: float) -> None:
    """A horizontal arm, 1 m and 1 kg, held at its end."""
    held = scene.box("arm", size=(1.0, 0.1, 0.1), position=(0.5, 0.0, 2.0), mass=1.0)
    scene.joint_revolute("motor", None, held, axis="Y", anchor=(0.0, 0.0, 2.0), drive=Drive(**drive))
    scene.sensor_joints("servo", "motor")


def test_the_effort_of_a_servo_is_what_it_holds(tmp_path: Path) -> None:
    def build(scene: Scene) -> None:
        arm(scene, stiffness=2000.0, damping=100.0)
        cart = scene.box("cart", size=(0.1, 0.1, 0.1), position=(0.0, 5.0, 1.0), velocity=(0.0, 0.5, 0.0))
        scene.joint_prismatic("rail", None, cart, axis="Y")
        scene.sensor_joints("both", ["motor", "rail"], rate=50.0)

    track = recorded(tmp_path, build, 1.0).sensors["/World/both"]
    assert track.time[0] == 0.0 and track.time[-1] == 1.0 and len(track.time) == 51
    np.testing.assert_allclose(track["effort"][0], 0.0)
    assert track["effort"][-1, 0] == pytest.approx(-0.5 * G, rel=1e-4)
    assert track["position"][-1, 0] == pytest.approx(0.5 * G / 2000.0, rel=1e-3)
    np.testing.assert_allclose(track["position"][:, 1], 0.5 * track.time, atol=1e-5)
    np.testing.assert_allclose(track["velocity"][:, 1], 0.5, atol=1e-5)
    np.testing.assert_allclose(track["effort"][:, 1], 0.0)


def test_a_joint_without_a_position_of_its_own_is_refused(tmp_path: Path) -> None:
    def build(scene: Scene) -> None:
        door = scene.box("door", size=(1.0, 0.1, 1.0), position=(0.5, 0.0, 2.0))
        scene.joint_revolute("hinge", None, door, axis="Z", break_force=1e4)
        scene.sensor_joints("angle", "hinge")

    with pytest.raises(UserError, match="/World/angle: its joint /World/hinge closes a loop or may break"):
        Simulation(stage(tmp_path, build), device="cpu")


def test_control_is_told_the_sample_of_its_own_time(tmp_path: Path) -> None:
    def build(scene: Scene) -> None:
        arm(scene, stiffness=200.0, damping=10.0)
        scene.sensor_imu("imu", "arm", rate=50.0)

    seen: list[tuple[float, np.ndarray, float]] = []

    def exchange(t: float, simulation: Any) -> None:
        seen.append((t, simulation.sensors.flat().copy(), float(simulation.state.joint_q.numpy()[0])))

    path = stage(tmp_path, build)
    simulation = Simulation(path, device="cpu", controller=exchange)
    assert channels(simulation.world.sensors) == [
        ("/World/servo", "position", (1,)), ("/World/servo", "velocity", (1,)), ("/World/servo", "effort", (1,)),
        ("/World/imu", "accelerometer", (3,)), ("/World/imu", "gyroscope", (3,)),
    ]  # fmt: skip
    simulation.run(tmp_path / "recording.rrd")
    track = read(tmp_path / "recording.rrd").sensors["/World/servo"]
    np.testing.assert_allclose([each[0] for each in seen], track.time[:-1])
    np.testing.assert_allclose([each[1][0, 0] for each in seen], [each[2] for each in seen])
    np.testing.assert_allclose([each[1][0, 0] for each in seen], track["position"][:-1, 0], atol=1e-7)
    np.testing.assert_allclose(seen[0][1][0, 3:], (0.0, 0.0, G, 0.0, 0.0, 0.0), atol=1e-6)
    np.testing.assert_array_equal(seen[2][1][0, 3:], seen[3][1][0, 3:])  # between two samples
    assert not Simulation(path, device="cpu").controlled  # sensors drive nothing


def test_what_sensors_read_changes_nothing(tmp_path: Path) -> None:
    """But for what is rounded between steps that are no longer taken in one go."""

    def build(scene: Scene, sensed: bool = True) -> None:
        scene.ground()
        box = scene.box("box", size=(0.2, 0.2, 0.2), position=(0.0, 0.0, 0.5), velocity=(1.0, 0.0, 0.0))
        if sensed:
            scene.sensor_imu("imu", box)

    ends = [recorded(tmp_path, lambda scene, on=on: build(scene, on)).body_q[-1] for on in (False, True)]
    np.testing.assert_allclose(ends[1], ends[0], atol=2e-6)


def test_worlds_whose_sensors_differ_in_numbers_are_alike(tmp_path: Path) -> None:
    def build(scene: Scene, reach: float = 0.1, rate: float = 100.0) -> None:
        ball = scene.sphere("ball", radius=0.1, position=(0.0, 0.0, 5.0))
        scene.sensor_imu("imu", ball, position=(reach, 0.0, 0.0), rate=rate)

    numbers = ({}, {"reach": 0.2}, {"rate": 50.0})
    stages = [stage(tmp_path, lambda s, n=n: build(s, **n), name=f"s{k}") for k, n in enumerate(numbers)]
    assert alike([Simulation(each, device="cpu").world for each in stages]) == [[0, 1], [2]]


def room(scene: Scene, **scan: Any) -> None:
    """A room of 8 m by 6 m with a car in it, 1 m off its middle, that looks along +X."""
    for name, x, y, size in (
        ("front", 4.05, 0.0, (0.1, 6.0, 5.0)), ("back", -4.05, 0.0, (0.1, 6.0, 5.0)),
        ("left", 0.0, 3.05, (8.2, 0.1, 5.0)), ("right", 0.0, -3.05, (8.2, 0.1, 5.0)),
    ):  # fmt: skip
        scene.box(name, size=size, position=(x, y, 2.5), static=True)
    scene.ground()
    car = scene.box("car", size=(0.5, 0.3, 0.2), position=(1.0, 0.0, 1.0), kinematic=True)
    scene.path(car, times=(0.0, 0.5), positions=((1.0, 0.0, 1.0), (2.0, 0.0, 1.0)))
    scene.sensor_range("lidar", car, position=(0.2, 0.1, 0.0), rate=25.0, **scan)


def to_the_walls(x: float, y: float, angles: np.ndarray) -> np.ndarray:
    """Distances in the room's plane from a place in it."""
    along = np.stack([np.cos(angles), np.sin(angles)])
    left = np.sign(along) * np.array([[4.0], [3.0]]) - np.array([[x], [y]])
    ahead = np.divide(left, along, out=np.full_like(along, math.inf), where=np.abs(along) > 1e-12)
    return np.asarray(ahead.min(axis=0))


def test_a_scan_of_a_room_is_the_distance_to_its_walls(tmp_path: Path) -> None:
    """The rays start inside of the body that carries the sensor, and do not see it."""
    recording = recorded(tmp_path, lambda s: room(s, rays=360, fan_deg=(-180.0, 180.0)))
    track = recording.sensors["/World/lidar"]
    angles = np.radians(np.arange(-180.0, 180.0, 1.0))
    assert track["distance"].shape == (13, 1, 360)
    for t, scan in zip(track.time, track["distance"], strict=True):
        x = recording.position("/World/car")[recording.frame_index(float(t)), 0]
        np.testing.assert_allclose(scan[0], to_the_walls(x + 0.2, 0.1, angles), rtol=2e-6)
    assert np.ptp(track["distance"][:, 0, 180]) > 0.98


def test_layers_meet_the_ground_and_the_walls_higher_up(tmp_path: Path) -> None:
    track = told(tmp_path, lambda s: room(s, rays=3, fan_deg=(-45.0, 45.0), layers=3, tilt_deg=(-30.0, 30.0)))
    flat, slant = to_the_walls(1.2, 0.1, np.radians((-45.0, 0.0, 45.0))), math.cos(math.radians(30.0))
    low, level, high = track["distance"][0]
    np.testing.assert_allclose(level, flat, rtol=2e-6)
    np.testing.assert_allclose(low, np.minimum(2.0, flat / slant), rtol=2e-6)  # 1 m over the ground: 1 / sin(30)
    np.testing.assert_allclose(high, flat / slant, rtol=2e-6)


def test_what_is_too_near_or_too_far_is_not_seen(tmp_path: Path) -> None:
    track = told(tmp_path, lambda s: room(s, rays=4, fan_deg=(-180.0, 180.0), nearest=2.85, farthest=5.0))
    np.testing.assert_allclose(track["distance"][0], [[math.inf, 3.1, math.inf, 2.9]], rtol=2e-6)  # 5.2, 3.1, 2.8, 2.9


def test_a_scan_of_a_ball_has_its_curve(tmp_path: Path) -> None:
    """From a place in the world, turned: d cos(b) - sqrt(r^2 - d^2 sin^2(b)), and nothing beside it; glass is seen."""
    away, radius = 3.0, 0.8

    def build(scene: Scene) -> None:
        glass = scene.material("glass", opacity=0.2)
        scene.sphere("ball", radius=radius, position=(1.0, away, 2.0), static=True, material=glass)
        scene.sensor_range(
            "eye", None, position=(1.0, 0.0, 2.0), rotation_deg=(0.0, 0.0, 90.0), rays=61, fan_deg=(-30.0, 30.0),
            rate=2.0,
        )  # fmt: skip

    aside = np.radians(np.linspace(-30.0, 30.0, 61))
    under = radius**2 - (away * np.sin(aside)) ** 2
    wanted = np.where(under > 0.0, away * np.cos(aside) - np.sqrt(np.maximum(under, 0.0)), np.inf)
    assert 20 < np.isfinite(wanted).sum() < 40
    np.testing.assert_allclose(told(tmp_path, build)["distance"][:, 0], [wanted] * 2, rtol=1e-5)


def test_a_scan_is_the_same_with_pictures(tmp_path: Path) -> None:
    """Those are drawn without the glass."""

    def build(scene: Scene) -> None:
        glass = scene.material("glass", opacity=0.2)
        scene.box("pane", size=(0.1, 2.0, 2.0), position=(3.0, 0.0, 1.0), static=True, material=glass)
        scene.camera("side", eye=(0.0, -6.0, 2.0), target=(1.0, 0.0, 1.0), width=32, height=32)
        scene.sensor_range("eye", None, position=(0.0, 0.0, 1.0), rays=1, rate=10.0)

    path = stage(tmp_path, build, 0.2)
    Simulation(path, device="cpu", draws=True).run(tmp_path / "r.rrd", video=tmp_path / "v.mp4")
    np.testing.assert_allclose(read(tmp_path / "r.rrd").sensors["/World/eye"]["distance"], [[[2.95]]] * 3, rtol=2e-6)


def test_a_scan_tells_nothing_beyond_its_bounds_however_noisy(tmp_path: Path) -> None:
    track = told(tmp_path, lambda s: room(s, rays=360, fan_deg=(-180.0, 180.0), noise=5.0, nearest=1.0, farthest=3.0))
    seen = track["distance"][np.isfinite(track["distance"])]
    assert seen.size > 100 and seen.min() >= 1.0 and seen.max() <= 3.0


def test_the_noise_of_a_scan_has_its_deviation(tmp_path: Path) -> None:
    track = told(tmp_path, lambda s: room(s, rays=720, fan_deg=(-180.0, 180.0), noise=0.01, seed=3))
    off = track["distance"][0, 0] - to_the_walls(1.2, 0.1, np.radians(np.arange(-180.0, 180.0, 0.5)))
    assert off.std() == pytest.approx(0.01, rel=4.0 / math.sqrt(2.0 * 720))
    assert abs(off.mean()) < 4.0 * 0.01 / math.sqrt(720)


def test_what_lies_on_a_slope_feels_its_weight_in_its_own_axes(tmp_path: Path) -> None:
    tilt, mass = math.radians(20.0), 2.0

    def build(scene: Scene) -> None:
        turn = (0.0, math.degrees(tilt), 0.0)
        up = np.array((math.sin(tilt), 0.0, math.cos(tilt)))
        scene.box("slope", size=(4.0, 1.0, 0.1), rotation_deg=turn, static=True, friction=0.8)
        box = scene.box("box", size=(0.2,) * 3, position=tuple(0.15 * up), rotation_deg=turn, mass=mass, friction=0.8)
        scene.sensor_contact("skin", box)
        scene.sensor_contact("turned", box, rotation_deg=(0.0, 0.0, 180.0))

    sensors = recorded(tmp_path, build, 1.0).sensors
    wanted = np.array((-math.sin(tilt), 0.0, math.cos(tilt))) * mass * G
    assert len(sensors["/World/skin"].time) == 100
    np.testing.assert_allclose(sensors["/World/skin"]["force"][20:], [wanted] * 80, atol=1e-4)
    np.testing.assert_allclose(sensors["/World/turned"]["force"][20:], [wanted * (-1, 1, 1)] * 80, atol=1e-4)
    np.testing.assert_array_equal(sensors["/World/skin"]["touching"], 1.0)


def test_a_ball_feels_nothing_until_it_lands(tmp_path: Path) -> None:
    height = 0.5

    def build(scene: Scene) -> None:
        scene.ground()
        ball = scene.sphere("ball", radius=0.1, position=(0.0, 0.0, 0.1 + height), mass=1.0)
        scene.sensor_contact("skin", ball)
        scene.sensor_contact("numb", ball, threshold=20.0)

    sensors = recorded(tmp_path, build, 1.0).sensors
    track, lands = sensors["/World/skin"], math.sqrt(2.0 * height / G)
    before = track.time < lands - 0.002
    assert not track["touching"][before].any() and not track["force"][before].any()
    np.testing.assert_array_equal(track["touching"][track.time > lands + 0.3], 1.0)
    late = track["force"][track.time > lands + 0.3]
    np.testing.assert_allclose(late, [(0.0, 0.0, G)] * len(late), atol=0.02)
    assert not sensors["/World/numb"]["touching"][track.time > lands + 0.3].any()


def test_what_is_squeezed_is_touched_and_its_forces_cancel(tmp_path: Path) -> None:
    def build(scene: Scene) -> None:
        scene.simulation(gravity=(0.0, 0.0, 0.0))
        box = scene.box("box", size=(0.2, 0.2, 0.2), position=(0.0, 0.0, 1.0), mass=1.0)
        scene.box("wall", size=(0.1, 1.0, 1.0), position=(-0.15, 0.0, 1.0), static=True)
        plate = scene.box("plate", size=(0.1, 0.2, 0.2), position=(0.15, 0.0, 1.0), mass=1.0)
        drive = Drive(stiffness=1000.0, damping=100.0, position=-0.01)  # into the box: 10 N
        scene.joint_prismatic("press", None, plate, axis="X", drive=drive)
        scene.sensor_contact("skin", box)
        scene.sensor_contact("hand", plate)

    sensors = recorded(tmp_path, build).sensors
    late = slice(25, None)
    np.testing.assert_array_equal(sensors["/World/skin"]["touching"][late], 1.0)
    np.testing.assert_allclose(sensors["/World/skin"]["force"][late], 0.0, atol=0.05)
    np.testing.assert_allclose(sensors["/World/hand"]["force"][late, 0], 10.0, rtol=0.02)


def test_each_world_of_a_batch_has_sensors_of_its_own(tmp_path: Path) -> None:
    """Stages that differ in numbers: a mass, a drive, a wall, and where the sensors are."""
    masses, goals, away, spin = (1.0, 3.0), (0.0, 0.2), (2.0, 2.5), math.radians(90.0)

    def build(scene: Scene, k: int) -> None:
        scene.ground()
        box = scene.box("box", size=(0.2, 0.2, 0.2), position=(0.0, 3.0, 0.1), mass=masses[k])
        scene.sensor_imu("still", box, rotation_deg=(0.0, 90.0 * k, 0.0))
        scene.sensor_contact("skin", box)
        disc = scene.cylinder(
            "disc", radius=0.5, height=0.1, position=(6.0, 0.0, 1.0), angular_velocity_deg=(0.0, 0.0, 90.0)
        )
        scene.joint_revolute("axle", None, disc, axis="Z")
        scene.sensor_imu("turning", disc, position=(0.2 + 0.2 * k, 0.0, 0.0))
        arm = scene.box("arm", size=(0.2, 0.2, 0.2), position=(0.0, -4.0, 1.0), mass=1.0)
        drive = Drive(stiffness=1000.0, damping=60.0, position=goals[k])
        scene.joint_prismatic("lift", None, arm, axis="Z", drive=drive)
        scene.sensor_joints("encoder", "lift")
        scene.box("wall", size=(0.2, 1.0, 1.0), position=(away[k] + 0.1, 0.0, 1.5), static=True)
        scene.sensor_range("eye", None, position=(0.0, 0.0, 1.5), rays=2, fan_deg=(0.0, 180.0))

    stages = [stage(tmp_path, lambda s, k=k: build(s, k), name=f"s{k}") for k in range(2)]
    simulation = Simulation(stages, device="cpu")
    for _ in range(25):
        simulation.advance_frame()
    simulation.sensors.ask(simulation.step_count, simulation)
    begin = np.cumsum([0, *(math.prod(shape) for _, _, shape in channels(simulation.world.sensors))])
    flat = simulation.sensors.flat()
    assert flat.shape == (2, begin[-1])
    for k in range(2):
        told = {
            (prim.removeprefix("/World/"), name): flat[k, begin[i] : begin[i + 1]]
            for i, (prim, name, _) in enumerate(channels(simulation.world.sensors))
        }
        up = (-G, 0.0, 0.0) if k else (0.0, 0.0, G)
        np.testing.assert_allclose(told["still", "accelerometer"], up, atol=0.01)
        np.testing.assert_allclose(told["skin", "force"], (0.0, 0.0, masses[k] * G), rtol=1e-3, atol=0.01)
        assert told["skin", "touching"] == 1.0
        np.testing.assert_allclose(told["turning", "accelerometer"], (-(spin**2) * (0.2 + 0.2 * k), 0.0, G), atol=0.02)
        np.testing.assert_allclose(told["turning", "gyroscope"], (0.0, 0.0, spin), atol=1e-3)
        assert told["encoder", "position"] == pytest.approx(goals[k] - G / 1000.0, abs=1e-3)
        assert told["encoder", "effort"] == pytest.approx(G, rel=0.01)
        np.testing.assert_allclose(told["eye", "distance"], (away[k], math.inf), rtol=1e-6)


def test_copies_of_a_stage_have_noise_of_their_own(tmp_path: Path) -> None:
    def build(scene: Scene) -> None:
        ball = scene.sphere("ball", radius=0.1, position=(0.0, 0.0, 5.0))
        scene.sensor_imu("imu", ball, gyroscope_noise=0.01)

    path = stage(tmp_path, build, 0.1)

    def spins(**options: Any) -> np.ndarray:
        simulation = Simulation(path, device="cpu", **options)
        simulation.advance_frame()
        return simulation.sensors.flat()[:, 3:]

    together = spins(world_count=3, seeds=[0, 5, 6])
    assert len({tuple(row) for row in together}) == 3
    np.testing.assert_array_equal(together[[1]], spins(seeds=[5]))  # by itself it is the same


@pytest.mark.parametrize("device", ["cpu", pytest.param("cuda:0", marks=pytest.mark.cuda)])
def test_worlds_at_once_tell_what_one_in_c_does(tmp_path: Path, device: str) -> None:
    def build(scene: Scene) -> None:
        scene.ground()
        box = scene.box("box", size=(0.2, 0.2, 0.2), position=(0.0, 0.0, 0.1), mass=2.0)
        scene.sensor_imu("imu", box, position=(0.05, 0.0, 0.02), rotation_deg=(90.0, 0.0, 0.0))
        scene.sensor_contact("sole", box)
        scene.sensor_range("scan", box, position=(0.0, 0.0, 0.3), rays=3, rate=50.0)
        scene.box("wall", size=(0.1, 4.0, 2.0), position=(1.05, 0.0, 1.0), static=True)
        rod = scene.box("rod", size=(0.4, 0.03, 0.03), position=(0.2, 2.0, 1.0), mass=1.0)
        hinge = scene.joint_revolute("hinge", None, rod, anchor=(0.0, 2.0, 1.0), axis="Y")
        scene.sensor_joints("encoder", [hinge])

    path = stage(tmp_path, build)
    one, many = Simulation(path, device="cpu"), Simulation(path, device=device, world_count=2)
    for _ in range(10):
        one.advance_frame()
        many.advance_frame()
    told_one, told_many = one.sensors.flat(), many.sensors.flat()
    assert told_many.shape == (2, told_one.shape[1])
    np.testing.assert_allclose(told_many, np.repeat(told_one, 2, axis=0), rtol=1e-3, atol=5e-3)
    assert np.isinf(told_one).sum() == 2  # two rays meet nothing
