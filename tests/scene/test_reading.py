"""A reading is the same to the last bit when it has been sent as JSON."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

from wsim.scene import Scene
from wsim.scene.describe import describe
from wsim.scene.reading import Reading, read
from wsim.scene.skeleton import skeleton


def test_it_comes_back_as_it_was(tmp_path: Path, workshop: Scene) -> None:
    path = workshop.save(tmp_path / "stage.usda")
    told = read(path)
    assert (told.world, told.skeleton) == (describe(path), skeleton(path))
    back = Reading.model_validate_json(told.to_json())
    assert repr(back) == repr(told)  # tells -0 from 0


def test_what_json_has_no_word_for_is_not_sent(tmp_path: Path, workshop: Scene) -> None:
    told = read(workshop.save(tmp_path / "stage.usda"))
    endless = told.world.model_copy(update={"time_step": math.inf})
    with pytest.raises(ValueError, match="JSON"):
        Reading.model_construct(world=endless, skeleton="").to_json()
