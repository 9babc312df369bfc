"""The Unitree Go2 of its wheel, for tests of what walks."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from wsim.assets import AssetError
from wsim.assets.folders import VARIABLE
from wsim.intake.pull import pull
from wsim.intake.robots import TakenIn


@pytest.fixture(scope="module")
def go2(tmp_path_factory: pytest.TempPathFactory) -> Iterator[TakenIn]:
    """The real one, in folders of its own; skipped where no registry is reached."""
    folder = tmp_path_factory.mktemp("go2")
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv(VARIABLE, str(folder / "own"))
        patch.setenv("XDG_CACHE_HOME", str(folder / "cache"))
        try:
            yield pull("go2")
        except AssetError as error:
            if "could not be fetched" in str(error) or "did not come" in str(error):
                pytest.skip(f"no registry: {error}")
            raise
