"""Compiles the kernels that a world needs side by side: Warp itself compiles a module when it is first launched.

A rehearsal goes through work without launching anything, which says what it would launch; what is not in Warp's cache
of kernels is then compiled by forked processes, one module each, and the work finds it there. A module is compiled from
the same source with the same options as it would be otherwise, so that what it computes is the same.
"""

from __future__ import annotations

import contextlib
import fcntl
import os
import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from importlib import import_module
from pathlib import Path
from typing import Any

import warp as wp

from wsim.forks import LostForkError, shared_out
from wsim.progress import Progress, silent
from wsim.scene.world import World

Needed = tuple[wp.Module, int]  # a module, and the threads of a block that it is compiled for
STAGE = "compiling kernels side by side"

# What is launched while a model and its solvers are made, which cannot be rehearsed: it reads back what it computes.
MODEL = ("newton._src.geometry.bvh", "newton._src.sim.articulation")
BODIES = (*MODEL, "newton._src.solvers.mujoco.kernels")
BODIES_OF_WARP = (
    *("mujoco_warp._src." + name for name in ("smooth", "set_const", "forward", "passive", "derivative")),
    "wsim.kernels.flight",
)
CAMERA = (
    "newton._src.sensors.sensor_camera_render.camera_utils",
    "newton._src.geometry.particle_surface_kernels",
    "newton._src.geometry.particle_surface_sparse_kernels",
    "wsim.kernels.render.surface",
    "wsim.kernels.render.composite",
    "wsim.kernels.render.display",
)


def compile_first(device: Any, world: World, in_c: bool, draws: bool, progress: Progress = silent) -> dict[str, float]:
    """Compile what a model and its solvers launch as they are made, and beside it what is large of the rest.

    Args:
        device: Warp device, or its name.
        world: What is to be simulated.
        in_c: Whether MuJoCo's C code steps it.
        draws: Whether pictures will be taken.
        progress: Told how many are done.

    Returns:
        Seconds that each module took [s], by its name.
    """
    names: tuple[str, ...] = BODIES if world.bodies else MODEL
    if world.bodies and not in_c:
        names += BODIES_OF_WARP
    if draws:
        names += CAMERA
    return compile_all(modules_named(names, device), device, progress)


def modules_named(names: Iterable[str], device: Any) -> list[Needed]:
    """Modules by the names of their files, for blocks of the size that a launch on the device has by default."""
    block = 1 if wp.get_device(device).is_cpu else 256
    found = []
    for name in names:
        import_module(name)
        found.append((wp.get_module(name), block))
    return found


def rehearse(work: Callable[[], object]) -> list[Needed]:
    """What some work would launch, in order. Nothing is launched: all that it writes is to be thrown away.

    Of a loop on the device one round is gone through, and of a choice both ways. What asks how large a kernel's blocks
    had best be is told the least, as the kernel is not there yet. Work that fails on numbers that nobody has computed
    tells what it would have launched until then.
    """
    found: dict[Needed, None] = {}

    def note(module: wp.Module, device: Any, block_dim: int | None = None, *_: Any, **__: Any) -> None:
        found[(module, block_dim or module.options["block_dim"])] = None  # Warp leaves out a launch of no module

    def once(condition: Any, while_body: Callable[..., object], stream: Any = None, **given: Any) -> None:
        while_body(**given)

    def both(condition: Any, on_true: Any = None, on_false: Any = None, stream: Any = None, **given: Any) -> None:
        for way in filter(None, (on_true, on_false)):
            way(**given)

    def least(kernel: wp.Kernel, device: Any = None) -> tuple[int, int]:
        note(kernel.module, device)
        return 1, 1

    instead = (
        (wp.Module, "load", note), (wp, "capture_while", once), (wp, "capture_if", both),
        (wp, "get_suggested_block_size", least),
    )  # fmt: skip
    with contextlib.ExitStack() as stack:
        stack.enter_context(contextlib.suppress(Exception))  # it fails again, and is told of, where it is truly done
        for owner, name, other in instead:
            stack.enter_context(_instead(owner, name, other))
        work()
    return list(found)


def compile_all(needed: Sequence[Needed], device: Any, progress: Progress = silent) -> dict[str, float]:
    """Compile into the cache what is not there, each module in a process of its own, as many at once as cores.

    Args:
        needed: Modules and blocks.
        device: Warp device, or its name.
        progress: Told how many are done.

    Returns:
        Seconds that each took [s], by its name. One that a process is lost over is left to its first launch.
    """
    device = wp.get_device(device)
    if not _missing(needed, device):
        return {}
    with _alone():  # who waited finds here what the other one has compiled
        return _compile_missing(_missing(needed, device), device, progress)


def load_all(needed: Sequence[Needed], device: Any) -> None:
    """Load modules, as their first launch would: while a graph is captured is no time for that."""
    device = wp.get_device(device)
    for module, block in dict.fromkeys(needed):
        with contextlib.suppress(Exception):  # one that does not compile says so when launched
            module.load(device, block)


def _compile_missing(missing: Sequence[Needed], device: Any, progress: Progress) -> dict[str, float]:
    if len(missing) < 2:
        return {}  # one alone is compiled as it is launched
    seconds: dict[str, float] = {}
    progress(STAGE, 0, len(missing))
    done = shared_out(lambda each: _compile(*each, device), missing, len(os.sched_getaffinity(0)))
    with contextlib.suppress(LostForkError):
        for k, (module, _) in enumerate(missing):
            seconds[module.name] = seconds.get(module.name, 0.0) + next(done)
            progress(STAGE, k + 1, len(missing))
    done.close()
    progress(STAGE, len(missing), len(missing))
    return seconds


@contextlib.contextmanager
def _alone() -> Iterator[None]:
    """One process after another: two that start together need the same."""
    folder = Path(wp.config.kernel_cache_dir)
    folder.mkdir(parents=True, exist_ok=True)
    with (folder / "wsim.lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        try:
            yield
        finally:
            fcntl.flock(lock, fcntl.LOCK_UN)  # for forks, too, that still have it open


def _missing(needed: Sequence[Needed], device: Any) -> list[Needed]:
    return [each for each in dict.fromkeys(needed) if not _is_cached(*each, device)]


def _compile(module: wp.Module, block: int, device: Any) -> float:
    """In a fork: compile, which asks nothing of the device; a module that does not compile says so when launched."""
    began = time.perf_counter()
    with contextlib.suppress(Exception):
        module.get_module_hash(block)
        module._compile(device, options=module.resolved_options[block])
    return time.perf_counter() - began


def _is_cached(module: wp.Module, block: int, device: Any) -> bool:
    if module.execs.get((device.context, block)) is not None:
        return True
    module.get_module_hash(block)
    folder = Path(wp.config.kernel_cache_dir) / module.get_module_identifier(block)
    return (folder / module._get_compile_output_name(device, block_dim=block)).exists()


@contextlib.contextmanager
def _instead(owner: Any, name: str, other: Callable[..., object]) -> Iterator[None]:
    kept = getattr(owner, name)
    setattr(owner, name, other)
    try:
        yield
    finally:
        setattr(owner, name, kept)
