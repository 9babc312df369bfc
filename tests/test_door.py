"""The doors of packages: what is behind one is listed before it is loaded."""

import gc
import subprocess
import sys

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
