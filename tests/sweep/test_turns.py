"""Workers that share a device: while one steps its worlds, the other builds, and never do both step."""

from __future__ import annotations

import fcntl
import functools
import multiprocessing
import os
import signal
import time
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any

import pytest

import wsim.sweep.batch
import wsim.sweep.work
from wsim.sweep import shards
from wsim.sweep.axis import Axis
from wsim.sweep.folder import SweepFolder
from wsim.sweep.pool import Found, Pool
from wsim.sweep.run import _here, dealer, packed
from wsim.sweep.shards import Dealer, Heard
from wsim.sweep.spec import Spec
from wsim.sweep.turns import TURNS, sharing, turn
from wsim.sweep.work import Shard, work

EVENTS = "WSIM_TEST_EVENTS"
PROGRAM = """
def build(scene):
    scene.simulation(duration=0.05)
    scene.ground()
    scene.sphere("ball", radius=0.1, position=(0, 0, scene.param("height", 1.0, low=0.2, high=3.0)))
"""
BATCHES, OF = 4, 2
PATIENCE = 60.0  # [s], for what comes unless it is waited for in vain


def note(what: str) -> None:
    with Path(os.environ[EVENTS]).open("a") as file:
        file.write(f"{os.getpid()} {what}\n")


def noted() -> list[tuple[int, str]]:
    lines = Path(os.environ[EVENTS]).read_text().splitlines()
    return [(int(pid), what) for pid, what in (line.split() for line in lines)]


def begun(what: str) -> int:
    return sum(each == what for _, each in noted())


def lasting(call: Callable[..., Any], begins: str, ends: str, other: str, ahead: int) -> Callable[..., Any]:
    """A call of which is noted when it begins and ends; the k-th, but the first, lasts until k + ahead others began."""

    @functools.wraps(call)
    def called(*given: Any) -> Any:
        note(begins)
        k, late = begun(begins), time.monotonic() + PATIENCE
        value = call(*given)
        while k > 1 and begun(other) < min(BATCHES, k + ahead) and time.monotonic() < late:
            time.sleep(0.01)
        note(ends)
        return value

    return called


def noted_work(shard: Shard) -> Iterator[Sequence[Found]]:
    """`work`, of which is noted when it builds and steps."""
    with pytest.MonkeyPatch.context() as patch:
        # Each waits for the other, in vain if one of them could not begin before the other has ended.
        patch.setattr(wsim.sweep.work, "build", lasting(wsim.sweep.work.build, "builds", "built", "steps", -1))
        patch.setattr(wsim.sweep.batch, "follow", lasting(wsim.sweep.batch.follow, "steps", "stepped", "builds", 1))
        yield from work(shard)


def test_one_builds_while_the_other_steps(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(EVENTS, str(tmp_path / "events"))
    program = tmp_path / "ball.py"
    program.write_text(PROGRAM)
    axes = [Axis(name="height", low=0.5, high=1.0)]
    spec = Spec(axes=axes, samples=BATCHES * OF - 1, worlds=OF, device="cpu", programs=["ball.py"])
    folder = SweepFolder.create(tmp_path / "runs", "ball", spec, [program])
    pool = Pool(noted_work, 2, [sharing(tmp_path, "cuda:0")])
    candidates = folder.spec.candidates()
    pack = packed(folder.path.resolve(), folder.spec, 1, False)
    deals = Dealer(len(candidates), OF, 10.0 * PATIENCE, OF)
    found = [each for came in shards.run(deals, candidates, pack, pool) for each in came]
    assert sorted(candidate.number for candidate, _ in found) == list(range(BATCHES * OF))
    assert all(outcome.together == OF and not outcome.note for _, outcome in found)
    stepping, building, meanwhile = set[int](), set[int](), set[tuple[int, int]]()
    for pid, what in noted():
        doing = stepping if what in ("steps", "stepped") else building
        (doing.add if what in ("steps", "builds") else doing.discard)(pid)
        assert len(stepping) <= 1, "both step"
        meanwhile |= {(one, other) for one in stepping for other in building}
    assert meanwhile
    assert all(one != other for one, other in meanwhile)


def holds(file: str, pipe: Any) -> None:
    os.environ[TURNS] = file
    with turn():
        if os.fork() == 0:  # who is forked has no part in it
            os.setpgid(0, 0)
            time.sleep(PATIENCE)
            os._exit(0)
        pipe.send(True)
        time.sleep(PATIENCE)


def test_a_turn_ends_with_its_process(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    file = str(tmp_path / "cuda-0")
    ours, theirs = multiprocessing.Pipe()
    process = multiprocessing.get_context("spawn").Process(target=holds, args=(file, theirs), daemon=True)
    process.start()
    assert ours.recv()
    with Path(file).open("wb") as other, pytest.raises(OSError):
        fcntl.lockf(other, fcntl.LOCK_EX | fcntl.LOCK_NB)
    assert process.pid
    os.kill(process.pid, signal.SIGKILL)
    process.join()
    monkeypatch.setenv(TURNS, file)
    with turn():
        pass


def test_no_shard_of_workers_that_share_is_less_than_half_a_batch() -> None:
    """What a batch takes beside its worlds, a second or more, is not shortened with it."""
    spec, sizes = Spec(device="cuda:0,cuda:1", worlds=1024), []
    of = dealer(spec, 4096, shared=True)
    while given := of.assign([0], 4, 0.0)[0]:
        sizes += [len(attempt.items) for attempt in given]
        of.heard(Heard(given[0].ticket, [(k, None) for k in given[0].items], over=True), 1.0)
    assert sizes == [512] * 8


@pytest.mark.parametrize(
    ("device", "asked", "candidates", "workers", "seen"),
    [
        ("cuda:0", 0, 1024, 1, [None]),
        ("cuda:0", 0, 4096, 2, [None]),
        ("cuda:0,cuda:1", 0, 4096, 4, ["0", "1"]),
        ("cuda:0,cuda:1", 0, 2000, 2, ["0", "1"]),
        ("cuda:0,cuda:1", 2, 4096, 2, ["0", "1"]),
    ],
)
def test_a_gpu_has_two_workers_if_there_is_more_than_a_batch_for_it(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    device: str,
    asked: int,
    candidates: int,
    workers: int,
    seen: list[str | None],
) -> None:
    monkeypatch.delenv("CUDA_VISIBLE_DEVICES", raising=False)
    spec = Spec(device=device)
    pool = _here(spec, asked, candidates, tmp_path)
    assert len(pool.places) == workers
    assert [each.get("CUDA_VISIBLE_DEVICES") for each in pool.environments] == seen
    assert len({each[TURNS] for each in pool.environments}) == len(device.split(","))
    assert pool.shared == (workers > len(device.split(",")))
    assert pool.cores == max(1, len(os.sched_getaffinity(0)) // len(device.split(",")))
