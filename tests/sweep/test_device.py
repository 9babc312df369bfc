"""Which device a sweep takes where none is named: by cases on both sides of where a GPU is worth its start."""

from __future__ import annotations

import runpy
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from wsim.cli import app
from wsim.scene import Scene
from wsim.scene.describe import describe
from wsim.scene.world import World
from wsim.sim.devices import cuda_devices
from wsim.sweep.device import choose
from wsim.sweep.folder import SweepFolder

WOOD = Path(__file__).parents[2] / "examples" / "wood_afloat.py"


def ball(scene: Scene) -> None:
    scene.simulation(duration=2.0)
    scene.ground()
    scene.sphere("ball", radius=scene.param("radius", 0.1, low=0.05, high=0.2), position=(0, 0, 1), density=500.0)


def stack(scene: Scene) -> None:
    scene.simulation(duration=10.0)
    scene.ground()
    for k in range(20):
        scene.box(f"box_{k}", size=(0.2, 0.2, 0.2), position=(0, 0, 0.1 + 0.2 * k), density=500.0)


BUILDS = {"ball": ball, "stack": stack, "wood": runpy.run_path(str(WOOD))["build"]}


@pytest.fixture
def world(tmp_path: Path) -> Callable[[str], World]:
    def one(name: str) -> World:
        scene = Scene()
        BUILDS[name](scene)
        return describe(scene.save(tmp_path / "stage.usda"))

    return one


@pytest.mark.parametrize(
    ("name", "count", "cores", "device"),
    [
        ("ball", 8, 2, "cpu"),
        ("ball", 64, 16, "cpu"),
        ("ball", 4096, 2, "cuda:0"),
        ("stack", 1, 2, "cpu"),
        ("stack", 64, 2, "cuda:0"),
        ("wood", 4, 16, "cpu"),
        ("wood", 1024, 16, "cuda:0"),
    ],
)
def test_many_go_to_the_gpu_and_few_do_not(
    world: Callable[[str], World], name: str, count: int, cores: int, device: str
) -> None:
    taken, why = choose("cuda:0", world(name), count, 1024, cores)
    other = f"{cores} CPU cores" if device == "cuda:0" else "cuda:0"
    assert taken == device
    assert why.startswith(f"{device}: {count:,} candidates take about ") and why.endswith(f" s on {other}")
    best, second = (float(part.split()[-1].replace(",", "")) for part in why.split(" s ")[:2])
    assert best <= second


@pytest.mark.parametrize("name", BUILDS)
def test_once_a_gpu_is_worth_its_start_more_candidates_are_too(world: Callable[[str], World], name: str) -> None:
    """In multiples of the cores, so that no core waits; each more costs a core more than it costs a GPU."""
    made, draw = world(name), np.random.default_rng(0)
    for cores in map(int, draw.integers(1, 64, 8)):
        taken = [choose("cuda:0", made, cores * 2**k, 1024, cores)[0] for k in range(14)]
        first = taken.index("cuda:0")
        assert first > 0 and set(taken[:first]) == {"cpu"} and set(taken[first:]) == {"cuda:0"}


def test_a_sweep_that_names_no_device_keeps_the_one_it_took(tmp_path: Path) -> None:
    if cuda_devices():
        pytest.skip("what is taken here hangs on the GPU's start")
    (tmp_path / "ball.py").write_text(
        "def build(scene):\n    scene.simulation(duration=0.1)\n    scene.ground()\n    "
        "scene.sphere('ball', radius=scene.param('r', 0.1, low=0.05, high=0.2), position=(0, 0, 1), density=500.0)\n"
    )
    asked = ["sweep", str(tmp_path / "ball.py"), "--samples", "1", "--no-full", "--runs", str(tmp_path / "runs")]
    for k, device in enumerate(["auto", None], start=1):
        ended = CliRunner().invoke(app, [*asked, *(["--device", device] if device else [])])
        assert ended.exit_code == 0
        folders = sorted((tmp_path / "runs").iterdir())
        assert len(folders) == k
        assert {SweepFolder(path).spec.device for path in folders} == {"cpu"}
