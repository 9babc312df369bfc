"""A builder made of another world's numbers is that world's own, to the last bit."""

from __future__ import annotations

import pickle
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any

import newton
import numpy as np
import pytest

from tests.sim.test_batch import Build, carried, held, loose
from wsim.scene import Scene
from wsim.scene.describe import describe
from wsim.scene.world import World
from wsim.sim import model
from wsim.sim.fluids import sph_config
from wsim.sim.model import build_batch
from wsim.sim.numbers import OtherThanNumbersError, differences, texts, with_numbers


def _stages(folder: Path, build: Build, count: int) -> list[Path]:
    stages = []
    for k in range(count):
        scene = Scene()
        build(scene, np.random.default_rng(k))
        stages.append(folder / f"{k}.usda")
        scene.save(stages[-1])
    return stages


@pytest.mark.parametrize("build", [loose, carried, held])
def test_a_batch_of_sent_numbers_is_the_batch(tmp_path: Path, build: Build, monkeypatch: pytest.MonkeyPatch) -> None:
    stages = _stages(tmp_path, build, 4)
    worlds = [describe(stage) for stage in stages]
    monkeypatch.setattr(model, "_stated", _nothing_stated)  # which needs no import
    made = _added(stages, worlds)
    assert _arrays(build_batch(stages, worlds, "cpu").model) == _arrays(made)
    sent = []

    def as_sent(call: Callable[[int], Any], items: Sequence[int], processes: int) -> Iterator[Any]:
        assert processes == 2
        for item in items:
            sent.append(pickle.dumps(call(item)))
            yield pickle.loads(sent[-1])

    monkeypatch.setattr(model, "forks", lambda processes: processes)
    monkeypatch.setattr(model, "shared_out", as_sent)
    again = build_batch(stages, worlds, "cpu", processes=2)
    assert [pickle.loads(each) is not None for each in sent] == [True] * 3
    assert _arrays(again.model) == _arrays(made)
    assert again.worlds == tuple(worlds)
    assert again.breakable == [model._import(*each, None).breakable for each in zip(stages, worlds, strict=True)]


def _nothing_stated(*given: Any) -> Any:
    raise model._UnstatedError("this is of what is not")


def _added(stages: Sequence[Path], worlds: Sequence[World]) -> newton.Model:
    """Each world by Newton's own importer, and added by itself."""
    builder = model._builder(worlds[0])
    for one in [model._import(stage, world, sph_config(worlds)) for stage, world in zip(stages, worlds, strict=True)]:
        builder.add_world(one.builder)
    return builder.finalize(device="cpu")


def test_what_is_no_number_is_refused() -> None:
    one, other = newton.ModelBuilder(), newton.ModelBuilder()
    for builder, boxes in ((one, 1), (other, 2)):
        for k in range(boxes):
            builder.add_shape_box(builder.add_body(label=f"b{k}"), hx=0.1, hy=0.1, hz=0.1)
    with pytest.raises(OtherThanNumbersError):
        differences(other, one, texts(one))
    assert differences(one, one, texts(one)) == {}


def test_signs_of_zero_and_nan_are_kept() -> None:
    one, other = newton.ModelBuilder(), newton.ModelBuilder()
    one.body_mass, other.body_mass = [0.0, 1.0, float("nan")], [-0.0, 1.0, float("nan")]
    assert list(differences(other, one, texts(one))) == ["body_mass"]
    assert repr(with_numbers(one, differences(other, one, texts(one))).body_mass) == "[-0.0, 1.0, nan]"
    assert repr(one.body_mass) == "[0.0, 1.0, nan]"


def _arrays(made: newton.Model) -> dict[str, bytes]:
    """All that a model has in arrays, MuJoCo's own, too."""
    found = {}
    for space, holder in (("", made), ("mujoco:", made.mujoco)):
        for name, value in vars(holder).items():
            if hasattr(value, "numpy") and "bvh" not in name:  # Newton's trees have room that nobody has written to
                found[space + name] = value.numpy().tobytes()
    assert len(found) > 60
    return found
