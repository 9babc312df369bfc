"""The robots that wsim ships are what is written of their models."""

from __future__ import annotations

import runpy
from pathlib import Path

from pxr import Sdf

from wsim.assets import assets_folder
from wsim.assets.robots import robots

HERE = assets_folder() / "robots"


def test_each_layer_is_what_its_model_makes(tmp_path: Path) -> None:
    made = runpy.run_path(str(HERE / "make.py"))["make"](tmp_path)
    assert {path.stem: HERE / path.name for path in made} == {id: robots()[id] for id in ("desk_arm",)}
    for path in made:
        kept, anew = (Sdf.Layer.FindOrOpen(str(each)) for each in (HERE / path.name, path))
        assert anew.ExportToString() == kept.ExportToString(), f"run {HERE / 'make.py'}"
