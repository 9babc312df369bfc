import json

import pytest
from pydantic import ValidationError

from wsim.errors import UserError
from wsim.plan import load
from wsim.plan.schema import Assumption, Plan, Step
from wsim.rules.planner import plan

PROMPT = "Three wooden blocks float on the water in a glass tank while a steel ball drops in and sinks."


@pytest.fixture
def data() -> dict:
    return plan(PROMPT).model_dump(mode="json")


def of(data: dict, name: str) -> dict:
    return next(item for item in data["objects"] if item["name"] == name)


def rows(data: dict, name: str) -> list[dict]:
    return of(data, name)["topology"]["relation"]


def add(data: dict, name: str, **row) -> None:
    rows(data, name).append(row)


def first(data: dict, name: str) -> None:
    """Move an object to the head of the plan."""
    data["objects"].insert(0, data["objects"].pop(data["objects"].index(of(data, name))))


def group(data: dict, members: list[str], name: str = "raft") -> None:
    add(data, "wooden_block_1", predicate="GROUP", group=name, members=members)


def joint(**fields) -> dict:
    return {"name": "hinge", "kind": "hinge", "child": "steel_ball", **fields}


SUPPORT = {"predicate": "PLACE-ON-BASE"}
# what is done to the plan: words of the one line that refuses it, with {name} for the place of an object in the plan
MISTAKES = {
    # objects
    "size": (
        lambda d: of(d, "steel_ball")["construction"].update(size=[0.1, 0.1]),
        ["objects.{steel_ball}.construction.proxy: size of a sphere", "(radius,)", "it has 2"],
    ),
    "negative size": (
        lambda d: of(d, "steel_ball")["construction"].update(size=[-0.1]),
        ["construction.proxy.size.0", "> 0"],
    ),
    "primitive": (
        lambda d: of(d, "steel_ball")["construction"].update(primitive="bal"),
        ["construction.proxy.primitive", "'sphere'"],
    ),
    "kind of construction": (
        lambda d: of(d, "steel_ball")["construction"].update(kind="magic"),
        ["objects.{steel_ball}.construction", "'magic'", "'robot', 'vehicle', 'terrain', 'scatter', 'external'"],
    ),
    "no stand-in": (
        lambda d: of(d, "steel_ball").update(construction={"kind": "external", "candidate": "a ball"}),
        ["construction.external.stand_in: it is missing; add it"],
    ),
    "the old form": (
        lambda d: of(d, "steel_ball").update(size=[0.1]),
        ["objects.{steel_ball}.size: there is no such field; remove it"],
    ),
    "name taken": (
        lambda d: of(d, "steel_ball").update(name="tank"),
        ["'tank' is taken by objects.{tank}; give it another name"],
    ),
    "name no identifier": (
        lambda d: of(d, "steel_ball").update(name="steel ball"),
        ["objects.{steel_ball}.name", "it must be a name of letters, digits and _"],
    ),
    "half a character": (lambda d: d.update(title="ball \ud800"), ["title: ", "lone surrogate"]),
    "half a character in a name": (
        lambda d: of(d, "tank").update(words="\udfff"),
        ["objects.{tank}.words: ", "surrogate"],
    ),
    "half a character as a field": (lambda d: d.update({"\ud800": 1}), ["lone surrogate"]),
    "beyond a million": (
        lambda d: of(d, "steel_ball")["pose"].update(position=[0.0, 1.1e6, 0.0]),
        ["objects.{steel_ball}.pose.position.1", "<= 1000000"],
    ),
    "not finite in JSON's eyes": (
        lambda d: of(d, "steel_ball").update(velocity=[0.0, 0.0, float("inf")]),
        ["Infinity is no number of a plan"],
    ),
    "role": (
        lambda d: of(d, "steel_ball")["construction"].update(primitive="tank", size=[1, 1, 1]),
        ["steel_ball: primitive of a rigid_body is box, sphere"],
    ),
    "state": (lambda d: of(d, "water").update(state="dynamic"), ["water: state of a fluid is fluid"]),
    "fluid asset": (
        lambda d: of(d, "water").update(construction={"kind": "asset", "asset": "sea"}),
        ["water: a fluid is no asset"],
    ),
    "material": (
        lambda d: of(d, "steel_ball").update(material=None),
        ['steel_ball: a dynamic body needs "material"'],
    ),
    "mass and density": (
        lambda d: of(d, "steel_ball").update(registration={"mass": 1.0, "density": 10.0}),
        ["objects.{steel_ball}.registration", "keep one of them"],
    ),
    "misspelt": (lambda d: d.update(objectves=[]), ["objectves", "spelling"]),
    # rows
    "reference": (
        lambda d: rows(d, "steel_ball")[0].update(ref="lake"),
        ["topology.relation.0.ref", "'lake'", "the plan has ground, tank"],
    ),
    "itself": (lambda d: rows(d, "steel_ball")[0].update(ref="steel_ball"), ["cannot be placed by itself"]),
    "predicate": (
        lambda d: rows(d, "steel_ball")[0].update(predicate="FLOAT-AT-SURFACE"),
        ["objects.{steel_ball}.topology.relation.0", "did you mean FLOATS-AT-SURFACE?"],
    ),
    "predicate like none": (
        lambda d: rows(d, "steel_ball")[0].update(predicate="???"),
        ["there is no predicate '???'; the predicates are LEFT-OF, "],
    ),
    "argument missing": (
        lambda d: rows(d, "water")[1].update(value=None),
        ['FREE-SURFACE-AT needs "value": a height or depth in metres'],
    ),
    "argument not taken": (
        lambda d: rows(d, "water")[1].update(gap=0.1),
        ['objects.{water}.topology.relation.1: FREE-SURFACE-AT takes value; remove "gap"'],
    ),
    "argument unknown": (
        lambda d: rows(d, "water")[1].update(hight=0.1),
        ["objects.{water}.topology.relation.1.hight: there is no such"],
    ),
    "region upside down": (
        lambda d: rows(d, "steel_ball").append(
            {"predicate": "PLACE-ANYWHERE", "region": {"low": [1, 0], "high": [0, 1]}}
        ),
        ["relation.2.region: low (1.0, 0.0) must be below high"],
    ),
    "afloat on glass": (
        lambda d: rows(d, "wooden_block_1")[0].update(ref="tank"),
        ["needs a fluid; tank is a container"],
    ),
    "filling a block": (
        lambda d: of(d, "water")["topology"].update(
            relation=[{"predicate": "fills_container_to_top", "ref": "ground"}]
        ),
        ["objects.{water}.topology.relation.0.ref: fills_container_to_top needs a container; ground is a terrain"],
    ),
    "surface of a solid": (
        lambda d: add(d, "tank", predicate="FREE-SURFACE-AT", value=1.0),
        ["objects.{tank}.topology.relation.1: FREE-SURFACE-AT is a fluid's; tank is a container"],
    ),
    # what carries what
    "fluid nowhere": (lambda d: of(d, "water")["topology"].update(relation=[]), ["water needs PLACE-IN", "or a size"]),
    "fluid without a surface": (
        lambda d: of(d, "water")["topology"].update(relation=[{"predicate": "PLACE-IN", "ref": "tank"}]),
        ["objects.{water}.topology.relation: the fluid water needs FREE-SURFACE-AT", "fills_container_to_top"],
    ),
    "fluid too late": (
        lambda d: first(d, "steel_ball"),
        [
            "objects.0.topology.relation.0.ref: the fluid water comes after steel_ball",
            "move it up: objects.",
        ],
    ),
    "two supports": (
        lambda d: rows(d, "tank").append({"predicate": "SPAWNED-ABOVE", "value": 1.0}),
        [
            "objects.{tank}.topology.relation.1: tank is 1 m above the ground (SPAWNED-ABOVE), "
            "and on the ground (PLACE-ON-BASE) by relation.0",
            "remove one of the two rows",
        ],
    ),
    "support and template": (
        lambda d: add(d, "wooden_block_1", predicate="centered_on_ref", ref="tank"),
        ["objects.{wooden_block_1}.topology.relation.1: ", "(centered_on_ref)", "(FLOATS-AT-SURFACE) by relation.0"],
    ),
    "circle of supports": (
        lambda d: (
            rows(d, "wooden_block_1").__setitem__(0, {"predicate": "PLACE-ON", "ref": "wooden_block_2"}),
            rows(d, "wooden_block_2").__setitem__(0, {"predicate": "placed_on_top", "ref": "wooden_block_1"}),
        ),
        [
            "objects.{wooden_block_1}.topology.relation.0.ref: nothing carries these in the end: ",
            "wooden_block_1 on wooden_block_2 (objects.{wooden_block_1}.topology.relation.0)",
            "wooden_block_2 on wooden_block_1 (objects.{wooden_block_2}.topology.relation.0)",
        ],
    ),
    "afloat in what stands on it": (
        lambda d: rows(d, "tank").__setitem__(0, {"predicate": "PLACE-ON", "ref": "wooden_block_1"}),
        ["nothing carries these in the end", "tank on wooden_block_1", "water in tank"],
    ),
    # groups
    "two groups": (
        lambda d: (
            group(d, ["wooden_block_2"]),
            add(d, "steel_ball", predicate="GROUP", group="b", members=["wooden_block_2"]),
        ),
        ["objects.{steel_ball}.topology.relation.2.members: wooden_block_2 is in the group of wooden_block_1 already"],
    ),
    "a group's name taken": (lambda d: group(d, ["wooden_block_2"], "tank"), ["'tank' is taken; give the group"]),
    "placed by its own group": (
        lambda d: (group(d, ["wooden_block_2"]), add(d, "wooden_block_2", predicate="FACING-TO", ref="raft")),
        ["objects.{wooden_block_2}.topology.relation.", "is in the group raft, and cannot be placed by it"],
    ),
    "copy of nothing": (
        lambda d: add(d, "wooden_block_1", predicate="COPY-GROUP", group="fleet", members=["wooden_block_2"]),
        ["group: no group 'fleet'; the plan's groups: none"],
    ),
    "copy of another count": (
        lambda d: (
            group(d, ["wooden_block_2"]),
            add(d, "wooden_block_3", predicate="COPY-GROUP", group="raft", members=["steel_ball", "tank"]),
        ),
        ["members: 2 members copy the group raft, which has 1 beside its anchor; name as many"],
    ),
    # joints, cameras, sensors, steps, objectives, outputs
    "joint of nothing": (
        lambda d: d.update(joints=[joint(parent="crane")]),
        ["joints.0.parent: no object 'crane'; the plan has ground, tank"],
    ),
    "joint with itself": (
        lambda d: d.update(joints=[joint(parent="steel_ball")]),
        ["joints.0.parent: steel_ball cannot hold itself"],
    ),
    "joint's limits": (
        lambda d: d.update(joints=[joint(limits=[2, 1])]),
        ["joints.0.limits: (2, 1) deg: the low limit", "swap"],
    ),
    "limits without the start": (
        lambda d: d.update(joints=[joint(limits=[10, 20])]),
        ["joints.0.limits: (10, 20) deg must hold 0, where the joint starts"],
    ),
    "limits that leave no way": (
        lambda d: d.update(joints=[joint(limits=[0, 0])]),
        ["joints.0.limits: (0, 0) deg leave it no way to go; use a fixed joint"],
    ),
    "limits that are no list": (
        lambda d: d.update(joints=[joint(limits="wide")]),
        ['joints.0.limits: it must be a list, [...]; it is "wide"'],
    ),
    "a drive of no strength": (
        lambda d: d.update(joints=[joint(drive={"damping": 1, "max_force": -1})]),
        ["joints.0.drive.max_force: it must be > 0; it is -1"],
    ),
    "duration": (lambda d: d["simulation"].update(duration=0), ["simulation.duration", "> 0; it is 0"]),
    "an endless duration": (
        lambda d: d["simulation"].update(duration=1e5),
        ["simulation.duration: 100000 must be <= 3600 s"],
    ),
    "frames": (lambda d: d["simulation"].update(frame_rate=1e5), ["frame_rate: 100000 must be <= 1000 Hz"]),
    "a time step of 28 days": (
        lambda d: d["simulation"].update(time_step=1e-9),
        ["simulation.time_step: 1e-09 must be >= 1e-05 s, or 0 for the simulator's choice"],
    ),
    "a time step of hours": (lambda d: d["simulation"].update(time_step=9), ["simulation.time_step: 9 must be <= 1 s"]),
    "friction of a contact": (
        lambda d: d.update(contacts=[{"object": "steel_ball", "ref": "ground", "friction": 20}]),
        ["contacts.0.friction: 20 must be <= 10"],
    ),
    "friction of a material": (
        lambda d: of(d, "steel_ball")["material"].update(friction=20),
        ["objects.{steel_ball}.material.friction: 20 must be <= 10"],
    ),
    "a contact of what a joint ties": (
        lambda d: d.update(
            joints=[joint(parent="wooden_block_1")],
            contacts=[{"object": "steel_ball", "ref": "wooden_block_1", "friction": 0.1}],
        ),
        ["contacts.0: steel_ball and wooden_block_1 never touch: the joint hinge ties them; leave one of the two out"],
    ),
    "speed of the ground": (
        lambda d: of(d, "ground").update(velocity=[1, 0, 0]),
        ["velocity: [1.0, 0.0, 0.0] of ground, which is static and never moves; remove it"],
    ),
    "a fluid that spins": (
        lambda d: of(d, "water").update(velocity=[1, 0, 0], angular_velocity_deg=[0, 0, 90]),
        ["angular_velocity_deg: [0.0, 0.0, 90.0] of water, which is a fluid, and starts without a spin; remove it"],
    ),
    "limits of a fixed joint": (
        lambda d: d.update(joints=[joint(kind="fixed", limits=[0, 1])]),
        ["joints.0.limits: a fixed joint has none"],
    ),
    "actuation of no joint": (
        lambda d: (
            d.update(joints=[joint()]),
            of(d, "steel_ball")["registration"].update(
                actuation=[{"kind": "velocity", "joint": "axle", "target": [1]}]
            ),
        ),
        ["objects.{steel_ball}.registration.actuation.0.joint: no joint 'axle'; the plan has hinge"],
    ),
    "a joint driven twice": (
        lambda d: (
            d.update(joints=[joint(drive={"velocity": 1.0, "damping": 1.0})]),
            of(d, "steel_ball")["registration"].update(
                actuation=[{"kind": "velocity", "joint": "hinge", "target": [1]}]
            ),
        ),
        ["objects.{steel_ball}.registration.actuation.0.joint: hinge has a drive; remove it, or this actuation"],
    ),
    "camera's name": (
        lambda d: d["cameras"][0].update(name="steel_ball"),
        ["cameras.0.name", "taken by objects.{steel_ball}"],
    ),
    "camera without a place": (
        lambda d: d.update(cameras=[{"name": "side", "eye": [1, 1, 1]}]),
        ['cameras.0: camera side: give "eye" and "target", or a "view"'],
    ),
    "camera at itself": (
        lambda d: d.update(cameras=[{"name": "side", "eye": [1, 1, 1], "target": [1, 1, 1]}]),
        ["cameras.0: camera side: eye and target are both"],
    ),
    "camera's view": (
        lambda d: d.update(cameras=[{"name": "side", "view": "from_above"}]),
        ["cameras.0.view: it must be 'side_minus_x'"],
    ),
    "camera that follows what stands": (
        lambda d: d.update(cameras=[{"name": "side", "view": "top_down", "follows": "tank"}]),
        ["cameras.0.follows: 'tank' is no body that moves; the plan has "],
    ),
    "camera of nothing": (
        lambda d: d.update(cameras=[{"name": "side", "view": "top_down", "of": "whale"}]),
        ["cameras.0.of: no object 'whale'"],
    ),
    "sensor on nothing": (
        lambda d: d.update(sensors=[{"name": "imu", "kind": "imu", "mount": "whale"}]),
        ["sensors.0.mount: no object 'whale'"],
    ),
    "step of nothing": (
        lambda d: d.update(steps=[{"title": "fill", "objects": ["tank", "whale"], "shows": "water"}]),
        ["steps.0.objects.1: no object 'whale'"],
    ),
    "objective of nothing": (
        lambda d: d["objectives"][0].update(object="whale"),
        ["objectives.0.object", "'whale'"],
    ),
    "objective without a reference": (
        lambda d: d["objectives"][0].update(ref=None),
        ["objectives.0.ref", '"floats" needs "ref"'],
    ),
    "still of nothing": (
        lambda d: d.update(outputs={"stills": ["back"]}),
        ["outputs.stills.0: no camera 'back'; the plan has "],
    ),
    "seed": (lambda d: d["simulation"].update(seed=2**31), ["simulation.seed", "< 2147483648"]),
    # the plan itself
    "version 1": (lambda d: d.update(version=1), ["version 1: this version of wsim reads version 2 plans"]),
    "no version": (lambda d: d.update(version="two"), ["version: it must be 2"]),
    "hash of a picture": (
        lambda d: d.update(image={"path": "a.png", "sha256": "abc"}),
        ["image.sha256: it must match"],
    ),
}


