import signal
import subprocess
import sys
from pathlib import Path

import pytest

from tests.children import started
from tests.patience import STUCK, until


@pytest.fixture
def background() -> None:
    """SIGINT is ignored, as in what a shell starts in the background."""
    before = signal.signal(signal.SIGINT, signal.SIG_IGN)
    yield
    signal.signal(signal.SIGINT, before)


def test_a_child_hears_ctrl_c_though_the_tests_do_not(background: None) -> None:
    with started(["sleep", f"{2 * STUCK:.0f}"]) as process:
        process.send_signal(signal.SIGINT)
        assert process.wait(timeout=STUCK) == -signal.SIGINT
    assert signal.getsignal(signal.SIGINT) is signal.SIG_IGN


def test_what_a_child_started_is_gone_when_a_test_fails() -> None:
    code = f"import subprocess; print(subprocess.Popen(['sleep', '{2 * STUCK:.0f}']).pid, flush=True); input()"
    pipe = subprocess.PIPE
    with (
        pytest.raises(ZeroDivisionError),
        started([sys.executable, "-c", code], stdin=pipe, stdout=pipe) as process,
    ):
        grandchild = int(process.stdout.readline())
        1 / 0  # noqa: B018
    state = Path(f"/proc/{grandchild}/stat")
    until(lambda: not state.exists() or state.read_text().rsplit(")", 1)[1].split()[0] == "Z")
