"""The final window, and the run that is long enough for it."""

from __future__ import annotations

import pytest

from wsim.judge.evidence.final_window import final_window, span_for


@pytest.mark.parametrize(("span", "length"), [(1.0, 0.5), (2.0, 1.0), (3.0, 1.0), (4.0, 1.0), (12.0, 3.0)])
def test_it_is_a_second_or_a_quarter_and_never_more_than_half(span: float, length: float) -> None:
    assert final_window(span) == length


@pytest.mark.parametrize("begins", [0.3, 1.0, 2.0, 3.0, 8.0, 10.2])
def test_a_run_for_it_has_it_begin_there(begins: float) -> None:
    span = span_for(begins)
    assert span - final_window(span) == pytest.approx(begins)
