"""A process that waits for a program runs nothing else."""

from __future__ import annotations

from pathlib import Path

import pytest

from wsim.runs.standby import Standby


def test_what_lies_in_the_current_folder_is_not_run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "wsim.py").write_text("open('ran', 'w').close()\n")
    monkeypatch.chdir(tmp_path)
    with Standby() as waiting:
        assert waiting.process.stdin is not None
        waiting.process.stdin.close()
        waiting.process.wait(timeout=120.0)
    assert not (tmp_path / "ran").exists()
