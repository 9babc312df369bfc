"""Of a stage whose skeleton is known to be sound only numbers are checked: that finds what the whole check does."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from wsim.scene import Scene
from wsim.scene.check import check_opened
from wsim.scene.skeleton import KNOWN, skeleton

NUMBER = re.compile(r"(?<![\w.])[-+]?\d[\w.+-]*")


@pytest.mark.parametrize("bad", ["nan", "-1", "1e39", "words"])
def test_numbers_are_held_to_the_same(tmp_path: Path, workshop: Scene, bad: str) -> None:
    sound = workshop.save(tmp_path / "sound.usda")
    lines, changed = sound.read_text().split("\n"), tmp_path / "changed.usda"
    seen: set[str] = set()
    refused = 0
    for k, line in enumerate(lines):
        known = KNOWN.fullmatch(line.encode())
        if not known or (head := known[1].decode()).strip() in seen:
            continue
        seen.add(head.strip())
        changed.write_text("\n".join([*lines[:k], head + NUMBER.sub(bad, line[len(head) :], count=1), *lines[k + 1 :]]))
        assert skeleton(changed) == skeleton(sound)
        whole, numbers = (check_opened(changed, [], known=each)[0] for each in (False, True))
        assert bool(whole) == bool(numbers), (line, whole)
        refused += bool(whole)
    assert refused > len(seen) // 4


def test_a_sound_stage_comes_open(tmp_path: Path, workshop: Scene) -> None:
    problems, stage = check_opened(workshop.save(tmp_path / "sound.usda"), [])
    assert not problems
    assert stage.GetDefaultPrim().GetName() == "World"
