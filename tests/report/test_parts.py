from __future__ import annotations

import math
import re
from html import unescape

import numpy as np
import pytest

from wsim.judge.verdict import Finding
from wsim.plan.schema import Relation
from wsim.report.chart import MOST_POINTS, Chart, Mark, Series, ticks
from wsim.report.numbers import digits_to_tell_apart, number, quantity
from wsim.report.source import SourceLine, source_lines
from wsim.report.text import describe_relation, duration, limit_word, program_line, table_numbers


@pytest.mark.parametrize(
    ("x", "text"),
    [
        (None, ""),
        (0.0, "0"),
        (0.15149, "0.151"),
        (0.1500, "0.15"),
        (-0.0213, "−0.0213"),
        (7850.4, "7850"),
        (123456.0, "123\u202f456"),
        (9.9996, "10"),
        (999999.7, "1 × 10⁶"),
        (1.3e-6, "1.3 × 10⁻⁶"),
        (-math.inf, "−∞"),
        (math.nan, "not a number"),
    ],
)
def test_numbers_have_three_digits(x: float | None, text: str) -> None:
    assert number(x) == text


def test_a_sign_and_a_unit() -> None:
    assert quantity(0.01, "kg/m^3", sign=True) == "+0.01\u00a0kg/m³"
    assert quantity(None, "m") == "" and quantity(2.0, "1") == "2"


def test_a_value_just_over_its_limit_does_not_look_equal_to_it() -> None:
    assert digits_to_tell_apart([0.10004, 0.1]) == 5
    assert digits_to_tell_apart([0.2, 0.1, None, math.nan]) == 3
    row = table_numbers(Finding(check="c", passed=False, message="", value=0.10004, limit=0.1, margin=-0.00004))
    assert row["value"] == "0.10004" and row["limit"] == "≤ 0.1"


@pytest.mark.parametrize(
    ("numbers", "word"),
    [
        ({"value": 0.2, "limit": 0.1, "margin": -0.1}, "at most"),
        ({"value": 0.2, "limit": 0.1, "margin": 0.1}, "at least"),
        ({"value": 0.2, "limit": 0.01, "expected": 0.205, "margin": 0.005}, "off by at most"),
        ({"value": 0.0, "limit": 0.01, "expected": 0.0, "margin": 0.01}, "at most"),
        ({"value": 0.1, "limit": 0.1, "margin": 0.0}, "limit"),
        ({"value": 0.2, "limit": 0.1}, "limit"),
        ({"value": 0.2, "limit": 0.1, "margin": 7.0}, "limit"),
    ],
)
def test_the_margin_tells_how_the_limit_bounds(numbers: dict[str, float], word: str) -> None:
    assert limit_word(Finding(check="c", passed=True, message="", **numbers)) == word


def test_a_line_is_the_programs_only_if_it_has_it() -> None:
    def line(text: str | None) -> int | None:
        return program_line(Finding(check="c", passed=False, message="", line=text), {"program.py"}, 20)

    assert line("program.py:20") == 20
    assert [line(text) for text in (None, "program.py:21", "program.py:0", "other.py:3", "program.py")] == [None] * 5


def test_durations_and_relations_in_words() -> None:
    assert duration(61.84) == "61.8\u00a0s" and duration(191.0) == "3\u00a0min 11\u00a0s" and duration(None) == ""
    assert duration(179.7) == "3\u00a0min 00\u00a0s"
    assert (
        describe_relation(Relation(predicate="FRONT-OF", ref="block", gap=0.1)) == "in front of block, gap 0.1\u00a0m"
    )


@pytest.mark.parametrize(("low", "high"), [(0.0, 3.0), (-0.21, 0.33), (1e-9, 4e-9), (99.0, 101.0), (-1e6, 2e6)])
def test_ticks_are_few_and_inside(low: float, high: float) -> None:
    found = ticks(low, high)
    assert 3 <= len(found) <= 9
    assert low - 1e-9 * abs(high) <= found[0] and found[-1] <= high + 1e-9 * abs(high)
    assert np.allclose(np.diff(found), found[1] - found[0])


def test_a_chart_draws_gaps_expected_values_and_moments() -> None:
    time = np.linspace(0.0, 2.0, 21)
    value = 0.1 * time
    value[10] = np.nan
    series = Series("<b>", time, value, 0, expected=0.15)
    svg = str(Chart("depth", "m", [series], [Mark("#3", 1.5, (2.0, 0.3))], downwards=True).svg)
    assert svg.count("<polyline") == 2 and svg.count('class="expected') == 1
    assert svg.count("<circle") == 1 and "#3" in svg and "<b>" not in svg and "nan" not in svg
    points = [tuple(map(float, point.split(","))) for point in svg.split('points="')[1].split('"')[0].split()]
    assert points[-1][1] > points[0][1]  # deeper is lower on the page


def test_many_points_are_thinned_without_losing_a_peak() -> None:
    value = np.zeros(20_000)
    value[12_345] = 1.0
    svg = str(Chart("speed", "m/s", [Series("a", np.arange(20_000) / 100, value)]).svg)
    points = svg.split('points="')[1].split('"')[0].split()
    assert len(points) <= MOST_POINTS + 2
    heights = {point.split(",")[1] for point in points}
    assert len(heights) == 2


@pytest.mark.parametrize("value", [np.zeros(5), np.full(5, np.nan), np.full(5, 3.7), np.array([np.inf, 1, 2, 3, 4])])
def test_charts_of_odd_values_are_whole(value: np.ndarray) -> None:
    svg = str(Chart("energy", "J", [Series("a", np.arange(5.0), value)], zero=" ").svg)
    assert svg.endswith("</svg>") and "nan" not in svg and "inf" not in svg


@pytest.mark.parametrize("most", [2.4e-5, 3e-4, 2e-3, 0.7, 123.0, 45_000.0, 8e5, 3e6, 1e9, -4e-7])
def test_an_axis_has_short_labels_and_one_power_of_ten(most: float) -> None:
    svg = str(Chart("depth", "mm", [Series("a", np.arange(5.0), np.linspace(0.0, most, 5))], zero=" ").svg)
    labels = re.findall(r'<text class="tick end"[^>]*>([^<]*)</text>', svg)
    assert max(map(len, labels)) <= 7  # what its margin has room for
    assert not any("×" in label for label in labels)
    assert svg.count("×") == (0 if 1e-3 <= abs(most) < 1e5 else 1)


def text_of(line: SourceLine) -> str:
    return unescape(re.sub("<[^>]*>", "", line.html))


def test_source_keeps_every_character_and_colours_tokens() -> None:
    program = 'def f(x):\n    """doc\n    more"""\n    return f"{x}" + "<i>"  # end\n'
    lines = source_lines(program, {4: [2]})
    assert [text_of(line) for line in lines] == program.splitlines()
    assert [line.number for line in lines] == [1, 2, 3, 4] and lines[3].failed == [2]
    assert '<span class="k">def</span>' in lines[0].html
    assert '<span class="sd">    more"""</span>' in lines[2].html
    assert '<span class="c1"># end</span>' in lines[3].html


def test_source_that_does_not_parse_is_shown_as_it_is() -> None:
    lines = source_lines("def f(:\n  '''open\n\tx < y", {})
    assert [text_of(line) for line in lines] == ["def f(:", "  '''open", "    x < y"]
