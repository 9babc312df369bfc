"""Two runs that the tools work on: rigid bodies for a second, and a coarse tank for a third of one."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from wsim.runs.folder import RunFolder
from wsim.runs.settings import Settings
from wsim.tools import TOOLS, Result, Workspace
from wsim.tools.text import LIMIT

Call = Callable[..., Result]
RIGID = '''\
"""A ball falls, a block stands, an arm on a hinge is let go level."""

from wsim.scene import Scene


def build(scene: Scene) -> None:
    scene.simulation(duration=1.0, frame_rate=20.0)
    scene.ground()
    scene.sphere("ball", radius=0.1, density=1000.0, position=(1.0, 0.0, 9.0), velocity=(0.5, 0.0, 0.0))
    scene.box("block", size=(0.2, 0.2, 0.2), density=600.0, position=(0.0, 0.0, 0.1))
    arm = scene.box("arm", size=(0.5, 0.04, 0.04), density=600.0, position=(-0.75, 0.0, 1.0))
    scene.joint_revolute("hinge", None, arm, anchor=(-1.0, 0.0, 1.0), axis="Y")
    scene.camera("side", eye=(0.0, -4.0, 1.0), target=(0.0, 0.0, 0.7), width=320, height=180)
    scene.camera("wide", eye=(0.0, -16.0, 5.0), target=(0.0, 0.0, 4.5), width=320, height=180)
'''
TANK = '''\
"""A block is let go over a tank."""

from wsim.scene import Scene


def build(scene: Scene) -> None:
    scene.simulation(duration=0.3, frame_rate=20.0)
    tank = scene.tank("tank", inner_size=(0.4, 0.4, 0.4))
    water = scene.fluid("water", fills=tank, level=0.2, spacing=0.05)
    scene.box("block", size=(0.2, 0.2, 0.14), density=600.0, position=(0.0, 0.0, water.surface + 0.08))
    scene.camera("side", eye=(0.0, -1.5, 0.6), target=(0.0, 0.0, 0.2), width=320, height=180)
    scene.camera("top", eye=(0.0, 0.0, 2.0), target=(0.0, 0.0, 0.2), width=320, height=180)
'''


def workspace_in(folder: Path) -> Workspace:
    (folder / "iterations").mkdir(parents=True)
    return Workspace(RunFolder(folder), Settings(device="cpu"))


def call_tool(workspace: Workspace, name: str, /, **arguments: Any) -> Result:
    """Call a tool; whatever it answers is short, and the same on any machine."""
    result = TOOLS[name](workspace, **arguments)
    assert 0 < len(result.text) <= LIMIT
    for folder in (workspace.run.path, Path.cwd(), Path.home()):
        assert f"{folder}/" not in result.text
    assert "Traceback" not in result.text
    return result


def done(workspace: Workspace, name: str, /, **arguments: Any) -> str:
    """What a tool answers that does what it is asked."""
    result = call_tool(workspace, name, **arguments)
    assert result.ok, result.text
    return result.text


def refused(workspace: Workspace, name: str, /, **arguments: Any) -> str:
    """What a tool answers that says no."""
    result = call_tool(workspace, name, **arguments)
    assert not result.ok, result.text
    return result.text


@pytest.fixture
def empty(tmp_path: Path) -> Workspace:
    """A run in which nothing is yet."""
    return workspace_in(tmp_path / "runs" / "empty")


@pytest.fixture(scope="session")
def rigid(tmp_path_factory: pytest.TempPathFactory) -> Workspace:
    """A run of rigid bodies; nothing may write to it but stills."""
    workspace = workspace_in(tmp_path_factory.mktemp("rigid") / "runs" / "rigid")
    done(workspace, "write_program", text=RIGID)
    assert "accepted" in done(workspace, "run_program", passes="physics")
    return workspace


@pytest.fixture(scope="session")
def tank(tmp_path_factory: pytest.TempPathFactory) -> Workspace:
    """A run of a tank, in full; nothing may write to it but stills."""
    workspace = workspace_in(tmp_path_factory.mktemp("tank") / "runs" / "tank")
    done(workspace, "write_program", text=TANK)
    done(workspace, "run_program", passes="frames")
    done(workspace, "run_program", passes="full")
    return workspace
