"""Stages, simulated: against closed-form mechanics, twice the same, with the worlds side by side."""

import math

import numpy as np
import pytest

from wsim.errors import UserError
from wsim.recording import read
from wsim.scene import Scene
from wsim.sim import Simulation

G = 9.81


def stage_of(tmp_path, build, name="stage.usda"):
    scene = Scene()
    build(scene)
    return scene.save(tmp_path / name)


def test_free_fall_and_projectile(tmp_path):
    """x = v t, z = z0 - g t^2 / 2 + O(dt)."""

    def build(scene):
        scene.simulation(duration=0.5)
        scene.sphere("ball", radius=0.1, density=1000.0, position=(0.0, 0.0, 5.0), velocity=(2.0, 0.0, 0.0))

    simulation = Simulation(stage_of(tmp_path, build), device="cpu")
    simulation.run(tmp_path / "r.rrd")
    recording = read(tmp_path / "r.rrd")
    t = recording.time
    position = recording.position("/World/ball")
    assert t[-1] == pytest.approx(0.5)
    assert position[:, 0] == pytest.approx(2.0 * t, abs=1e-4)
    assert position[:, 2] == pytest.approx(5.0 - 0.5 * G * t**2, abs=G * 0.5 * simulation.dt)
    energy = recording.scalars["energy/kinetic"] + recording.scalars["energy/potential"]
    assert energy == pytest.approx(energy[0], rel=1e-3)


def test_pendulum_of_one_body_swings_with_its_period(tmp_path):
    """A rod on a hinge: T = 2 pi sqrt(2 L / (3 g)) (1 + theta^2/16); a lone jointed body must move at all."""
    length, angle = 1.0, math.radians(10.0)

    def build(scene):
        scene.simulation(duration=3.5, frame_rate=100.0)
        center = (-0.5 * length * math.sin(angle), 0.0, 2.0 - 0.5 * length * math.cos(angle))
        tilt = (0.0, math.degrees(angle), 0.0)
        rod = scene.box("rod", size=(0.02, 0.02, length), density=1000.0, position=center, rotation_deg=tilt)
        scene.joint_revolute("hinge", None, rod, anchor=(0.0, 0.0, 2.0), axis="Y")

    Simulation(stage_of(tmp_path, build), device="cpu").run(tmp_path / "r.rrd")
    recording = read(tmp_path / "r.rrd")
    x, t = recording.position("/World/rod")[:, 0], recording.time
    assert np.ptp(x) > 0.9 * length * math.sin(angle)
    falling = np.flatnonzero((x[:-1] < 0.0) & (x[1:] >= 0.0))
    crossings = t[falling] - x[falling] * (t[falling + 1] - t[falling]) / (x[falling + 1] - x[falling])
    expected = 2.0 * math.pi * math.sqrt(2.0 * length / (3.0 * G)) * (1.0 + angle**2 / 16.0)
    assert np.diff(crossings).mean() == pytest.approx(expected, rel=0.005)
    energy = recording.scalars["energy/kinetic"] + recording.scalars["energy/potential"]
    assert np.ptp(energy) < 1e-4 * np.ptp(recording.scalars["energy/potential"])


def test_block_slides_to_rest_and_its_contact_force_is_its_weight(tmp_path):
    """At rest on level ground the net contact force is the weight."""

    def build(scene):
        scene.simulation(duration=1.0)
        scene.ground(friction=0.5)
        scene.box("slider", size=(0.2, 0.2, 0.1), mass=2.0, position=(0.0, 0.0, 0.05), velocity=(2.0, 0.0, 0.0))

    Simulation(stage_of(tmp_path, build), device="cpu").run(tmp_path / "r.rrd")
    recording = read(tmp_path / "r.rrd")
    x = recording.position("/World/slider")[:, 0]
    assert x[-1] == pytest.approx(2.0**2 / (2.0 * 0.5 * G), rel=0.05)  # v^2 / (2 mu g)
    assert recording.force("/World/slider")[-1] == pytest.approx([0.0, 0.0, 2.0 * G], abs=0.02 * 2.0 * G)
    assert recording.scalars["contact/penetration"].max() < 2e-3


