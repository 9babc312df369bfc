"""A Ctrl-C is raised once more where Python would drop it, and nothing of it is printed."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from tests.patience import STUCK

PROGRAM = """
import os, signal, sys, time
from wsim.cli.interrupts import keep_interrupts

def press():
    os.kill(os.getpid(), signal.SIGINT)

def report(dropped):
    press()
    time.sleep(0.05)  # the signal comes here, at the latest
    print("reported", dropped.exc_type.__name__)

class Deleted:
    def __del__(self):
        {deleted}

sys.unraisablehook = report
keep_interrupts()
try:
    Deleted()
    time.sleep(5.0)
    print("lost")
except KeyboardInterrupt:
    print("stopped")
"""


@pytest.mark.parametrize(
    ("deleted", "said"),
    [("press(); time.sleep(0.05)", "stopped\n"), ("raise ValueError", "reported ValueError\nstopped\n")],
)
def test_while_an_object_is_deleted_or_what_that_raised_is_reported(deleted: str, said: str) -> None:
    command = [sys.executable, "-c", PROGRAM.format(deleted=deleted)]
    ended = subprocess.run(command, capture_output=True, text=True, timeout=STUCK, check=False)
    assert (ended.returncode, ended.stdout, ended.stderr) == (0, said, "")


CAUGHT = """
import sys
from wsim.cli.interrupts import ignore_interrupts

try:
    exec("raise KeyboardInterrupt")
except KeyboardInterrupt:
    ignore_interrupts()
sys.exit(130)
"""


def test_the_exit_code_is_kept_wherever_it_came(tmp_path: Path) -> None:
    (tmp_path / "caught.py").write_text(CAUGHT)
    command = [sys.executable, "-m", "caught"]
    assert subprocess.run(command, cwd=tmp_path, timeout=STUCK, check=False).returncode == 130
