"""The scratch scene knows every call of `Scene`: one that it does not know is never tried, so its mistakes pass."""

import inspect

import pytest

from wsim.program.validator.scratch import _NEEDS, BODIES, CORDS, OBJECTS, OPENINGS, SENSORS
from wsim.scene import Scene, SceneError

CALLS = {
    name: set(inspect.signature(call).parameters)
    for name, call in inspect.getmembers(Scene, inspect.isfunction)
    if not name.startswith("_")
}
SOLIDS = {name for name, takes in CALLS.items() if {"position", "rotation_deg", "static"} <= takes}
FROM_FILES = {"mesh", "asset"}  # how the scratch scene tries these is written out in it


def test_each_call_that_makes_a_body_is_known():
    assert {"box", "mesh", "asset"} <= SOLIDS
    missing = sorted(SOLIDS - {*BODIES})
    assert not missing, f"name {missing} in BODIES of program/validator/scratch.py"


def test_of_each_call_it_is_known_what_it_needs():
    missing = sorted({*CALLS} - {*_NEEDS} - {"mesh", "save"})
    assert not missing, f"say in _NEEDS of program/validator/scratch.py what a good call of {missing} has"
    made = {name for name, takes in CALLS.items() if "name" in takes and not name.startswith("joint_")}
    missing = sorted(
        made
        - {*OBJECTS, *CORDS, *SENSORS, *OPENINGS, "gear", "policy", "schedule", "camera", "light", "material", "param"}
    )
    assert not missing, f"name {missing} in OBJECTS of program/validator/scratch.py, or beside them in its `call`"


@pytest.mark.parametrize("kind", sorted(SOLIDS - FROM_FILES))
def test_what_it_needs_is_good_and_enough(kind):
    getattr(Scene(), kind)(name="a", **_NEEDS[kind])
    for field in _NEEDS[kind]:
        with pytest.raises(TypeError):
            getattr(Scene(), kind)(name="a", **{k: v for k, v in _NEEDS[kind].items() if k != field})
        bad = tuple(-1.0 for _ in _NEEDS[kind][field]) if isinstance(_NEEDS[kind][field], tuple) else -1.0
        with pytest.raises(SceneError, match=field):
            getattr(Scene(), kind)(name="a", **{**_NEEDS[kind], field: bad})
