"""Where candidates lie in the space of their parameters."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.stats import qmc

from wsim.errors import UserError
from wsim.sweep.axis import Axis, walked_together
from wsim.sweep.sampling import read_points, sample

LENGTH = Axis(name="length", low=0.5, high=2.0)
STIFFNESS = Axis(name="stiffness", low=1.0, high=1000.0, scale="log")
COUNT = Axis(name="count", low=1.0, high=5.0, values=(1.0, 2.0, 5.0))


@pytest.mark.parametrize("method", ["sobol", "latin", "random", "grid"])
@given(count=st.integers(1, 70), seed=st.integers(0, 5))
def test_points_stay_in_their_ranges_and_come_again(method, count: int, seed: int) -> None:
    points = sample([LENGTH, STIFFNESS, COUNT], method, count, seed)
    assert points == sample([LENGTH, STIFFNESS, COUNT], method, count, seed)
    assert len(points) == count or method == "grid"
    for point in points:
        assert LENGTH.low <= point["length"] <= LENGTH.high
        assert 1.0 <= point["stiffness"] <= 1000.0 * (1 + 1e-12)
        assert point["count"] in COUNT.values


def test_sobol_and_latin_fill_the_space_more_evenly_than_random_points_do() -> None:
    plane = [Axis(name="x", low=0.0, high=1.0), Axis(name="y", low=0.0, high=1.0)]

    def unevenness(method) -> float:
        return qmc.discrepancy(np.array([[p["x"], p["y"]] for p in sample(plane, method, 128)]))

    assert unevenness("sobol") < unevenness("latin") < unevenness("random")


def test_a_latin_hypercube_has_one_point_in_each_slice() -> None:
    shares = np.sort([(p["length"] - 0.5) / 1.5 for p in sample([LENGTH, STIFFNESS], "latin", 20)])
    assert (np.floor(20 * shares) == np.arange(20)).all()


def test_a_grid_is_the_product_of_its_axes_from_end_to_end() -> None:
    points = sample([LENGTH, STIFFNESS], "grid", 16)
    assert len(points) == 16
    assert sorted({p["length"] for p in points}) == pytest.approx([0.5, 1.0, 1.5, 2.0])
    assert sorted({p["stiffness"] for p in points}) == pytest.approx([1.0, 10.0, 100.0, 1000.0])
    assert len(sample([LENGTH, COUNT], "grid", 6)) == 6
    assert len(sample([LENGTH, STIFFNESS, Axis(name="z", low=0, high=1)], "grid", 27)) == 27


@pytest.mark.parametrize(
    ("text", "axis"),
    [
        ("length=0.5:2", LENGTH),
        ("stiffness=log:1:1e3", STIFFNESS),
        ("count=1,2,5", COUNT),
        ("mass=3", Axis(name="mass", low=3, high=3, values=(3.0,))),
    ],
)
def test_what_is_varied_is_said_in_a_word(text: str, axis: Axis) -> None:
    assert Axis.parse(text) == axis


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("length=2:0.5", "low 2 is not below high 0.5"),
        ("length=log:0:3", "low 0 has no logarithm"),
        ("length", "expected NAME=LOW:HIGH"),
        ("length=1:2:3", "expected NAME=LOW:HIGH"),
        ("length=nan:1", "expected NAME=LOW:HIGH"),
        ("length=1,,2", "expected NAME=LOW:HIGH"),
        ("a b=1:2", "expected NAME=LOW:HIGH"),
    ],
)
def test_what_is_no_range_is_refused_in_a_line(text: str, said: str) -> None:
    with pytest.raises(UserError, match=f"--vary {text}: .*{said}"):
        Axis.parse(text)


def test_points_come_from_a_file(tmp_path: Path) -> None:
    file = tmp_path / "points.csv"
    file.write_text("density, level\n300,0.4\n\n600,5e-1\n", encoding="utf-8-sig")
    assert read_points(file) == [{"density": 300.0, "level": 0.4}, {"density": 600.0, "level": 0.5}]


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("density\n", "no candidates"),
        ("density,density\n1,2\n", "twice"),
        ("density,level\n1\n", "line 2: 1 numbers for 2 names"),
        ("density\n600\nnan\n", "line 3: density is 'nan'"),
        ("density\nmuch\n", "density is 'much'"),
    ],
)
def test_a_file_that_holds_no_points_is_refused(tmp_path: Path, text: str, said: str) -> None:
    (tmp_path / "points.csv").write_text(text)
    with pytest.raises(UserError, match=said):
        read_points(tmp_path / "points.csv")


def test_what_is_zipped_is_walked_together_and_crossed_with_the_rest() -> None:
    size = Axis(name="size", low=1.0, high=3.0, values=(1.0, 2.0, 3.0))
    axes = walked_together([COUNT, LENGTH, size, STIFFNESS], ["count,size,length"])
    assert [axis.label for axis in axes] == ["count & size & length", "stiffness"]
    points = sample(axes, "grid", 12)
    walked = [(1.0, 1.0, 0.5), (2.0, 2.0, 1.25), (5.0, 3.0, 2.0)]  # a range has as many values as the list
    assert [(p["count"], p["size"], p["length"]) for p in points[::4]] == walked
    assert len(points) == 12 and len({p["stiffness"] for p in points}) == 4


@pytest.mark.parametrize("method", ["sobol", "latin", "random", "grid", "saltelli"])
def test_ranges_that_are_zipped_are_at_one_share_of_each(method) -> None:
    axes = walked_together([LENGTH, STIFFNESS], ["stiffness,length"])
    for point in sample(axes, method, 24):
        assert math.log(point["stiffness"]) / math.log(1000.0) == pytest.approx((point["length"] - 0.5) / 1.5)


@pytest.mark.parametrize(
    ("groups", "said"),
    [
        (["length"], "--zip length: expected two parameters or more"),
        (["length,length"], "--zip length,length: expected two parameters or more"),
        (["length,width"], "--zip length,width: 'width' is not varied; what is: length, stiffness, count, pair"),
        (["count,pair"], "lists are walked value by value, and count has 3, pair has 2; give each as many"),
        (["length,count", "count,stiffness"], "--zip count,stiffness: count goes with others already"),
        (["length,count", "length,stiffness"], "--zip length,stiffness: length goes with others already"),
    ],
)
def test_what_cannot_be_walked_together_is_said_in_a_line(groups: list[str], said: str) -> None:
    pair = Axis(name="pair", low=1.0, high=2.0, values=(1.0, 2.0))
    with pytest.raises(UserError) as told:
        walked_together([LENGTH, STIFFNESS, COUNT, pair], groups)
    assert said in str(told.value)
