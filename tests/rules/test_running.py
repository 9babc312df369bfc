"""What runs under what stands on it, in the ways that people say it."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from wsim.errors import UserError
from wsim.rules.planner import plan

LOADS = st.sampled_from(["A crate", "A barrel", "A box of 20 kg", "A wooden block"])
STANDS = st.sampled_from(["stands", "lies", "sits", "rests", "is", "rides", "is placed"])
BELTS = st.sampled_from(["conveyor", "conveyor belt", "belt", "treadmill"])
SPEEDS = st.sampled_from([0.5, 1, 1.5, 2])
RUNS = st.sampled_from(["runs", "moves", "turns", "is running", "is moving"])
ING = st.sampled_from(["running", "moving", "turning"])
WHICH = st.sampled_from(["that", "which"])


@st.composite
def stories(draw):
    """A sentence or two, and the belt's speed [m/s]."""
    load, stands, belt, speed = draw(LOADS), draw(STANDS), draw(BELTS), draw(SPEEDS)
    runs = draw(RUNS)
    at, the_load = f"at {speed:g} m/s", load.lower()
    said = draw(
        st.sampled_from(
            [
                f"{load} {stands} on a {belt} {draw(WHICH)} {runs} {at}",
                f"{load} {stands} on a {belt} {draw(ING)} {at}",
                f"{load} on a {belt} {draw(WHICH)} {runs} {at}",
                f"A {belt} {draw(WHICH)} {runs} {at} carries {the_load}",
                f"A {belt} {draw(ING)} {at} carries {the_load}",
                f"A {belt} {draw(WHICH)} carries {the_load} {runs} {at}",
                f"A {belt} {runs} {at} and {the_load} {stands} on it",
                f"{load} {stands} on a {belt}. The {belt} {runs} {at}",
                f"{load} {stands} on a {belt} {at}",
                f"{load} {stands} on a {draw(ING)} {belt} {at}",
            ]
        )
    )
    return f"{said}{draw(st.sampled_from(['.', '']))}", belt, speed


@settings(max_examples=60, deadline=None)
@given(stories())
def test_a_belt_runs_as_it_is_said_to_and_carries_what_stands_on_it(story):
    prompt, belt, speed = story
    made = plan(prompt)
    [carrier] = [one for one in made.objects if one.surface_velocity is not None]
    assert carrier.name == ("treadmill" if belt == "treadmill" else "conveyor")
    assert carrier.surface_velocity == (speed, 0.0, 0.0)
    [load] = [one for one in made.objects if one.role == "rigid_body"]
    assert load.pose.position[2] > carrier.pose.position[2]
    assert not any("gives no speed" in one.why for one in made.assumptions)
    assert any(one.object == load.name for one in made.objectives)


@pytest.mark.parametrize("turns", ["turns", "spins", "rotates", "is turning"])
def test_a_turntable_turns_as_it_is_said_to(turns):
    made = plan(f"A box sits on a turntable that {turns} at 30 rpm.")
    assert made.object("turntable").angular_velocity_deg == (0.0, 0.0, 180.0)


@pytest.mark.parametrize("thing", ["table", "shelf", "pallet", "desk", "ramp", "seesaw"])
@pytest.mark.parametrize("runs", ["that runs at 1 m/s", "moving at 1 m/s", "that moves"])
def test_what_cannot_run_is_named(thing, runs):
    with pytest.raises(UserError, match=f"{thing} {runs}"):
        plan(f"A crate stands on a {thing} {runs}.")


def test_two_speeds_are_refused():
    with pytest.raises(UserError, match=r"\[1.0, 2.0\] m/s"):
        plan("A crate at 2 m/s stands on a conveyor that runs at 1 m/s")
    with pytest.raises(UserError, match=r"conveyor that runs at 9 m/s.*: 9 m/s is not above 0 and up to 5 m/s"):
        plan("A crate stands on a conveyor that runs at 9 m/s.")
