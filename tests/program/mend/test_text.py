"""Edits of a program's text touch what they are to touch, and nothing else."""

from __future__ import annotations

import ast

import pytest
from hypothesis import given
from hypothesis import strategies as st

from wsim.program.mend.text import NotMendedError, Source, keyword

PROGRAM = '''\
"""Zwei Körper."""
from wsim.scene import Scene


def build(scene: Scene) -> None:
    # Assumed: it is of oak.
    oak = scene.material("oak", density=700.0)  # dry
    scene.box("crate", size=(1, 1, 1), material=oak)  # the crate
    scene.sphere(
        "ball",
        radius=0.1,  # a hand's
        position=(0.0, 0.0, 2.0),
    )
    scene.simulation()
'''


def test_a_keyword_is_changed_where_it_stands() -> None:
    source = Source(PROGRAM)
    source.put(source.call("ball"), "radius", 0.25)
    assert source.text == PROGRAM.replace("radius=0.1,", "radius=0.25,")


@pytest.mark.parametrize(
    ("name", "value", "before", "after"),
    [
        ("crate", 400, "material=oak)", "material=oak, density=400.0)"),
        ("ball", (1.0, 0, 0), "2.0),\n    )", "2.0),\n        density=(1.0, 0.0, 0.0),\n    )"),
    ],
)
def test_a_keyword_is_added_as_a_person_would(name: str, value: object, before: str, after: str) -> None:
    source = Source(PROGRAM)
    source.put(source.call(name), "density", value)
    assert source.text == PROGRAM.replace(before, after)


def test_a_call_without_arguments_gets_its_first() -> None:
    source = Source(PROGRAM)
    (run,) = (call for call in source.calls() if source.said(call) == "scene.simulation()")
    source.put(run, "duration", 3)
    assert "scene.simulation(duration=3.0)\n" in source.text


def test_keywords_and_statements_are_left_out() -> None:
    source = Source(PROGRAM)
    assert source.drop(source.call("ball"), "position")
    assert not source.drop(source.call("ball"), "mass")
    source.remove(source.build.body[1])
    assert source.text == PROGRAM.replace(",  # a hand's\n        position=(0.0, 0.0, 2.0)", "").replace(
        '    scene.box("crate", size=(1, 1, 1), material=oak)  # the crate\n', ""
    )
    ast.parse(source.text)


def test_statements_are_put_before_others() -> None:
    source = Source(PROGRAM)
    source.insert(source.build.body[-1], 'scene.light("sun")\nscene.ground()')
    assert '    )\n    scene.light("sun")\n    scene.ground()\n    scene.simulation()\n' in source.text


def test_what_is_not_there_is_said() -> None:
    with pytest.raises(NotMendedError, match="'lamp'"):
        Source(PROGRAM).call("lamp")
    with pytest.raises(NotMendedError, match="no build"):
        Source("x = 1\n")


@given(st.lists(st.sampled_from(["size", "mass", "density", "radius", "position", "friction"]), max_size=6),
       st.floats(-1e4, 1e4))  # fmt: skip
def test_any_keywords_in_any_order_are_what_was_put(names: list[str], value: float) -> None:
    text = PROGRAM
    for name in names:
        for thing in ("crate", "ball"):
            source = Source(text)
            source.put(source.call(thing), name, value)
            text = source.text
    for thing in ("crate", "ball"):
        for name in set(names):
            held = keyword(Source(text).call(thing), name)
            assert held is not None
            assert ast.literal_eval(held) == pytest.approx(value, abs=1e-6, rel=1e-3)
    assert text.count("#") == PROGRAM.count("#")
