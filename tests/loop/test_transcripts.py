"""Recorded runs with language models, made again offline: the same programs, and the same ends.

What models were asked hangs on prompts and skills, which grow; what they answered is what was recorded. So the replies
must lead to the same patches and programs, byte for byte, and each program must come as far as it did. Which findings
fail on the way is the judge's affair, which learns.

A first draft without the `control` that its plan asks for now ends before it is simulated, and no judge is asked of it:
what was recorded of that judge is left out of `model_errors`. All others are as they were.
"""

import json
from pathlib import Path

import pytest

from wsim.loop.replay import replay

FOLDER = Path(__file__).parents[1] / "transcripts"
# Recorded before blows, friction and stops were as hard as they are: of its failing programs another is the best now,
# and what the coder was asked then is another thing from there on.
MOVED_ON = {"gave_up"}
RECORDED = sorted(path.parent for path in FOLDER.glob("*/run.json"))


@pytest.mark.parametrize("recorded", RECORDED, ids=lambda path: path.name)
def test_a_recorded_run_is_made_again(recorded: Path, tmp_path: Path) -> None:
    again = replay(recorded, tmp_path, device="cpu")
    before = json.loads((recorded / "run.json").read_text(encoding="utf-8"))
    after = again.generated.run.facts()
    assert after["status"] == before["status"], (after["summary"], again.divergences[:3])
    rows = [[(row["reached"], row["kept"]) for row in run["iterations"]] for run in (after, before)]
    if recorded.name in MOVED_ON:
        assert [reached for reached, _ in rows[0]] == [reached for reached, _ in rows[1]][: len(rows[0])]
        return
    assert after.get("best") == before.get("best")
    assert rows[0] == rows[1]
    assert [line for line in again.differing if "program.py" in line or "patch.diff" in line] == []
    left = [line for line in again.divergences if "were not asked for" in line]
    assert not any(role in line for line in left for role in ("planner", "coder", "reviewer"))


def test_what_was_recorded_covers_what_can_happen() -> None:
    runs = [json.loads((path / "run.json").read_text(encoding="utf-8")) for path in RECORDED]
    lines = [
        json.loads(line)
        for path in RECORDED
        for line in (path / "transcript.jsonl").read_text(encoding="utf-8").splitlines()
    ]
    assert {run["status"] for run in runs} == {"accepted", "blocked"}
    assert max(len(run["iterations"]) for run in runs) >= 4  # three repairs
    assert any("picture" in str(line.get("messages")) and line["role"] == "reviewer" for line in lines)
    assert {line["error"]["kind"] for line in lines if "error" in line} >= {"rate limit", "server", "timeout"}
    assert any("repair" in str(line.get("messages")) and line["role"] == "coder" for line in lines)
