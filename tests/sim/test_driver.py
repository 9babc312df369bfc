"""A driver in the simulator: how well a vehicle on springs and tyres follows its line and its speed."""

import math

import numpy as np
import pytest

from tests.ways import lane_change, ring
from wsim.program.control_world import INPUTS, OUTPUTS, ControlLayout
from wsim.scene import Arc, Brake, Driver, Legs, Scene
from wsim.scene.vehicle_spec import preset
from wsim.sim import Simulation
from wsim.sim.control import ArrayController, driven_joints


def driven(driver, tmp_path, seconds, *, speed=0.0, slope=0.0, rate=20.0, kind="hmmwv"):
    """Its position (frames, 2) [m], forward speed (frames,) and time, of a truck that starts at the origin."""
    scene = Scene()
    scene.simulation(duration=seconds, frame_rate=rate)
    if slope:
        lean = math.radians(slope)
        scene.box("hill", size=(200.0, 20.0, 1.0), rotation_deg=(0.0, -slope, 0.0), static=True, friction=0.9,
                  position=(0.5 * math.sin(lean), 0.0, -0.5 * math.cos(lean)))  # fmt: skip
    else:
        scene.ground(friction=0.9)
    scene.vehicle("truck", kind, pitch_deg=-slope, speed=speed)
    stage = scene.save(tmp_path / "v.usda")
    found, arrays = [], {}

    def exchange(t, state):
        for name, values in state.items():
            arrays[name][...] = values
        arrays["joint_force"][...] = 0.0
        driver.drive(world, t)
        return {name: arrays[name].copy() for name in OUTPUTS}

    simulation = Simulation(stage, device="cpu", controller=ArrayController(exchange))
    bodies = [body.prim for body in simulation.world.bodies]
    layout = ControlLayout(bodies, driven_joints(simulation.world))
    arrays |= {name: np.zeros(shape, np.float32) for name, shape in layout.shapes().items() if name != "t"}
    (world,) = layout.worlds(arrays)
    assert set(INPUTS) <= set(arrays)
    truck = bodies.index("/World/truck")
    for k in range(round(seconds * rate)):
        simulation.advance_frame()
        q = simulation.state.body_q.numpy()[truck].astype(float)
        qd = simulation.state.body_qd.numpy()[truck].astype(float)
        x, y, z, w = q[3:]
        ahead = np.array([1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y + z * w), 2.0 * (x * z - y * w)])
        found.append([*q[:2], qd[:3] @ ahead, (k + 1) / rate])
    return np.array(found)


def test_it_keeps_to_a_circle_at_its_speed(tmp_path):
    """Of 15 m at 5 m/s, 0.17 g: within 0.15 m of the line, and 5 % of the speed, once it has begun to turn."""
    driver = Driver("truck", "hmmwv", path=ring(15.0, 1.0), speed=5.0, start_speed=5.0, stop=False)
    found = driven(driver, tmp_path, 4.0, speed=5.0)
    off = np.abs(np.hypot(found[:, 0], found[:, 1] - 15.0) - 15.0)
    assert off.max() < 0.15
    assert found[20:, 2] == pytest.approx(5.0 * np.ones(len(found) - 20), rel=0.05)
    assert np.ptp(np.unwrap(np.arctan2(found[:, 0], 15.0 - found[:, 1]))) > 1.2  # 18 m of it


def test_it_changes_lanes_and_stops_at_the_end(tmp_path):
    """3.5 m aside within 24 m at 8 m/s: within 0.25 m of the line, then 8 m/s within 5 %, then at rest at the end."""
    x = np.arange(0.0, 42.1, 0.5)
    driver = Driver("truck", "hmmwv", path=np.stack([x, lane_change(x)], axis=1), speed=8.0, start_speed=8.0)
    found = driven(driver, tmp_path, 8.0, speed=8.0)
    off = np.abs(found[:, 1] - lane_change(found[:, 0]))
    assert off.max() < 0.25
    steady = (found[:, 3] > 0.5) & (found[:, 0] < 30.0)
    assert found[steady, 2] == pytest.approx(8.0 * np.ones(steady.sum()), rel=0.05)
    assert found[-1, 0] == pytest.approx(42.0, abs=0.3)
    assert abs(found[-1, 2]) < 0.1


