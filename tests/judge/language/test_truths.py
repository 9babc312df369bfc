"""Each predicate holds a few percent to one side of the truth and fails to the other, however the motion was seen."""

import itertools

import numpy as np
import pytest

from tests.judge.language.drawn import MOTIONS, vessel
from wsim.judge.evidence.evidence import Evidence
from wsim.judge.language import Signals, evaluate, parse

RATES = (24.0, 30.0, 60.0)


@pytest.mark.parametrize("seed", range(2))
@pytest.mark.parametrize("motion", MOTIONS, ids=lambda motion: motion.__name__)
def test_what_is_true_holds_and_what_is_off_fails(motion, seed):
    drawn, wrong = motion(np.random.default_rng(seed)), []
    for (rate, own), contacts in zip(
        itertools.product(RATES, (True, False)), itertools.cycle((False, True, True, False))
    ):
        signals = drawn.seen(rate, own, contacts)
        for said, holds in drawn.claims:
            if "energy" in said and not own:
                continue  # of velocities that are known no better than frames follow one another
            found = evaluate(parse(said), signals)
            if found.satisfied[0] != holds or (found.margin[0] >= 0.0) != holds:
                wrong.append((rate, own, contacts, said, holds, float(found.margin[0]), found.units[0]))
    assert wrong == []


@pytest.mark.parametrize("seed", range(3))
def test_what_is_true_of_a_fluid_holds_and_what_is_off_fails(seed):
    recording, claims = vessel(np.random.default_rng(seed))
    signals = Signals.of(Evidence(recording))
    assert [said for said, holds in claims if evaluate(parse(said), signals).satisfied[0] != holds] == []
