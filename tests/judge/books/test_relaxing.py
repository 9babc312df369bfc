"""What a damper takes of what comes to rest relative to it within an interval, by closed form and by recordings."""

import numpy as np
import pytest

from tests.judge.theory import ask, with_world
from wsim.judge.books.relaxing import relaxation, resolved, taken
from wsim.judge.checks.energy import CheckEnergy
from wsim.recording import read
from wsim.scene import Scene
from wsim.sim import Simulation

H = 0.01  # [s]


def relaxing(rate, ratio, force=0.0):
    """Ends let go at -2 m/s, unstretched, with another force that gives `force` [m/s^2]: speed, length and work."""
    root = np.sqrt(rate * (rate - 4.0 * ratio))
    fast, slow = 0.5 * (rate + root), 0.5 * (rate - root)
    at_rest = force / (rate * ratio) if ratio else 0.0
    # x = a exp(-fast t) + b exp(-slow t) + at_rest, of x(0) = 0 and x'(0) = -2.
    b = (-2.0 - fast * at_rest) / (fast - slow)
    a = -at_rest - b
    t = np.arange(12) * H
    x = a * np.exp(-fast * t) + b * np.exp(-slow * t) + at_rest
    v = -a * fast * np.exp(-fast * t) - b * slow * np.exp(-slow * t)
    terms = ((-a * fast, fast), (-b * slow, slow))
    work = sum(
        p * q * (np.exp(-(f + g) * t[:-1]) - np.exp(-(f + g) * t[1:])) / (f + g) for p, f in terms for q, g in terms
    )
    return v, 1.0 + x, work


@pytest.mark.parametrize("ratio", [0.5, 20.0])
@pytest.mark.parametrize("force", [0.0, 9.81])
@pytest.mark.parametrize("rate", [120.0, 1000.0, 1e4])
def test_the_work_is_that_of_the_law(rate, ratio, force):
    """Of what comes to rest in 0.8 to 0.01 of an interval, with a weight on it or none."""
    v, length, work = relaxing(rate, ratio, force)
    found, unsure = taken(v, length, 1.0, ratio, np.full(len(v) - 1, H))
    assert found[0] == pytest.approx(work[0], rel=1e-4)
    assert unsure[0] < 1e-3 * work[0]
    trapezoid = 0.5 * H * (v[0] ** 2 + v[1] ** 2)
    assert abs(trapezoid / work[0] - 1.0) > 0.1


@pytest.mark.parametrize("phase", [0.0, 0.7, 1.6])
@pytest.mark.parametrize("swing", [0.3, 0.8, 1.2])
def test_a_swing_that_frames_resolve(swing, phase):
    """The rate is cos(w t + p), by w h rad a frame; its square is integrated to 1 % in each frame, and over the run."""
    t = np.arange(30.0)
    at = swing * t + phase
    work = np.diff(0.5 * t + np.sin(2.0 * at) / (4.0 * swing)) * H
    found, unsure = resolved(np.cos(at), H * np.sin(at) / swing, np.full(len(t) - 1, H))
    assert np.abs(found - work).max() < 0.01 * H * (swing / 1.2) ** 4
    assert abs(found.sum() / work.sum() - 1.0) < 0.01 * (swing / 1.2) ** 4
    assert unsure.mean() < 0.01 * H


@pytest.mark.parametrize("when", [0.02, 0.3, 0.5, 0.9])
def test_what_a_blow_does_to_the_rate_is_unsure(when):
    """It goes from 0 to 1 at some moment of an interval."""
    rate, way = np.array([0.0, 0.0, 0.0, 1.0, 1.0, 1.0]), np.array([0.0, 0.0, 1.0 - when, 1.0, 1.0])
    found, unsure = resolved(rate, H * np.concatenate([[0.0], np.cumsum(way)]), np.full(5, H))
    assert abs(found[2] - (1.0 - when) * H) <= unsure[2] * (1.0 + 1e-9)


def test_what_frames_resolve_is_none_of_it():
    assert relaxation((-2.0, -1.9), -0.0195, H, 5.0) is None


def pair(folder, damping):
    """Two balls that fly at each other without weight, with a spring between them."""
    scene = Scene()
    scene.simulation(gravity=(0, 0, 0), duration=0.1, frame_rate=100.0)
    for name, x in (("left", 0.0), ("right", 1.0)):
        scene.sphere(name, radius=0.1, mass=1, position=(x, 0, 1), velocity=(1 - 2 * x, 0, 0))
    scene.spring("coil", "left", "right", stiffness=100, damping=damping)
    Simulation(scene.save(folder / "stage.usda"), device="cpu").run(folder / "r.rrd")
    return read(folder / "r.rrd")


@pytest.mark.parametrize("damping", [60.0, 600.0])
def test_the_energy_of_what_an_overdamped_spring_stops(tmp_path, damping):
    """It comes to rest in 0.8 or 0.08 of a frame, as c / mu has it, and loses all but 2 % of what it had."""
    sound = pair(tmp_path, damping)
    assert all(finding.passed for finding in ask(CheckEnergy(), sound))
    for share in (0.9, 1.1):
        springs = [spring.model_copy(update={"damping": share * damping}) for spring in sound.world.springs]
        assert not all(finding.passed for finding in ask(CheckEnergy(), with_world(sound, springs=springs)))
