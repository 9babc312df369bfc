"""Vehicles as they are authored: geometry of the steering, engine, mass, errors."""

import math

import numpy as np
import pytest

from wsim.geometry.shapes import kind_of
from wsim.scene import Scene, SceneError, VehicleSpec
from wsim.scene.describe import describe
from wsim.scene.validate import Call
from wsim.scene.vehicle_looks import body_pieces
from wsim.scene.vehicle_spec import CORNERS, preset, presets, spec_of

KINDS = pytest.mark.parametrize("kind", presets())


@KINDS
def test_what_it_weighs_is_what_the_spec_says(kind, tmp_path):
    scene = Scene()
    scene.ground()
    scene.vehicle("v", spec_of(Call("vehicle", "v"), preset(kind)))  # checked as one that a program makes
    world, spec = describe(scene.save(tmp_path / "v.usda")), preset(kind)
    assert sum(body.mass for body in world.bodies) == pytest.approx(spec.mass, rel=1e-5)
    height = sum(body.mass * (body.position[2] + body.com[2]) for body in world.bodies) / spec.mass
    ahead = sum(body.mass * (body.position[0] + body.com[0]) for body in world.bodies) / spec.mass
    assert height == pytest.approx(spec.com_height, rel=1e-5)
    assert 0.5 + ahead / spec.wheelbase == pytest.approx(spec.front_share, rel=1e-5)


@KINDS
def test_no_part_turns_harder_than_all_its_mass_at_its_edge(kind, tmp_path):
    scene = Scene()
    scene.vehicle("v", kind)
    for body in describe(scene.save(tmp_path / "v.usda")).bodies:
        reach = max(math.dist(shape.position, body.com) + kind_of(shape).radius_about for shape in body.shapes)
        greatest = np.linalg.eigvalsh(np.reshape(body.inertia, (3, 3)))[2]
        assert 0.0 < greatest <= body.mass * reach**2, body.prim


@KINDS
def test_all_wheels_point_at_one_centre(kind):
    """Across each wheel a line meets that of the rear axle in one point, which is wheelbase / tan(angle) away."""
    spec = preset(kind)
    for steer in (-20.0, 5.0, 25.0):
        for corner in ("front_left", "front_right"):
            turned = math.radians(spec.wheel_angle_deg(corner, steer))
            assert spec.place(corner)[1] + spec.wheelbase / math.tan(turned) == pytest.approx(
                spec.wheelbase / math.tan(math.radians(steer))
            )


def test_the_engine_gives_its_torque_then_its_power():
    spec = VehicleSpec()
    slow, fast = spec.wheel_torque(0.1), spec.wheel_torque(60.0)
    assert 2 * slow == pytest.approx(spec.engine_torque * spec.gear)
    assert 2 * fast * 60.0 / spec.wheel_radius == pytest.approx(spec.engine_power)


@KINDS
def test_its_body_leaves_its_wheels_room(kind):
    """No part that collides is in the box of a wheel that goes up to its stop."""
    spec = preset(kind)
    for corner in CORNERS:
        x, y = spec.place(corner)
        low, high = 0.0, 2.0 * spec.wheel_radius + spec.travel_up
        for piece in body_pieces(spec):
            place, size = piece.part.position, piece.part.size
            apart = (
                abs(place[0] - x) >= 0.5 * size[0] + spec.wheel_radius
                or abs(place[1] - y) >= 0.5 * size[1] + 0.5 * spec.wheel_width
                or place[2] - 0.5 * size[2] >= high
                or place[2] + 0.5 * size[2] <= low
            )
            assert apart or piece.trim, (corner, piece)


def test_brakes_and_engine_take_turns(tmp_path):
    scene = Scene()
    vehicle = scene.vehicle("v", "hmmwv")
    vehicle.brake(0.5)
    vehicle.drive(3.0)
    vehicle.brake(0.25)
    joints = {joint.prim: joint for joint in describe(scene.save(tmp_path / "v.usda")).joints}
    for handle in vehicle.axles.values():
        assert joints[handle.path].friction == pytest.approx(1000.0) and joints[handle.path].drive is None


@pytest.mark.parametrize(
    ("spec", "says"),
    [
        ("hmwv", 'did you mean "hmmwv"?'),
        (3.0, "must be a VehicleSpec or one of"),
        (VehicleSpec(mass=-1.0), "spec.mass = -1"),
        (VehicleSpec(wheel_radius=1.3), "or the wheels meet"),
        (VehicleSpec(mass=100.0), "the wheels and uprights alone are"),
        (VehicleSpec(inertia=(275.7, 853.4, 1200.0)), "none more than the other two together"),
        (VehicleSpec(track=0.6), "no room"),
        (VehicleSpec(driven="al"), "spec.driven"),
        (VehicleSpec(friction=float("nan")), "friction"),
    ],
)
def test_what_cannot_be_is_one_clear_line(spec, says):
    with pytest.raises(SceneError, match="vehicle") as caught:
        Scene().vehicle("v", spec)
    assert says in str(caught.value) and "\n" not in str(caught.value)


def test_it_cannot_be_steered_beyond_its_stops():
    with pytest.raises(SceneError, match="angle_deg"):
        Scene().vehicle("v", "car").steer(40.0)


def test_what_meets_nothing_weighs_what_it_states(tmp_path):
    """A hub has no colliders; its moments are its own, not those of a small sphere."""
    scene = Scene()
    scene.vehicle("v", "hmmwv")
    hub = describe(scene.save(tmp_path / "v.usda")).body("/World/v_hub_rear_left")
    assert not any(shape.collides for shape in hub.shapes)
    assert hub.mass == pytest.approx(69.975) and hub.inertia[0] == pytest.approx(69.975 * (0.4 * 0.467) ** 2)


def test_it_leans_with_its_left_side_up(tmp_path):
    """Turned left by 90 degrees, then: its left is -X. All its parts turn about the point between its axles."""
    scene = Scene()
    scene.vehicle("v", "cart", position=(1.0, 2.0, 3.0), yaw_deg=90.0, roll_deg=10.0)
    world = describe(scene.save(tmp_path / "v.usda"))
    at = {name: np.array(world.body(f"/World/v_wheel_{name}").position) for name in ("front_left", "front_right")}
    apart = at["front_left"] - at["front_right"]
    lean = math.radians(10.0)
    track = preset("cart").track
    assert apart == pytest.approx((-track * math.cos(lean), 0.0, track * math.sin(lean)), abs=1e-5)
