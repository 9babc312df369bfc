"""Workers of a Ray cluster: on each GPU one, or one for each core, on this machine or on many (extra `wsim[ray]`).

Each is an actor that has a process do the work, as a worker of this machine is one (`wsim.sweep.pool`): what kills the
process is told by the actor, what kills the actor or its machine by Ray. The sweep's programs travel with the actor;
wsim itself must be installed wherever one runs.
"""

from __future__ import annotations

import math
import os
import socket
import tempfile
import time
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from wsim.errors import UserError
from wsim.sweep.pool import Found, Pool
from wsim.sweep.shards import Attempt, Heard, Lost, Share
from wsim.sweep.work import Shard, work

LOOPBACK = "127.0.0.1"
NOBODY = 600.0  # [s] after which a cluster on which no worker runs is given up
ANSWERS = 5.0  # [s] for which a cluster is waited for


def connect(address: str) -> Any:
    """Ray, connected to a cluster.

    Args:
        address: Of its head, as HOST:PORT; "auto": the one that runs on this machine, or else one that is started for
            as long as this process runs, and listens on the loopback alone.

    Raises:
        UserError: If Ray is not installed, or there is no such cluster.
    """
    os.environ.setdefault("RAY_USAGE_STATS_ENABLED", "0")
    try:
        import ray  # an extra, and slow to load
    except ImportError as error:
        raise UserError(f"--ray needs Ray ({error}); install it with: pip install 'wsim[ray]'") from error
    if ray.is_initialized():
        return ray
    if address != "auto":
        _answers(address)
    quiet: dict[str, Any] = {"log_to_driver": False, "logging_level": "error"}
    try:
        ray.init(address, **quiet)
    except ConnectionError as error:
        if address != "auto":
            raise UserError(f"--ray {address}: {error}") from error
        from ray._private import ray_constants  # no public setting keeps a Linux machine's address out of it

        ray_constants.ENABLE_RAY_CLUSTER = False  # as on other systems: the loopback is its address
        cores = len(os.sched_getaffinity(0))
        ray.init("local", num_cpus=cores, include_dashboard=False, _node_ip_address=LOOPBACK, **quiet)
    return ray


def _answers(address: str) -> None:
    """Refuse an address at which nobody is, for which Ray would wait for minutes."""
    host, _, port = address.rpartition(":")
    if not host or not port.isdigit() or "/" in host:
        raise UserError(f"--ray {address}: expected auto, or the cluster's HOST:PORT, as 10.0.0.1:6379")
    try:
        socket.create_connection((host.strip("[]"), int(port)), timeout=ANSWERS).close()
    except (OSError, OverflowError) as error:
        raise UserError(f"--ray {address}: no Ray cluster answers there ({error})") from error


class Actor:
    """In a worker of the cluster: holds a process that does the work.

    Args:
        files: The sweep's, by name.
        cores: That it may keep busy.
    """

    def __init__(self, files: Mapping[str, bytes], cores: int = 1) -> None:
        self._scratch = tempfile.TemporaryDirectory(prefix="wsim-sweep-")
        for name, content in files.items():
            (Path(self._scratch.name) / name).write_bytes(content)
        self._pool = Pool(work, 1, cores=cores)

    def hello(self) -> int:
        """Its process id: it has started."""
        return os.getpid()

    def run(self, shard: Shard) -> Iterator[Sequence[Found] | Lost]:
        """What is found, as it is; at last, if its process ended, why."""
        items = tuple(range(len(shard.candidates)))
        here = replace(shard, folder=Path(self._scratch.name))
        self._pool.give(Attempt(0, 0, Share(items), items, self._pool.now()), here)
        while True:
            for said in self._pool.hear(math.inf):
                if said.results:
                    yield said.results
                if said.lost:
                    yield said.lost
                if said.over:
                    return


@dataclass
class _Place:
    actor: Any
    hello: Any  # a promise, until the actor has started
    attempt: Attempt | None = None
    says: Any = None  # the stream of what it finds