@pytest.mark.parametrize("restitution", [0.0, 0.5, 0.8])
def test_ball_bounces_to_the_height_of_its_restitution(tmp_path, restitution):
    """h' = e^2 h between shapes of the same restitution; the step's place in the contact moves e by up to 0.04."""

    def build(scene):
        scene.simulation(duration=1.2, frame_rate=100.0)
        scene.ground(restitution=restitution)
        scene.sphere("ball", radius=0.1, density=1000.0, position=(0.0, 0.0, 1.1), restitution=restitution)

    simulation = Simulation(stage_of(tmp_path, build), device="cpu")
    simulation.run(tmp_path / "r.rrd")
    recording = read(tmp_path / "r.rrd")
    height = recording.position("/World/ball")[:, 2] - 0.1
    landed = int(np.argmax(height < 0.01))
    rebound = math.sqrt(height[landed:].max())
    assert rebound == pytest.approx(restitution, abs=0.04 if restitution else 0.15)  # hard contacts keep up to exp(-2)
    speed, frequency = math.sqrt(2.0 * G), 1.0 / (6.0 * simulation.dt)
    assert recording.scalars["contact/penetration"].max() < speed / frequency  # the spring alone, undamped


def tank(scene):
    scene.simulation(duration=0.2, frame_rate=20.0)
    tank = scene.tank("tank", inner_size=(0.3, 0.3, 0.3))
    water = scene.fluid("water", fills=tank, level=0.15, spacing=0.03)
    scene.box("block", size=(0.1, 0.1, 0.1), density=500.0, position=(0.0, 0.0, water.surface + 0.06))


def test_same_stage_twice_is_the_same_bit_for_bit(tmp_path):
    stage = stage_of(tmp_path, tank)
    tracks = []
    for k in range(2):
        Simulation(stage, device="cpu").run(tmp_path / f"{k}.rrd")
        recording = read(tmp_path / f"{k}.rrd")
        tracks.append((recording.body_q, recording.body_qd, recording.fluids["/World/water"].position))
    for first, second in zip(*tracks, strict=True):
        assert first.tobytes() == second.tobytes()


def test_recording_holds_fluid_energy_and_log(tmp_path):
    simulation = Simulation(stage_of(tmp_path, tank), device="cpu")
    result = simulation.run(tmp_path / "r.rrd")
    recording = read(tmp_path / "r.rrd")
    assert result.problems == []
    assert recording.fluids["/World/water"].position.shape == (5, 500, 3)
    mass = 1000.0 * 0.3 * 0.3 * 0.15
    assert simulation.model.particle_mass.numpy().sum() == pytest.approx(mass, rel=1e-5)
    floor = 0.02
    expected = mass * G * (floor + 0.075)
    assert recording.scalars["energy/potential_fluid"][0] == pytest.approx(expected, rel=0.01)
    assert recording.metadata["complete"]
    assert any("fluid particles" in line.text for line in recording.log)


def test_worlds_side_by_side_do_not_touch(tmp_path):
    """Two worlds at the same place: each has its own fluid, and both do the same."""

    def build(scene):
        tank(scene)
        scene.simulation(duration=0.05)

    simulation = Simulation(stage_of(tmp_path, build), device="cpu", world_count=2)
    simulation.advance_frame()
    position = simulation.state.particle_q.numpy()
    half = len(position) // 2
    assert np.abs(position[:half] - position[half:]).max() < 1e-4
    heights = simulation.state.body_q.numpy()[:, 2]
    assert heights[0] == pytest.approx(heights[1], abs=1e-5)
    single = Simulation(simulation.stage, device="cpu")
    single.advance_frame()
    assert heights[0] == pytest.approx(float(single.state.body_q.numpy()[0, 2]), abs=2e-4)


def test_time_step_is_chosen_from_the_stage(tmp_path):
    def fine(scene):
        tank = scene.tank("tank", inner_size=(0.2, 0.2, 0.2))
        scene.fluid("water", fills=tank, level=0.1, spacing=0.015)
        scene.simulation(duration=0.2, frame_rate=20.0)

    water = Simulation(stage_of(tmp_path, fine), device="cpu")
    assert water.built.time_step.reason == "sound in the fluid"
    assert water.dt <= water.built.sph.max_time_step
    assert water.substeps * water.dt == pytest.approx(1.0 / 20.0)
    given = Simulation(water.stage, device="cpu", time_step=1e-4)
    assert given.dt <= 1e-4

    def bullet(scene):
        scene.box("wall", size=(0.01, 1.0, 1.0), density=500.0, position=(1.0, 0.0, 0.5))
        scene.sphere("bullet", radius=0.01, density=7850.0, position=(0.0, 0.0, 0.5), velocity=(50.0, 0.0, 0.0))

    fast = Simulation(stage_of(tmp_path, bullet, "b.usda"), device="cpu")
    assert 50.0 * fast.dt < 0.01  # it cannot jump the wall in one step


