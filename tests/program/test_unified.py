"""Unified diffs as edits: what `diff` writes of two programs makes the one of the other."""

from __future__ import annotations

import difflib

import pytest
from hypothesis import given
from hypothesis import strategies as st

from wsim.program.patch import Edit, PatchError, apply, diff, parse
from wsim.program.unified import edits_of

LINES = [f"    scene.call_{k}({k})" for k in range(40)]


@given(
    gone=st.sets(st.integers(0, 39), max_size=6),
    put=st.dictionaries(
        st.integers(0, 39), st.sampled_from(["    # <- new", "    @@ = 1", "    -- x", "+++ y"]), max_size=6
    ),
    context=st.integers(1, 4),
)
def test_a_diff_of_two_programs_makes_the_one_of_the_other(gone, put, context: int) -> None:
    after = []
    for k, line in enumerate(LINES):
        after += [put[k]] if k in put else []
        after += [] if k in gone else [line]
    before, wanted = "".join(f"{x}\n" for x in LINES), "".join(f"{x}\n" for x in after)
    if before == wanted:
        return
    made = difflib.unified_diff(before.splitlines(True), wanted.splitlines(True), "a.py", "b.py", n=context)
    assert apply(before, edits_of("".join(made))) == wanted
    assert apply(before, edits_of("diff --git a/a.py b/a.py\nindex 1..2 100644\n" + diff(before, wanted))) == wanted


def test_a_file_that_ends_without_a_line_feed_is_read() -> None:
    text = "--- a\n+++ b\n@@ -1,2 +1,2 @@\n a\n-b\n\\ No newline at end of file\n+c\n\\ No newline at end of file\n"
    assert edits_of(text) == [Edit("a\nb\n", "a\nc\n")]
    assert edits_of(text.replace("\n", "\r\n")) == [Edit("a\nb\n", "a\nc\n")]


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("@@ -1,3 +1,3 @@\n a\n-b\n", "hunk 1 ends after"),
        ("@@ -1,2 +1,2 @@\n a\n-b\n+c\n@@ -9,2 +9,3 @@\n a\nx = 1\n", "hunk 2 ends after"),
        ("--- a\n+++ a\n@@ -1 +1 @@\n-a\n+b\n--- c\n+++ c\n@@ -1 +1 @@\n-a\n+b\n", "it changes 2 files"),
        ("I would lower it.", "no edit"),
    ],
)
def test_what_is_no_diff_of_one_file_is_said(text: str, said: str) -> None:
    with pytest.raises(PatchError, match=said):
        edits_of(text)


def test_blocks_are_read_as_they_are_elsewhere() -> None:
    text = "<<<<<<< SEARCH\n@@ -1 +1 @@\n=======\nb\n>>>>>>> REPLACE\n"
    assert edits_of(text) == parse(text)
