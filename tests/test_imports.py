"""Imports point down, and what starts first is light."""

import os
import subprocess
import sys

import pytest


def test_import_directions():
    """The layers and forbidden imports of pyproject.toml, as import-linter reads them."""
    done = subprocess.run(
        [sys.executable, "-c", "from importlinter.cli import lint_imports_command as c; c()"],
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stdout + done.stderr


@pytest.mark.parametrize(
    ("code", "forbidden"),
    [
        ("import wsim", {"newton", "warp", "pxr", "rerun", "pydantic", "typer", "numpy", "mujoco"}),
        ("import wsim.cli", {"newton", "warp", "pxr", "rerun", "mujoco", "av", "matplotlib", "cv2"}),
        ("import wsim.scene", {"newton", "warp", "rerun", "pydantic", "mujoco", "trimesh", "typer"}),
        ("import wsim.rules.planner", {"newton", "warp", "pxr", "rerun", "mujoco"}),
        ("import wsim.judge", {"newton", "warp", "pxr", "mujoco"}),
        ("import wsim.recording", {"newton", "warp", "mujoco"}),
    ],
)
def test_what_an_import_brings(code, forbidden):
    script = f"{code}; import sys; print(*sorted({{m.split('.')[0] for m in sys.modules}}))"
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    assert forbidden.isdisjoint(done.stdout.split())


# What the programs' side, the simulator and the models need; the command line itself needs typer and rich.
HEAVY = {
    "av", "coacd", "cv2", "griffe", "jinja2", "lark", "matplotlib", "mcp", "mujoco", "mujoco_warp", "newton", "numpy",
    "openai", "ortools", "PIL", "pxr", "pydantic", "pydantic_ai", "rerun", "scipy", "trimesh", "warp",
}  # fmt: skip


def test_help_brings_nothing_heavy():
    """How long it takes is measured by benchmarks/start_up.py."""
    script = """
import sys
from wsim.cli import main

sys.argv = ["wsim", "--help"]
try:
    main()
finally:
    print(*sorted({name.split(".")[0] for name in sys.modules}), file=sys.stderr)
"""
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    assert "Usage: wsim" in done.stdout
    brought = set(done.stderr.split())
    assert {"wsim", "typer"} <= brought
    assert HEAVY.isdisjoint(brought)


@pytest.mark.parametrize(("said", "threads"), [(None, "1"), ("2", "2")])
def test_the_command_line_shares_out_no_small_matrices(said, threads):
    """Judging a heap takes several times as long on two threads, which wait for each other, as on one."""
    script = """
import os
import wsim.cli
import numpy

print(os.environ["OPENBLAS_NUM_THREADS"], len(os.listdir("/proc/self/task")))
"""
    others = {name: value for name, value in os.environ.items() if name != "OPENBLAS_NUM_THREADS"}
    environment = others | ({"OPENBLAS_NUM_THREADS": said} if said else {})
    done = subprocess.run([sys.executable, "-c", script], env=environment, capture_output=True, text=True, check=True)
    told, running = done.stdout.split()
    assert told == threads
    assert running == threads or os.cpu_count() == 1
