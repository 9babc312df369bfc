from __future__ import annotations

import pytest

from wsim.program.sandbox import available


@pytest.fixture(params=["bubblewrap", "landlock"])
def isolation(request: pytest.FixtureRequest) -> str:
    problem = available()[request.param]
    if problem:
        pytest.skip(f"{request.param}: {problem}")
    return request.param
