"""What is under water stays there by its weight, or because something holds it."""

import numpy as np
import pytest

from wsim.judge.evidence.evidence import Evidence
from wsim.judge.language import ObjectiveCheck, Signals, evaluate, parse
from wsim.plan.schema import Objective
from wsim.scene.world import Joint

BLOCK_PRIM, G, WALL, HEIGHT = "/World/wooden_block", 9.81, 0.02, 0.14
WEIGHT = 600.0 * 0.2 * 0.2 * HEIGHT * G
LIFT = 400.0 * 0.2 * 0.2 * HEIGHT * G  # of 1000 kg/m^3, less its own 600


def lies(pool, pressed=0.0, density=600.0):
    """The block lies still on the tank's floor all the time, pressed down by contacts with so many newtons."""
    case = pool(density=density)
    block = next(k for k, b in enumerate(case.recording.world.bodies) if b.prim == BLOCK_PRIM)
    case = case.edit("body_q", (slice(None), block, 2), WALL + HEIGHT / 2).edit("body_qd", (slice(None), block), 0.0)
    return case.edit("contact_force", (slice(None), block, 2), -pressed)


def submerged(case):
    evidence = Evidence(case.recording, case.plan)
    return ObjectiveCheck(Objective(kind="submerged", object="wooden_block", ref="water")).run(evidence)


def test_wood_on_the_floor_of_a_tank_lacks_its_lift(pool):
    (lift,) = submerged(lies(pool))
    assert not lift.passed and lift.unit == "N" and lift.value == pytest.approx(LIFT, rel=1e-3)
    for text in ("submerged(wooden_block, water)", "sinks(wooden_block, water)"):
        found = evaluate(parse(text), Signals.of_recording(lies(pool).recording))
        assert not found.satisfied[0] and found.units == ["N"]
        assert found.margin[0] == pytest.approx(0.25 * WEIGHT - LIFT, rel=1e-3)


def test_what_is_pressed_or_tied_down_or_heavy_lies_there(pool):
    assert all(finding.passed for finding in submerged(lies(pool, pressed=LIFT)))
    tied = lies(pool).world(joints=[Joint(prim="/World/tie", kind="spherical", parent=None, child=BLOCK_PRIM)])
    assert [finding.passed for finding in submerged(tied)] == [True]
    assert [finding.passed for finding in submerged(lies(pool, density=2000.0))] == [True]
    assert np.isclose(LIFT / WEIGHT, 2.0 / 3.0)
