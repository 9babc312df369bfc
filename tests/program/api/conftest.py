from __future__ import annotations

import pytest

from wsim.program.api import Index, index


@pytest.fixture(scope="session")
def api() -> Index:
    return index()
