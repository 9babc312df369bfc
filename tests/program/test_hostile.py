"""Programs that mean harm, or do it by mistake: each ends as the right kind, in time, and leaves nothing."""

from __future__ import annotations

import os
import platform
import re
import shutil
import socket
import subprocess
import sys
import tempfile
from pathlib import Path

import pytest

from tests.patience import STUCK, until
from wsim.program.sandbox import BuildResult, Limits, build
from wsim.program.sandbox.process import SandboxProcess
from wsim.program.sandbox.result import REPORT_BYTES

HOSTILE = Path(__file__).parent / "hostile"
SECONDS = 2.0
MIB = 1 << 20
LIMITS = Limits(
    wall_seconds=STUCK,
    cpu_seconds=STUCK,
    memory_bytes=2048 * MIB,
    scratch_bytes=16 * MIB,
    file_bytes=8 * MIB,
    log_bytes=100_000,
    threads=64,
)

# program: (kind, part of the message, line)
ENDS: dict[str, tuple[str, str, int | None]] = {
    "raises": ("exception", "RuntimeError: no such world", 3),
    "raises_unprintable": ("exception", "Nasty", 7),
    "exits": ("crash", "ended its process", None),
    "calls_exit": ("exception", "called exit(0)", 5),
    "segfault": ("crash", "SIGSEGV", None),
    "nan_pose": ("exception", "SceneError", 2),
    "nan_in_stage": ("stage", "nan", None),
    "fills_root": ("exception", "/filler", 2),
    "fills_scratch_one_file": ("output", "File too large", 4),
    "hogs_memory": ("memory", "2048 MiB", 4),
    "hogs_memory_of_the_kernel": ("exception", "refused, as it should be", 14),
    "fork_bomb": ("exception", "PermissionError", 6),
    "daemon": ("exception", "PermissionError", 6),
    "starts_a_program": ("exception", "PermissionError", 5),
    "connects": ("exception", "PermissionError", 5),
    "talks_in_the_kernel": ("exception", "nobody heard", 21),
    "hides_its_descriptors": ("exception", "refused", 17),
    "leaves_its_group": ("exception", "still there", 11),
    "writes_to_the_kernel": ("exception", "0 opened", None),
    "reads_shadow": ("exception", "/etc/shadow", 2),
    "reads_a_secret": ("exception", "nothing to see", 18),
    "writes_outside": ("exception", "Error", None),
    "changes_metadata": ("exception", "unchanged", 26),
    "prints_forever": ("output", "printed more than 100000 bytes", None),
    "symlink_as_stage": ("exception", "stage.usda", None),
    "device_as_stage": ("exception", "Error", None),
    "huge_stage": ("output", "8388608 bytes", None),
    "binary_stage": ("stage", "not a USD text file", None),
    "garbled_stage": ("stage", "", None),
    "stage_that_reaches_out": ("stage", "/etc/passwd", None),
    "forged_report": ("stage", "not a USD text file", None),
    "signals_its_parent": ("exception", "nobody was hurt", 23),
    "raises_its_limits": ("exception", "ValueError", 5),
    "no_build": ("exception", "no function build(scene)", None),
    "makes_nothing": ("exception", "without making an object", None),
    "deep_recursion": ("exception", "RecursionError", 2),
}
RUN_OUT = ("loops_forever", "sleeps_forever", "loops_at_import", "burns_threads")


