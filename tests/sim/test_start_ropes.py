"""Starts that would stretch a taut rope are refused; what keeps its length or slackens it starts as stated."""

import numpy as np
import pytest

from wsim.errors import UserError
from wsim.scene import Scene
from wsim.sim import Simulation


def bob(tmp_path, velocity, *, length=None, worlds=1):
    """On a rope of 1 m from above, 0.6 m aside."""
    scene = Scene()
    scene.sphere("bob", radius=0.05, mass=1.0, position=(0.6, 0, -0.8), velocity=velocity)
    scene.rope("rope", None, "bob", anchor_a=(0, 0, 0), length=length)
    return Simulation(scene.save(tmp_path / "stage.usda"), "cpu", world_count=worlds)


@pytest.mark.parametrize("worlds", [1, 2])
def test_a_bob_that_is_thrown_outwards_is_refused(tmp_path, worlds):
    """Of 1 m/s along x 0.6 would stretch it: what is left is (1, 0, 0) - 0.6 (0.6, 0, -0.8)."""
    with pytest.raises(UserError, match=r"/World/rope: .* at 0\.6 m/s .* \(0\.64, 0\.0, 0\.48\) m/s"):
        bob(tmp_path, (1, 0, 0), worlds=worlds)


@pytest.mark.parametrize(
    ("velocity", "length"), [((0.64, 0, 0.48), None), ((0, 2, 0), None), ((-1, 0, 0), None), ((1, 0, 0), 1.01)]
)
def test_what_keeps_it_or_slackens_it_starts_as_stated(tmp_path, velocity, length):
    simulation = bob(tmp_path, velocity, length=length)
    assert simulation.state.body_qd.numpy()[0, :3] == pytest.approx(velocity, abs=1e-6)


def test_a_spin_that_winds_a_rope_up_is_refused(tmp_path):
    """Tied 5 cm off its middle a plate that turns at 2 rad/s takes the rope along at 0.1 m/s."""
    scene = Scene()
    turn = np.degrees(2.0)
    scene.box("plate", size=(0.2, 0.2, 0.05), position=(0, 0, -1), angular_velocity_deg=(0, turn, 0))
    scene.rope("rope", None, "plate", anchor_a=(0.05, 0, 0), anchor_b=(0.05, 0, -1))
    with pytest.raises(UserError, match=r"stretched at 0\.1 m/s"):
        Simulation(scene.save(tmp_path / "stage.usda"), "cpu")


@pytest.mark.parametrize(("other", "refused"), [(1.0, False), (0.5, True)])
def test_over_a_post_one_end_goes_down_as_the_other_comes_up(tmp_path, other, refused):
    scene = Scene()
    scene.cylinder("post", radius=0.1, height=0.2, axis="Y", position=(0, 0, 1), static=True)
    for name, x, speed in (("left", -0.1, 1.0), ("right", 0.1, -other)):
        scene.sphere(name, radius=0.04, mass=1.0, position=(x, 0, 0), velocity=(0, 0, -speed))
    scene.rope("rope", "left", "right", around=["post"])
    stage = scene.save(tmp_path / "stage.usda")
    if refused:
        with pytest.raises(UserError, match=r"/World/rope: .* at 0\.5 m/s"):
            Simulation(stage, "cpu")
    else:
        assert Simulation(stage, "cpu").state.body_qd.numpy()[:, 2] == pytest.approx([-1.0, 1.0], abs=1e-6)


def test_what_is_led_may_jerk_it(tmp_path):
    scene = Scene()
    scene.box("tug", size=(0.1,) * 3, position=(0, 0, 1), velocity=(1, 0, 0), kinematic=True)
    scene.box("load", size=(0.1,) * 3, position=(-1, 0, 1), mass=1.0)
    scene.rope("rope", "tug", "load")
    Simulation(scene.save(tmp_path / "stage.usda"), "cpu")


@pytest.mark.parametrize("seed", range(12))
def test_a_spin_about_its_line_leaves_a_rope_as_it_is(tmp_path, seed):
    """What only spins goes nowhere: it is not refused for the rounding of a rate of 0, of which any is too much."""
    rng = np.random.default_rng(seed)
    way = rng.normal(size=3)
    way /= np.linalg.norm(way)
    tied = np.array([0.0, 0.0, 1.0]) + rng.uniform(-0.05, 0.05, 3)
    spin = rng.uniform(5.0, 600.0) * way
    scene = Scene()
    scene.box("box", size=(0.1,) * 3, mass=1.0, position=(0, 0, 1), angular_velocity_deg=spin.tolist())
    far = tied + rng.uniform(0.2, 1.5) * way
    scene.rope("rope", None, "box", anchor_a=far.tolist(), anchor_b=tied.tolist())
    found = Simulation(scene.save(tmp_path / "stage.usda"), "cpu").state.body_qd.numpy()[0]
    assert found == pytest.approx([0, 0, 0, *np.radians(spin)], abs=1e-5)
