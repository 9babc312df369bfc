"""Masses, sizes, places, looks, joints and cameras against the plan: what differs by a stated size is found."""

import math
from dataclasses import replace

import numpy as np
import pytest

from tests.crashing import crashing
from tests.judge.theory import (
    RADIUS,
    STEP,
    G,
    ask,
    ball,
    box,
    camera,
    ground,
    only,
    record,
    resting,
    swinging,
    times,
    with_world,
)
from wsim.judge.checks.camera import CheckInFrame, CheckSeen
from wsim.judge.checks.mass import CheckMass
from wsim.judge.checks.plan import CheckPlanLooks, CheckPlanPlaces, CheckPlanSizes
from wsim.judge.checks.plan_joints import CheckPlanJoints
from wsim.judge.language import ObjectiveCheck
from wsim.plan.schema import Objective, Plan, PlanObject
from wsim.plan.schema.formula_place import Crosses
from wsim.recording.recording import SeenTrack
from wsim.scene.world import Motor, Parameter, Shape, Static

SIZE = (0.4, 0.2, 0.1)
BOX_KG, BALL_KG = 500.0 * math.prod(SIZE), 2.0
RED, BLUE = (0.8, 0.1, 0.1), (0.1, 0.1, 0.8)
QUARTER = (0.0, 0.0, math.sqrt(0.5), math.sqrt(0.5))


def a_plan(**joint):
    material = {"name": "wood", "density": 500.0, "friction": 0.5, "color": RED}
    ground = {"kind": "proxy", "primitive": "ground"}
    objects = [
        {"name": "ground", "role": "terrain", "state": "static", "construction": ground},
        {
            "name": "box", "role": "rigid_body", "construction": {"kind": "proxy", "primitive": "box", "size": SIZE},
            "material": material, "pose": {"position": (0.0, 0.0, 0.05)},
        },
        {
            "name": "ball", "role": "rigid_body", "material": {**material, "name": "paint", "color": BLUE},
            "construction": {"kind": "proxy", "primitive": "sphere", "size": (RADIUS,)}, "velocity": (2.0, 0.0, 0.0),
            "pose": {"position": (1.0, 0.0, 0.1)}, "registration": {"mass": BALL_KG},
        },
    ]  # fmt: skip
    plan = {
        "title": "a box and a ball",
        "prompt": "A box and a ball",
        "objects": objects,
        "joints": [{"anchor": (0.0, 0.0, 0.5)} | joint] if joint else [],
    }
    return Plan.model_validate(plan)


def a_world(places=((0.0, 0.0, 0.05), (1.0, 0.0, 0.1)), rotation=None, **changed):
    """The plan's world; `changed` has fields of a body or its shape, as "box__mass" or "ball__shape__color"."""
    t = times(0.2)
    made = {"box": box(size=SIZE, mass=BOX_KG), "ball": ball(mass=BALL_KG, velocity=(2.0, 0.0, 0.0))}
    fields = {"box__shape__color": RED, "ball__shape__color": BLUE} | changed
    for key, value in fields.items():
        name, *rest = key.split("__")
        body = made[name]
        shape = body.shapes[0].model_copy(update={rest[-1]: value} if rest[0] == "shape" else {})
        own = {} if rest[0] == "shape" else {rest[0]: value}
        made[name] = body.model_copy(update={"shapes": [shape], **own})
    place = np.tile(np.array(places), (len(t), 1, 1))
    turn = None if rotation is None else np.tile(np.array([rotation, (0.0, 0.0, 0.0, 1.0)]), (len(t), 1, 1))
    return record(list(made.values()), place, np.zeros((len(t), 2, 3)), t, rotation=turn, statics=[ground()])


CHECKS = (CheckMass, CheckPlanSizes, CheckPlanPlaces, CheckPlanLooks)


def wrong(recording, plan=None):
    return [f for check in CHECKS for f in ask(check(), recording, plan or a_plan()) if not f.passed]


def test_the_plans_world_passes_and_says_so():
    findings = [ask(check(), a_world(), a_plan()) for check in CHECKS]
    assert [only(f).passed for f in findings] == [True] * 4
    assert wrong(a_world(box__shape__size=(0.405, 0.2, 0.1), box__mass=1.02 * BOX_KG)) == []


