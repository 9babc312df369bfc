"""What single precision cannot solve is named: bodies, masses, and the condition of what is factored."""

import math

import mujoco
import numpy as np
import pytest

from wsim.scene import Scene
from wsim.sim import Simulation
from wsim.solvers.single_precision import beyond_single_precision

RING = 0.21


@pytest.fixture
def lines(tmp_path):
    """Of a cable over a post with a weight at either end."""

    def of(weight):
        scene = Scene()
        scene.cylinder("post", radius=0.2, height=0.3, axis="Y", static=True)
        turn = [(RING * math.cos(a), 0, RING * math.sin(a)) for a in np.linspace(math.pi, 0, 37)]
        for name, x in (("left", -RING), ("right", RING)):
            scene.box(name, size=(0.04, 0.04, 0.04), mass=weight, position=(x, 0, -0.22))
        scene.cable("c", "left", "right", anchor_a=(-RING, 0, -0.2), anchor_b=(RING, 0, -0.2), through=turn, links=26,
                    mass_per_length=0.1, radius=0.01)  # fmt: skip
        simulation = Simulation(scene.save(tmp_path / "stage.usda"), "cpu")
        assert simulation.rigid.beyond_precision() == []  # it is solved in double
        return beyond_single_precision(mujoco, simulation.rigid.solver.mj_model, str)

    return of


def test_two_kilograms_on_links_of_four_grams_are_named_with_the_way_out(lines):
    (line,) = lines(2.0)
    assert "of 2 kg, hangs together with 27 bodies down to 0.0034 kg" in line
    assert "1.8e+08: single precision can solve up to 1e+07" in line
    assert "mass_per_length" in line
    assert "one world on a CPU" in line


def test_what_single_precision_solves_is_not(lines):
    assert lines(0.05) == []
