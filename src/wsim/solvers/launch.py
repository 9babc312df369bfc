"""Launch a kernel on all cores of a CPU device, which Warp itself runs on one."""

from __future__ import annotations

import functools
import math
import os
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import warp as wp

from wsim.kernels.sph.pair_sums import BLOCK

SMALLEST_SHARE = 512


@functools.cache
def thread_count() -> int:
    """Threads for CPU kernels: `WSIM_THREADS`, or the processors this process may use."""
    given = os.environ.get("WSIM_THREADS", "")
    return max(1, int(given)) if given.isdigit() else len(os.sched_getaffinity(0))


@functools.cache
def _pool() -> ThreadPoolExecutor:
    return ThreadPoolExecutor(max_workers=max(1, thread_count() - 1), thread_name_prefix="wsim")


def launch_shared(
    kernel: wp.Kernel,
    dim: int | tuple[int, ...],
    inputs: list[Any],
    outputs: list[Any],
    device: Any = None,
    first: int = 0,
) -> None:
    """Launch a kernel whose first argument is the index of its first thread, split over the cores of a CPU.

    Each index writes only its own entries, so the result does not depend on the number of threads. Warp releases the
    interpreter's lock while a CPU kernel runs.

    Args:
        kernel: Takes `first: int` before `inputs`, and works on index `first + wp.tid()`, along its first axis.
        dim: Number of indices; the first axis is split.
        inputs: Arguments after `first`.
        outputs: Output arrays.
        device: Warp device; the current one by default.
        first: Index to begin at.
    """
    device = wp.get_device(device)
    rows, *rest = (dim,) if isinstance(dim, int) else dim
    shares = 1 if device.is_cuda else min(thread_count(), max(1, rows * math.prod(rest) // SMALLEST_SHARE))
    cuts = [rows * k // shares for k in range(shares + 1)]

    def part(k: int) -> None:
        size = (cuts[k + 1] - cuts[k], *rest)
        wp.launch(kernel, dim=size, inputs=[first + cuts[k], *inputs], outputs=outputs, device=device, block_dim=BLOCK)

    if shares == 1 or not kernel.module.execs:  # the first launch compiles; it goes alone
        for k in range(shares):
            part(k)
        return
    others = [_pool().submit(part, k) for k in range(1, shares)]
    part(0)
    for other in others:
        other.result()
