"""A sweep on a Ray cluster of two workers on this machine, one of which is killed as it runs."""

from __future__ import annotations

import os
import signal
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.processes import below, lives
from wsim.errors import UserError
from wsim.sweep import Axis, Spec, SweepFolder, sweep
from wsim.sweep.cluster import RayWorkers, connect

PROGRAM = """
def build(scene):
    scene.simulation(duration=0.5)
    scene.ground(friction=0.5)
    edge = scene.param("edge", 0.2, low=0.05, high=0.5)
    if edge > 0.45:
        raise ValueError("too large")
    scene.box("box", size=(edge, edge, edge), position=(0, 0, edge / 2), velocity=(1, 0, 0), density=500.0)
"""


def test_without_ray_it_is_said_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "ray", None)
    with pytest.raises(UserError, match=r"--ray needs Ray .*pip install 'wsim\[ray\]'"):
        connect("auto")


@pytest.fixture(scope="module")
def ray() -> Iterator[object]:
    pytest.importorskip("ray", reason="Ray is not installed: pip install 'wsim[ray]'")
    module = connect("auto")
    yield module
    module.shutdown()


def _listens(pids: set[int]) -> set[str]:
    """Addresses, as the kernel writes them, on which some processes listen."""
    sockets = set()
    for pid in pids:
        try:
            sockets |= {str(link.readlink()) for link in Path(f"/proc/{pid}/fd").iterdir()}
        except OSError:
            continue
    lines = [
        line.split() for name in ("tcp", "tcp6") for line in Path(f"/proc/net/{name}").read_text().splitlines()[1:]
    ]
    return {line[1].split(":")[0] for line in lines if line[3] == "0A" and f"socket:[{line[9]}]" in sockets}


def test_what_is_started_here_listens_on_the_loopback_alone(ray: object) -> None:
    """127.0.0.1, by itself and as an address of IPv6 (proc(5): words are in the order of the machine's bytes)."""
    found = _listens({os.getpid(), *below(os.getpid())})
    assert found
    assert found <= {"0100007F", "0000000000000000FFFF00000100007F"}


def test_a_worker_that_is_killed_loses_nothing(ray: object, tmp_path: Path) -> None:
    (tmp_path / "program.py").write_text(PROGRAM)
    edges = (0.1, 0.12, 0.15, 0.18, 0.2, 0.22, 0.25, 0.28, 0.3, 0.5)
    spec = Spec(axes=[Axis(name="edge", low=0.1, high=0.5, values=edges)], method="grid")
    folder = SweepFolder.create(tmp_path / "runs", "killed", spec, [tmp_path / "program.py"])
    killed: list[int] = []

    def kill_one(stage: str, done: float, total: float) -> None:
        actors = [pid for pid, name in below(os.getpid()).items() if name.startswith("ray::Actor")]
        if done and actors and not killed:
            own = below(actors[0])
            os.kill(actors[0], signal.SIGKILL)
            killed.extend([actors[0], *own])

    found = sweep(folder, 2, kill_one, ray="auto")
    assert len(killed) > 1, "an actor, and the process that does its work"
    assert sorted(outcome.candidate.number for outcome in found) == list(range(11))
    lines = (folder.path / "outcomes.jsonl").read_text().splitlines()
    assert len(lines) == 11
    status = {outcome.candidate.params.get("edge", 0.0): outcome.status for outcome in found}
    assert status.pop(0.5) == "rejected"
    assert set(status.values()) == {"accepted"}
    until = time.monotonic() + 20.0
    while (left := [pid for pid in killed if lives(pid)]) and time.monotonic() < until:
        time.sleep(0.2)
    assert not left


def test_a_cluster_without_gpus_has_no_workers_that_need_one(ray: object) -> None:
    with pytest.raises(UserError, match=r"the Ray cluster has \d+ cores and 0 GPUs: none for a worker"):
        RayWorkers(ray, {}, cuda=True)
