"""Prompts of each kind become worlds that the judge accepts: composed, built, simulated on the CPU, judged."""

import pytest

from wsim.program.compose import compose
from wsim.rules.planner import plan
from wsim.runs.iteration import Iteration
from wsim.runs.settings import Settings

PROMPTS = [
    "A steel ball rolls down a wooden ramp for 1.4 seconds",
    "An oak cube slides down a 35 degree ramp",
    "An ice block slides down a ramp of 20 degrees",
    "A concrete block slides across the floor at 3 m/s and hits a wall",
    "A 0.4 m pendulum swings from 30 degrees",
    "A red ball and a blue ball collide for 1 second",
    "A ball is thrown at 5 m/s at an angle of 30 degrees for 1.2 seconds",
    "A box is pushed to the left at 2 m/s for 1 second",
    "A conveyor carries three crates",
    "A crate rides on a conveyor at 1 m/s and falls onto the floor",
    "A ball rolls on a treadmill at 2 m/s for 1 second",
    "A turntable carries a box",
    "A barrel rolls at 2 m/s",
    "A box falls onto a seesaw",
    "A tower of 2 blocks stands on a table for 1 second",
    "A wooden block rests on a ramp",
    "A ball rolls at 2 m/s down a ramp of 10 degrees",
    "A stack of four crates topples",
    "A crate slides at 2 m/s and stops before a wall",
    "A rubber ball bounces and dies down",
    "A rubber ball drops from 0.3 m, bounces and comes up to 30 % of its height for 1 second",
    "A 0.4 m pendulum swings from 30 degrees and dies down",
    "A 0.4 m pendulum swings and climbs to 95 % of its height for 1.5 seconds",
    "A crate falls onto a seesaw and the seesaw tilts by 8 degrees",
    "A turntable turns at 30 rpm",
    "A steel ball with a restitution of 0.8 drops from 0.3 m for 1 second",
    "A marble rolls off the edge of a table that is 0.8 m high and lands in a bucket on the floor",
    "A pendulum with a 2 kg bob is let go from 60 degrees and knocks a wooden block off a pedestal",
    "A seesaw with a 30 kg box on the left end and a 20 kg box on the right: the left end goes down",
    "A box on a conveyor belt drops off its end into a bin",
    "Two boxes hang from ropes",
]


def judged_world(prompt, folder):
    made = plan(prompt)
    (folder / "program.py").write_text(compose(made))
    return made, Iteration.of(folder / "program.py", folder, made, Settings(device="cpu", pictures=False)).run()


@pytest.mark.parametrize("prompt", PROMPTS)
def test_a_world_is_accepted(prompt, tmp_path):
    made, verdict = judged_world(prompt, tmp_path)
    assert verdict.status == "accepted", verdict.summary
    judged = {finding.objective for finding in verdict.findings if finding.objective}
    assert judged == {objective.sentence for objective in made.objectives}


def test_what_slides_off_its_ramp_and_lies_still_has_not_rested_on_it(tmp_path):
    """By 3 s it is on the ground, at rest: more time, as advice, would change nothing; friction would."""
    _, verdict = judged_world("A wooden block rests on a wooden ramp of 40 degrees for 3 seconds", tmp_path)
    assert verdict.status == "rejected"
    wrong = [finding for finding in verdict.findings if not finding.passed]
    assert {finding.check for finding in wrong} >= {"ObjectiveFormula"}
    assert {(finding.target.parameter, finding.target.direction) for finding in wrong} == {("friction", "raise")}
    assert wrong[0].target.suggested == pytest.approx(1.1 * 0.839, abs=1e-3)  # tan 40 degrees, and room to it
