"""The benchmark of the static validator: its cases are intact, they are what they say, and it counts right."""

import ast
import json
from collections import Counter

import pytest

from benchmarks import validator
from benchmarks.validator_cases import FOLDER, Mistake, Program, halves, mistakes, programs
from benchmarks.validator_cases.prove import excuse, objection

MISTAKES = {mistake.name: mistake for mistake in mistakes()}


def a_case(name: str) -> validator.Case:
    return next(case for case in validator.cases() if case[1] is not None and case[1].name == name)


def changed(name: str, **fields: object) -> Mistake:
    return Mistake.model_validate({**MISTAKES[name].model_dump(), **fields})


def test_there_are_sixty_programs_and_a_hundred_mistakes():
    assert len(programs()) == 60
    assert len(mistakes()) == len(MISTAKES) == 100
    assert len({mistake.kind for mistake in mistakes()}) >= 12
    assert {path.stem for path in (FOLDER / "plans").iterdir()} == {p.name for p in programs() if p.plan}


def test_the_correct_programs_are_of_every_size():
    sizes = sorted(program.text.count("\n") for program in programs())
    assert sizes[0] <= 15 and sizes[len(sizes) // 2] >= 25 and sizes[-1] >= 140
    for program in programs():
        compile(program.text, program.name, "exec")


@pytest.mark.parametrize("mistake", mistakes(), ids=lambda mistake: f"{mistake.kind}: {mistake.name}")
def test_a_mistake_changes_one_place_and_has_its_lines(mistake):
    text = mistake.program.text
    assert Program.named(mistake.base).text.count(mistake.search) == 1 and text != Program.named(mistake.base).text
    assert mistake.anywhere or mistake.lines
    assert all(1 <= line <= text.count("\n") for line in mistake.lines)
    if mistake.name != "forgotten colon":
        ast.parse(text)
    if mistake.fails == "plan":
        assert mistake.program.plan is not None


def test_a_search_text_that_is_not_there_once_is_refused():
    for search in ("no such text", "scene."):
        with pytest.raises(ValueError, match="not once"):
            _ = changed("scene.cube", search=search).program
    with pytest.raises(ValueError, match="2 times, not once"):
        _ = changed("scene.cube", at=("scene.camera(",)).lines
    with pytest.raises(ValueError, match="why it is a mistake"):
        changed("scene.cube", fails=None)


def test_the_halves_are_equal_and_do_not_change():
    of = halves(MISTAKES)
    assert Counter(of.values()) == {"tuning": 50, "held-out": 50}
    assert halves(reversed(list(MISTAKES))) == of


# A plan and a loop, `control`, a file beside the program, the catalogue, raw USD.
SAMPLE = ("planned_blocks", "cartpole_control", "wedge_mesh", "builder_pattern", "usd_compound_body")


@pytest.mark.parametrize("name", SAMPLE)
def test_a_correct_program_is_correct(name):
    assert objection(Program.named(name)) == ""


@pytest.mark.parametrize("name", ["np.Inf", "world.get_joint in control", "no ground", "import socket"])
def test_a_mistake_is_one(name):
    assert excuse(MISTAKES[name]) == ""


def test_what_is_no_mistake_is_noticed():
    same = changed("scene.cube", replace="scene.box('dominoes_%02d'")
    assert "fails in None, not in build" in excuse(same)
    elsewhere = changed("scene.cube", at=("scene.camera('top'",))
    assert "fails at line 18, not at [27]" in excuse(elsewhere)
    broken = Program("broken", "def build(scene):\n    scene.cone('cone')\n", None)
    assert objection(broken).startswith("broken:2 fails in build: AttributeError")


def test_a_mistake_is_found_within_a_line_of_it():
    case = a_case("scene.add_box")
    (line,) = MISTAKES["scene.add_box"].lines
    for away, found in ((0, True), (1, True), (-1, True), (2, False), (-2, False)):
        assert validator.score(case, [(line + away, "Scene has no add_box")]).found is found
    assert not validator.score(case, [(None, "Scene has no add_box; box(name, *, size)")]).found


def test_the_right_name_counts_where_the_mistake_is_found():
    case = a_case("scene.add_box")
    (line,) = MISTAKES["scene.add_box"].lines
    assert validator.score(case, [(line, "no add_box; nearest: box(name, *, size)")]).named
    assert not validator.score(case, [(line, "no add_box; nearest: boxes, my_box")]).named
    assert not validator.score(case, [(line, "no add_box"), (line + 5, "nearest: box")]).named


def test_what_has_no_line_is_found_by_its_name():
    case = a_case("an object forgotten")
    assert validator.score(case, [(None, "the plan's target_box has no prim")]).found
    assert not validator.score(case, [(1, "the plan has more objects than the program")]).found


def test_the_summary_counts_by_half_and_kind():
    planted = [case for case in validator.cases() if case[1] is not None]
    outcomes = [validator.score(case, []) for case in planted]
    mistake = planted[0][1]
    outcomes[0] = validator.score(planted[0], [(None, "define build(scene)")])
    (program,) = (case for case in validator.cases() if case[0].name == "pyramid" and case[1] is None)
    outcomes += [validator.score(program, [(1, "a complaint")]), validator.score(program, [])]
    facts = validator.summary(outcomes)
    assert facts["all"]["mistakes"] == 100 and facts["all"]["found"] == facts["all"]["named"] == 1
    assert facts["kinds"][mistake.kind]["found"] == 1 and facts["halves"][planted[0][2]]["found"] == 1
    assert sum(counts["mistakes"] for counts in facts["halves"].values()) == 100
    assert facts["correct"] == 2 and facts["complained_of"] == 1


def test_the_held_out_half_is_counted_and_not_told(capsys):
    outcomes = [validator.score(case, []) for case in validator.cases()]
    validator.print_misses(outcomes, "tuning")
    assert capsys.readouterr().out.count("MISSED") == 50
    validator.print_misses(outcomes, "all")
    assert capsys.readouterr().out.count("MISSED") == 100


def test_the_benchmark_measures_the_validator(tmp_path, capsys):
    report = tmp_path / "results.json"
    status = validator.main(["--only", "falling_box", "scene.add_box", "--json", str(report), "--half", "all"])
    facts = json.loads(report.read_text())
    assert facts["correct"] == 1 and facts["all"]["mistakes"] == 1 and facts["errors"] == 0
    assert status == int(facts["complained_of"] > 0 or facts["all"]["found"] < 1 or facts["worst_s"] > 0.5)
    assert "1 of 1" in capsys.readouterr().out
    with pytest.raises(SystemExit):
        validator.main(["--only", "no such case"])