@pytest.fixture
def run(isolation: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    """Run a hostile program and check that nothing of it is left."""
    (tmp_path / "secret").write_text("topsecret")
    monkeypatch.setenv("WSIM_TEST_TOKEN", "topsecret")
    folder = tmp_path / "temporary"
    folder.mkdir()
    monkeypatch.setattr(tempfile, "tempdir", str(folder))

    def once(name: str, limits: Limits = LIMITS, **params: float) -> BuildResult:
        program = tmp_path / f"{name}.py"
        shutil.copyfile(HOSTILE / f"{name}.py", program)
        text = program.read_bytes()
        before = set(tmp_path.iterdir())
        result = build(program, tmp_path / "stage.usda", params, limits, isolation)
        assert not result.ok
        assert result.isolation == isolation
        assert len(result.log) <= limits.log_bytes
        assert "SECRET" not in result.log
        assert set(tmp_path.iterdir()) == before, "a file was left"
        assert list(folder.iterdir()) == [], "a temporary file was left"
        assert program.read_bytes() == text
        assert _processes(str(program)) == [], "a process was left"
        return result

    return once


def _processes(word: str) -> list[str]:
    """Numbers of the processes whose command lines contain a word."""
    found = []
    for path in Path("/proc").glob("[0-9]*/cmdline"):
        try:
            line = path.read_bytes().decode(errors="replace")
        except OSError:
            continue
        if word in line and path.parent.name != str(os.getpid()):
            found.append(path.parent.name)
    return found


def _filters(process: str) -> int:
    """How many seccomp filters a process has; one that is confined has one more."""
    try:
        found = re.search(r"^Seccomp_filters:\s+(\d+)$", Path(f"/proc/{process}/status").read_text(), re.MULTILINE)
    except OSError:
        return 0
    return int(found[1]) if found else 0


@pytest.mark.parametrize("name", ENDS)
def test_ends_as_the_right_kind(run, name: str) -> None:
    kind, message, line = ENDS[name]
    result = run(name)
    assert (result.kind, result.line) == (kind, f"{name}.py:{line}" if line else result.line), result.message
    assert message in result.message
    assert "\n" not in result.finding()["message"]


@pytest.mark.parametrize("name", RUN_OUT)
def test_is_stopped_when_its_time_is_up(run, name: str) -> None:
    result = run(name, LIMITS.model_copy(update={"wall_seconds": SECONDS}))
    assert result.kind == "timeout"
    assert "2 s" in result.message


def test_is_stopped_when_its_cpu_time_is_up(run) -> None:
    result = run("loops_forever", LIMITS.model_copy(update={"cpu_seconds": 1.0}))
    assert result.kind == "timeout"
    assert "CPU" in result.message


@pytest.mark.parametrize(
    "name",
    ["fills_scratch_many_files", "fills_scratch_empty_files", "fills_scratch_unseen", "fills_scratch_mapped"],
)
def test_many_files_do_not_fill_the_disk(run, name: str) -> None:
    result = run(name)
    assert result.kind == "output", result.message


def test_inherited_files_do_not_fill_the_disk(isolation: str, tmp_path: Path) -> None:
    stage = tmp_path / "stage.usda"
    job = {"task": "build", "program": str(HOSTILE / "grows_its_files.py"), "params": {}, "seed": 0}
    limits = LIMITS.model_copy(update={"scratch_bytes": 64 * MIB})
    with stage.open("w+b") as target:
        before = shutil.disk_usage(tmp_path).free
        with SandboxProcess(
            {**job, "stage_fd": target.fileno()},
            limits=limits,
            isolation=isolation,
            readable=[HOSTILE],
            descriptors=[target.fileno()],
        ) as process:
            process.wait(limits.wall_seconds)
            assert "tried" in process.log
            assert len(process.report()) <= REPORT_BYTES + 1
            # The stage, the report and the scratch folder, and as much again for what others write meanwhile.
            assert before - shutil.disk_usage(tmp_path).free < 2 * (2 * limits.file_bytes + limits.scratch_bytes)
        assert stage.stat().st_size <= limits.file_bytes
        assert stage.stat().st_blocks * 512 <= limits.file_bytes + MIB


def test_sockets_by_path_are_out_of_reach(run, tmp_path: Path) -> None:
    with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as listener:
        listener.bind(str(tmp_path / "socket"))
        listener.setblocking(False)
        result = run("reaches_a_socket")
        assert "nobody was reached" in result.message
        with pytest.raises(BlockingIOError):
            listener.recv(100)


@pytest.mark.skipif(platform.machine() != "x86_64", reason="32-bit calls are those of x86")
def test_the_calls_of_32_bit_programs_end_the_process(run) -> None:
    result = run("calls_the_old_way")
    assert (result.kind, "SIGSYS" in result.message) == ("crash", True), result.message


def test_dies_with_the_process_that_asked(isolation: str, tmp_path: Path) -> None:
    program = tmp_path / "sleeps_forever.py"
    shutil.copyfile(HOSTILE / "sleeps_forever.py", program)
    asking = (
        "import sys, pathlib; from wsim.program.sandbox import build; "
        "build(pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[1] + '.usda'), isolation=sys.argv[2])"
    )
    with subprocess.Popen([sys.executable, "-c", asking, str(program), isolation]) as parent:
        until(lambda: any(_filters(one) > _filters("self") for one in _processes(str(program))))
        parent.kill()
    until(lambda: _processes(str(program)) == [])


def test_many_threads_are_stopped(run) -> None:
    result = run("thread_bomb")
    assert result.kind == "crash"
    assert "64 threads" in result.message


def test_other_processes_are_out_of_reach(run) -> None:
    with subprocess.Popen(["sleep", f"{2 * STUCK:.0f}"]) as victim:
        run("signals_its_parent", victim=float(victim.pid), again=float(victim.pid))
        assert victim.poll() is None
        victim.kill()
