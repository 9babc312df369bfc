"""The door of a package: its names are loaded when they are first used, so that what is heavy waits until then.

    __getattr__ = door(__name__, {"Simulation": "simulation"})

Who imports the package (`from wsim import sim`) pays nothing; `sim.Simulation` loads `wsim.sim.simulation` (PEP 562).
`dir(sim)` lists what is behind the door and loads none of it.
"""

from __future__ import annotations

import gc
import os
import sys
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, suppress
from importlib import import_module
from threading import Thread
from types import ModuleType
from typing import Any

_lasts = False  # what is loaded is kept from all later searches for garbage


def keep_what_loads() -> None:
    """Say that this process is wsim's own: what is loaded from here on stays, and no search for garbage looks at it.

    Each full one would go through all that Newton made, for the better part of a second, and a run has several. Who
    uses wsim as a library decides that alone: with what is loaded, all that is there at the time is kept. Nor does such
    a process draw with MuJoCo, whose windows take a third of its loading: it is told to leave them out.
    """
    global _lasts
    _lasts = True
    os.environ.setdefault("MUJOCO_GL", "disable")


@contextmanager
def unsearched() -> Iterator[None]:
    """Load without looking for garbage on the way.

    A package such as Newton makes a million objects as it loads and drops none of them, and Python's collector goes
    through all that there are again and again: a third of the time.
    """
    collects = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if _lasts:
            gc.freeze()
        if collects:
            gc.enable()


def load_module(name: str) -> ModuleType:
    """Import a module, unsearched."""
    with unsearched():
        return import_module(name)


def load_beside(name: str) -> None:
    """Load a module in a thread while this one goes on. Who imports it before it is there waits, and sees its errors.

    What both load at a time must not import one another.
    """
    do_beside(lambda: load_module(name), f"loads {name}")


def do_beside(call: Callable[[], object], name: str) -> None:
    """Do in a thread what only takes time, while this one goes on; if it fails, who needs it will see why."""

    def do() -> None:
        with suppress(Exception):
            call()

    Thread(target=do, name=name, daemon=True).start()


def door(package: str, homes: Mapping[str, str]) -> Callable[[str], Any]:
    """A module's `__getattr__`; the module is given a `__dir__`, too.

    Args:
        package: Its name.
        homes: The module inside it that has each name; "module.other" where it is called otherwise there.
    """

    def load(name: str) -> Any:
        if name not in homes:
            raise AttributeError(f"module {package!r} has no attribute {name!r}")
        home, _, other = homes[name].partition(".")
        return getattr(load_module(f"{package}.{home}"), other or name)

    module = sys.modules[package]
    module.__dict__["__dir__"] = lambda: sorted({*module.__dict__, *homes})
    return load
