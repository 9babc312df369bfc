"""Tests marked `cuda` are skipped where there is no CUDA device."""

import pytest

from tests.agents.scripted import own_cache, server

__all__ = ["own_cache", "server"]


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    marked = [item for item in items if item.get_closest_marker("cuda")]
    if not marked:
        return
    import warp as wp

    if not wp.is_cuda_available():
        for item in marked:
            item.add_marker(pytest.mark.skip(reason="needs a CUDA device"))
