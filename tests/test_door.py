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