@pytest.mark.parametrize("mistake", MISTAKES)
def test_each_mistake_is_refused_where_it_is(tmp_path, data, mistake):
    spoil, words = MISTAKES[mistake]
    index = {item["name"]: k for k, item in enumerate(data["objects"])}
    spoil(data)
    path = tmp_path / "plan.json"
    path.write_text(json.dumps(data))
    with pytest.raises(UserError) as caught:
        load(path)
    message = str(caught.value)
    assert message.startswith(str(path)) and "\n" not in message
    for word in words:
        assert word.format(**index) in message, message


def test_a_chain_of_supports_may_be_as_long_as_a_plan():
    """No recursion: ten thousand boxes on one another are checked, and a circle of as many is found."""
    box = {
        "role": "rigid_body",
        "construction": {"kind": "proxy", "primitive": "box", "size": [1, 1, 1]},
        "state": "static",
    }
    objects = [
        {**box, "name": f"b{k}", "topology": {"relation": [{"predicate": "PLACE-ON", "ref": f"b{k - 1}"}]}}
        for k in range(1, 10_000)
    ]
    whole = {"title": "tower", "prompt": "", "objects": [{**box, "name": "b0"}, *objects]}
    assert len(Plan.model_validate(whole).objects) == 10_000
    whole["objects"][0]["topology"] = {"relation": [{"predicate": "PLACE-ON", "ref": "b9999"}]}
    with pytest.raises(ValidationError, match="nothing carries these in the end"):
        Plan.model_validate(whole)


