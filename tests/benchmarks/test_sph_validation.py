"""The harness of the fluid's validation: what it runs, and that it hides nothing."""

import dataclasses
import json
import math

import pytest

from benchmarks import sph_validation
from benchmarks.sph_cases.case import Case, Measured, Value


def make_case(name: str, errors: dict[float, float | None]) -> Case:
    """A case whose error at each spacing is given; None raises."""

    def run(device: str, spacing: float) -> Measured:
        error = errors[spacing]
        if error is None:
            raise RuntimeError("the fluid\nhas collapsed")
        line = ([0.0, 1.0], [0.0, error])
        return Measured(errors={"e": error}, curves={"reference: exact": line, f"dp = {spacing}": line}, particles=7)

    return Case(name, name, "exact", {"e": 1.0}, {"e": "%"}, tuple(errors), tuple(errors), run, ("t [s]", "e [%]"))


@pytest.fixture
def with_cases(monkeypatch):
    def plant(*cases: Case) -> None:
        monkeypatch.setattr(sph_validation, "find_cases", lambda wanted=None: list(cases))

    return plant


def test_cases_are_found_by_name():
    names = [case.name for case in sph_validation.find_cases()]
    assert {"standing_wave", "poiseuille", "taylor_green", "dam_break_koshizuka"} <= set(names)
    assert [case.name for case in sph_validation.find_cases(["poiseuille"])] == ["poiseuille"]
    with pytest.raises(SystemExit, match="standing_wives"):
        sph_validation.find_cases(["standing_wives"])


def test_every_case_says_what_it_measures():
    for case in sph_validation.find_cases():
        assert set(case.reach) == set(case.unit)
        for spacings in (case.coarse, case.fine):
            assert len(spacings) >= 2
            assert list(spacings) == sorted(spacings, reverse=True)


def test_a_miss_is_said_and_does_not_fail(with_cases, capsys, tmp_path):
    with_cases(make_case("falls", {0.2: 4.0, 0.1: 1.0}), make_case("lost", {0.1: math.nan}))
    paths = tmp_path / "out" / "r.json", tmp_path / "t.md", tmp_path / "plots"
    arguments = ["--device", "cpu", "--json", str(paths[0]), "--markdown", str(paths[1]), "--plots", str(paths[2])]
    assert sph_validation.main(arguments) == 0
    printed = capsys.readouterr().out
    assert "MISSED by 3 %" in printed
    assert "MISSED: not finite" in printed
    found = json.loads(paths[0].read_text())
    first, second, lost = (run["errors"]["e"] for run in found["runs"])
    assert (first["reached"], second["reached"], lost["reached"]) == (False, True, False)
    assert second["order"] == pytest.approx(2.0)
    assert lost["value"] == "nan"
    assert found["made_with"]["device"] == "cpu"
    assert paths[1].read_text().count("\n") == 5
    assert "| **MISSED by 3 %** |" in paths[1].read_text()
    assert (paths[2] / "falls.png").stat().st_size < 100_000


def test_a_value_stands_beside_its_reference(with_cases, capsys):
    case = make_case("knows", {0.1: 0.5})
    known = Measured({"e": 0.5}, values={"e": Value(10.05, 10.0, 9.9, 10.1, "N")})
    with_cases(dataclasses.replace(case, run=lambda device, spacing: known))
    assert sph_validation.main(["--device", "cpu"]) == 0
    printed = capsys.readouterr().out
    assert "e: 10.05 / 10 / 9.9 to 10.1 N" in printed
    assert "0.5 % (10.05 for 10 N)" in printed


def test_a_case_that_raises_is_a_row_and_the_others_still_run(with_cases, capsys):
    with_cases(make_case("breaks", {0.2: None, 0.1: 0.5}), make_case("holds", {0.1: 0.5}))
    assert sph_validation.main(["--device", "cpu"]) == 1
    rows = capsys.readouterr().out
    assert "failed: RuntimeError: the fluid has collapsed" in rows
    assert rows.count("reached") == 2
