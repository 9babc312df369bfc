"""Each entry of the table of predicates: in the schema, in a layout that keeps it, in one that is refused."""

import re
from pathlib import Path

import pytest
from pydantic import ValidationError

from tests.plan.layout.scenes import WOOD, box, make, rel, solve, tank, water
from wsim.plan.layout import LayoutError, residual, unsatisfied
from wsim.plan.schema import PREDICATES, Plan, PlanObject, Pose, Region, Relation
from wsim.plan.schema.predicates import ROWS, Predicate, template
from wsim.plan.schema.relations import ARGUMENTS

GIVEN = {
    "other": "pier", "axis": "pier", "value": 0.1, "gap": 0.15, "overlap": 0.05, "anchor": "top", "by": "center",
    "region": Region(low=(-3.0, -3.0), high=(3.0, 3.0)), "range": (10.0, 20.0), "group": "pair", "members": ["mate"],
}  # fmt: skip
REF = {"fluid": "water", "container": "tank", None: "ref"}
SIZE = (0.3, 0.2, 0.1)  # as high as `value`, for HEIGHT
FREE = {"construction": box("any", size=SIZE).construction, "material": WOOD}


def ref_of(spec: Predicate) -> str:
    return "tank" if spec.name == "PLACE-IN" else REF[spec.ref_role]


def row_of(spec: Predicate, **changes) -> Relation:
    """The row with all that it may state; without `ref` where it may lack one and stand on the base."""
    names = [name for name in (*spec.needs, *spec.takes) if name != "ref"]
    ref = {"ref": ref_of(spec)} if "ref" in (*spec.needs, *spec.takes) else {}
    return Relation(predicate=spec.name, **{**{name: GIVEN[name] for name in names}, **ref, **changes})


def subject(spec: Predicate) -> str:
    return {"fluid": "water", "container": "tank"}.get(spec.of_role or "", "b")


def scene(spec: Predicate, *more: Relation) -> list[PlanObject]:
    """Two piers, a low block, a tank of water and another, an object with the rows; of a group, its mate and model."""
    rows = [row_of(spec), *more]
    poured = [rel("PLACE-IN", "tank"), rel("FREE-SURFACE-AT", value=0.3)]
    if subject(spec) == "water":
        poured = rows if spec.fills else [poured[0], *rows]
    basin = tank(*(rows if subject(spec) == "tank" else [])).model_copy(update={"pose": Pose(position=(0, 3, 0))})
    things = [
        box("ref", size=(0.8, 0.6, 0.4), pose=Pose(position=(0.0, 0.0, 0.2))),
        box("pier", size=(0.8, 0.6, 0.4), pose=Pose(position=(2.5, 0.4, 0.2))),
        box("low", size=(0.2, 0.2, 0.2), pose=Pose(position=(-3.0, 0.3, 0.1))),
        water(*poured),
        basin,
        tank().model_copy(update={"name": "far", "pose": Pose(position=(0, -3, 0))}),
    ]
    if "members" in spec.needs:
        things.append(box("mate", *([rel("LEFT-OF", "b")] if spec.name == "GROUP" else []), size=SIZE))
    if spec.name == "COPY-GROUP":
        first = box("first", rel("GROUP", group="pair", members=["second"]), size=SIZE)
        things += [first, box("second", rel("LEFT-OF", "first"), size=SIZE)]
    if subject(spec) == "b":
        body = box("b", *rows, size=SIZE)
        things.append(lying(body) if spec.kind == "posture" else body)
    return things


def lying(body: PlanObject) -> PlanObject:
    built = body.construction.model_copy(update={"primitive": "cylinder", "size": (0.1, 0.5)})
    return body.model_copy(update={"construction": built})


def against(spec: Predicate) -> list[Relation]:
    """Rows that cannot hold beside the entry's."""
    if spec.kind == "orientation":
        return [rel("FACING-LEFT"), rel("FACING-RIGHT")]
    if spec.kind == "posture":
        return [rel(name) for name, other in ROWS.items() if other.kind == "posture" and name != spec.name]
    if "value" in spec.needs:
        return [row_of(spec, value=7.0)]
    if spec.kind == "support":
        return [rel("SPAWNED-ABOVE", value=1.0)]
    if spec.name == "COPY-GROUP":
        return [row_of(spec, group="none")]
    elsewhere = {"container": "far", None: "low"}.get(spec.ref_role, "tank")
    return [row_of(spec, ref=elsewhere)] if "ref" in spec.needs else [row_of(spec)]


@pytest.mark.parametrize("name", PREDICATES)
def test_the_schema_takes_its_arguments_and_no_others(name):
    spec = PREDICATES[name]
    whole = row_of(spec).model_dump(exclude_none=True)
    assert set(whole) - {"predicate"} == {*spec.needs, *spec.takes} <= set(ARGUMENTS)
    for needed in spec.needs:
        with pytest.raises(ValidationError, match=f'{name} needs "{needed}"'):
            Relation.model_validate({key: value for key, value in whole.items() if key != needed})
    strange = next(name for name in GIVEN if name not in whole)
    with pytest.raises(ValidationError, match=f'{name} takes .*; remove "{strange}"'):
        Relation.model_validate({**whole, strange: GIVEN[strange]})
    assert "{" not in row_of(spec).sentence()


