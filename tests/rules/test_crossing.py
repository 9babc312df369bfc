"""A vehicle crosses a floating block: how thick that has to be, where all of it stands, what must come of it."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from wsim.defaults import GRAVITY, WALL
from wsim.errors import UserError
from wsim.judge.language import sentence
from wsim.plan.schema import Material
from wsim.plan.store import load
from wsim.program.compose import compose
from wsim.program.validator import validate
from wsim.rules.grammar import NotUnderstood
from wsim.rules.lexicon import lexicon
from wsim.rules.planner import plan
from wsim.rules.scenes.afloat import FREE, Block
from wsim.scene.vehicle_spec import preset, presets

SAYS = "A Polaris-class vehicle leaves one dock, crosses a floating block, and reaches the other dock."
EXAMPLE = "examples/plans/polaris_crossing.json"


@pytest.fixture(scope="module")
def made():
    return plan(SAYS)


def test_it_is_the_world_that_the_example_has(made) -> None:
    """That was worked out by hand, with walls and a floor of 0.1 m."""
    by_hand, thinner = load(EXAMPLE), 0.1 - WALL
    for name in ("basin", "block"):
        one, other = made.object(name), by_hand.object(name)
        assert one.size == pytest.approx(other.size), name
        assert one.material.density == other.material.density, name
    assert made.object("block").pose.position[2] == pytest.approx(by_hand.object("block").pose.position[2] - thinner)
    for name in ("dock_near", "dock_far"):
        one, other = made.object(name), by_hand.object(name)
        assert one.size == pytest.approx((*other.size[:2], other.size[2] - thinner))
        assert abs(one.pose.position[0]) == pytest.approx(abs(other.pose.position[0]) - thinner)
    assert made.object("water").registration.spacing == 0.1
    assert {(each.object, each.ref, each.friction) for each in made.contacts} == {
        ("block", "apron_near", 0.1), ("block", "apron_far", 0.1),
    }  # fmt: skip
    asked, wanted = ([sentence(each.formula) for each in whole.objectives if each.formula] for whole in (made, by_hand))
    assert (
        asked[1].partition("](")[2]
        == wanted[1].partition("](")[2]
        == "gone_between(block, z, low -0.0697 m, high -0.0571 m))"
    )
    assert asked[3] == wanted[3]
    assert [each.kind for each in made.objectives] == [each.kind for each in by_hand.objectives]


def test_its_program_is_whole_and_waits(made) -> None:
    program = compose(made)
    assert [each.message for each in validate(program, made)] == []
    assert "waits=[(0.19, 0.0, 4.0)]" in program
    assert {name for step in made.steps for name in step.objects} == {item.name for item in made.objects}


def test_there_is_time_to_come_to_wait_and_to_recover(made) -> None:
    (drive,) = made.object("polaris").registration.actuation
    way = drive.route[-1][0] - made.object("polaris").pose.position[0]
    least = way / drive.speed + drive.waits[0]
    assert least + 3.0 < made.simulation.duration < least + 7.0


@pytest.mark.parametrize("kind", presets())
@pytest.mark.parametrize("density", [None, 100, 400])
def test_every_vehicle_gets_a_block_that_carries_it(kind: str, density: int | None) -> None:
    said = f" with a density of {density} kg/m3" if density else ""
    found = plan(f"A {kind} crosses a pontoon{said} between two docks.")
    block, spec = found.object("block"), preset(kind)
    assert validate(compose(found), found) == []
    size, rho = block.size, block.material.density
    assert rho == (density or 250.0)
    free, lean = floats(size, rho, spec)
    assert free >= FREE - 1e-3 and lean < 15.0
    top = block.pose.position[2] + size[2] / 2
    dock, basin = found.object("dock_near"), found.object("basin")
    assert dock.size[2] == pytest.approx(top - 0.1)
    assert basin.size[2] + WALL <= dock.size[2] - 0.1 + 1e-9
    spacing = found.object("water").registration.spacing
    level = found.object("water").relations[1].value
    draft = level + WALL - (block.pose.position[2] - size[2] / 2)
    assert draft == pytest.approx(rho / 1000.0 * size[2], abs=1e-5)
    for length in (*size[:2], *basin.size[:2], level, draft):  # what particles fill is what is said
        assert length / spacing == pytest.approx(round(length / spacing), abs=1e-3)
    assert (
        abs(found.object(kind).pose.position[0]) + spec.length / 2 < dock.size[0] - dock.pose.position[0] * 2 / 2 + 0.1
    )


def floats(size, density: float, spec) -> tuple[float, float]:
    """How far the lower end is above the water [m] with the rear axle over it, and the lean [deg].

    Not by a metacentric height, but by the water's plane: what is under it, in thin slices of the leaning block, weighs
    as much as block and load, and its moment is theirs.
    """
    length, width, height = size
    mass, load = density * length * width * height, spec.mass
    arm = length / 2 - spec.front_share * spec.wheelbase
    slices = np.linspace(-length / 2, length / 2, 4001)

    def wrong(middle: float, lean: float) -> tuple[float, float]:
        under = np.clip(middle - slices * math.tan(lean), 0.0, height)  # draft along it
        push = 1000.0 * width * length * under.mean()
        # Moments about the block's middle at its bottom; what is high leans the same way.
        lift = 1000.0 * width * length * (under * (slices - under / 2 * math.tan(lean))).mean()
        weight = mass * (-height / 2 * math.tan(lean))
        weight += load * (-arm - (height + spec.com_height) * math.tan(lean))
        return push - mass - load, lift - weight

    low, high = 0.0, math.radians(30.0)
    for _ in range(60):
        lean = 0.5 * (low + high)
        a, b = 0.0, 2.0 * height
        for _ in range(60):
            middle = 0.5 * (a + b)
            a, b = (middle, b) if wrong(middle, lean)[0] < 0.0 else (a, middle)
        low, high = (lean, high) if wrong(middle, lean)[1] > 0.0 else (low, lean)
    return height - middle - length / 2 * math.tan(lean), math.degrees(lean)


@given(st.floats(3.0, 8.0), st.floats(2.0, 4.0), st.floats(0.5, 1.5), st.floats(100.0, 500.0))
def test_its_lean_is_that_of_the_waters_plane(length: float, width: float, height: float, density: float) -> None:
    """Where the block goes in with all of its bottom, and comes out with all of its top."""
    spec = preset("polaris")
    block = Block((length, width, height), Material(name="foam", density=density, friction=0.9, color=(1, 1, 1)), spec)
    dips = length / 2 * math.tan(min(block.lean, 1.5))
    if block.free < 0.02 or dips > block.loaded or math.degrees(block.lean) > 8.0:
        return
    free, lean = floats(block.size, density, spec)
    assert lean == pytest.approx(math.degrees(block.lean), rel=0.03, abs=0.05)
    assert free == pytest.approx(block.free, abs=0.02)


def test_its_heave_is_that_of_a_spring() -> None:
    block = Block(
        (4.0, 2.0, 0.8), Material(name="foam", density=250.0, friction=0.9, color=(1, 1, 1)), preset("polaris")
    )
    k, m = 1000.0 * GRAVITY * 8.0, 2.3 * (1600.0 + 1360.0)
    assert block.period == pytest.approx(2.0 * math.pi * math.sqrt(m / k))


def test_one_that_goes_under_is_said_to_and_another_is_proposed() -> None:
    found = plan("A Polaris crosses a 4 x 2 x 0.4 m floating block with a density of 400 kg/m3.")
    assert found.object("block").size == (4.0, 2.0, 0.4)
    (warning,) = [each for each in found.assumptions if each.choice.startswith("warning:")]
    assert "0.4 m of 400 kg/m^3 go under" in warning.choice
    assert "0.9 m of 250 kg/m^3 would carry it" in warning.why


def test_its_colour_is_the_one_that_is_said() -> None:
    found = plan("A Polaris crosses a red floating block.").object("block")
    assert found.material.color == lexicon().colors["red"] and found.material.density == 250.0


@pytest.mark.parametrize(
    "says",
    [
        "A buggy drives from one dock over a floating block to the other dock.",
        "An HMMWV crosses a raft at 1 m/s.",
        "A car leaves a pier, crosses a floating bridge and arrives at the other pier.",
        "A truck drives across a floating platform from one quay to the other quay.",
        "A golf cart crosses a wooden pontoon between two jetties.",
        "A buggy crosses a raft between docks.",
    ],
)
def test_it_is_said_in_other_words(says: str) -> None:
    found = plan(says)
    assert [item.primitive for item in found.objects].count("vehicle") == 1
    assert found.object("block").size[0] > 2.0


@pytest.mark.parametrize(
    ("says", "why"),
    [
        ("A Polaris crosses a steel pontoon.", "of 7850 kg/m^3 it does not float"),
        ("A truck crosses a pontoon with a density of 900 kg/m3.", "no block of 900 kg/m^3"),
        ("A Polaris crosses a 60 x 60 x 1 m pontoon.", "particles would be around it; give a smaller one"),
        ("A Polaris crosses a 4 m thick raft.", "it turns over"),
        ("A Polaris crosses a 10 x 1 x 1 m raft.", "needs 3.4 x 1.6 m to stand on"),
        ("A Polaris crosses a 2 x 8 x 1 m raft.", "needs 3.4 x 1.6 m to stand on"),
        ("A Polaris crosses a 0 m thick raft.", "more than 0"),
        ("A Polaris crosses a 5 x 3 x 1 m steel raft.", "does not float"),
        ("A buggy drives 20 m over a floating block.", "as it was made"),
        ("A big buggy crosses a raft.", "as it was made"),
        ("A buggy crosses a raft between two 3 m docks.", "as it was made"),
        ("A buggy behind a dock crosses a raft.", "as it was made"),
        ("A Polaris crosses a floating block, and a crate stands on the ground.", "leave it out"),
        ("Two Polaris cross a floating block.", "leave it out"),
        ("A Polaris crosses two floating blocks.", "leave it out"),
        ("A Polaris crosses a floating block at 9 m/s.", "outside 0.5 to 2 m/s"),
        ("A Polaris crosses a floating block for 5 s.", "5 s are too short"),
    ],
)
def test_what_it_does_not_build_is_said(says: str, why: str) -> None:
    with pytest.raises(UserError, match=why.replace("^", r"\^")):
        plan(says)


@pytest.mark.parametrize(
    "says",
    [
        "A ball crosses a floating block.",
        "A Polaris crosses a table.",
        "A Polaris leaves one dock.",
        "A crate stands on a dock.",
        "A Polaris leaves the table and crosses a floating block.",
        "A buggy leaves the other dock, crosses a raft, and reaches the other dock.",
        "A buggy reaches one dock, crosses a raft and leaves the other dock.",
        "A buggy leaves two docks and crosses a raft.",
        "A buggy crosses a raft between three docks.",
        "A buggy crosses a raft and crosses a raft.",
    ],
)
def test_what_makes_no_crossing_is_refused_by_its_words(says: str) -> None:
    with pytest.raises(NotUnderstood):
        plan(says)
