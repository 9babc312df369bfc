"""The product on a GPU: graphs, contacts, the books, pictures, batches, against theory and against the CPU's code."""

import numpy as np
import pytest

from tests.sim.test_ledger import Push, kite
from wsim.loop.generate import generate
from wsim.loop.options import Options
from wsim.recording import read
from wsim.runs.settings import Settings
from wsim.scene import Drive, Scene
from wsim.sim import Simulation, Stills
from wsim.sim.collect import collect

pytestmark = pytest.mark.cuda
G = 9.81
GPU = "cuda:0"


def stage_of(tmp_path, build):
    scene = Scene()
    build(scene)
    return scene.save(tmp_path / "stage.usda")


def slider(scene):
    scene.simulation(duration=1.0)
    scene.ground(friction=0.5)
    scene.box("slider", size=(0.2, 0.2, 0.1), mass=2.0, position=(0.0, 0.0, 0.05), velocity=(2.0, 0.0, 0.0))


def arm(scene):
    scene.simulation(duration=0.5, frame_rate=60.0)
    beam = scene.box("arm", size=(0.6, 0.05, 0.05), density=2700.0, position=(0.3, 0.0, 1.0))
    motor = Drive(position=-60.0, stiffness=200.0, damping=2.0)
    scene.joint_revolute("hinge", None, beam, anchor=(0.0, 0.0, 1.0), axis="Y", drive=motor)


def afloat(scene):
    scene.simulation(duration=2.5, frame_rate=24.0)
    scene.ground()
    tank = scene.tank("tank", inner_size=(0.5, 0.4, 0.4))
    water = scene.fluid("water", fills=tank, level=0.25, spacing=0.025)
    scene.box("block", size=(0.2, 0.2, 0.15), density=600.0, position=(0.0, 0.0, water.surface - 0.015))
    scene.camera("side", eye=(0.0, -1.4, 0.6), target=(0.0, 0.0, 0.2), width=320, height=180)


def test_ground_is_laid_between_graphs(tmp_path):
    """Water runs off a shelf: each graph that meets new ground is captured anew, and goes on as steps do."""

    def shelf(scene):
        scene.ground()
        scene.box("shelf", size=(0.5, 0.5, 0.2), position=(0.0, 0.0, 0.4), static=True)
        scene.fluid("water", size=(0.3,) * 3, position=(0.0, 0.0, 0.65), spacing=0.05, velocity=(2.0, 0.0, 0.0))

    stage = stage_of(tmp_path, shelf)
    graph, steps = Simulation(stage, device=GPU), Simulation(stage, device=GPU)
    laid = graph.fluid.wall_count
    for _ in range(20):
        graph.advance_frame()
        for _ in range(steps.substeps):
            steps.step()
    assert graph.fluid.wall_count == steps.fluid.wall_count > laid
    assert graph.state.particle_q.numpy() == pytest.approx(steps.state.particle_q.numpy(), abs=1e-3)
    assert graph.state.particle_q.numpy()[:, 2].min() > -1e-6


@pytest.mark.parametrize("build", [slider, arm, afloat])
def test_a_frame_in_one_graph_is_its_steps(tmp_path, build):
    stage = stage_of(tmp_path, build)
    graph, steps = Simulation(stage, device=GPU), Simulation(stage, device=GPU)
    for _ in range(6):
        graph.advance_frame()
        for _ in range(steps.substeps):
            steps.step()
    assert graph.time == pytest.approx(steps.time)
    assert graph.state.body_q.numpy() == pytest.approx(steps.state.body_q.numpy(), abs=1e-4)
    assert graph.state.body_qd.numpy() == pytest.approx(steps.state.body_qd.numpy(), abs=1e-2)


@pytest.mark.parametrize("worlds", [1, 3])
def test_a_frame_under_control_is_its_steps(tmp_path, worlds):
    """The controller is asked at the same times, every 0.01 s, which is no frame."""
    stage, asked = stage_of(tmp_path, arm), ([], [])
    made = []
    for told in asked:

        def push(t, simulation, told=told):
            told.append(t)
            force = simulation.control_force.numpy()
            force[:, 2] = 5.0 * np.sin(20.0 * t)
            simulation.control_force.assign(force)

        made.append(Simulation(stage, device=GPU, world_count=worlds, controller=push))
    graph, steps = made
    for _ in range(12):
        graph.advance_frame()
        for _ in range(steps.substeps):
            steps.step()
    assert asked[0] == asked[1] and len(asked[0]) > 15
    assert graph.state.body_q.numpy() == pytest.approx(steps.state.body_q.numpy(), abs=1e-4)
    assert graph.state.body_qd.numpy() == pytest.approx(steps.state.body_qd.numpy(), abs=1e-2)