# ---- mass
@pytest.mark.parametrize(
    ("factor", "passes"), [(3.0, False), (1 / 3, False), (1.06, False), (0.94, False), (1.04, True), (0.96, True)]
)
def test_a_mass_is_density_times_volume(factor, passes):
    inertia = tuple(factor * x for x in box(size=SIZE, mass=BOX_KG).inertia)
    found = wrong(a_world(box__mass=factor * BOX_KG, box__inertia=inertia))
    assert (found == []) == passes
    for finding in found:
        assert finding.prim == "/World/box" and finding.value == pytest.approx(factor * BOX_KG)
        assert finding.expected == pytest.approx(BOX_KG) and finding.target.suggested == pytest.approx(500.0)
        assert finding.target.direction == ("lower" if factor > 1 else "raise")


def test_a_parameter_that_was_changed_may_change_a_mass_by_half_and_no_more():
    changed = [Parameter(name="density", value=750.0, default=500.0)]
    inertia = tuple(1.5 * x for x in box(size=SIZE, mass=BOX_KG).inertia)
    heavier = a_world(box__mass=1.5 * BOX_KG, box__inertia=inertia)
    assert wrong(heavier) and wrong(with_world(heavier, parameters=changed)) == []
    thrice = a_world(box__mass=3.0 * BOX_KG, box__inertia=tuple(2.0 * x for x in inertia))
    assert wrong(with_world(thrice, parameters=changed))


@pytest.mark.parametrize(("by", "fits"), [(0.8, False), (0.98, True), (1.02, True), (1.2, False)])
def test_a_planned_solid_turns_as_one_of_its_material(by, fits):
    inertia = tuple(by * x for x in box(size=SIZE, mass=BOX_KG).inertia)
    assert (wrong(a_world(box__inertia=inertia)) == []) == fits


@pytest.mark.parametrize(("share", "fits"), [(0.005, True), (0.05, False)])
def test_a_planned_solid_has_its_centre_where_its_shape_has_it(share, fits):
    low = (0.0, 0.0, -share * SIZE[2])
    assert (wrong(a_world(box__com=low)) == []) == fits


@pytest.mark.parametrize(("density", "passes"), [(0.5, False), (1.5, True), (22_000.0, True), (23_000.0, False)])
def test_without_a_plan_it_is_some_matter(density, passes):
    body = box(mass=density * 0.008)
    finding = ask(CheckMass(), with_world(resting(), bodies=[body]))[0]
    assert finding.passed == passes


@pytest.mark.parametrize(
    ("moments", "passes"),
    [
        ((1.0, 1.0, 1.0), True),
        ((20.0, 20.0, 20.0), False),  # beyond m R^2
        ((0.01, 0.01, 0.01), False),  # all of it in the middle
        ((0.5, 0.5, 1.2), False),  # no mass has moments of which one is more than the others' sum
        ((0.6, 0.6, 1.19), True),
    ],
)
def test_an_inertia_is_that_of_some_mass_of_its_size(moments, passes):
    inertia = tuple(np.diag(np.array(moments) * 4.0 * 0.2**2 / 6).ravel())
    body = box().model_copy(update={"inertia": inertia})
    assert ask(CheckMass(), with_world(resting(), bodies=[body]))[0].passed == passes


# ---- sizes, places, looks
@pytest.mark.parametrize(("factor", "passes"), [(1.25, False), (0.8, False), (1.06, False), (1.04, True), (0.96, True)])
def test_a_size_is_the_plans(factor, passes):
    found = ask(CheckPlanSizes(), a_world(box__shape__size=(factor * 0.4, 0.2, 0.1)), a_plan())
    assert all(f.passed for f in found) == passes
    assert passes or (found[0].value == pytest.approx(factor) and found[0].target.suggested == pytest.approx(0.4))


def test_an_object_without_a_collision_shape_is_found():
    finding = only(ask(CheckPlanSizes(), a_world(box__shape__collides=False), a_plan()))
    assert not finding.passed and finding.prim == "/World/box"


