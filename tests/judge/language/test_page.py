"""docs/objectives.md: every predicate is on it, and what it shows parses, evaluates and is as it says."""

import json
import math
import re
from dataclasses import replace
from pathlib import Path
from typing import get_args

import numpy as np
import pytest

from tests.judge.language.conftest import moving, shape, solid, still, times
from wsim.judge.evidence.evidence import Evidence
from wsim.judge.evidence.recorded import MissingError
from wsim.judge.language import Signals, evaluate, from_json, parse, python, sentence
from wsim.judge.language.kinds import KINDS, formula_of
from wsim.plan.schema import Objective
from wsim.plan.schema.draft import KindOfTwo
from wsim.plan.schema.formula import VOCABULARY, Predicate
from wsim.recording.contacts import ContactTrack
from wsim.recording.recording import FluidTrack, Recording
from wsim.scene.world import Container, Fluid, Shape, World

NOTHING = ContactTrack(np.zeros(0, np.int32), np.zeros((0, 2), np.int32), np.zeros((0, 16), np.float32))
KINDS_OF_TWO = get_args(KindOfTwo)
ROOT = Path(__file__).parents[3]
PAGE = (ROOT / "docs" / "objectives.md").read_text(encoding="utf-8")
ROWS = [[cell.strip() for cell in line.strip("|").split("|")] for line in PAGE.splitlines() if line.startswith("| `")]
PREDICATES = [row for row in ROWS if len(row) == 6]
OPERATORS = [row for row in ROWS if len(row) == 3]
CODE = {language: re.findall(rf"```{language}\n(.*?)```", PAGE, re.DOTALL) for language in ("json", "python")}


@pytest.fixture(scope="module")
def signals() -> Signals:
    """The page's world: a ball and a box in a tank of still water, and a bob that swings."""
    time = times(6.0, 20.0)
    world = World(
        bodies=[
            solid("ball", shape("sphere", 0.1), 33.0), solid("box", shape("box", 0.2, 0.2, 0.4), 8.0),
            solid("bob", shape("sphere", 0.1)),
        ],
        statics=[
            still("ground", Shape(prim="/g", kind="plane", size=())), still("wall", shape("box", 0.1, 4.0, 2.0)),
            still("ramp", shape("box", 2.0, 1.0, 0.2, position=(-5.0, 0.0, 0.0), rotation=(0.0, 0.2, 0.0, 0.98**0.5))),
            still("tank", shape("box", 1.0, 1.0, 0.1, position=(0.0, 0.0, -0.05))),
        ],
        containers=[Container(prim="/World/tank", inner_size=(1.0, 1.0, 0.6), inner_center=(0.0, 0.0, 0.3))],
        fluids=[
            Fluid(prim="/World/water", density=1000.0, viscosity=0.001, spacing=0.1, size=(1.0, 1.0, 0.3),
                  center=(0.0, 0.0, 0.15), container="/World/tank")
        ],
    )  # fmt: skip
    angle = 0.3 * np.cos(math.pi * time)
    bob = np.stack([9.0 + np.sin(angle), 0.0 * time, 2.0 - np.cos(angle)], axis=1)
    rate = -0.3 * math.pi * np.sin(math.pi * time)
    spin = np.zeros((len(time), 3, 3))
    spin[:, 2, 1] = -rate
    still_ones = (np.broadcast_to(place, bob.shape) for place in ([-0.2, 0.0, 0.1], [0.2, 0.0, 0.3]))
    bodies = moving(world, time, *still_ones, bob, w=spin)
    ticks = (np.arange(10) + 0.5) / 10 - 0.5
    grid = np.stack(np.meshgrid(ticks, ticks, [0.05, 0.15, 0.25], indexing="ij"), axis=-1).reshape(-1, 3)
    points = np.broadcast_to(grid.astype(np.float32), (len(time), *grid.shape))
    water = FluidTrack(time, points, np.zeros_like(points), np.full(points.shape[:2], 1000.0, np.float32))
    recording = Recording(
        path=Path("x.rrd"), world=world, metadata={}, time=time, body_q=bodies.body_q[0], body_qd=bodies.body_qd[0],
        contact_force=bodies.contact_force[0], fluids={"/World/water": water}, scalars={}, log=[], images={},
    )  # fmt: skip
    return Signals.of(Evidence(recording))


def test_the_page_has_every_predicate_and_operator() -> None:
    assert {row[0].strip("`") for row in PREDICATES} == set(VOCABULARY)
    assert {row[0].strip("`") for row in OPERATORS} == {
        "always", "eventually", "until", "then", "finally", "mean", "and", "or", "not",
    }  # fmt: skip


