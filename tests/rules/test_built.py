"""Nothing of a sentence is lost: drawn ones are planned as they say, or refused in a few lines that name the words."""

import re
from dataclasses import dataclass, field

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from wsim.errors import UserError
from wsim.plan.layout.bodies import around
from wsim.rules.planner import plan
from wsim.rules.scenes.part import DIRECTIONS

COLORS = ("red", "blue", "green", "yellow", "purple", "orange")
TOWARD = {"to the left": "left", "to the right": "right", "forward": "front", "backwards": "back"}
SIDE = {"in front of": (0, 1), "behind": (0, -1), "to the left of": (1, 1), "to the right of": (1, -1)}
NUMBERS = {1: "one", 2: "two", 3: "three", 4: "four"}
MOST_LINES, LONGEST = 3, 400  # of a refusal


@dataclass
class Drawn:
    """What a drawn sentence says."""

    text: str = ""
    counts: dict[str, int] = field(default_factory=dict)  # by the stem of their names
    goes: dict[str, str] = field(default_factory=dict)  # where to
    gaps: list[tuple[str, str, str, float]] = field(default_factory=list)  # this, on which side of that, and how far
    verbs: list[tuple[str, str]] = field(default_factory=list)  # and of what it is said, in their order
    on: list[tuple[str, str]] = field(default_factory=list)


@st.composite
def clauses(draw, own, other):
    """One clause about a thing of one colour, or about one and another."""
    said, noun = Drawn(), draw(st.sampled_from(("ball", "cube", "crate")))
    name, second = f"{own}_{noun}", f"{other}_{draw(st.sampled_from(('box', 'cube', 'crate')))}"
    what = draw(st.sampled_from(("goes", "drops", "stands", "falls_on", "several", "with", "goes_for", "lies_near")))
    said.counts[name] = 1
    a, b = f"a {own} {noun}", f"a {second.replace('_', ' ')}".replace("a orange", "an orange")
    a = a.replace("a orange", "an orange")
    verb = "rolls" if noun == "ball" else "slides"
    if what == "goes":
        where = draw(st.sampled_from(sorted(TOWARD)))
        said.text, said.goes[name] = f"{a} {verb} {where}", TOWARD[where]
        said.verbs.append((verb, name))
    elif what == "goes_for":
        said.text = f"{a} {verb} for two seconds"
        said.verbs.append((verb, name))
    elif what in ("drops", "stands", "lies_near"):
        side, gap = draw(st.sampled_from(sorted(SIDE))), draw(st.sampled_from((0.2, 0.5, 1.0)))
        does = {"drops": "is dropped", "stands": "stands", "lies_near": "lies"}[what]
        said.text = f"{a} {does} {gap:g} m {side} {b}"
        said.counts[second] = 1
        said.gaps.append((name, side, second, gap))
        said.verbs.append((does.split()[-1], name))
    elif what == "falls_on":
        said.text, said.counts[second] = f"{a} falls on {b}", 1
        said.verbs.append(("falls", name))
        said.on.append((name, second))
    elif what == "several":
        count = draw(st.integers(2, 4))
        said.text, said.counts = f"{NUMBERS[count]} {own} {noun}s lie on the ground", {name: count}
        said.verbs.append(("lie", name))
    else:
        count = draw(st.integers(2, 3))
        said.text = f"a conveyor with {NUMBERS[count]} {own} crates runs at 0.3 m/s"
        said.counts = {f"{own}_crate": count}
    return said


@st.composite
def sentences(draw):
    """Up to three clauses about things of different colours."""
    colors = draw(st.permutations(COLORS))
    drawn = [draw(clauses(colors[2 * k], colors[2 * k + 1])) for k in range(draw(st.integers(1, 3)))]
    whole = Drawn(
        text=draw(st.sampled_from((" and ", ", and ", ". ", "; ", " while "))).join(each.text for each in drawn)
    )
    for each in drawn:
        whole.counts |= each.counts
        whole.goes |= each.goes
        whole.gaps += each.gaps
        whole.verbs += each.verbs
        whole.on += each.on
    whole.text = whole.text[0].upper() + whole.text[1:] + "."
    return whole


def named(made, stem):
    """The objects of a kind: "red_ball", or "red_ball_1" and so on."""
    return [item for item in made.objects if re.fullmatch(rf"{stem}(_\d+)?", item.name)]


def involved(objective):
    found = {objective.object, objective.ref}
    return found | (set() if objective.formula is None else set(objective.formula.names()))


@settings(max_examples=50, deadline=None, derandomize=True)
@given(sentences())
def test_a_drawn_sentence_is_planned_as_it_says_or_refused(said):
    try:
        made = plan(said.text)
    except UserError as error:
        assert len(str(error).splitlines()) <= MOST_LINES, said.text
        assert len(str(error)) < LONGEST, said.text
        assert "'" in str(error), said.text
        return
    for stem, count in said.counts.items():
        assert len(named(made, stem)) == count, said.text
    for stem, way in said.goes.items():
        (item,) = named(made, stem)
        assert sum(a * b for a, b in zip(item.velocity, DIRECTIONS[way], strict=True)) > 0.0, said.text
        assert {o.direction for o in made.objectives if o.object == stem and o.kind == "moves"} == {way}, said.text
    for stem, side, other, gap in said.gaps:
        (item,), (ref,) = named(made, stem), named(made, other)
        axis, sign = SIDE[side]
        mine, theirs = (around(one) for one in ((item, ref) if sign > 0 else (ref, item)))
        assert mine.low[axis] - theirs.high[axis] == pytest.approx(gap, abs=0.005), said.text
    for stem, below in said.on:
        (item,), (ref,) = named(made, stem), named(made, below)
        assert around(item).low[2] > around(ref).high[2], said.text
        assert item.pose.position[:2] == pytest.approx(ref.pose.position[:2], abs=0.01), said.text
    _verbs_are_of_their_things(made, said)
    _nothing_runs_into_another(made, said)


def _verbs_are_of_their_things(made, said):
    """Each verb's clause in its turn: of its own things, and of none else alone."""
    left = [*said.verbs]
    for clause in made.clauses:
        at = next((k for k, (verb, _) in enumerate(left) if verb == clause.words.lower()), None)
        if at is None:
            continue
        _, stem = left.pop(at)
        own = {item.name for item in named(made, stem)}
        for each in clause.by or []:
            parties = involved(made.objectives[each]) if isinstance(each, int) else {each.partition(".")[0]}
            assert parties & own, f"{said.text}: {clause}"


def _nothing_runs_into_another(made, said):
    """By the speeds at the start: what goes one way does not meet what is on that way."""
    movers = [item for item in made.objects if named(made, item.name) and any(item.velocity[:2])]
    movers = [item for item in movers if "crate" not in item.name or item.relations]  # those on a belt are in a row
    for item in movers:
        for other in made.objects:
            if other.primitive == "ground" or other is item or other.name.startswith("conveyor"):
                continue
            box, there = around(item), around(other)
            if box.low[2] > there.high[2] or there.low[2] > box.high[2]:
                continue
            for time in (0.05 * k for k in range(21)):
                ways = [[v * time for v in one.velocity] for one in (item, other)]
                if not (item.rolling and (other.rolling or not any(other.velocity))):
                    break  # what slides is braked: the plan itself looks at that
                apart = [
                    max(box.low[k] + ways[0][k] - there.high[k] - ways[1][k],
                        there.low[k] + ways[1][k] - box.high[k] - ways[0][k])
                    for k in (0, 1)
                ]  # fmt: skip
                assert max(apart) > -0.005, f"{said.text}: {item.name} and {other.name}"
