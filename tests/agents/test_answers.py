"""The JSON object of an answer, however it is wrapped."""

from __future__ import annotations

import pytest

from wsim.agents.ask import UnusableError, object_in


@pytest.mark.parametrize(
    "answer",
    [
        '{"a": 1}',
        '```json\n{"a": 1}\n```',
        'Here it is:\n```\n{"a": 1}\n```\nDone.',
        'Here: ```JSON\r\n{"a": 1}\r\n```',
        'Sure! {"a": 1} I hope that it helps.',
        '```python\nprint({})\n```\n```json\n{"a":\n1}\n  ```',
        '```json\n{}\n```\n```json\n{"a": 1}\n```',
        '<b>Plan</b>\n<pre>{"a": 1}</pre>',
    ],
)
def test_it_is_found(answer: str) -> None:
    assert object_in(answer) == {"a": 1}


@pytest.mark.parametrize(
    ("answer", "message"),
    [
        ("", "no JSON object in the answer"),
        ("I would rather not.", "no JSON object in the answer"),
        ("} {", "not JSON"),
        ("```json\n```", "no JSON object in the answer"),
        ("```json\n[1, 2]\n```", "must be one JSON object"),
        ("{'a': 1}", "not JSON"),
        ('{"a": 1', r"it breaks off: the answer was cut; give a shorter one\); give one whole JSON object"),
        ('```json\n{"objects": [{"name": "crate", "size": [0.4,', "it breaks off"),
        ('{"a": ' * 50_000, "not JSON"),
        ('{"a": ' + "9" * 5000 + "}", "not JSON"),
        ("<html><body>502 Bad Gateway</body></html>", "no JSON object"),
    ],
)
def test_what_is_wrong_is_said(answer: str, message: str) -> None:
    with pytest.raises(UnusableError, match=message) as caught:
        object_in(answer)
    assert len(str(caught.value)) < 300


@pytest.mark.timeout(300)
@pytest.mark.parametrize("line", ["x```\n", "```json\n", "{", "}", "```json\n{\n"])
def test_an_answer_that_repeats_itself_is_read(line: str) -> None:
    with pytest.raises(UnusableError):
        object_in(line * 100_000)
