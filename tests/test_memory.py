"""What memory is left."""

from pathlib import Path

import pytest

from wsim.memory import free_memory


def test_of_this_machine_it_is_a_part() -> None:
    assert 1e7 < free_memory() < 1e14


@pytest.mark.parametrize(("most", "left"), [("max", 2048e3), ("3000000", 1e6), ("1000", 0.0)])
def test_the_less_of_the_machines_and_the_groups(tmp_path: Path, most: str, left: float) -> None:
    (tmp_path / "meminfo").write_text("MemTotal: 9000 kB\nMemAvailable:    2000 kB\n")
    (tmp_path / "memory.max").write_text(f"{most}\n")
    (tmp_path / "memory.current").write_text("2000000\n")
    assert free_memory(tmp_path / "meminfo", tmp_path) == left