def test_objects_that_are_swapped_or_moved_are_found():
    swapped = ask(CheckPlanPlaces(), a_world(places=((1.0, 0.0, 0.05), (0.0, 0.0, 0.1))), a_plan())
    assert {f.prim for f in swapped if not f.passed} == {"/World/box", "/World/ball"}
    for shift, passes in ((0.09, True), (0.11, False)):  # a quarter of 0.4 m
        found = ask(CheckPlanPlaces(), a_world(places=((shift, 0.0, 0.05), (1.0, 0.0, 0.1))), a_plan())
        assert all(f.passed for f in found) == passes


def test_a_turned_box_is_found_unless_it_looks_the_same():
    def turn(degrees):
        half = math.radians(degrees) / 2
        return (0.0, 0.0, math.sin(half), math.cos(half))

    for degrees, passes in ((0.0, True), (3.5, True), (4.5, False), (90.0, False), (180.0, True)):
        found = ask(CheckPlanPlaces(), a_world(rotation=turn(degrees)), a_plan())
        assert all(f.passed for f in found) == passes, degrees
    # Its edges exchanged and turned by a quarter, it is the same box.
    exchanged = (0.2, 0.4, 0.1)
    inertia = box(size=exchanged, mass=BOX_KG).inertia
    assert wrong(a_world(rotation=QUARTER, box__shape__size=exchanged, box__inertia=inertia)) == []


@pytest.mark.parametrize(("speed", "passes"), [(2.0, True), (2.06, True), (1.0, False), (-2.0, False)])
def test_a_start_is_as_fast_as_the_plans(speed, passes):
    found = ask(CheckPlanPlaces(), a_world(ball__velocity=(speed, 0.0, 0.0)), a_plan())
    assert all(f.passed for f in found) == passes


@pytest.mark.parametrize(("steps", "passes"), [(0.9, True), (1.1, False), (10.0, False)])
def test_what_is_to_stand_has_no_speed_but_a_steps(steps, passes):
    """What gravity gives in a step may be there: an engine may record its first frame after it."""
    found = ask(CheckPlanPlaces(), a_world(box__velocity=(0.0, 0.0, -steps * G * STEP)), a_plan())
    assert all(f.passed for f in found) == passes


@pytest.mark.parametrize(
    ("change", "unit"),
    [
        ({"box__shape__color": BLUE}, "colour"),
        ({"box__shape__friction": 0.2}, "friction"),
        ({"box__shape__restitution": 0.5}, "restitution"),
    ],
)
def test_another_colour_or_surface_is_found(change, unit):
    finding = only(ask(CheckPlanLooks(), a_world(**change), a_plan()))
    assert not finding.passed and finding.prim == "/World/box" and unit in finding.message
    near = {"box__shape__color": (0.85, 0.1, 0.15), "box__shape__friction": 0.53}
    assert only(ask(CheckPlanLooks(), a_world(**near), a_plan())).passed


@pytest.mark.parametrize(("primitive", "size"), [("ground", ()), ("tank", (0.4, 0.4, 0.3))])
@pytest.mark.parametrize(("friction", "passes"), [(0.5, True), (0.53, True), (0.3, False), (0.0, False)])
def test_the_ground_and_every_wall_of_a_tank_are_of_the_plans_material(primitive, size, friction, passes):
    world, plan = a_world(), a_plan()
    under = PlanObject.model_validate(
        {"name": "ground", "role": "container" if size else "terrain", "state": "static",
         "material": plan.objects[1].material,
         "construction": {"kind": "proxy", "primitive": primitive, "size": size}}
    )  # fmt: skip
    plan = plan.model_copy(update={"objects": [under, *plan.objects[1:]]})
    walls = [Shape(prim=f"/World/ground/{k}", kind="box", size=(0.4, 0.4, 0.02), friction=mu, color=RED)
             for k, mu in enumerate([0.5, friction, 0.5])]  # fmt: skip
    plane = [ground(friction).shapes[0].model_copy(update={"color": RED})]
    static = Static(prim="/World/ground", shapes=walls if size else plane)
    finding = only(ask(CheckPlanLooks(), with_world(world, statics=[static]), plan))
    assert finding.passed == passes
    assert passes or (finding.prim == "/World/ground" and finding.value == friction)


def test_without_a_plan_nothing_is_compared():
    assert all(ask(check(), a_world()) == [] for check in CHECKS[1:])


