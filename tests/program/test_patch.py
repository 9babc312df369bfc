"""Edits of a program: found once each, all of them or none, and what is said where one does not fit."""

from __future__ import annotations

import re

import pytest
from hypothesis import given
from hypothesis import strategies as st

from wsim.program.patch import Edit, PatchError, apply, diff, parse

PROGRAM = """\
from wsim.scene import Scene


def build(scene: Scene) -> None:
    scene.ground()
    scene.box("crate", size=(0.4, 0.4, 0.4), density=600.0, position=(0.0, 0.0, 0.2))
    scene.box("block", size=(0.2, 0.2, 0.2), density=600.0, position=(1.0, 0.0, 0.1))
    scene.simulation(duration=1.0)
"""


def block(search: str, replace: str) -> str:
    return f"<<<<<<< SEARCH\n{search}=======\n{replace}>>>>>>> REPLACE\n"


def refused(text: str, *edits: Edit) -> str:
    with pytest.raises(PatchError) as caught:
        apply(text, edits)
    return str(caught.value)


def test_blocks_are_found_among_words() -> None:
    one, two, three = block("a\nb\n", "c\n"), block("d\n", ""), block("", "e\n")
    answer = f"It is too short.\n\n{one}\nand\n```\n{two}```\n{three}"
    assert parse(answer) == [Edit("a\nb\n", "c\n"), Edit("d\n", ""), Edit("", "e\n")]


def test_marks_may_be_longer_or_shorter_and_lines_may_end_as_on_windows() -> None:
    assert parse("<<<<< SEARCH\na\n=====\nb\n>>>>>>>>> REPLACE") == [Edit("a\n", "b\n")]
    assert parse(block("a\n", "b\n").replace("\n", "\r\n")) == [Edit("a\n", "b\n")]
    assert parse(block("if a == b:  # <<<<<<< SEARCH\n", "x = '=======' \n")) == [
        Edit("if a == b:  # <<<<<<< SEARCH\n", "x = '=======' \n")
    ]


@pytest.mark.parametrize(
    ("answer", "message"),
    [
        ("", "no edit: give at least one block"),
        ("I would lower the friction.", "no edit: give at least one block"),
        (block("a\n", "b\n")[:-2], "1 of 1 edits has no end"),
        ("<<<<<<< SEARCH\na\n>>>>>>> REPLACE\n", "1 of 1 edits has no end"),
        ("<<<<<<< SEARCH\na\n=======\nb\n" + block("c\n", "d\n"), "1 of 2 edits has no end"),
        (block("c\n", "d\n") + "<<<<<<< SEARCH\na\n=======\nb", "1 of 2 edits has no end"),
    ],
)
def test_what_is_no_edit_is_said(answer: str, message: str) -> None:
    with pytest.raises(PatchError, match=message):
        parse(answer)


@pytest.mark.parametrize("line", ["<<<<<<< SEARCH\n", "=======\n", ">>>>>>> REPLACE\n", "<<<<<<< SEARCH\na\n=======\n"])
@pytest.mark.timeout(300)  # a reader that looks on from each mark takes far longer
def test_a_model_that_repeats_itself_is_read(line: str) -> None:
    with pytest.raises(PatchError):
        parse(line * 100_000)


def test_lines_found_once_are_replaced_and_nothing_else() -> None:
    made = apply(PROGRAM, [Edit("    scene.simulation(duration=1.0)\n", "    scene.simulation(duration=2.0)\n")])
    assert made == PROGRAM.replace("duration=1.0", "duration=2.0")
    assert apply(PROGRAM, [Edit("    scene.ground()\n", "")]) == PROGRAM.replace("    scene.ground()\n", "")


def test_edits_are_made_in_order() -> None:
    edits = [Edit("duration=1.0", "duration=2.0"), Edit("duration=2.0", "duration=3.0"), Edit('"crate"', '"chest"')]
    assert apply(PROGRAM, edits) == PROGRAM.replace("duration=1.0", "duration=3.0").replace("crate", "chest")


def test_all_edits_are_made_or_none() -> None:
    good, bad = Edit("duration=1.0", "duration=2.0"), Edit("scene.sphere(", "scene.box(")
    assert refused(PROGRAM, good, bad).startswith("edit 2 of 2: these lines are not in the program: 'scene.sphere('")
    assert "edit 2 of 2" in refused(PROGRAM, good, good)  # the first has taken away what the second searches for


def test_what_is_not_there_is_answered_with_what_comes_nearest() -> None:
    wanted = PROGRAM[PROGRAM.index("    scene.box") :].replace("crate", "create").rpartition("    scene.simulation")[0]
    told = refused(PROGRAM, Edit(wanted, ""))
    near = "\\n".join(PROGRAM.splitlines()[5:7])
    assert f"nearest: line 6: '{near}'" in told


def test_what_is_there_twice_is_answered_with_its_lines() -> None:
    twice = "a = 1\nb = 2\na = 1\n"
    assert "found more than once, at lines 1, 3; give more lines" in refused(twice, Edit("a = 1", "a = 2"))
    assert "found more than once, at lines 6, 7" in refused(PROGRAM, Edit("density=600.0", "density=700.0"))
    assert "found more than once, at lines 1" in refused("a = (1, 1)\n", Edit("1", "2"))
    assert apply(twice, [Edit("b = 2\na = 1", "c = 3")]) == "a = 1\nc = 3\n"


