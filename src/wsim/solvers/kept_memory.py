"""Memory for what MuJoCo Warp makes anew at every call, where a loop in a CUDA graph may allocate none."""

from __future__ import annotations

from collections import defaultdict
from contextlib import AbstractContextManager, nullcontext
from typing import Any

import warp as wp


class KeptMemory:
    """An allocator of Warp's that keeps what is given back, for the next array of the same size.

    A solution of MuJoCo Warp makes its scratch arrays anew, and the body of a conditional node of a CUDA graph may not
    allocate. What was made once, outside a graph, is here for all the like that come after; they are made and given
    back in the order of one stream.

    Args:
        device: Where the arrays are; on a CPU Warp allocates as ever.
    """

    def __init__(self, device: Any) -> None:
        self._device = device
        self._source = wp.get_device_allocator(device)
        self._blocks: dict[int, wp.array] = {}
        self._unused: defaultdict[int, list[int]] = defaultdict(list)

    def allocate(self, size_in_bytes: int) -> int:
        """A block of this size [bytes], kept or new."""
        unused = self._unused[size_in_bytes]
        if unused:
            return unused.pop()
        start = self._source.allocate(size_in_bytes)
        if self._device.is_capturing:  # a graph's own, which is gone with it
            return start
        self._blocks[start] = wp.array(
            ptr=start, dtype=wp.uint8, shape=size_in_bytes, device=self._device, deleter=self._source.deallocate
        )
        return start

    def deallocate(self, ptr: int, size_in_bytes: int) -> None:
        """Keep a block for the next of its size."""
        if ptr in self._blocks:
            self._unused[size_in_bytes].append(ptr)
        else:
            self._source.deallocate(ptr, size_in_bytes)

    def used(self) -> AbstractContextManager[Any]:
        """Where Warp's arrays are of this memory, on CUDA."""
        return wp.ScopedAllocator(self._device, self) if self._device.is_cuda else nullcontext()