def test_a_joint_of_the_plan_that_the_world_lacks_is_found():
    plan = a_plan(name="hinge", kind="hinge", child="box")
    missing = only(ask(CheckPlanJoints(), a_world(), plan))
    assert not missing.passed and missing.target.kind == "joint" and missing.target.direction == "add"
    joint = swinging().world.joints[0].model_copy(update={"child": "/World/box"})
    assert only(ask(CheckPlanJoints(), with_world(a_world(), joints=[joint]), plan)).passed
    other = joint.model_copy(update={"kind": "fixed"})
    assert only(ask(CheckPlanJoints(), with_world(a_world(), joints=[other]), plan)).target.parameter == "kind"
    assert ask(CheckPlanJoints(), a_world(), a_plan()) == []


def hinged(low=-80.0, high=90.0, **drive):
    """The plan's world, its box on a hinge with limits [deg] and a drive."""
    limits = {"low": low and math.radians(low), "high": high and math.radians(high)}
    fields = {"child": "/World/box", "drive": Motor(**drive) if drive else None, **limits}
    return with_world(a_world(), joints=[swinging().world.joints[0].model_copy(update=fields)])


@pytest.mark.parametrize(
    ("low", "high", "passes"),
    [(-80, 90, True), (-90, 80, True), (-80, 97, True), (-80, 100, False), (-80, 150, False), (-80, None, False)],
)
def test_a_joint_ends_where_the_plan_has_it_seen_from_either_end(low, high, passes):
    plan = a_plan(name="hinge", kind="hinge", child="box", limits=(-80.0, 90.0))
    finding = only(ask(CheckPlanJoints(), hinged(low, high), plan))
    assert finding.passed == passes
    assert passes or (finding.target.parameter, finding.target.vector) == ("limits_deg", (-80.0, 90.0))
    assert high is None or passes or finding.value == pytest.approx(math.radians(high - 90.0), rel=1e-6)


DRIVE = {"position": math.degrees(1.0), "stiffness": 10.0, "damping": 2.0, "max_force": 40.0}
MOTOR = {"position": 1.0, "stiffness": 10.0, "damping": 2.0, "max_effort": 40.0}


def driven(kind="hinge", plan=DRIVE, **motor):
    """A world whose box is driven by a motor, and a plan with a drive."""
    world = hinged(None, None, **motor)
    if kind == "slider":
        world = with_world(world, joints=[world.world.joints[0].model_copy(update={"kind": "prismatic"})])
    return world, a_plan(name="joint", kind=kind, child="box", drive=plan)


@pytest.mark.parametrize(("position", "passes"), [(1.0, True), (-1.04, True), (1.06, False), (2.0, False)])
def test_a_drive_is_set_to_what_the_plan_has(position, passes):
    world, plan = driven(**{**MOTOR, "position": position})
    finding = only(ask(CheckPlanJoints(), world, plan))
    assert finding.passed == passes
    assert passes or (finding.target.suggested == pytest.approx(1.0) and finding.target.parameter == "drive.position")
    assert only(ask(CheckPlanJoints(), replace(world, metadata={"controlled": True}), plan)).passed
    changed = with_world(world, parameters=[Parameter(name="angle", value=2.0, default=1.0)])
    assert only(ask(CheckPlanJoints(), changed, plan)).passed


@pytest.mark.parametrize(("velocity", "passes"), [(2.0, True), (-2.0, True), (2.09, True), (2.2, False), (0.0, False)])
@pytest.mark.parametrize("kind", ["hinge", "slider"])
def test_a_motor_turns_as_fast_as_the_plans(kind, velocity, passes):
    planned = {"velocity": math.degrees(2.0) if kind == "hinge" else 2.0, "damping": 5.0}
    world, plan = driven(kind, planned, velocity=velocity, damping=5.0)
    finding = only(ask(CheckPlanJoints(), world, plan))
    assert finding.passed == passes
    assert passes or finding.unit == ("rad/s" if kind == "hinge" else "m/s")


