"""What rolls between steps that are exact and steps of the first order, whose velocities stand half a step behind."""

from dataclasses import replace

import numpy as np
import pytest

from tests.judge.theory import ask
from tests.sim.test_bodies import Run
from wsim.judge.books.recorded import RecordedContacts
from wsim.judge.checks.recorded import CheckRecordedForces
from wsim.judge.evidence.evidence import Evidence
from wsim.recording import read
from wsim.scene import Scene
from wsim.sim import Simulation

G, RADIUS = 9.81, 0.02
DEVICES = [("cpu", 1), ("cpu", 2), pytest.param(("cuda:0", 2), marks=pytest.mark.cuda)]


def v_track(scene, bend=0.3, slope=30.0):
    """A ball let go on one of two slopes with a bend between them."""
    pieces = [("line", 0.6), ("up", bend, 2.0 * slope), ("line", 0.6)]
    track = scene.track(
        "track", pieces=pieces, slope_deg=-slope, start=(0, 0, 1), width=0.2, profile="flat", friction=0.5
    )
    scene.sphere("ball", radius=RADIUS, density=7800.0, position=track.place(0.2, RADIUS), friction=0.5)


def energy(run, name="ball"):
    """Of a ball over its mass, through time [J/kg]."""
    q, v, w = run.q[name], run.v[name], run.w[name]
    return G * q[:, 2] + 0.5 * (v**2).sum(axis=1) + 0.2 * RADIUS**2 * (w**2).sum(axis=1)


@pytest.fixture(params=DEVICES, ids=["alone", "batch", "cuda"])
def simulate(request, tmp_path):
    """A run of what a function builds: MuJoCo in C, and MuJoCo Warp on both devices."""
    device, worlds = request.param
    return lambda build, seconds: Run(tmp_path, device, build, seconds, worlds)


def test_a_ball_on_a_v_track_keeps_its_energy(simulate):
    """Straight, round the bend, straight, and back: a velocity that is taken on as it stands is a h / 2 off each time.

    That cost 0.44 % here.
    """
    run = simulate(v_track, 1.5)
    found = energy(run)
    assert np.abs(found - found[0]).max() < 5e-4 * (found[0] - G * run.q["ball"][:, 2].min())


@pytest.fixture(scope="module")
def recording(tmp_path_factory):
    """A ball in a tight bend, whose push changes from step to step."""
    folder, scene = tmp_path_factory.mktemp("v"), Scene()
    scene.simulation(duration=1.0, frame_rate=60.0)
    v_track(scene, bend=0.15, slope=20.0)
    Simulation(scene.save(folder / "stage.usda"), device="cpu").run(folder / "r.rrd")
    return read(folder / "r.rrd")


def failing(recording):
    return {finding.unit for finding in ask(CheckRecordedForces(), recording) if not finding.passed}


def test_the_books_of_centred_velocities_balance(recording):
    """To single precision: half a step of what changes along the track is recorded beside the impulses."""
    books = RecordedContacts(Evidence(recording), recording.contacts).balanced()
    assert np.abs(recording.lead[:, 0, :3]).max() > 1e-4 * recording.world.bodies[0].mass  # [m/s]
    assert np.linalg.norm(books.force[:, 0], axis=1).max() < 1e-4 * G
    assert np.linalg.norm(books.torque[:, 0], axis=1).max() < 1e-4 * G
    assert not failing(recording)


def test_a_recording_of_before_is_judged_without_a_lead(recording):
    assert not failing(replace(recording, lead=None))


@pytest.mark.parametrize(("part", "unit"), [(slice(3), "N"), (slice(3, 6), "N m")])
def test_a_lead_accounts_for_no_more_than_half_a_step_can(recording, part, unit):
    """A velocity that grows by 0.3 m/s^2 of itself, and says that it is ahead of its impulses by as much."""
    ball, t = recording.world.bodies[0], recording.time
    grown = np.linspace(0.0, 0.3 * t[-1], len(t))[:, None, None] * np.eye(6)[4 if unit == "N m" else 1]
    scale = np.array([ball.mass] * 3 + [ball.inertia[0]] * 3)
    if unit == "N m":
        grown = grown * ball.mass * RADIUS / ball.inertia[0]
    forged = replace(
        recording,
        body_qd=(recording.body_qd + grown).astype(np.float32),
        lead=(recording.lead + scale * np.diff(grown, axis=0, prepend=0.0)).astype(np.float32),
    )
    assert unit in failing(forged)
