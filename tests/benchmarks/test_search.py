"""The benchmark of the searches: it counts right, and the shares that were measured hold."""

import pytest

from benchmarks.search import SEARCHES, found, misses


def test_a_right_answer_may_be_a_pattern() -> None:
    assert found("mug bowl", ["chair", "bowl"])
    assert found("wsim.scene.Drive*", ["wsim.scene.Drive.stiffness"])
    assert not found("wsim.scene.Drive", ["wsim.scene.Drive.stiffness"])


def test_every_second_query_is_held_out() -> None:
    cases = dict.fromkeys("abcde", "never")
    assert list(misses(cases, lambda words: [], "tuning")) == ["a", "c", "e"]
    assert list(misses(cases, lambda words: [], "held out")) == ["b", "d"]
    assert misses({"a": "yes", "b": "no"}, lambda words: ["yes"]) == {"b": ["yes"]}


@pytest.mark.parametrize(("name", "most"), [("assets", 6), ("skills", 6), ("API", 20)])
def test_other_words_find_what_they_found(name: str, most: int) -> None:
    cases, search = SEARCHES[name]
    assert len(misses(cases, search)) <= most, misses(cases, search)
