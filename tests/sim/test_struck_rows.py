"""What touches hands a blow on at once, and goes on together: no row sinks into itself, no pair parts by itself."""

from functools import partial

import numpy as np
import pytest

from tests.sim.test_bodies import G, Run

SIZE = 0.2  # [m]
BOTH = pytest.mark.parametrize("worlds", [1, 2])  # MuJoCo in C, and in Warp


@pytest.fixture(params=["cpu", pytest.param("cuda:0", marks=pytest.mark.cuda)])
def simulate(request, tmp_path):
    """A run of what a function builds, on each device."""
    return partial(Run, tmp_path, request.param)


@BOTH
@pytest.mark.parametrize("kind", ["sphere", "box"])
@pytest.mark.parametrize(("restitution", "speed"), [(0.3, 11.0), (0.9, 4.0), (1.0, 11.0)])
def test_a_row_that_is_hit_does_not_sink_into_itself(simulate, kind, restitution, speed, worlds):
    """Four that touch; the first would be sent a step's way into the second, by speed h (1 + e) / 2, 9 to 14 mm."""

    def build(scene):
        scene.simulation(gravity=(0, 0, 0))
        shape = {"radius": SIZE / 2} if kind == "sphere" else {"size": (SIZE,) * 3}
        for k in range(4):
            getattr(scene, kind)(f"b{k}", position=(k * SIZE, 0, 0), mass=1.0, restitution=restitution, **shape)
        reach = 3.2 * speed * 1.25e-3  # it is there a fifth of a step after one has begun: nothing overlaps yet
        getattr(scene, kind)("hits", position=(-SIZE - reach, 0, 0), velocity=(speed, 0, 0), mass=1.0,
                             restitution=restitution, **shape)  # fmt: skip

    run = simulate(build, 0.05, worlds)
    names = ["hits", *(f"b{k}" for k in range(4))]
    place, motion = (np.stack([kept[name][:, 0] for name in names], axis=1) for kept in (run.q, run.v))
    assert (np.diff(place, axis=1) - SIZE).min() > -1e-4
    assert motion.sum(axis=1) == pytest.approx(np.full(len(motion), speed), rel=1e-5)
    energy = (motion**2).sum(axis=1) / speed**2
    assert energy.max() < 1.0 + 1e-5
    if restitution == 1.0:
        assert motion[-1] == pytest.approx([0, 0, 0, 0, speed], abs=1e-3 * speed)
    else:  # what the first two blows give the last is the least that it has
        assert motion[-1, -1] > (0.5 * (1 + restitution)) ** 4 * speed * 0.99


@BOTH
@pytest.mark.parametrize("restitution", [0.0, 0.5])
def test_what_is_struck_keeps_beside_what_it_touches(simulate, restitution, worlds):
    """Two smooth boxes fall on each other's faces, a ball hits the lower one level: their gap stays. By steps of two
    orders it would change by g h² / 2, 7.7 um, which a step later is 6 mm/s from nowhere."""

    def build(scene):
        smooth = {"mass": 1.0, "friction": 0.0, "restitution": restitution}
        for name, z in (("low", 0.0), ("high", SIZE)):
            scene.box(name, size=(SIZE,) * 3, position=(0, 0, z), **smooth)
        scene.sphere("ball", radius=0.05, position=(-0.17, 0, 0), velocity=(3, 0, 0), **smooth)

    run = simulate(build, 0.02, worlds)
    assert run.v["low"][-1, 0] == pytest.approx(1.5 * (1 + restitution), rel=1e-3)
    assert run.q["high"][:, 2] - run.q["low"][:, 2] == pytest.approx(np.full(len(run.q["low"]), SIZE), abs=3e-7)
    fallen = 0.5 * G * (run.dt * (1 + np.arange(len(run.q["low"])))) ** 2
    assert run.q["low"][:, 2] == pytest.approx(-fallen, abs=1e-6)
