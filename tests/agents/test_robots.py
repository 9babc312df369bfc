"""What a planning model is told of a robot that the prompt names."""

import pytest

from wsim.agents.robots import robots_for
from wsim.scene import Scene
from wsim.scene.errors import SceneError


def test_a_named_arm_says_what_can_be_scheduled_and_where_its_fingers_are() -> None:
    told = robots_for("A desk arm picks up a cube.")
    assert "left_finger (0 to 0.035 m)" in told
    assert "right_finger (follows left_finger, and takes no schedule)" in told
    assert "fingers in the frame of hand at the start: left_finger x" in told


def test_a_robot_that_is_not_named_is_told_in_a_line() -> None:
    assert "right_finger" not in robots_for("A ball rolls down a ramp.")


def test_what_follows_is_not_led_and_it_is_said_who_leads() -> None:
    arm = Scene().robot("arm", "desk_arm")
    with pytest.raises(SceneError, match="right_finger: it follows left_finger, whose servo moves both; leave it out"):
        arm.drive("right_finger", times=[0.0, 1.0], positions=[0.0, 0.03])
