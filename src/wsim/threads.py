"""How many threads linear algebra takes."""

from __future__ import annotations

import os

# The judge's matrices have tens to hundreds of rows. OpenBLAS shares them out to all cores, whose threads wait for each
# other by turning round and round: a heap's verdict took 4 to 7 times as much processor time, on two cores.
_ONE = {"OPENBLAS_NUM_THREADS": "1"}


def one_thread() -> None:
    """Let it take one in this process and those that it starts, if nobody has said otherwise.

    NumPy reads it as it is loaded: later calls change nothing.
    """
    for name, count in _ONE.items():
        os.environ.setdefault(name, count)
