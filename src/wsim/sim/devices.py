"""Warp's devices, started without chatter."""

from __future__ import annotations

import os
import sys
from pathlib import Path
from typing import Any

import warp as wp

from wsim.errors import UserError


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


def pick_device(name: str) -> str:
    """The Warp device that a name means; "auto" is the first CUDA device, or the CPU.

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
