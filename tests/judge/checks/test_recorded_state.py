"""Recorded energies and depths of real runs: as they are, and with a number changed that nothing else asks for."""

from dataclasses import replace

import numpy as np
import pytest

from tests.judge.theory import ask, edited
from wsim.judge.checks.recorded_state import CheckRecordedDepth, CheckRecordedEnergy
from wsim.recording import read
from wsim.scene import Part, Scene
from wsim.sim import Simulation

G = 9.81


def run(folder, scene):
    Simulation(scene.save(folder / "stage.usda"), device="cpu").run(folder / "r.rrd")
    return read(folder / "r.rrd")


def heap(seed):
    """Boxes, balls, rollers and a hammer that fall on each other, off a paddle that is led, beside a spring."""
    random, scene = np.random.default_rng(seed), Scene()
    scene.simulation(duration=0.8, frame_rate=60.0)
    scene.ground(friction=0.5)
    size = 10.0 ** random.uniform(-1.5, 0.5)
    for k in range(6):
        place = (*random.uniform(-0.6, 0.6, 2) * size, (0.7 + 1.2 * k) * size)
        options = {
            "position": place,
            "density": 10.0 ** random.uniform(2.0, 4.0),
            "restitution": random.uniform(0, 0.8),
        }
        turn = {"rotation_deg": tuple(random.uniform(0, 360, 3))}
        if k % 3 == 0:
            scene.sphere(f"ball_{k}", radius=0.3 * size, **options)
        elif k % 3 == 1:
            scene.box(f"box_{k}", size=tuple(random.uniform(0.3, 0.6, 3) * size), **turn, **options)
        else:
            scene.cylinder(f"roller_{k}", radius=0.2 * size, height=0.5 * size, **turn, **options)
    parts = [Part("box", size=(size, 0.1 * size, 0.1 * size)), Part("sphere", radius=0.2 * size, position=(size, 0, 0))]
    scene.compound(
        "hammer", parts=parts, mass=500.0 * size**3, position=(0, 3 * size, size), angular_velocity_deg=(0, 300, 0)
    )
    scene.box("paddle", size=(size, size, 0.2 * size), position=(3 * size, 0, 0.5 * size), kinematic=True,
              velocity=(-size, 0, 0))  # fmt: skip
    bob = scene.sphere("bob", radius=0.2 * size, density=500.0, position=(0, -3 * size, 2 * size))
    scene.spring("spring", None, bob, anchor_a=(0, -3 * size, 4 * size), stiffness=500.0 * size**2, rest_length=size)
    return scene


@pytest.fixture(scope="module", params=range(3))
def fallen(request, tmp_path_factory):
    return run(tmp_path_factory.mktemp("heap"), heap(request.param))


def told(recording, name, change):
    return replace(recording, scalars=recording.scalars | {name: change(np.array(recording.scalars[name]))})


def passes(check, recording):
    (finding,) = ask(check(), recording)
    return finding.passed


def test_what_is_recorded_is_what_poses_and_velocities_have(fallen):
    for check in (CheckRecordedEnergy, CheckRecordedDepth):
        (finding,) = ask(check(), fallen)
        assert finding.passed, finding.message
        assert finding.limit > 0.0


@pytest.mark.parametrize("part", ["kinetic", "kinetic_bodies", "potential", "potential_bodies", "potential_springs"])
def test_an_energy_that_is_made_up_is_found(fallen, part):
    def more(values):
        k = int(np.argmax(np.abs(values)))
        values[k] *= 1.0001
        return values

    assert not passes(CheckRecordedEnergy, told(fallen, f"energy/{part}", more))


def test_velocities_that_were_changed_no_longer_have_the_energy(fallen):
    moved = np.array(fallen.body_qd)
    moved[:, 0, :3] *= 1.001
    assert not passes(CheckRecordedEnergy, replace(fallen, body_qd=moved))


def test_a_contact_that_is_said_to_be_deeper_or_less_deep_is_found(fallen):
    fastest = np.linalg.norm(fallen.body_qd[..., :3], axis=2).max()
    deep = 8.0 * (fastest + G / 60.0) * fallen.metadata["time_step"]  # beyond what a step may move them
    assert not passes(CheckRecordedDepth, told(fallen, "contact/penetration", lambda depth: depth + deep))
    sunk = np.array(fallen.body_q)
    sunk[:, :, 2] -= 8.0 * deep
    assert not passes(CheckRecordedDepth, replace(fallen, body_q=sunk))


def test_a_fluid_has_the_energy_of_its_particles(tmp_path):
    scene = Scene()
    scene.simulation(duration=0.2, frame_rate=30.0)
    tank = scene.tank("tank", inner_size=(0.4, 0.4, 0.4))
    scene.fluid("water", fills=tank, level=0.2, spacing=0.05)
    still = run(tmp_path, scene)
    assert passes(CheckRecordedEnergy, still)
    for part in ("kinetic_fluid", "potential_fluid"):
        assert not passes(CheckRecordedEnergy, told(still, f"energy/{part}", lambda values: 1.001 * values))


def test_of_what_is_in_a_mesh_only_less_is_asked_for(tmp_path):
    """How deep triangles are in something only the simulator says; that two boxes are in each other poses say, too."""
    scene = Scene()
    scene.simulation(duration=0.3, frame_rate=60.0)
    (tmp_path / "roof.obj").write_text(
        "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nv 0 0 0.2\nf 1 2 5\nf 2 3 5\nf 3 4 5\nf 4 1 5\nf 4 3 2 1\n"
    )
    scene.mesh("roof", file=tmp_path / "roof.obj", static=True)
    scene.sphere("ball", radius=0.1, mass=1.0, position=(0.3, 0, 0.3))
    scene.box("box", size=(0.2, 0.2, 0.2), mass=1.0, position=(3, 0, 0.1))
    scene.ground()
    recording = run(tmp_path, scene)
    assert passes(CheckRecordedDepth, recording)
    assert passes(CheckRecordedDepth, told(recording, "contact/penetration", lambda depth: depth + 0.05))
    sunk = np.array(recording.body_q)
    sunk[:, 1, 2] -= 0.05
    assert not passes(CheckRecordedDepth, replace(recording, body_q=sunk))


def test_what_is_led_through_what_stands_is_not_deep_in_it(tmp_path):
    """A deck on a path dips into the ground: neither gives way, and the simulator has them pass."""
    scene = Scene()
    scene.simulation(duration=0.5, frame_rate=30.0)
    scene.ground()
    scene.box("deck", size=(1, 1, 0.1), position=(0, 0, 0.06), velocity=(0, 0, -0.2), kinematic=True)
    scene.sphere("ball", radius=0.1, position=(2, 0, 0.1), density=500.0)
    recording = run(tmp_path, scene)
    assert passes(CheckRecordedDepth, recording)
    assert not passes(CheckRecordedDepth, edited(recording, "body_q", (slice(None), 1, 2), -0.01))  # a ball's tenth