def test_an_empty_search_fits_an_empty_program_alone() -> None:
    assert "the search is empty" in refused(PROGRAM, Edit("", "x = 1\n"))
    assert "the search is empty" in refused(PROGRAM, Edit("  \n\n", "x = 1\n"))
    assert apply("\n", [Edit("", PROGRAM)]) == PROGRAM


def test_blanks_at_the_ends_of_lines_do_not_count() -> None:
    spaced = PROGRAM.replace("scene.ground()\n", "scene.ground()  \t\n")
    made = apply(spaced, [Edit("    scene.ground()   \n", "    scene.ground(friction=0.5)\n")])
    assert made == PROGRAM.replace("ground()", "ground(friction=0.5)")
    assert "not in the program" in refused(PROGRAM, Edit("  scene.ground()\n    scene.box(", ""))  # those in front do


def test_lines_that_end_as_on_windows_are_the_same_lines() -> None:
    windows = PROGRAM.replace("\n", "\r\n")
    edit = Edit("    scene.ground()\r\n", "    scene.ground(friction=0.5)\r\n")
    expected = PROGRAM.replace("ground()", "ground(friction=0.5)")
    assert apply(windows, [edit]) == apply(PROGRAM, [edit]) == expected
    assert apply(windows, [Edit("ground()", "ground(friction=0.5)")]) == expected


@pytest.mark.parametrize("mark", ["\x0b", "\x0c", "\x1c", "\x85", "\u2028", "\u2029"])
def test_only_line_feeds_part_lines(mark: str) -> None:
    text = f"a = '{mark}'\nb = 1\n"
    assert apply(text, [Edit("b = 1", "b = 2")]) == f"a = '{mark}'\nb = 2\n"
    assert diff(text, text.replace("1", "2")).splitlines(keepends=True)[-2:] == ["-b = 1\n", "+b = 2\n"]


@pytest.mark.timeout(300)
def test_a_search_of_a_megabyte_is_refused_shortly() -> None:
    told = refused(PROGRAM * 20, Edit("scene.box(" * 100_000, ""))
    told += refused(PROGRAM * 20, Edit("scene.box(\n" * 100_000, ""))
    assert len(told) < 5000


def test_a_diff_names_the_lines() -> None:
    made = diff(PROGRAM, PROGRAM.replace("duration=1.0", "duration=2.0"))
    assert made.startswith("--- program.py\n+++ program.py\n@@ -6,3 +6,3 @@\n")
    assert made.endswith("-    scene.simulation(duration=1.0)\n+    scene.simulation(duration=2.0)\n")
    assert diff(PROGRAM, PROGRAM) == ""


# Lines that differ from one another, so that a place is found once; in between, any sort of blank and mark.
LINES = st.lists(
    st.text(st.sampled_from("ab =()\"'#\t\x0c\u2028<>"), max_size=8).map(lambda x: x.rstrip()), max_size=12
)


def _text(lines: list[str]) -> str:
    return "".join(f"{number} {line}".rstrip() + "\n" for number, line in enumerate(lines))


def _hunks(patch: str) -> list[tuple[int, list[str], list[str]]]:
    """Of a unified diff: line number, lines before and lines after."""
    found: list[tuple[int, list[str], list[str]]] = []
    for line in patch.split("\n")[2:-1]:
        if start := re.match(r"@@ -(\d+)(,\d+)? \+\d+(,\d+)? @@$", line):
            found.append((int(start[1]), [], []))
            continue
        if line[0] in " -":
            found[-1][1].append(line[1:])
        if line[0] in " +":
            found[-1][2].append(line[1:])
    return found


@given(LINES.filter(bool), LINES, st.integers(0, 12))
def test_a_diff_made_into_edits_gives_the_text_that_it_was_made_of(old: list[str], new: list[str], shared: int) -> None:
    before, after = _text(old), _text([*old[:shared], *new]) or "0\n"
    patch = diff(before, after)
    assert (patch == "") == (before == after)
    blocks = ["".join(f"{line}\n" for line in half) for _, *halves in _hunks(patch) for half in halves]
    if any(not search for search in blocks[::2]):
        return  # a whole text that is replaced has no place to search for
    answer = "\n".join(block(search, replace) for search, replace in zip(blocks[::2], blocks[1::2], strict=True))
    made = apply(before, parse(answer)) if patch else before
    assert made == after


@given(LINES.filter(bool), st.data())
def test_a_place_is_changed_and_changed_back(lines: list[str], data: st.DataObject) -> None:
    text = _text(lines)
    k = data.draw(st.integers(0, len(lines) - 1))
    n = data.draw(st.integers(k + 1, len(lines)))
    place = _text(lines).split("\n")[k:n]
    edit = Edit("\n".join(place), "x1 = 1\nx2 = 2")
    there = apply(text, [edit])
    assert there.count("x1 = 1\nx2 = 2") == 1
    assert apply(there, [Edit(edit.replace, edit.search)]) == text
