"""Worker processes of this machine, that may die, hang or raise: each loses what it was at, and nothing else."""

from __future__ import annotations

import contextlib
import ctypes
import math
import multiprocessing
import os
import pickle
import signal
import time
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from multiprocessing.connection import Connection, wait
from typing import Any, TypeVar

from wsim import helpers
from wsim.door import keep_what_loads, unsearched
from wsim.scene import usd_threads
from wsim.sweep.shards import Attempt, Dealer, Heard, Lost, run

Task = TypeVar("Task")
Result = TypeVar("Result")
Found = tuple[int, Any]  # where in its task a result belongs, and it

# As many processes as cores, and they may be forked.
ONE_THREAD = {"OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1", **usd_threads.ONE_THREAD}

PR_SET_PDEATHSIG = 1  # prctl(2)


@dataclass
class _Worker:
    process: Any
    pipe: Connection
    attempt: Attempt | None = None


class Pool:
    """Processes, each at a place; a `Workers`.

    Args:
        work: Called in a process with each task; a function of a module. Yields what it has found, some at a time.
        workers: How many processes.
        environments: Variables that differ, as which GPU is seen; taken in turn.
        cores: That each process may keep busy; as many helpers wait in it (`wsim.helpers`) from its start, while it is
            small and at no GPU.

    Attributes:
        environments: They.
        cores: They.
    """

    def __init__(
        self,
        work: Callable[[Any], Iterable[Sequence[Found]]],
        workers: int,
        environments: Sequence[Mapping[str, str]] = ({},),
        cores: int = 1,
    ) -> None:
        self._work, self.environments, self.cores = work, environments, cores
        self._places = range(max(1, workers))
        self._workers: dict[int, _Worker] = {}

    @property
    def places(self) -> Collection[int]:
        """One for each process."""
        return self._places

    @property
    def shared(self) -> bool:
        """Whether some have the same variables, of several that differ: they share what those name, as a GPU."""
        return len(self._places) > len(self.environments) and any(self.environments)

    def now(self) -> float:
        """The clock of this machine [s]."""
        return time.monotonic()

    def idle(self) -> Sequence[int]:
        """Places whose process waits for work, or is yet to be started."""
        return [k for k in self._places if k not in self._workers or self._workers[k].attempt is None]

    def give(self, attempt: Attempt, task: Any) -> None:
        """Send a task to a place's process."""
        place = attempt.place
        if place not in self._workers:
            self._workers[place] = _start(self._work, self.environments[place % len(self.environments)], self.cores)
        self._workers[place].attempt = attempt
        with contextlib.suppress(OSError):  # it has died; what it was to do is found lost
            self._workers[place].pipe.send(task)

    def hear(self, until: float) -> Sequence[Heard]:
        """What processes have said, or that they have ended."""
        busy = {place: worker for place, worker in self._workers.items() if worker.attempt is not None}
        signs: dict[Any, int] = {worker.pipe: place for place, worker in busy.items()}
        signs |= {worker.process.sentinel: place for place, worker in busy.items()}
        found = wait(list(signs), timeout=None if math.isinf(until) else max(0.0, until - time.monotonic()))
        return [self._read(place) for place in dict.fromkeys(signs[sign] for sign in found)]

    def end(self, place: int) -> None:
        """End a process, whatever it is at."""
        worker = self._workers.pop(place)
        worker.pipe.close()
        worker.process.terminate()
        worker.process.join(2.0)
        if worker.process.is_alive():
            worker.process.kill()
            worker.process.join()

    def stop(self) -> None:
        """End all of them."""
        for place in list(self._workers):
            self.end(place)

    def _read(self, place: int) -> Heard:
        worker = self._workers[place]
        attempt = worker.attempt
        assert attempt is not None  # only who is at something is heard
        try:
            if worker.pipe.poll():
                said = worker.pipe.recv()
                if said is None or isinstance(said, Lost):
                    worker.attempt = None
                    return Heard(attempt.ticket, over=True, lost=said)
                return Heard(attempt.ticket, [(attempt.items[k], result) for k, result in said])
        except (EOFError, OSError):
            worker.process.join(2.0)  # it says itself how it ends
        self.end(place)
        how = f"its process ended with {_cause(worker.process.exitcode)}"
        return Heard(attempt.ticket, over=True, lost=Lost(how, again=True))


def each(
    work: Callable[[Task], Result], tasks: Sequence[Task], workers: int, patience: float
) -> Iterator[tuple[Task, Result | Lost]]:
    """Each task with its result, in the order in which they are done; every task comes once, and what is late is lost.

    Args:
        work: Called in a process with each task; a function of a module.
        tasks: They.
        workers: How many processes.
        patience: After how many seconds a task's process is stopped [s].
    """
    dealer = Dealer(len(tasks), 1, patience, elsewhere=False)
    pool = Pool(partial(_one, work), min(workers, len(tasks)))
    for found in run(dealer, tasks, lambda items: items[0], pool):
        yield from found


def _one(work: Callable[[Any], Any], task: Any) -> Iterator[list[Found]]:
    yield [(0, work(task))]


def _start(work: Callable[[Any], Iterable[Sequence[Found]]], environment: Mapping[str, str], cores: int) -> _Worker:
    context = multiprocessing.get_context("spawn")
    ours, theirs = context.Pipe()
    threads = {name: value for name, value in ONE_THREAD.items() if name not in os.environ}
    with _environment({**threads, **environment}):
        process = context.Process(target=_serve, args=(theirs, pickle.dumps(work), cores), daemon=True)
        process.start()
    theirs.close()
    return _Worker(process, ours)


@contextlib.contextmanager
def _environment(values: Mapping[str, str]) -> Iterator[None]:
    """What is started within has these variables."""
    before = {name: os.environ.get(name) for name in values}
    os.environ.update(values)
    try:
        yield
    finally:
        for name, value in before.items():
            if value is None:
                os.environ.pop(name, None)
            else:
                os.environ[name] = value


def _serve(pipe: Connection, packed: bytes, cores: int) -> None:
    """In a process: do what comes, until nobody is there to send it. It ends when who started it is killed.

    Args:
        pipe: Tasks come by it, and what is found goes.
        packed: The pickled `work`; what it needs, the simulator too, is loaded as it is unpacked.
        cores: How many helpers it has.
    """
    ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, signal.SIGKILL)
    parent = multiprocessing.parent_process()
    if parent is None or not parent.is_alive():
        return
    keep_what_loads()
    with unsearched():
        work: Callable[[Any], Iterable[Sequence[Found]]] = pickle.loads(packed)
    helpers.start(cores)
    with contextlib.suppress(EOFError, OSError, KeyboardInterrupt):
        while True:
            task = pipe.recv()
            end = None
            try:
                for found in work(task):
                    pipe.send(found)
            except (BrokenPipeError, ConnectionError):
                return
            except Exception as error:  # noqa: BLE001 - whatever it was, the row says so
                end = lost_to(error)
            pipe.send(end)


def lost_to(error: Exception) -> Lost:
    """What went wrong; another machine may have the memory, or the disk, that this one lacks."""
    return Lost(told(error), again=isinstance(error, (MemoryError, OSError)))


def told(error: Exception) -> str:
    """What went wrong, in a line."""
    return f"{type(error).__name__}: {' '.join(str(error).split())[:400]}"


def _cause(code: int | None) -> str:
    if code is not None and code < 0:
        return f"signal {-code}" + (" (killed, as for want of memory)" if code == -9 else "")
    return f"exit code {code}"
