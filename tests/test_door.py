"""The doors of packages: what is behind one is listed before it is loaded."""

import gc
import os
import subprocess
import sys
from pathlib import Path

import pytest

from wsim.door import load_module


@pytest.mark.parametrize(
    ("package", "names", "unloaded"),
    [
        ("wsim.sim", {"Simulation", "pick_device"}, "wsim.sim.simulation"),
        ("wsim.recording", {"RecordingWriter", "read"}, "wsim.recording.writer"),
    ],
)
def test_a_door_lists_what_is_behind_it(package: str, names: set[str], unloaded: str) -> None:
    script = f"import {package} as p, sys; print(*dir(p)); print({unloaded!r} in sys.modules)"
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    listed, loaded = done.stdout.splitlines()
    assert names | {"__name__", "__getattr__"} <= set(listed.split())
    assert loaded == "False"


def test_garbage_is_looked_for_again_after_a_load() -> None:
    load_module("json.tool")
    assert gc.isenabled()
    with pytest.raises(ModuleNotFoundError):
        load_module("wsim.nothing")
    assert gc.isenabled()
    gc.disable()
    try:
        load_module("json.scanner")
        assert not gc.isenabled()  # whoever has stopped it keeps it so
    finally:
        gc.enable()


WORLD = """
import gc, sys
from wsim.door import keep_what_loads, load_module
if sys.argv[1] == "own":
    keep_what_loads()
load_module("wsim.plan.schema")
print(gc.get_freeze_count(), len(gc.get_objects()), gc.isenabled())
"""


def test_only_in_wsims_own_process_is_what_loads_kept_from_the_search_for_garbage() -> None:
    """There a search goes through hardly anything; a library's user keeps everything searched."""

    def counts(whose: str) -> tuple[int, int, str]:
        done = subprocess.run([sys.executable, "-c", WORLD, whose], capture_output=True, text=True, check=True)
        frozen, searched, collects = done.stdout.split()
        return int(frozen), int(searched), collects

    frozen, searched, collects = counts("own")
    assert frozen > 50 * searched
    assert collects == "True"
    frozen, searched, collects = counts("library")
    assert frozen < 1000 < 10_000 < searched  # Python itself may freeze a few
    assert collects == "True"


def test_the_command_line_is_such_a_process() -> None:
    script = """
import gc, sys
from wsim.cli import main
sys.argv = ["wsim", "runs", "--help"]
try:
    main()
except SystemExit:
    print(gc.get_freeze_count())
"""
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    assert int(done.stdout.split()[-1]) > 10_000


SLOW = """
import sys, time
told = sys.modules["__main__"].told
told.append("begins")
while "asked" not in told:
    time.sleep(0.001)
value = 3
"""
BESIDE = """
import importlib, sys, time
from wsim.door import load_beside
told = []
load_beside("slow")
load_beside("wsim.nothing")
while "begins" not in told:
    time.sleep(0.001)
told.append("asked")
print(importlib.import_module("slow").value)
try:
    importlib.import_module("wsim.nothing")
except ModuleNotFoundError as error:
    print(error.name)
"""


def test_what_loads_beside_is_waited_for_by_who_needs_it(tmp_path: Path) -> None:
    (tmp_path / "slow.py").write_text(SLOW)
    done = subprocess.run(
        [sys.executable, "-c", BESIDE],
        capture_output=True,
        text=True,
        check=True,
        timeout=120.0,
        env={**os.environ, "PYTHONPATH": str(tmp_path)},
    )
    assert done.stdout.split() == ["3", "wsim.nothing"]
    assert done.stderr == ""


def test_a_world_is_planned_and_written_without_the_simulator() -> None:
    """It loads while the stage is built; what confirms a run builds its own meanwhile, too."""
    script = "import sys, wsim.cli.generate, wsim.loop.generate, wsim.runs.bare_run; print(*sys.modules)"
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    assert not {"newton", "warp", "mujoco_warp", "wsim.sim.simulation"} & set(done.stdout.split())
