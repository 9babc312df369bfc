"""Warp's devices, started without chatter."""

from __future__ import annotations

import os
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import warp as wp

from wsim.errors import UserError
from wsim.progress import Progress, silent
from wsim.scene.world import World


def start_warp() -> None:
    """Initialise Warp silently; later calls do nothing.

    On a machine without a CUDA driver its C code writes a warning straight to standard error, which no setting of
    Warp's stops, so the descriptor points elsewhere for that moment.
    """
    wp.config.log_level = wp.LOG_WARNING
    sys.stderr.flush()
    kept = os.dup(2)
    with Path(os.devnull).open("wb") as nowhere:
        os.dup2(nowhere.fileno(), 2)
        try:
            wp.init()
        finally:
            os.dup2(kept, 2)
            os.close(kept)


def steps_in_c(device: Any, world_count: int) -> bool:
    """Whether MuJoCo's own C code steps the bodies: one world on a CPU."""
    return world_count <= 1 and not wp.get_device(device).is_cuda


def cuda_devices() -> list[str]:
    """The CUDA devices of this machine."""
    start_warp()
    return [str(device) for device in wp.get_devices() if device.is_cuda]


def choose_device(cuda: Sequence[str], world: World, world_count: int = 1) -> tuple[str, str]:
    """The device that is quicker for a world, and why in a line.

    Bodies alone, one world of them, are stepped by MuJoCo's C code in tenths of a millisecond, which a GPU's kernels do
    not reach, and which compiles none. A fluid's particles and the worlds of a batch are what a GPU steps at once.

    Args:
        cuda: The CUDA devices that are here.
        world: What is to be simulated.
        world_count: Worlds simulated at once.
    """
    if not cuda:
        return "cpu", "cpu: no CUDA device is here"
    if world.fluids:
        return cuda[0], f"{cuda[0]}: a fluid"
    if world_count > 1:
        return cuda[0], f"{cuda[0]}: {world_count:,} worlds at once"
    return "cpu", "cpu: rigid bodies alone, one world"


def pick_device(name: str, world: World, world_count: int = 1, progress: Progress = silent) -> str:
    """The Warp device that a name means; "auto" is what `choose_device` takes.

    Args:
        name: "auto", "cpu", "cuda:0", ….
        world: What is to be simulated.
        world_count: Worlds simulated at once.
        progress: Told what "auto" took, and why, where there was a choice.

    Raises:
        UserError: If there is no such device.
    """
    if name != "auto":
        return known_device(name)
    cuda = cuda_devices()
    device, why = choose_device(cuda, world, world_count)
    if cuda:
        progress(why, 1, 1)
    return device


def known_device(name: str) -> str:
    """The Warp device of a name, whatever the world; "auto" is the first CUDA device, or the CPU.

    Raises:
        UserError: If there is no such device.
    """
    start_warp()
    known = [str(device) for device in wp.get_devices()]
    if name == "auto":
        return next((device for device in known if device.startswith("cuda")), "cpu")
    if name == "cuda":
        name = "cuda:0"
    if name not in known:
        raise UserError(f"device {name!r} is not here; this machine has {', '.join(known)}")
    return name
