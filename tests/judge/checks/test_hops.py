"""What bounces for about a frame: it may be back when the next one sees it, and is never seen where it touches."""

from dataclasses import replace

import pytest

from tests.judge.theory import ask, only
from wsim.judge.books.impacts import comes_back
from wsim.judge.checks.impacts import CheckRestitution
from wsim.judge.checks.rest import CheckJitter
from wsim.recording import read
from wsim.scene import Scene
from wsim.sim import Simulation

G = 9.81  # [m/s^2]


def dropped(folder, restitution, height):
    scene = Scene()
    scene.simulation(duration=1.0, frame_rate=30)
    scene.ground(friction=0.6)
    scene.sphere("ball", radius=0.1, position=(0, 0, height), restitution=restitution)
    Simulation(scene.save(folder / "stage.usda"), device="cpu").run(folder / "r.rrd")
    return replace(read(folder / "r.rrd"), contacts=None)  # as of a batch, whose blows are not recorded


# Seen of 8,192 drops that the judge took for others' restitution, or for chatter.
@pytest.mark.parametrize(
    ("restitution", "height"),
    [(0.031831, 1.72531), (0.062782, 0.917677), (0.087467, 0.550934), (0.065108, 0.376371)],
)
def test_what_may_have_hopped_within_a_frame_tells_no_restitution(tmp_path, restitution, height):
    assert all(finding.passed for finding in ask(CheckRestitution(), dropped(tmp_path, restitution, height)))


@pytest.mark.parametrize(("restitution", "height"), [(0.599611, 0.426107), (0.583467, 0.447)])
def test_what_no_frame_sees_touch_bounces_and_does_not_tremble(tmp_path, restitution, height):
    assert only(ask(CheckJitter(), dropped(tmp_path, restitution, height))).passed


def test_a_hop_from_where_a_step_found_it_is_back_sooner():
    """From the surface 2 v / g; from z above it, where it has less speed left, down to v / g where it would turn."""
    assert comes_back(0.5, G, 0.0) == pytest.approx(2.0 * 0.5 / G)
    assert comes_back(0.5, G, 0.01) == pytest.approx((0.5 + (0.25 - 0.02 * G) ** 0.5) / G)
    assert comes_back(0.5, G, 1.0) == pytest.approx(0.5 / G)
    assert comes_back(0.0, G, 0.01) == comes_back(0.5, 0.0, 0.01) == float("inf")