@pytest.mark.parametrize(
    ("change", "parameter", "direction"),
    [
        ({"stiffness": 1.0}, "drive.stiffness", "raise"),
        ({"damping": 20.0}, "drive.damping", "lower"),
        ({"max_effort": 4.0}, "drive.max_force", "raise"),
        ({"max_effort": None}, "drive.max_force", "lower"),
        ({"saturates": True}, "drive.saturates", "remove"),
    ],
)
def test_a_drive_is_as_strong_as_the_plans(change, parameter, direction):
    near = {"position": 1.0, "stiffness": 10.4, "damping": 1.92, "max_effort": 41.0}
    assert only(ask(CheckPlanJoints(), *driven(**near))).passed
    finding = only(ask(CheckPlanJoints(), *driven(**{**MOTOR, **change})))
    assert not finding.passed and (finding.target.parameter, finding.target.direction) == (parameter, direction)


def test_a_spring_where_the_plan_has_a_motor_is_found():
    motor = {"velocity": math.degrees(2.0), "damping": 5.0}
    found = ask(CheckPlanJoints(), *driven(plan=motor, position=1.0, stiffness=10.0))
    assert {f.target.parameter for f in found} == {"drive.velocity", "drive.stiffness", "drive.damping"}


def test_a_drive_that_the_world_lacks_is_found():
    finding = only(ask(CheckPlanJoints(), *driven()))
    assert not finding.passed and (finding.target.kind, finding.target.direction) == ("drive", "add")


# ---- cameras
def test_a_camera_that_looks_away_is_found():
    right = with_world(a_world(), cameras=[camera()])
    assert only(ask(CheckInFrame(), right)).passed
    away = with_world(a_world(), cameras=[camera(target=(0.0, -10.0, 1.0))])
    assert {f.prim for f in ask(CheckInFrame(), away) if not f.passed} == {"/World/side", "/World/box", "/World/ball"}
    two = with_world(a_world(), cameras=[camera(), camera(target=(0.0, -10.0, 1.0), name="other")])
    assert {f.prim for f in ask(CheckInFrame(), two) if not f.passed} == {"/World/other"}
    assert ask(CheckInFrame(), a_world()) == []


@pytest.mark.parametrize(("asked", "passes"), [("ball", False), ("box", True)])
def test_what_is_asked_for_and_gone_most_of_the_time_is_found(asked, passes):
    """A ball that is out of the picture after a tenth of the run: none shows what the ball was asked to do."""
    t = times(2.0)
    place = np.tile(np.array(((0.0, 0.0, 0.05), (1.0, 0.0, 0.1))), (len(t), 1, 1))
    place[t > 0.2, 1, 0] += 50.0
    bodies = [box(size=SIZE, mass=BOX_KG), ball(mass=BALL_KG)]
    still = record(bodies, place, np.zeros((len(t), 2, 3)), t, statics=[ground()])
    plan = a_plan().model_copy(update={"objectives": [Objective(kind="settles", object=asked)]})
    found = ask(CheckInFrame(), with_world(still, cameras=[camera()]), plan)
    assert {f.prim for f in found if not f.passed} == (set() if passes else {"/World/ball"})


@pytest.mark.parametrize(("follows", "out"), [("/World/ball", set()), ("/World/box", {"/World/ball"}), (None, None)])
def test_a_camera_that_follows_has_what_goes_far_in_frame(follows, out):
    """A ball goes 60 m, to be asked about: one that goes with it shows it all the time, one that stays does not."""
    t = times(2.0)
    place = np.tile(np.array(((0.0, 0.0, 0.05), (1.0, 0.0, 0.1))), (len(t), 1, 1))
    place[:, 1, 0] += 30.0 * t
    bodies = [box(size=SIZE, mass=BOX_KG), ball(mass=BALL_KG)]
    goes = record(bodies, place, np.gradient(place, t, axis=0), t, statics=[ground()])
    goes = with_world(goes, bodies=[bodies[0], bodies[1].model_copy(update={"position": (1.0, 0.0, 0.1)})])
    plan = a_plan().model_copy(update={"objectives": [Objective(kind="settles", object="ball")]})
    seen_by = camera().model_copy(update={"follows": follows})
    found = ask(CheckInFrame(), with_world(goes, cameras=[seen_by]), plan)
    assert {f.prim for f in found if not f.passed} == (out if out is not None else {"/World/ball"})
    both = [seen_by, camera(target=(0.0, -10.0, 1.0), name="other")]
    away = next(f for f in ask(CheckInFrame(), with_world(goes, cameras=both), plan) if f.prim == "/World/other")
    assert not away.passed and away.target.prim == "/World/other"


