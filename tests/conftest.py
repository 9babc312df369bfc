"""Tests marked `cuda` are skipped where there is no CUDA device, and none hangs on the clock. Long files come first."""

# ruff: noqa: E402
from wsim.threads import one_thread

one_thread()  # before anything loads NumPy: the tests have a process for each core

import os

os.environ["WSIM_ASSETS"] = "/nonexistent/wsim-assets"  # the assets of whoever runs the tests are none of theirs

import gc
from functools import cache
from pathlib import Path

import pytest
from hypothesis import HealthCheck, settings
from xdist.scheduler import LoadScopeScheduling

from tests.agents.scripted import own_cache, server

__all__ = ["own_cache", "server"]

# How long an example takes is the machine's affair.
settings.register_profile("any_machine", deadline=None, suppress_health_check=[HealthCheck.too_slow])
settings.load_profile("any_machine")


# A worker takes a group at a time: a file, or those that share a world of a session, which each worker would make for
# itself. A long one that is taken last leaves the other cores idle. Left to itself xdist begins with the files of most
# tests, which are quick ones: `make test` has it keep this order.
LONG = (
    "loop/test_transcripts.py", "benchmarks/test_sph", "program/test_hostile.py", "skills/", "sim/", "test_examples",
    "cli/", "sweep/", "runs/", "mcp/", "judge/checks/test_heaps.py", "loop/", "solvers/", "kernels/",
    "assets/test_standing.py", "judge/", "rules/", "tools/", "agents/", "benchmarks/", "program/",
)  # fmt: skip
TOGETHER = (("cli/test_generate.py", "cli/test_verbs.py"), ("tools/test_query.py", "tools/test_run.py"))
HERE = Path(__file__).parent
# What is collected stays until the end, and so do the packages that it loads: two thirds of the time went into searches
# for garbage among them.
gc.disable()


def inside(path: Path) -> str:
    """A test's file, from here on."""
    return path.relative_to(HERE).as_posix() if path.is_relative_to(HERE) else path.as_posix()


@cache  # thousands of tests lie in some hundreds of files
def place(path: Path) -> int:
    """Where a file of tests stands in `LONG`; behind them all if it does not."""
    return next((k for k, long in enumerate(LONG) if inside(path).startswith(long)), len(LONG))


@cache
def group(path: Path) -> str:
    """What a worker takes at a time: a file of tests, or the first of those that it goes together with."""
    return next((files[0] for files in TOGETHER if inside(path) in files), inside(path))


class ByGroup(LoadScopeScheduling):  # type: ignore[misc]
    """xdist's own marks of groups are lost on pytest 9.2, which makes its tests' names anew: it split every file."""

    def _split_scope(self, nodeid: str) -> str:
        return group(HERE.parent / nodeid.partition("::")[0])


@pytest.hookimpl(optionalhook=True)  # `-p no:xdist`
def pytest_xdist_make_scheduler(config: pytest.Config, log: object) -> ByGroup:
    """By files, whatever `--dist` says."""
    return ByGroup(config, log)


def pytest_collection_finish() -> None:
    gc.freeze()
    gc.enable()


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    items.sort(key=lambda item: place(item.path))
    marked = [item for item in items if item.get_closest_marker("cuda")]
    if not marked:
        return
    import warp as wp

    if not wp.is_cuda_available():
        for item in marked:
            item.add_marker(pytest.mark.skip(reason="needs a CUDA device"))
