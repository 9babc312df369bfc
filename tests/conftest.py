"""Tests marked `cuda` are skipped where there is no CUDA device, and none hangs on the clock."""

import pytest
from hypothesis import HealthCheck, settings

from tests.agents.scripted import own_cache, server

__all__ = ["own_cache", "server"]

# How long an example takes is the machine's affair.
settings.register_profile("any_machine", deadline=None, suppress_health_check=[HealthCheck.too_slow])
settings.load_profile("any_machine")


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    marked = [item for item in items if item.get_closest_marker("cuda")]
    if not marked:
        return
    import warp as wp

    if not wp.is_cuda_available():
        for item in marked:
            item.add_marker(pytest.mark.skip(reason="needs a CUDA device"))
