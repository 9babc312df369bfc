"""What bounces keeps its energy, alone, beside a mechanism, and in a cluster."""

from functools import partial

import numpy as np
import pytest

from tests.sim.test_bodies import G, Run


@pytest.fixture(params=["cpu", pytest.param("cuda:0", marks=pytest.mark.cuda)])
def simulate(request, tmp_path):
    """A run of what a function builds, on each device."""
    return partial(Run, tmp_path, request.param)


@pytest.mark.parametrize("worlds", [1, 2])
@pytest.mark.parametrize("jointed", [False, True])
def test_an_elastic_ball_keeps_its_energy(simulate, jointed, worlds):
    """Whichever order of steps it flies by: a world with a joint makes them of the fourth."""

    def build(scene):
        scene.ground()
        scene.sphere("ball", radius=0.1, mass=10.0, position=(0, 0, 1.1), restitution=1.0)
        if jointed:
            scene.sphere("bob", radius=0.1, mass=1.0, position=(3, 0, 3))
            scene.joint_revolute("hinge", None, "bob", anchor=(3, 0, 4), axis="Y")

    run = simulate(build, 2.5, worlds)
    height, speed = run.q["ball"][:, 2] - 0.1, run.v["ball"][:, 2]
    energy = G * height + 0.5 * speed**2
    if not jointed:  # the parabola through places of the first order
        energy -= 0.5 * G * run.dt * speed
    assert int((np.diff(np.sign(speed)) > 0).sum()) == 3
    assert energy[-1] == pytest.approx(energy[0], rel=5e-4)


@pytest.mark.parametrize("worlds", [1, 2])
def test_a_ball_with_fast_spin_bounces_as_one_without(simulate, worlds):
    """On a floor and on another ball: friction is sought until it fits the push, or half of the bounce is lost."""

    def build(scene):
        scene.simulation(gravity=(0, 0, 0))
        scene.ground()
        spun = {"radius": 0.1, "mass": 1.0, "friction": 1.0, "restitution": 0.9}
        scene.sphere("ball", position=(0, 0, 0.15), velocity=(0, 0, -2), angular_velocity_deg=(0, 8000, 0), **spun)
        scene.sphere("one", position=(3, 0, 2), velocity=(1, 0, 0), angular_velocity_deg=(0, 8000, 0), **spun)
        scene.sphere("two", position=(3.25, 0, 2), velocity=(-1, 0, 0), angular_velocity_deg=(0, 8000, 0), **spun)

    run = simulate(build, 0.05, worlds)
    assert run.v["ball"][-1, 2] == pytest.approx(0.9 * 2.0, rel=2e-3)
    assert run.v["two"][-1, 0] - run.v["one"][-1, 0] == pytest.approx(0.9 * 2.0, rel=2e-3)


def test_a_blow_through_a_cluster_keeps_its_energy(simulate):
    """A ball that is hit while it nears another lets go of that one: nothing is lost at a dead stop."""

    def build(scene):
        scene.simulation(gravity=(0, 0, 0))
        for k, (x, speed) in enumerate(((0.0, 0.5), (0.204, 0.0), (-0.25, 20.0))):
            scene.sphere(f"b{k}", radius=0.1, mass=1.0, position=(x, 0, 0), velocity=(speed, 0, 0), friction=0.0,
                         restitution=1.0)  # fmt: skip

    run = simulate(build, 0.05)
    energy = sum(0.5 * (v**2).sum(axis=1) for v in run.v.values())
    assert energy[-1] == pytest.approx(200.125, rel=1e-4)
