"""Launches that come again and again with the same arguments, on a CPU.

There a small world's kernel runs for a microsecond or two, and Warp takes 2 to 4 more an argument to look at each and
to pack it: 0.1 ms for the 26 of a step of loose bodies, as much as all else of a step of such a world takes in C.
"""

from __future__ import annotations

from typing import Any

import warp as wp

MOST = 64  # launches that are kept: a state to read and one to write, by a few lengths of step


class Packed:
    """Launches kernels on a device; on a CPU their arguments are packed once.

    Args:
        device: Warp's.
    """

    def __init__(self, device: Any) -> None:
        self._device = wp.get_device(device)
        self._kept: dict[tuple[Any, ...], Any] = {}

    def launch(
        self, kernel: wp.Kernel, dim: int | tuple[int, ...], inputs: list[Any], outputs: list[Any], changing: Any = ()
    ) -> None:
        """Launch a kernel.

        Args:
            kernel: As `wp.launch` takes it, likewise the next three.
            dim: Numbers of threads.
            inputs: Arguments.
            outputs: Those that are written.
            changing: Of the arguments all numbers and arrays that are not the same in each call with this kernel. Of
                arrays only where their memory is counts: a launch keeps the ones that it had.
        """
        if not self._device.is_cpu:
            wp.launch(kernel, dim=dim, inputs=inputs, outputs=outputs, device=self._device)
            return
        if dim == 0 or (isinstance(dim, tuple) and 0 in dim):
            return
        key = (kernel, dim, *(each.ptr if isinstance(each, wp.array) else each for each in changing))
        command = self._kept.get(key)
        if command is None:
            command = wp.launch(kernel, dim=dim, inputs=inputs, outputs=outputs, device=self._device, record_cmd=True)
            if command is None:  # in a rehearsal (`wsim.sim.compiling`), of which nothing is kept
                return
            if len(self._kept) >= MOST:
                self._kept.clear()
            self._kept[key] = command
        command.launch()
