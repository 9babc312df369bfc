"""The door of a package: its names are loaded when they are first used, so that what is heavy waits until then.

    __getattr__ = door(__name__, {"Simulation": "simulation"})

Who imports the package (`from wsim import sim`) pays nothing; `sim.Simulation` loads `wsim.sim.simulation` (PEP 562).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from importlib import import_module
from typing import Any


def door(package: str, homes: Mapping[str, str]) -> Callable[[str], Any]:
    """A module's `__getattr__`.

    Args:
        package: Its name.
        homes: The module inside it that has each name.
    """

    def load(name: str) -> Any:
        if name not in homes:
            raise AttributeError(f"module {package!r} has no attribute {name!r}")
        return getattr(import_module(f"{package}.{homes[name]}"), name)

    return load
