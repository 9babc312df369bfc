"""Launch a kernel on all cores of a CPU device, which Warp itself runs on one."""

from __future__ import annotations

import functools
import os
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import warp as wp

SMALLEST_SHARE = 512


@functools.cache
def thread_count() -> int:
    """Threads for CPU kernels: `WSIM_THREADS`, or the processors this process may use."""
    given = os.environ.get("WSIM_THREADS", "")
    return max(1, int(given)) if given.isdigit() else len(os.sched_getaffinity(0))


@functools.cache
def _pool() -> ThreadPoolExecutor:
    return ThreadPoolExecutor(max_workers=max(1, thread_count() - 1), thread_name_prefix="wsim")


def launch_shared(kernel: wp.Kernel, dim: int, inputs: list[Any], outputs: list[Any]) -> None:
    """Launch a kernel whose first argument is the index of its first thread, split over the cores of a CPU.

    Each index writes only its own entries, so the result does not depend on the number of threads. Warp releases the
    interpreter's lock while a CPU kernel runs.

    Args:
        kernel: Takes `first: int` before `inputs`, and works on index `first + wp.tid()`.
        dim: Number of indices.
        inputs: Arguments after `first`.
        outputs: Output arrays.
    """
    shares = 1 if wp.get_device().is_cuda else min(thread_count(), max(1, dim // SMALLEST_SHARE))
    if shares == 1:
        wp.launch(kernel, dim=dim, inputs=[0, *inputs], outputs=outputs)
        return
    device = wp.get_device()
    cuts = [dim * k // shares for k in range(shares + 1)]

    def part(k: int) -> None:
        wp.launch(kernel, dim=cuts[k + 1] - cuts[k], inputs=[cuts[k], *inputs], outputs=outputs, device=device)

    # The first launch compiles; it goes alone.
    if not kernel.module.execs:
        part(0)
        list(_pool().map(part, range(1, shares)))
        return
    others = [_pool().submit(part, k) for k in range(1, shares)]
    part(0)
    for other in others:
        other.result()
