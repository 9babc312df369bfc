"""What fills the cache of kernels is worlds that simulate."""

import pytest

from wsim import sim
from wsim.errors import UserError


def test_all_worlds_are_gone_through():
    told = {}
    folder = sim.fill_cache("cpu", lambda stage, done, total: told.update({stage: (done, total)}))
    assert folder.is_dir()
    assert told["kernels"] == (3, 3)
    assert {name.split(":")[0] for name in told} == {"kernels", "bodies in water", "bodies", "a batch of bodies"}
    assert all(done == total for done, total in told.values())


def test_a_device_that_is_not_here_is_refused():
    with pytest.raises(UserError, match="cuda:99"):
        sim.fill_cache("cuda:99")