def test_it_holds_its_speed_up_a_hill(tmp_path):
    """From rest up 10 deg to 3 m/s: v² = 2 a s, once its springs are pressed in, then the speed, within 5 %."""
    driver = Driver("truck", "hmmwv", path=[(x, 0.0) for x in np.arange(0.0, 60.0, 0.5)], speed=3.0,
                    acceleration=2.0, stop=False)  # fmt: skip
    found = driven(driver, tmp_path, 3.5, slope=10.0)
    rising = (found[:, 0] > 0.8) & (found[:, 0] < 2.2)
    assert found[rising, 2] == pytest.approx(np.sqrt(2.0 * 2.0 * found[rising, 0]), rel=0.05)
    assert rising.sum() > 5
    assert found[found[:, 3] > 2.5, 2] == pytest.approx(3.0 * np.ones((found[:, 3] > 2.5).sum()), rel=0.05)


@pytest.mark.parametrize(("kind", "share"), [("hmmwv", 1.0), ("hmmwv", 0.4), ("polaris", 1.0)])
def test_it_brakes_hard_at_a_place(kind, share, tmp_path):
    """From 10 m/s: locked in v² / (2 mu g), else in v² / (2 a) with a = 4 T / (r (m + 4 I / r²)) and rolling, to 5 %.

    After that it stands where it is.
    """
    spec = preset(kind)
    path = [(x, 0.0) for x in np.arange(0.0, 40.0, 0.5)]
    driver = Driver("truck", kind, path=path, speed=10.0, start_speed=10.0, brake=Brake(at=(3.0, 0.0), share=share))
    found = driven(driver, tmp_path, 3.2 if share == 1.0 else 4.0, speed=10.0, kind=kind)
    locked = 0.9 * 9.81
    torque = share * 4.0 * spec.brake_torque / spec.wheel_radius + spec.rolling * spec.mass * 9.81
    slows = min(locked, torque / spec.effective_mass)
    assert (slows < locked) == ((kind, share) != ("hmmwv", 1.0))
    assert found[-1, 0] - 3.0 == pytest.approx(10.0**2 / (2.0 * slows), rel=0.05)
    assert np.ptp(found[-10:, 0]) < 2e-3


def test_its_brakes_hold_it_on_a_slope(tmp_path):
    """Up 10 deg from 3 m/s, at once: v² / (2 g (mu cos + sin)) along it, then within 2 mm for two seconds."""
    path = [(x, 0.0) for x in np.arange(0.0, 20.0, 0.5)]
    driver = Driver("truck", "hmmwv", path=path, speed=3.0, start_speed=3.0, brake=Brake(time=0.0))
    found = driven(driver, tmp_path, 4.0, speed=3.0, slope=10.0)
    lean = math.radians(10.0)
    slows = 9.81 * (0.9 * math.cos(lean) + math.sin(lean))
    assert found[30, 0] / math.cos(lean) == pytest.approx(3.0**2 / (2.0 * slows), abs=0.05)
    assert np.ptp(found[40:, 0]) < 2e-3


def test_it_drives_round_an_arc_of_legs(tmp_path):
    """At 4 m/s, 4 m straight on, then a quarter of 10 m to the left: within 0.15 m of it, to its end."""
    legs = Legs((0.0, 0.0), 0.0, [(4.0, 0.0), Arc(10.0, 90.0)])
    driver = Driver("truck", "hmmwv", path=legs.line(), speed=4.0, start_speed=4.0)
    found = driven(driver, tmp_path, 6.0, speed=4.0)
    round_it = found[found[:, 0] > 4.0]
    assert np.abs(np.hypot(round_it[:, 0] - 4.0, round_it[:, 1] - 10.0) - 10.0).max() < 0.15
    assert found[-1, :2] == pytest.approx([14.0, 10.0], abs=0.1)