@pytest.mark.parametrize(("at", "passes"), [(1.0, True), (3.0, False)])
def test_what_happens_is_in_the_picture_as_it_does(at, passes):
    """Seen for most of the time, a ball crosses x = 3 m out of a picture that ends 2.3 m to the right."""
    t = times(2.0)
    place = np.tile(np.array(((0.0, 0.0, 0.05), (0.0, 0.0, 0.1))), (len(t), 1, 1))
    place[:, 1, 0] = 2.0 * t
    bodies = [box(size=SIZE, mass=BOX_KG), ball(mass=BALL_KG)]
    moves = record(bodies, place, np.gradient(place, t, axis=0), t, statics=[ground()])
    asked = Objective(kind="formula", object="ball", formula=Crosses(object="ball", axis="x", at=at))
    plan = a_plan().model_copy(update={"objectives": [asked]})
    found = [f for f in ask(CheckInFrame(), with_world(moves, cameras=[camera()]), plan) if not f.passed]
    assert [(f.prim, round(f.time, 1)) for f in found] == ([] if passes else [("/World/ball", at / 2.0)])


def test_an_objective_that_crashes_takes_no_camera_with_it(monkeypatch):
    crashing(monkeypatch, ObjectiveCheck)
    plan = a_plan().model_copy(update={"objectives": [Objective(kind="settles", object="box")]})
    found = ask(CheckInFrame(), with_world(a_world(), cameras=[camera(target=(0.0, -10.0, 1.0))]), plan)
    assert [f.passed for f in found].count(False) > 0


@pytest.mark.parametrize(
    ("x", "z", "passes"), [(2.2, 1.0, True), (2.5, 1.0, False), (0.0, 2.25, True), (0.0, 2.4, False)]
)
def test_the_frame_is_as_wide_and_as_high_as_the_lens_has_it(x, z, passes):
    """At 5 m, 50 degrees are 2 * 2.33 m across, and 9/16 of that high."""
    world = with_world(a_world(places=((x, 0.0, z), (x, 0.0, z))), cameras=[camera()])
    assert all(f.passed for f in ask(CheckInFrame(), world)) == passes


def test_an_object_that_is_hidden_in_all_pictures_is_found():
    t = np.array([0.0, 0.1, 0.2])

    def seen(shares):
        track = SeenTrack(t, ["/World/ball", "/World/box"], np.array([[0.01, share] for share in shares], np.float32))
        return replace(with_world(a_world(), cameras=[camera()]), seen={"/World/side": track})

    speck = 15.0 / (640 * 360)
    assert only(ask(CheckSeen(), seen((0.02, 0.02, 0.02)))).passed
    assert "67%" in only(ask(CheckSeen(), seen((0.0, 0.0, 0.02)))).message
    finding = only(ask(CheckSeen(), seen((0.0, speck, 0.0))))
    assert not finding.passed and finding.prim == "/World/box" and finding.target.kind == "camera"
    assert only(ask(CheckSeen(), seen((0.0, 1.2 * speck, 0.0)))).passed
    assert ask(CheckSeen(), a_world()) == []  # no pictures were made


@pytest.mark.parametrize(
    ("speed", "planned", "passes"), [(0.0, False, True), (0.0, True, False), (0.2, False, False), (0.01, False, True)]
)
def test_what_lies_there_and_no_plan_names_may_be_hidden(speed, planned, passes):
    """A box behind something in all pictures goes 20 or 1 cm, or is planned; a twentieth of its radius is 1.1 cm."""
    t = times(1.0)
    place = np.tile(np.array(((0.0, 0.0, 0.05), (0.0, 2.0, 0.1))), (len(t), 1, 1))
    place[:, :, 0] += np.outer(t, (speed, 1.0))
    bodies = [box(size=SIZE, mass=BOX_KG), ball(mass=BALL_KG)]
    moves = record(bodies, place, np.gradient(place, t, axis=0), t, statics=[ground()])
    track = SeenTrack(t, ["/World/ball", "/World/box"], np.tile(np.float32((0.01, 0.0)), (len(t), 1)))
    seen = replace(with_world(moves, cameras=[camera()]), seen={"/World/side": track})
    found = ask(CheckSeen(), seen, a_plan()) if planned else ask(CheckSeen(), seen)
    assert all(finding.passed for finding in found) == passes
