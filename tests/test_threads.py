"""How many threads linear algebra takes while we judge, in a process that is not ours alone."""

import os
import subprocess
import sys

import pytest

SCRIPT = """
import numpy
import scipy.linalg
from threadpoolctl import threadpool_info

def threads():
    return max(library["num_threads"] for library in threadpool_info() if library["user_api"] == "blas")

from wsim.threads import in_one_thread

before = threads()
with in_one_thread():
    meanwhile = threads()
print(before, meanwhile, threads())
"""


@pytest.mark.skipif(os.cpu_count() == 1, reason="one processor has one thread")
@pytest.mark.parametrize("said", [None, "2"])
def test_judging_takes_one_thread_and_gives_the_others_back(said):
    """Unless somebody has said how many."""
    others = {name: value for name, value in os.environ.items() if name != "OPENBLAS_NUM_THREADS"}
    environment = others | ({"OPENBLAS_NUM_THREADS": said} if said else {})
    done = subprocess.run([sys.executable, "-c", SCRIPT], env=environment, capture_output=True, text=True, check=True)
    before, meanwhile, after = map(int, done.stdout.split())
    assert before == after > 1
    assert meanwhile == (before if said else 1)