class RayWorkers:
    """Actors of a cluster; a `wsim.sweep.shards.Workers`.

    Args:
        ray: What `connect` gave.
        files: The sweep's, by name.
        cuda: Whether each has a GPU.
        count: How many; 0: one for each GPU, or for each core.

    Raises:
        UserError: If the cluster has nothing for them.
    """

    def __init__(self, ray: Any, files: Mapping[str, bytes], cuda: bool, count: int = 0) -> None:
        has = ray.cluster_resources()
        cores, gpus = int(has.get("CPU", 0)), int(has.get("GPU", 0))
        self.count = count or (gpus if cuda else cores)
        if not self.count or (cuda and not gpus):
            raise UserError(f"the Ray cluster has {cores} cores and {gpus} GPUs: none for a worker")
        self.cores = max(1, cores // self.count)
        needs = {"num_cpus": min(1.0, cores / self.count), "num_gpus": min(1.0, gpus / self.count) if cuda else 0}
        self._ray, self._class = ray, ray.remote(**needs, max_restarts=0, max_task_retries=0)(Actor)
        self._files = ray.put(dict(files))
        self._places = {k: self._start() for k in range(self.count)}
        self._seen = time.monotonic()  # when there was a worker
        self._why = "it has no room for one"  # why there is none

    @property
    def places(self) -> Collection[int]:
        """One for each worker that is to be."""
        return self._places.keys()

    def now(self) -> float:
        """The clock of this machine [s]."""
        return time.monotonic()

    def idle(self) -> Sequence[int]:
        """Places whose actor has started, and waits for work."""
        return [k for k, place in self._places.items() if place.hello is None and place.attempt is None]

    def give(self, attempt: Attempt, task: Any) -> None:
        """Send a shard to a place's actor."""
        place = self._places[attempt.place]
        place.attempt = attempt
        place.says = place.actor.run.options(num_returns="streaming").remote(task)

    def hear(self, until: float) -> Sequence[Heard]:
        """What actors have said, and which have ended."""
        signs = {place.hello or place.says: k for k, place in self._places.items() if place.hello or place.says}
        left = min(until - time.monotonic(), NOBODY)
        self._ray.wait(list(signs), num_returns=1, timeout=max(0.0, left))
        ready, _ = self._ray.wait(list(signs), num_returns=len(signs), timeout=0.0)  # of a thousand, all that are
        said = [heard for sign in ready if (heard := self._read(signs[sign]))]
        if any(place.hello is None for place in self._places.values()):
            self._seen = time.monotonic()
        elif time.monotonic() - self._seen > NOBODY:
            raise UserError(f"no worker of the Ray cluster has started for {NOBODY:g} s: {self._why}; see --resume")
        return said

    def end(self, place: int) -> None:
        """Kill an actor; another one is started, here or on another machine."""
        self._ray.kill(self._places[place].actor)
        self._places[place] = self._start()

    def stop(self) -> None:
        """Kill all of them."""
        for place in self._places.values():
            self._ray.kill(place.actor)

    def _start(self) -> _Place:
        actor = self._class.remote(self._files, self.cores)
        return _Place(actor, actor.hello.remote())

    def _read(self, k: int) -> Heard | None:
        place, errors = self._places[k], self._ray.exceptions
        attempt = place.attempt
        try:
            if attempt is None:
                self._ray.get(place.hello)
                place.hello = None
                return None
            said = self._ray.get(next(place.says))
        except StopIteration:
            place.attempt = place.says = None
            return Heard(attempt.ticket, over=True) if attempt else None
        except (errors.RayError, errors.RayTaskError) as error:
            self.end(k)
            self._why = f"its worker ended with {_line(error)}"
            return Heard(attempt.ticket, over=True, lost=Lost(self._why, again=True)) if attempt else None
        assert attempt is not None
        if isinstance(said, Lost):
            place.attempt = place.says = None
            return Heard(attempt.ticket, over=True, lost=said)
        return Heard(attempt.ticket, [(attempt.items[item], result) for item, result in said])


def _line(error: Exception) -> str:
    lines = [line.strip() for line in str(error).splitlines() if line.strip()]
    return f"{type(error).__name__}: {lines[0][:300] if lines else ''}"
