"""What a prompt or a plan speaks of picks the skills that it needs."""

import subprocess
import sys
from pathlib import Path

import pytest

from wsim.skills import pick

FLOAT, FLUID, WAVES = "floating-bodies", "containers-and-fluid", "waves-and-dam-breaks"
RIGID, STACK, JOINT = "rigid-bodies", "stacks-and-contact", "joints-and-mechanisms"
SWING, HIT, CONTROL = "pendulums-and-springs", "projectiles-and-collisions", "control-functions"
CAMERA, PARAM, STEP = "cameras-and-light", "parameters", "time-step-and-stability"
USD, GOAL, REPAIR, SENSE = "raw-usd", "objectives", "repairing", "sensors"

CASES = {
    "A cork ball floats in a tank of water.": {FLOAT},
    "Three wooden blocks float on the water in a glass tank.": {FLOAT, FLUID},
    "A raft with a crate on it bobs in a basin.": {FLOAT},
    "A steel ball drops into a tank of oil and sinks.": {FLOAT},
    "A stack of five boxes on the ground, and a heavy ball knocks it over.": {STACK},
    "A tower of blocks balances on a plank.": {STACK},
    "A row of dominoes topples.": {STACK},
    "A steel ball rolls down a wooden ramp.": {RIGID},
    "A block of ice slides down an incline.": {RIGID},
    "Five rubber cubes lie on a concrete floor.": {RIGID},
    "A four-bar linkage with a motor on its crank.": {JOINT},
    "A crank turns and pushes a piston to and fro.": {JOINT},
    "A door on a hinge is pushed open.": {JOINT},
    "A seesaw tilts when a crate lands on it.": {JOINT},
    "A pendulum swings from the ceiling.": {SWING},
    "A double pendulum is let go from the side.": {SWING},
    "A mass hangs on a spring and oscillates, slowly damped.": {SWING},
    "Two billiard balls collide.": {HIT},
    "A ball is thrown over a wall and bounces twice.": {HIT},
    "A Newton's cradle of five steel balls.": {HIT},
    "A column of water collapses and floods the floor.": {WAVES},
    "A wave maker makes waves in a long tank.": {WAVES},
    "Water is poured into a bucket.": {FLUID},
    "Honey fills a glass.": {FLUID},
    "A drone hovers at 1 m by feedback control.": {CONTROL},
    "What an IMU on the trolley measures, and a lidar that scans the room.": {SENSE},
    "A robot with a depth camera sees a ball and follows it by its images.": {"camera-sensors"},
    "A cart follows a sine path along a rail.": {CONTROL, JOINT},
    "Show it from above, with a close camera and sunlight from the left.": {CAMERA},
    "Sweep the friction from 0.1 to 0.9.": {PARAM},
    "The run explodes; is the time step too long?": {STEP},
    "A hammer of two shapes lies on a table.": {USD},
    "The ball must hit the wall before it comes to rest.": {GOAL, HIT},
    "The verdict is rejected: CheckPenetration fails.": {REPAIR},
    # what a plan speaks of
    "tank fluid box water wood glass floats settles A box floats in a tank": {FLOAT, FLUID},
    "ground box sphere wood iron collides_with topples stays_on": {STACK, HIT},
    "ground box hinge revolute aluminium swings": {SWING, JOINT},
    "ground box slider prismatic drive velocity steel moves": {JOINT},
    "tank fluid fills stays_inside water pour": {FLUID},
    "ground box sphere ramp rolls_down slides": {RIGID},
}


@pytest.mark.parametrize(("words", "wanted"), CASES.items(), ids=CASES)
def test_what_is_needed_is_among_three(words: str, wanted: set[str]) -> None:
    picked = pick(words)
    assert len(picked) <= 3
    assert wanted <= {each.skill.name for each in picked}, [(each.skill.name, each.words) for each in picked]


def test_they_are_ranked_and_say_why() -> None:
    picked = pick("A cork ball floats in a tank of water.", limit=15)
    assert [each.score for each in picked] == sorted((each.score for each in picked), reverse=True)
    assert picked[0].skill.name == FLOAT
    assert set(picked[0].words) == {"cork", "floats", "tank", "water"} and picked[0].words[0] in ("cork", "floats")
    assert pick("A cork ball floats in a tank of water.", limit=15) == picked
    assert pick("A cork ball floats in a tank of water.", limit=2) == picked[:2]


@pytest.mark.parametrize("words", ["", "the and of it", "xylophone quasar", "12 34", "Größe Δx"])
def test_nothing_is_picked_for_nothing(words: str) -> None:
    assert pick(words) == []


@pytest.mark.parametrize(
    ("words", "name"),
    [
        ("tsunami", WAVES),  # of one meaning with a word that it has
        ("pendullum", SWING),  # a slip
        ("color of the sunlight", CAMERA),  # American
        ("jittering", STEP),
    ],
)
def test_other_words_for_it(words: str, name: str) -> None:
    assert name in [each.skill.name for each in pick(words)]


def test_saying_a_word_again_changes_nothing() -> None:
    assert pick("pendulum swinging pendulums swing")[0].score == pick("pendulum swing")[0].score


def test_what_a_skill_is_not_for_does_not_pick_it() -> None:
    assert FLOAT not in [each.skill.name for each in pick("rain over a river")]


def test_a_limit_below_one_is_refused() -> None:
    with pytest.raises(ValueError, match="limit = 0"):
        pick("water", limit=0)


def test_the_package_is_light() -> None:
    code = "import sys, wsim.skills; wsim.skills.pick('water'); print(*sys.modules)"
    loaded = subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True).stdout.split()
    assert "wsim.skills.retrieval" in loaded
    assert not {"numpy", "scipy", "pxr", "pydantic", "newton", "warp"} & {module.split(".")[0] for module in loaded}


def test_it_finds_a_wheels_folder_first(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    import wsim.skills.library as library

    monkeypatch.setattr(library, "_SHIPPED", tmp_path)
    assert library.skills_folder() == tmp_path
    monkeypatch.setattr(library, "_SHIPPED", tmp_path / "none")
    assert library.skills_folder().name == "skills"
    monkeypatch.setattr(library, "_SOURCE", tmp_path / "none")
    with pytest.raises(library.SkillError, match="install wsim again"):
        library.skills_folder()
