"""How many threads linear algebra takes."""

from __future__ import annotations

import contextlib
import functools
import os
from collections.abc import Iterator
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from threadpoolctl import ThreadpoolController

# The judge's matrices have tens to hundreds of rows. OpenBLAS shares them out to all cores, whose threads wait for each
# other by turning round and round: a heap's verdict took 4 to 7 times as much processor time, on two cores.
_ONE = {"OPENBLAS_NUM_THREADS": "1"}


def one_thread() -> None:
    """Let it take one in this process and those that it starts, if nobody has said otherwise.

    NumPy reads it as it is loaded: later calls change nothing.
    """
    for name, count in _ONE.items():
        os.environ.setdefault(name, count)


@contextlib.contextmanager
def in_one_thread() -> Iterator[None]:
    """Let it take one meanwhile, in a process that is not ours alone, if nobody has said otherwise."""
    if _ONE.keys() <= os.environ.keys():
        yield
    else:
        with _libraries().limit(limits=1, user_api="blas"):
            yield


@functools.cache
def _libraries() -> ThreadpoolController:
    """Those that are loaded: to look for them takes 5 ms."""
    import scipy.linalg  # noqa: F401 - has one of its own
    from threadpoolctl import ThreadpoolController

    return ThreadpoolController()