@pytest.mark.parametrize("row", PREDICATES, ids=lambda row: row[1].strip("`"))
def test_a_predicates_row_is_as_it_says(row, signals) -> None:
    name, example, units, alone, meaning, test = row
    formula = parse(example.strip("`"))
    assert formula.op == name.strip("`") and formula.alone == alone
    if formula.op == "touches_only":  # it asks what was recorded: that nothing touches
        recording = replace(signals.evidence.recording, contacts=NOTHING)
        signals = Signals.of(Evidence(recording))
    assert {measure.unit for measure in evaluate(formula, signals).measures} == set(units.split(", "))
    # Each number that the predicate takes is explained.
    fields = type(formula).model_fields
    numbers = {field for field, info in fields.items() if isinstance(info.json_schema_extra, dict)}
    said = " ".join(line[4] for line in PREDICATES if line[0] == name)
    assert numbers <= set(re.findall(r"`(\w+)`", said)), meaning
    function, path = re.fullmatch(r"\[(\w+)\]\(\.\./(.+)\)", test).groups()
    assert f"def {function}(" in (ROOT / path).read_text(encoding="utf-8")


@pytest.mark.parametrize("row", OPERATORS, ids=lambda row: row[0].strip("`"))
def test_an_operators_example_evaluates(row, signals) -> None:
    formula = parse(row[1].strip("`"))
    assert formula.op == row[0].strip("`")
    assert np.isfinite(evaluate(formula, signals).margin[0])


def test_the_three_forms_are_one(signals) -> None:
    said = re.findall(r"^ {4}(.+)$", PAGE, re.MULTILINE)[0]
    objective = Objective.model_validate(json.loads(CODE["json"][0]))
    called = eval(CODE["python"][0].strip(), vars(python).copy())
    assert parse(said) == objective.formula == called == from_json(called.model_dump_json())
    assert evaluate(called, signals).margin.shape == (1,)


def test_the_code_for_many_worlds_runs(signals) -> None:
    names = {
        "Signals": Signals, "evaluate": evaluate, "parse": parse, "mass": signals.mass,
        **{name: getattr(signals, name) for name in ("world", "time", "body_q", "body_qd", "contact_force")},
    }  # fmt: skip
    exec(CODE["python"][1], names)
    assert names["outcome"].satisfied.shape == (1,)


JUDGE = (ROOT / "docs" / "judge.md").read_text(encoding="utf-8").split("\n## Objectives\n")[1].split("\n## ")[0]
SAID = dict(re.findall(r"^\| `(\w+)` \| `([^`]+)`", JUDGE, re.MULTILINE))


@pytest.mark.parametrize("kind", KINDS)
def test_the_judges_page_says_which_formula_each_kind_is(kind, signals) -> None:
    formula = parse(SAID[kind])
    first = next(node for node in formula.walk() if isinstance(node, Predicate))
    names = {"object": getattr(first, "object", None) or first.fluid}
    names |= {"ref": getattr(first, "ref", None) or getattr(first, "fluid", None)} if kind in KINDS_OF_TWO else {}
    value = getattr(first, "least", None) if kind in ("moves", "slides", "rolls_down") else None
    asked = Objective(kind=kind, value=value, direction=getattr(first, "direction", None), **names)
    signals.evidence.recording.contact_force[:] = 1.0
    assert sentence(formula_of(asked, signals.evidence)) == sentence(formula)


def test_a_kind_takes_the_objectives_own_tolerance(signals) -> None:
    for kind, ref, said in (
        ("floats", "water", "mean(floats(box, water, within 0.03 m))"),
        ("stays_inside", "tank", "stays_inside(box, tank, within 0.03 m)"),
        ("rests_on", "tank", "mean(lies_on(box, tank, within 0.03 m)) and mean(weighs_on(box, tank))"),
        ("settles", None, "mean[0.5](settles(box, speed 0.03 m/s))"),
        ("tilts", "ball", "tilts_to(box, ball, least 0.03 deg)"),
    ):
        asked = Objective(kind=kind, object="box", ref=ref, tolerance=0.03)
        assert formula_of(asked, signals.evidence) == parse(said)
    asked = Objective(kind="stays_inside", object="water", ref="tank", tolerance=0.03)
    assert formula_of(asked, signals.evidence) == parse("stays_inside(water, tank, share 3 %)")
    with pytest.raises(MissingError, match='"rests_on" needs another object'):
        formula_of(Objective(kind="rests_on", object="box"), signals.evidence)
