"""Three forms of one tree: JSON, sentence and Python."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pydantic import ValidationError

from wsim.judge.language import from_json, parse, python, sentence
from wsim.plan.schema.formula import (
    VOCABULARY,
    Always,
    And,
    Eventually,
    Finally,
    Mean,
    Not,
    Or,
    Ordered,
    Predicate,
    Then,
    Until,
)
from wsim.plan.schema.formula_motion import Conserves
from wsim.plan.schema.formula_place import SpeedBetween

names = st.one_of(
    st.from_regex(r"\A[A-Za-z_][A-Za-z0-9_]{0,8}\Z"),
    st.sampled_from(["and", "end", "not", "then", "ordered", "within", "m", "touches", "/World/robot/arm", "a/b"]),
)
ALL_NAMED = VOCABULARY["counts"], VOCABULARY["touches_only"]  # some objects at least
numbers = st.floats(1e-6, 1e6, allow_nan=False)
points = st.tuples(*[st.floats(-1e6, 1e6, allow_nan=False)] * 3)
windows = st.one_of(
    st.none(),
    st.tuples(st.floats(0, 9), st.one_of(st.none(), st.floats(0, 9))).map(
        lambda w: w if w[1] is None else (min(w), max(w))
    ),
)


def fields(kind: type[Predicate]) -> st.SearchStrategy[Predicate]:
    """Predicates of a kind, with whatever its fields take."""
    shares = st.floats(1e-6, 0.999)
    needs = kind.model_fields.get("within") is not None and kind.model_fields["within"].default is not None
    taken = {
        "object": names, "ref": names, "fluid": names, "on": st.one_of(st.none(), names),
        "target": st.one_of(names, points), "center": st.one_of(names, points), "radius": numbers, "share": shares,
        "path": st.lists(points, min_size=2, max_size=4), "axis": st.sampled_from("xyz"), "at": st.floats(-1e6, 1e6),
        "clearance": st.one_of(st.just(0.0), numbers), "period": st.one_of(st.none(), numbers), "level": numbers,
        "least": st.floats(1e-6, 90.0) if kind is VOCABULARY["tilts_to"] else numbers,
        "direction": st.sampled_from([None, "front", "back", "left", "right"]),
        "amplitude": st.one_of(st.none(), st.floats(0.1, 180)), "speed": st.one_of(st.none(), numbers),
        "restitution": st.one_of(st.none(), st.floats(0, 1)), "what": st.sampled_from(["energy", "momentum"]),
        "objects": st.lists(names, min_size=kind in ALL_NAMED, max_size=3), "height": numbers,
        "within": st.floats(1e-6, 0.9) if needs else st.one_of(st.none(), st.floats(1e-6, 180)),
    }  # fmt: skip
    if kind is SpeedBetween:
        return st.tuples(names, numbers, numbers).map(
            lambda v: SpeedBetween(object=v[0], low=min(v[1:]), high=max(v[1:]))
        )
    if {"low", "high", "axis"} <= set(kind.model_fields):
        taken |= {"low": numbers.map(lambda x: -x), "high": numbers, "of": st.one_of(st.none(), names)}
        taken["axis"] = st.sampled_from(kind.model_fields["axis"].annotation.__args__)
    chosen = {name: taken[name] for name in kind.model_fields if name != "op"}
    return st.fixed_dictionaries(chosen).map(kind.model_validate)


predicates = st.sampled_from([kind for kind in VOCABULARY.values() if kind is not Ordered]).flatmap(fields)
formulas = st.recursive(
    predicates,
    lambda inner: st.one_of(
        st.lists(inner, min_size=2, max_size=3).map(lambda of: And(of=of)),
        st.lists(inner, min_size=2, max_size=3).map(lambda of: Or(of=of)),
        inner.map(lambda of: Not(of=of)),
        st.tuples(predicates, st.one_of(st.none(), numbers)).map(lambda p: Mean(of=p[0], seconds=p[1])),
        st.tuples(predicates, windows).map(lambda p: Mean(of=p[0], window=p[1])),
        st.tuples(inner, windows).map(lambda p: Always(of=p[0], window=p[1])),
        st.tuples(inner, windows).map(lambda p: Eventually(of=p[0], window=p[1])),
        st.tuples(inner, st.one_of(st.none(), numbers)).map(lambda p: Finally(of=p[0], seconds=p[1])),
        st.tuples(inner, inner, windows).map(lambda p: Until(hold=p[0], goal=p[1], window=p[2])),
        st.lists(st.tuples(inner, windows), min_size=2, max_size=3).map(
            lambda p: Then(events=[f for f, _ in p], windows=[w for _, w in p[1:]])
        ),
        st.lists(inner, min_size=2, max_size=3).map(lambda of: Ordered(events=of)),
    ),
    max_leaves=6,
)


@settings(max_examples=100, deadline=None)
@given(formulas)
def test_a_tree_survives_its_sentence_and_its_json(formula):
    assert parse(sentence(formula)) == formula
    assert from_json(formula.model_dump_json()) == formula
    assert from_json(formula.model_dump()) == formula


def test_the_three_forms_of_one_objective():
    said = parse("always[2, 5](upright(tower, 10 deg)) and not touches(tower, wall)")
    tree = {
        "op": "and",
        "of": [
            {"op": "always", "window": [2, 5], "of": {"op": "upright", "object": "tower", "within": 10}},
            {"op": "not", "of": {"op": "touches", "object": "tower", "ref": "wall"}},
        ],
    }
    called = python.always(python.upright("tower", 10), (2, 5)) & ~python.touches("tower", "wall")
    assert said == from_json(tree) == called
    assert sentence(called) == "always[2, 5](upright(tower, within 10 deg)) and not touches(tower, wall)"


@pytest.mark.parametrize("name", [name for name in VOCABULARY if name not in ("ordered", "conserves")])
def test_python_calls_every_predicate_by_its_fields(name):
    kind = VOCABULARY[name]
    samples = {"path": ((0, 0, 0), (1, 0, 0)), "axis": "x", "target": "c", "center": "c", "objects": ("c", "d")}
    wanted = [field for field, info in kind.model_fields.items() if info.is_required()]
    values = [
        samples.get(
            field, 0.5 if field in ("radius", "low", "high", "at", "level", "height", "least", "share") else "a"
        )
        for field in wanted
    ]
    assert getattr(python, name)(*values) == kind(**dict(zip(wanted, values, strict=True)))
    with pytest.raises(TypeError, match="takes "):
        getattr(python, name)(*["a"] * 9)


def test_python_operators_join_what_is_of_one_kind():
    a, b, c = (python.settles(name) for name in "abc")
    assert (a & b & c) == And(of=(a, b, c)) and (a | b | c) == Or(of=(a, b, c))
    assert a.then(b, (0, 2)).then(c) == Then(events=(a, b, c), windows=((0, 2), None))
    assert a.until(b, (1, 2)) == Until(hold=a, goal=b, window=(1, 2))
    assert python.ordered(a, b) == Ordered(events=(a, b)) and ~a == Not(of=a)
    assert python.conserves("momentum", "a", "b", share=0.1) == Conserves(
        what="momentum", objects=("a", "b"), share=0.1
    )
    assert python.finally_(a, 2) == Finally(of=a, seconds=2) and python.eventually(a) == Eventually(of=a)


@pytest.mark.parametrize(
    ("text", "same"),
    [
        ("not settles(a) and settles(b) or settles(c)", "((not settles(a)) and settles(b)) or settles(c)"),
        ("settles(a) or settles(b) until settles(c)", "(settles(a) or settles(b)) until settles(c)"),
        ("reaches(a, (1, 2, 3), 10 cm)", "reaches(a,(1 m,2,300 cm), within = 0.1 m)"),
        ("speed_between(a, 1 m/s, 7.2 km/h)", "speed_between(a, high 2 m/s, low 1)"),
        ("always[500 ms, 2 s](settles(a))", "always[0.5, 2](settles(a))"),
        ("conserves(energy, share 5 %)", "conserves(energy, 0.05)"),
        ("upright(a, 3.141592653589793 rad)", "upright(a, 180)"),
        ("touches_only(a, b, c)", "touches_only(a, [b, c])"),
        ("counts(bowl, 2, a, b)", "counts(bowl, 2, objects [a, b])"),
        ("gone_between(a, x, 1 m, 2 m)", "gone_between(a, X, 1 m, 2 m)"),
    ],
)
def test_sentences_that_say_the_same(text, same):
    first, second = parse(text), parse(same)
    assert type(first) is type(second)
    assert first == second or sentence(first) == sentence(second)


@pytest.mark.parametrize(
    ("text", "why"),
    [
        ("always[5, 2](settles(a))", r"the window \[5, 2\] s ends before it begins"),
        ("leans(a)", "no predicate 'leans'; there are reaches, stays_within"),
        ("upright(a, 3 kg)", "within is in deg or rad, not 'kg'"),
        ("upright(a, tilt 3 deg)", "upright has no 'tilt'; it has object, within"),
        ("upright(a, 3 deg, within 4 deg)", "within is given twice"),
        ("touches(a, b, c)", "no place for another name; it has object, ref, within"),
        ("touches(a)", "ref: Field required"),
        ("settles(a, -1 m/s)", "speed: Input should be greater than 0"),
        ("crosses(a, w, 1 m)", "axis: Input should be 'x', 'y' or 'z'"),
        ("speed_between(a, 2 m/s, 1 m/s)", "low 2 m/s is above high 1 m/s; swap them"),
        ("conserves(mass)", "name one fluid, not 0 objects"),
        ("settles(a", "character 9, it ends; here may stand a comma"),
        ("touches_only(a, [b)", "character 19, this does not go on; here may stand a comma"),
        ("settles(a) settles(b)", "character 12, this does not go on; here may stand its end, and"),
        ("settles(a) $", "character 12, this does not go on"),
        ("", "at its start"),
        ("settles(a, 1e999 m/s)", "speed: Input should be a finite number|less than or equal"),
        ("not " * 60 + "settles(a)", "nested more than 40 deep"),
        ("(" * 4000, "it ends"),
        ("settles(a) and " * 2000 + "settles(a)", "the longest has 20000"),
    ],
)  # fmt: skip
def test_what_is_no_sentence_says_where_and_what_to_do(text, why):
    with pytest.raises(ValueError, match=why):
        parse(text)


@pytest.mark.parametrize(
    ("tree", "why"),
    [
        ({"op": "upright", "object": "a", "within": 3, "unit": "deg"}, "Extra inputs"),
        ({"op": "leans", "object": "a"}, "expected tags: 'and', 'or'"),
        ({"op": "and", "of": [{"op": "settles", "object": "a"}]}, "at least 2"),
        ({"op": "settles", "object": "a b"}, "match pattern"),
        ({"op": "settles", "object": "a", "speed": float("nan")}, "finite|greater"),
        ({"op": "then", "events": [{"op": "settles", "object": "a"}] * 3, "windows": [None]}, "have 2 windows between"),
        ({"op": "always", "window": [-1, 2], "of": {"op": "settles", "object": "a"}}, "greater than or equal to 0"),
    ],
)  # fmt: skip
def test_json_takes_nothing_that_it_does_not_know(tree, why):
    with pytest.raises(ValidationError, match=why):
        from_json(tree)
