"""Worker processes that may die, hang or raise: each loses what it was at, and nothing else."""

from __future__ import annotations

import contextlib
import multiprocessing
import os
import time
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from multiprocessing.connection import Connection, wait
from typing import Any, Generic, TypeVar

from wsim.scene import usd_threads

Task = TypeVar("Task")
Result = TypeVar("Result")

TRIES = 2  # a worker may be killed for what another one uses; who kills two is to blame
# As many processes as cores, and they may be forked.
ONE_THREAD = {"OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1", **usd_threads.ONE_THREAD}


@dataclass(frozen=True)
class Lost:
    """Why a task has no result, and whether another try may have one."""

    reason: str
    again: bool = False


@dataclass
class _Worker:
    process: Any
    pipe: Connection
    task: int | None = None
    until: float = 0.0  # [s] of the clock, when it is given up


class Pool(Generic[Task, Result]):
    """Processes that work off a list, and are replaced when they end.

    Args:
        work: Called in a worker with each task; a function of a module.
        workers: How many processes.
        patience: After how many seconds a task's worker is stopped [s], of each task.
    """

    def __init__(self, work: Callable[[Task], Result], workers: int, patience: Callable[[Task], float]) -> None:
        self._work, self._patience, self._count = work, patience, max(1, workers)
        self._workers: list[_Worker] = []

    def run(self, tasks: Sequence[Task]) -> Iterator[tuple[Task, Result | Lost]]:
        """Each task with its result, in the order in which they are done; every task comes once."""
        todo, tries = deque(range(len(tasks))), [0] * len(tasks)
        try:
            while todo or any(worker.task is not None for worker in self._workers):
                self._fill(tasks, todo, tries)
                for worker in self._ready():
                    index, result = self._answer(worker, tasks)
                    if index is None:
                        continue
                    if isinstance(result, Lost) and result.again and tries[index] < TRIES:
                        todo.appendleft(index)
                        continue
                    yield tasks[index], result
        finally:
            self.stop()

    def stop(self) -> None:
        """End every worker, whatever it is at."""
        for worker in self._workers:
            _end(worker)
        self._workers = []

    def _fill(self, tasks: Sequence[Task], todo: deque[int], tries: list[int]) -> None:
        while todo and len(self._workers) < min(self._count, len(tasks)):
            self._workers.append(_start(self._work))
        for worker in self._workers:
            if todo and worker.task is None:
                index = todo.popleft()
                tries[index] += 1
                worker.task, worker.until = index, time.monotonic() + self._patience(tasks[index])
                with contextlib.suppress(OSError):  # it has died; what it was to do is found lost
                    worker.pipe.send(tasks[index])

    def _ready(self) -> list[_Worker]:
        """Workers that have answered, ended, or been given up."""
        busy = [worker for worker in self._workers if worker.task is not None]
        signs = {worker.pipe: worker for worker in busy} | {worker.process.sentinel: worker for worker in busy}
        left = min((worker.until for worker in busy), default=0.0) - time.monotonic()
        found = wait(list(signs), timeout=max(0.0, left))
        late = [worker for worker in busy if time.monotonic() >= worker.until]
        return list({id(worker): worker for worker in [*(signs[sign] for sign in found), *late]}.values())

    def _answer(self, worker: _Worker, tasks: Sequence[Task]) -> tuple[int | None, Any]:
        index, worker.task = worker.task, None
        try:
            if worker.pipe.poll():
                return index, worker.pipe.recv()
        except (EOFError, OSError):
            worker.process.join(2.0)  # it says itself how it ends
        hung = worker.process.is_alive() and time.monotonic() >= worker.until
        _end(worker)
        self._workers.remove(worker)
        if hung and index is not None:
            return index, Lost(f"took more than {self._patience(tasks[index]):g} s")
        return index, Lost(f"its process ended with {_cause(worker.process.exitcode)}", again=True)


def _start(work: Callable[[Any], Any]) -> _Worker:
    context = multiprocessing.get_context("spawn")
    ours, theirs = context.Pipe()
    before = {name: os.environ.get(name) for name in ONE_THREAD}
    os.environ.update({name: value for name, value in ONE_THREAD.items() if before[name] is None})
    try:
        process = context.Process(target=_serve, args=(theirs, work), daemon=True)
        process.start()
    finally:
        for name, value in before.items():
            if value is None:
                os.environ.pop(name, None)
    theirs.close()
    return _Worker(process, ours)


def _serve(pipe: Connection, work: Callable[[Any], Any]) -> None:
    """In a worker: do what comes, until nobody is there to send it."""
    with contextlib.suppress(EOFError, OSError, KeyboardInterrupt):
        while True:
            task = pipe.recv()
            try:
                done = work(task)
            except Exception as error:  # noqa: BLE001 - whatever it was, the row says so
                done = Lost(told(error))
            pipe.send(done)


def told(error: Exception) -> str:
    """What went wrong, in a line."""
    return f"{type(error).__name__}: {' '.join(str(error).split())[:400]}"


def _end(worker: _Worker) -> None:
    worker.pipe.close()
    worker.process.terminate()
    worker.process.join(2.0)
    if worker.process.is_alive():
        worker.process.kill()
        worker.process.join()


def _cause(code: int | None) -> str:
    if code is not None and code < 0:
        return f"signal {-code}" + (" (killed, as for want of memory)" if code == -9 else "")
    return f"exit code {code}"