def test_a_fluid_may_have_a_size_of_its_own_or_fill_what_holds_it(data):
    of(data, "water")["construction"]["size"] = [0.3, 0.3, 0.2]
    of(data, "water")["topology"]["relation"] = [{"predicate": "PLACE-IN", "ref": "tank"}]
    Plan.model_validate(data)
    of(data, "water")["construction"]["size"] = []
    add(data, "water", predicate="fills_container_lower_half", ref="tank")
    Plan.model_validate(data)


def test_numbers_must_be_finite(data):
    of(data, "steel_ball")["velocity"] = [0.0, 0.0, float("nan")]
    with pytest.raises(ValidationError):
        Plan.model_validate(data)


def test_what_is_open_of_a_choice_or_a_step_is_not_written():
    plain = {"subject": "a ball", "choice": "of wood", "why": "the prompt names no material"}
    assert Assumption(**plain).model_dump(mode="json") == plain
    kind = {**plain, "kind": "material", "value": "wood"}
    assert Assumption.model_validate_json(Assumption(**kind).model_dump_json()) == Assumption(**kind)
    assert Step(title="motion", shows="it turns").model_dump() == {
        "title": "motion",
        "objects": [],
        "shows": "it turns",
    }
    assert Step(title="motion", shows="it turns", controls=False).model_dump()["controls"] is False
    for half in ({"kind": "material"}, {"value": "wood"}):
        with pytest.raises(ValidationError, match="go together"):
            Assumption(**plain, **half)


def test_a_step_asks_for_control_by_its_field_or_by_its_words():
    """A plan from before the field names control in words."""
    assert Step(title="The motor turns", shows="Control turns the crank").asks_for_control
    assert Step(title="motion", shows="it turns", controls=True).asks_for_control
    assert not Step(title="motion", shows="it is out of control", controls=False).asks_for_control
    assert not Step(title="motion", shows="it turns").asks_for_control
