"""Each second is counted in one phase."""

import time

import pytest

from wsim.phases import Phases, since_start


def test_a_phase_inside_another_is_counted_once():
    phases = Phases()
    began = time.perf_counter()
    with phases.phase("outer"):
        time.sleep(0.02)
        with phases.phase("inner"):
            time.sleep(0.05)
        with pytest.raises(ValueError), phases.phase("inner"):
            time.sleep(0.01)
            raise ValueError
        time.sleep(0.02)
    whole = time.perf_counter() - began
    assert list(phases.seconds) == ["outer", "inner"]
    assert sum(phases.seconds.values()) == pytest.approx(whole, abs=1e-3)
    assert phases.seconds["inner"] >= 0.06
    assert phases.seconds["outer"] >= 0.04
    assert phases.rounded() == {name: round(seconds, 3) for name, seconds in phases.seconds.items()}


def test_a_process_knows_how_long_it_is_there():
    before = since_start()
    if before is None:
        pytest.skip("this system does not say")
    time.sleep(0.1)
    after = since_start()
    assert after is not None
    assert after - before == pytest.approx(0.1, abs=0.05)
