"""Documents are ranked by rare words, where they stand, and words of one meaning; a slip finds what was meant."""

import sqlite3
from pathlib import Path

import pytest

from wsim.search.ranking import SLIP, Ranking, meant
from wsim.search.vocabulary import RELATED, Vocabulary

WEIGHTS = {"name": 3.0, "text": 1.0}
DOCUMENTS = [
    ("hinge", "turns about an axis"),
    ("slider", "moves along an axis, as no hinge"),
    ("weld", "holds"),
    ("motor", "drives"),
    ("lamp", "shines"),
    ("pivot", "turns; a hinge"),
]
VOCABULARY = Vocabulary("an as no about along", ["hinge pivot", "lamp light", "water fluid"])


@pytest.fixture
def ranking() -> Ranking:
    documents = ((i, [VOCABULARY.stems(text) for text in texts]) for i, texts in enumerate(DOCUMENTS))
    return Ranking.create(sqlite3.connect(":memory:"), WEIGHTS, documents)


def order(scores: dict[int, float]) -> list[str]:
    return [DOCUMENTS[i][0] for i in sorted(scores, key=lambda i: -scores[i])]


def test_a_name_counts_more_than_a_text(ranking: Ranking) -> None:
    assert order(ranking.having("hing")) == ["hinge", "pivot", "slider"]
    assert ranking.having("elephant") == {}


def test_a_rare_word_counts_more(ranking: Ranking) -> None:
    assert ranking.having("weld")[2] > ranking.having("hing")[0]


def test_words_of_one_meaning_find_it_and_add_less_than_two_words_do(ranking: Ranking) -> None:
    either = meant("pivot", VOCABULARY, ranking)
    assert either == {"pivot": 1.0, "hing": RELATED}
    scores = ranking.scores(either)
    assert order(scores) == ["pivot", "hinge", "slider"]
    alone, other = ranking.having("pivot")[5], RELATED * ranking.having("hing")[5]
    assert max(alone, other) < scores[5] < alone + other


def test_a_word_that_only_the_vocabulary_has_finds_what_means_it(ranking: Ranking) -> None:
    assert order(ranking.scores(meant("light", VOCABULARY, ranking))) == ["lamp"]


def test_a_slip_counts_less(ranking: Ranking) -> None:
    assert meant("wald", VOCABULARY, ranking) == {}, "too short to tell"
    assert meant("motar", VOCABULARY, ranking) == {"motor": SLIP}
    assert meant("pivott", VOCABULARY, ranking) == {"pivot": SLIP, "hing": SLIP * RELATED}
    assert meant("xylophone", VOCABULARY, ranking) == {}


def test_the_words_of_two_rankings_are_no_slips(ranking: Ranking) -> None:
    other = Ranking.create(sqlite3.connect(":memory:"), {"name": 1.0}, [(0, [["motar"]])])
    assert meant("motar", VOCABULARY, ranking, other) == {"motar": 1.0}


def test_a_vocabulary_file_is_read_with_the_spellings_that_all_know(tmp_path: Path) -> None:
    file = tmp_path / "vocabulary.toml"
    file.write_text('small = "the"\nsame = ["hinge pivot"]\n', encoding="utf-8")
    read = Vocabulary.read(file)
    assert read.related("color") == {"colour"}
    assert read.related("hing") == {"pivot"} and "hing" not in read.related("hing")
    assert read.stems("the Hinges, a pivot") == ["hing", "pivot"]
