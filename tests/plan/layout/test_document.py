"""docs/predicates.md names every predicate, template and view, and tests and pictures that are there."""

import re
from pathlib import Path

import pytest

from wsim.plan.schema import PREDICATES
from wsim.plan.schema.draft import VIEWS

ROOT = Path(__file__).parents[3]
TEXT = (ROOT / "docs" / "predicates.md").read_text(encoding="utf-8")
ROWS = re.findall(r"^\| `([^`]+)` \| (.*?) \| (.*) \| \[(test_\w+)\]\(\.\./([\w/]+\.py)\) \|$", TEXT, re.MULTILINE)


def test_every_row_of_the_schema_is_there():
    views = [*VIEWS, *(f"{view}_room" for view in VIEWS)]
    assert sorted(name for name, *_ in ROWS) == sorted([*PREDICATES, *views])


@pytest.mark.parametrize("name", PREDICATES)
def test_arguments_and_meaning_are_the_tables(name):
    [(said, means)] = [(arguments, means) for row, arguments, means, *_ in ROWS if row == name]
    spec = PREDICATES[name]
    assert re.findall(r"`(\w+)`(\??)", said) == [(a, "") for a in spec.needs] + [(a, "?") for a in spec.takes]
    assert means == spec.means


@pytest.mark.parametrize(("test", "path"), sorted({(test, path) for *_, test, path in ROWS}))
def test_the_tests_are_there(test, path):
    assert f"\ndef {test}(" in (ROOT / path).read_text(encoding="utf-8")


def test_pictures_are_there_and_small():
    pictures = re.findall(r"\]\((images/predicates/\w+\.png)\)", TEXT)
    assert len(pictures) == 6
    assert all((ROOT / "docs" / path).stat().st_size < 200_000 for path in pictures)