def test_a_block_slides_as_far_as_on_the_cpu_and_presses_with_its_weight(tmp_path):
    stage = stage_of(tmp_path, slider)
    found = {}
    for device in ("cpu", GPU):
        Simulation(stage, device=device).run(tmp_path / f"{device[:3]}.rrd")
        found[device] = read(tmp_path / f"{device[:3]}.rrd")
    ends = {device: recording.position("/World/slider")[-1, 0] for device, recording in found.items()}
    assert ends[GPU] == pytest.approx(2.0**2 / (2.0 * 0.5 * G), rel=0.05)
    assert ends[GPU] == pytest.approx(ends["cpu"], abs=5e-3)
    assert found[GPU].force("/World/slider")[-1] == pytest.approx([0.0, 0.0, 2.0 * G], abs=0.02 * 2.0 * G)
    assert found[GPU].scalars["contact/penetration"].max() < 2e-3


def test_a_motors_work_is_in_the_books_as_on_the_cpu(tmp_path):
    stage = stage_of(tmp_path, arm)
    work = {}
    for device in ("cpu", GPU):
        Simulation(stage, device=device).run(tmp_path / f"{device[:3]}.rrd")
        work[device] = np.cumsum(read(tmp_path / f"{device[:3]}.rrd").scalars["work/drives"])
    assert np.ptp(work[GPU]) > 5.0  # [J]
    assert work[GPU] == pytest.approx(work["cpu"], abs=0.02 * np.ptp(work["cpu"]))


def test_control_pushes_and_is_in_the_books(tmp_path):
    """A controller is called between steps, which then are in no graph."""

    Simulation(stage_of(tmp_path, kite), device=GPU, controller=Push()).run(tmp_path / "r.rrd")
    recording = read(tmp_path / "r.rrd")
    pushed = np.outer(recording.time, [3.0, 0.0, 50.0])
    assert np.cumsum(recording.applied_impulse[:, 0], axis=0) == pytest.approx(pushed, abs=1e-3)


def test_a_block_floats_and_is_drawn_as_on_the_cpu(tmp_path):
    stage = stage_of(tmp_path, afloat)
    result = Simulation(stage, device=GPU).run(
        tmp_path / "r.rrd", video=tmp_path / "v.mp4", frames_dir=tmp_path / "frames", review=tmp_path / "review.json"
    )
    assert result.problems == [] and len(result.stills) == 6 and (tmp_path / "v.mp4").stat().st_size > 1000
    recording = read(tmp_path / "r.rrd")
    late = recording.time > 1.5
    lift = np.diff(recording.time)[-1] * 600.0 * 0.2 * 0.2 * 0.15 * G  # of a body at rest, its weight each frame
    assert recording.applied_impulse[late, 0, 2].mean() == pytest.approx(lift, rel=0.03)
    (on_gpu,), (on_cpu,) = (Stills(stage, device).draw_start() for device in (GPU, "cpu"))
    assert np.abs(on_gpu.rgb.astype(int) - on_cpu.rgb.astype(int)).mean() < 1.0  # of 255 levels
    assert on_gpu.pixels["/World/block"] == pytest.approx(on_cpu.pixels["/World/block"], rel=0.02)


def test_worlds_of_a_batch_go_as_one_alone(tmp_path):
    stage = stage_of(tmp_path, slider)
    worlds = collect(Simulation(stage, device=GPU, world_count=64))
    alone = collect(Simulation(stage, device=GPU))
    assert all(problems == [] for problems in worlds.problems)
    ends = np.array([worlds.recording(k).position("/World/slider")[-1, 0] for k in range(64)])
    assert ends == pytest.approx(alone.recording(0).position("/World/slider")[-1, 0], abs=1e-3)


@pytest.mark.parametrize("prompt", ["A wooden crate falls onto the ground.", "A cork ball floats in a tank of water."])
def test_a_sentence_becomes_an_accepted_world(tmp_path, prompt):
    done = generate(prompt, tmp_path, Options(settings=Settings(device=GPU)))
    assert done.verdict is not None and done.verdict.status == "accepted", done.verdict.summary
