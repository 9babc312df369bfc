"""What touches though the simulator looks for no contact between it and the other."""

from dataclasses import replace

import numpy as np
import pytest

from tests.judge.theory import RADIUS, ball, record, times, with_world
from wsim.judge.language import Signals, evaluate, parse
from wsim.recording.contacts import ContactTrack
from wsim.scene.world import Gear, Joint

NONE = ContactTrack(np.zeros(0, np.int32), np.zeros((0, 2), np.int32), np.zeros((0, 16), np.float32))


def axle(name):
    return Joint(prim=f"/World/axle_{name}", kind="revolute", axis="Y", parent=None, child=f"/World/{name}")


MESH = Gear(prim="/World/mesh", first="/World/axle_a", second="/World/axle_b", ratio=-1.0)
SPARED = {
    "objects": {"apart": [("/World/b", "/World/a")]},
    "shapes": {"apart": [("/World/a/g", "/World/b/g")]},
    "a shape and an object": {"apart": [("/World/b/g", "/World/a")]},
    "a gear": {"joints": [axle("a"), axle("b")], "gears": [MESH]},
}
ASKED = {"axles": {"joints": [axle("a"), axle("b")]}, "others": {"apart": [("/World/a", "/World/c")]}}


@pytest.mark.parametrize(("fields", "reach"), [(each, True) for each in SPARED] + [(each, False) for each in ASKED])
def test_what_is_spared_touches_where_it_is_as_near_as_what_touches(fields, reach):
    """Two balls 1 mm apart, half of a hundredth of their size, where contacts are recorded and they have none."""
    time = times(1.0)
    place = np.tile([[0.0, 0.0, 1.0], [2.0 * RADIUS + 1e-3, 0.0, 1.0]], (len(time), 1, 1))
    near = with_world(record([ball("a"), ball("b")], place, 0.0 * place, time), **(SPARED | ASKED)[fields])
    signals = Signals.of_recording(replace(near, contacts=NONE))
    assert evaluate(parse("touches(a, b)"), signals).satisfied[0] == reach
    assert evaluate(parse("touches(b, a)"), signals).satisfied[0] == reach