@pytest.mark.parametrize("bad", [math.nan, math.inf, -1.0, 0.0, 1e-9])
def test_a_time_step_that_is_none_is_refused(tmp_path, bad):
    with pytest.raises(UserError, match=r"^time_step = .* s or more"):
        Simulation(stage_of(tmp_path, tank), device="cpu", time_step=bad)


@pytest.mark.parametrize("bad", [Scene().stage, Scene(), None, [], [Scene().stage], 3])
def test_what_is_no_path_of_a_stage_is_refused(bad):
    with pytest.raises(UserError, match=r"^stage = .* stage\.Export\(path\) writes a Usd\.Stage, scene\.save"):
        Simulation(bad, device="cpu")


@pytest.mark.parametrize("bad", [0, -2, 1.5, "2"])
def test_a_count_of_worlds_that_is_none_is_refused(tmp_path, bad):
    with pytest.raises(UserError, match=r"^world_count = .* whole number"):
        Simulation(stage_of(tmp_path, tank), device="cpu", world_count=bad)


def test_state_that_is_not_finite_ends_the_run_and_is_logged(tmp_path):
    simulation = Simulation(stage_of(tmp_path, tank), device="cpu")
    velocity = simulation.state.particle_qd.numpy()
    velocity[3] = math.nan
    simulation.state.particle_qd.assign(velocity)
    result = simulation.run(tmp_path / "r.rrd")
    assert any("not finite" in problem for problem in result.problems)
    recording = read(tmp_path / "r.rrd")
    assert not recording.metadata["complete"]
    assert any(line.level == "ERROR" for line in recording.log)


def test_body_that_leaves_the_fluids_domain_is_logged_once(tmp_path):
    def build(scene):
        tank = scene.tank("tank", inner_size=(0.4, 0.3, 0.3))
        scene.fluid("water", fills=tank, level=0.12, spacing=0.04)
        scene.sphere("ball", radius=0.05, density=500.0, position=(0.0, 0.0, 0.5), velocity=(3.0, 0.0, 0.0))
        scene.sphere("bystander", radius=0.05, density=500.0, position=(2.0, 0.0, 0.06))
        scene.simulation(duration=0.4, frame_rate=20.0)

    simulation = Simulation(stage_of(tmp_path, build), device="cpu")
    simulation.run(tmp_path / "recording.rrd")
    told = [entry for entry in read(tmp_path / "recording.rrd").log if "domain" in entry.text]
    assert [entry.prim for entry in told] == ["/World/ball"]
    assert told[0].level.upper().startswith("WARN")
    assert 0.05 < told[0].time < 0.15  # 0.2 m and more at 3 m/s


def test_controller_is_called_once_a_control_step(tmp_path):
    def build(scene):
        scene.simulation(duration=0.05, frame_rate=100.0)
        scene.sphere("ball", radius=0.1, density=1000.0, position=(0.0, 0.0, 5.0))

    calls = []
    simulation = Simulation(
        stage_of(tmp_path, build), device="cpu", controller=lambda t, _: calls.append(t), control_interval=0.01
    )
    simulation.run(tmp_path / "r.rrd")
    assert calls == pytest.approx([0.0, 0.01, 0.02, 0.03, 0.04], abs=1e-9)


def test_unknown_device_is_named(tmp_path):
    with pytest.raises(UserError, match="cuda:7"):
        Simulation(stage_of(tmp_path, tank), device="cuda:7")


def test_fluids_of_different_spacings_are_refused(tmp_path):
    def build(scene):
        for k, spacing in enumerate((0.05, 0.04)):
            scene.fluid(f"fluid_{k}", size=(0.2, 0.2, 0.2), position=(k, 0.0, 0.2), spacing=spacing)

    with pytest.raises(UserError, match=r"spacing = 0\.04 differs"):
        Simulation(stage_of(tmp_path, build), device="cpu")