@pytest.mark.parametrize("name", PREDICATES)
def test_a_layout_keeps_it(name):
    spec = PREDICATES[name]
    placed = solve(*scene(spec))
    item = placed.object(subject(spec))
    assert unsatisfied(placed) == [] and residual(placed, item, row_of(spec)) < 1e-6


@pytest.mark.parametrize("name", [name for name, spec in PREDICATES.items() if subject(spec) == "b" and spec.places])
def test_its_measure_sees_that_it_does_not_hold(name):
    spec = PREDICATES[name]
    placed = solve(*scene(spec))
    item = placed.object("b")
    (x, y, z), (roll, _, yaw) = item.pose.position, item.pose.rotation_deg
    moved = item.model_copy(
        update={"pose": Pose(position=(x + 3, y - 4, z + 1), rotation_deg=(roll + 40, 50, yaw + 70))}
    )
    spoilt = placed.model_copy(update={"objects": [moved if one is item else one for one in placed.objects]})
    assert residual(spoilt, moved, row_of(spec)) > 0.1
    assert any(said.startswith(f"b {name}") for said in unsatisfied(spoilt))


@pytest.mark.parametrize("name", PREDICATES)
def test_what_rules_it_out_is_refused_by_name(name):
    spec = PREDICATES[name]
    rows = against(spec)
    with pytest.raises((LayoutError, ValidationError)) as caught:
        solve(*scene(spec, *rows))
    said = ["a thing has one group"] if spec.kind == "group" else []
    said += [row.predicate for row in (row_of(spec), *rows)]
    assert any(words in str(caught.value) for words in said), caught.value


@pytest.mark.parametrize("name", [name for name, spec in PREDICATES.items() if spec.ref_role or spec.of_role])
def test_it_asks_for_the_roles_of_its_entry(name):
    spec = PREDICATES[name]
    things = scene(spec)
    if spec.ref_role:
        wrong = [one.related([row_of(spec, ref="ref")]) if one.name == subject(spec) else one for one in things]
        with pytest.raises(ValidationError, match=f"{name} needs a {spec.ref_role}; ref is a rigid_body"):
            make(*wrong)
    if spec.of_role:
        with pytest.raises(ValidationError, match=f"{name} is a {spec.of_role}'s; b is a rigid_body"):
            make(*things, box("b", row_of(spec)))


def test_templates_are_written_out_as_rows_of_the_table():
    for spec in PREDICATES.values():
        assert (spec.kind == "template") == bool(spec.expands) and set(spec.expands) <= set(ROWS)


def test_a_new_side_is_one_entry(monkeypatch):
    """Taken, laid out, measured, said and refused, by its axis, sign and default."""
    far = Predicate("FAR-LEFT-OF", "side", "far to the left", "far left of {ref}", ("ref",), ("gap",), axis=1, sign=1.0,
                    defaults={"gap": 2.0})  # fmt: skip
    monkeypatch.setitem(ROWS, far.name, far)
    monkeypatch.setitem(PREDICATES, far.name, far)
    a = box("a", pose=Pose(position=(1.0, 2.0, 0.05)))  # 0.2 x 0.4 x 0.1 m
    placed = solve(a, box("b", rel("FAR-LEFT-OF", "a")))
    assert placed.object("b").pose.position == pytest.approx((1.0, 4.4, 0.05)) and unsatisfied(placed) == []
    assert rel("FAR-LEFT-OF", "a").sentence() == "far left of a"
    with pytest.raises(LayoutError, match=r"by 1.95 m along Y: b FAR-LEFT-OF a; b LEFT-OF a"):
        solve(a, box("b", rel("FAR-LEFT-OF", "a"), rel("LEFT-OF", "a")))


def test_a_new_template_is_one_entry(monkeypatch):
    corner = template("on_front_left_corner", "PLACE-ON, in the corner", "on the corner of {ref}",
                      ("PLACE-ON", "ALIGN-FRONT", "ALIGN-LEFT"))  # fmt: skip
    monkeypatch.setitem(PREDICATES, corner.name, corner)
    a = box("a", pose=Pose(position=(1.0, 2.0, 0.05)))
    placed = solve(a, box("b", rel(corner.name, "a"), size=(0.1, 0.1, 0.1)))
    assert placed.object("b").pose.position == pytest.approx((1.05, 2.15, 0.15)) and unsatisfied(placed) == []
    with pytest.raises(ValidationError, match=r"on the corner of a \(on_front_left_corner\)"):  # it carries
        Plan.model_validate(make(a, box("b", rel("PLACE-ON-BASE"), rel(corner.name, "a"))).model_dump())


def test_the_planners_prompt_names_rows_as_the_table_has_them():
    """The prompt is prose and names some of the table alone; what it names must be there, with what it needs."""
    prompt = Path(__file__).parents[2] / "src" / "wsim" / "agents" / "prompts" / "planner.md"
    [said] = re.findall(r"^Relations: (.*)$", prompt.read_text(encoding="utf-8"), re.MULTILINE)
    name = r"(?:[A-Z]+(?:-[A-Z]+)+|[a-z]+(?:_[a-z]+)+)"
    found = re.findall(rf"({name}(?:, {name})*)((?: \(?(?:{'|'.join(ARGUMENTS)})\b\)?)*)", said)
    assert len(found) >= 10
    for names, arguments in found:
        given = set(re.findall(r"\w+", arguments))
        for one in names.split(", "):
            spec = PREDICATES[one]
            assert set(spec.needs) <= given <= {*spec.needs, *spec.takes}, one
