"""`wsim warmup`: compile kernels before they are needed."""

from __future__ import annotations

import time

from wsim import sim
from wsim.cli.options import Device
from wsim.cli.show import ConsoleProgress, console


def warmup(device: Device = "auto") -> None:
    """Compile the kernels that most worlds need, side by side, so that a first world need not wait for them."""
    began = time.perf_counter()
    with ConsoleProgress() as progress:
        cache = sim.fill_cache(device, progress)
    console.print(f"the kernels are in {cache}; it took {time.perf_counter() - began:.1f} s", soft_wrap=True)
