"""A plan's terrain is the scene's, and vehicles stand on it."""

from __future__ import annotations

import math
from typing import get_args

import numpy as np
import pytest
from pydantic import ValidationError

from wsim.errors import UserError
from wsim.geometry.rotations import rotate
from wsim.judge.checks.plan import quaternion
from wsim.plan.layout import LayoutError, layout
from wsim.plan.layout.bodies import local_size
from wsim.plan.layout.drives import drive_time
from wsim.plan.layout.land import set_down, survey
from wsim.plan.schema import Plan, PlanObject, Pose, explain
from wsim.plan.schema.constructions import VehicleKind
from wsim.program.compose import compose
from wsim.scene import Hill, Level, Noise, Road, Scene
from wsim.scene.describe import describe
from wsim.scene.vehicle_spec import CORNERS, VehicleSpec, preset, presets
from wsim.scene.world import World

LAND = {
    "name": "land", "role": "terrain", "state": "static", "material": {"name": "soil", "density": 1600},
    "construction": {
        "kind": "terrain", "extent": [40.0, 30.0], "layers": [
            {"kind": "noise", "amplitude": 0.5, "wavelength": 12.0, "octaves": 3, "seed": 3},
            {"kind": "hill", "position": [5.0, 2.0], "radius": 8.0, "height": 2.0},
            {"kind": "level", "position": [-10.0, 0.0], "radius": 3.0},
            {"kind": "road", "points": [[-18.0, 8.0], [0.0, 6.0], [18.0, 8.0]], "width": 4.0},
        ],
    },
}  # fmt: skip
CAR = {"name": "car", "role": "vehicle", "construction": {"kind": "vehicle", "vehicle": "car"}}
PLACES = [(-10.0, 0.0), (5.0, 2.0), (0.0, 6.0), (-3.3, -9.1), (17.2, 12.9)]


def a_plan(*objects: dict) -> Plan:
    return Plan.model_validate({"title": "", "prompt": "", "objects": list(objects)})


def test_it_is_as_high_as_the_scenes() -> None:
    land = Scene().terrain(
        "land", size=(40.0, 30.0),
        layers=[Noise(0.5, 12.0, octaves=3, seed=3), Hill((5.0, 2.0), 8.0, 2.0), Level((-10.0, 0.0), 3.0),
                Road([(-18.0, 8.0), (0.0, 6.0), (18.0, 8.0)], width=4.0)],
    )  # fmt: skip
    ground = survey(PlanObject.model_validate(LAND))
    assert [ground.height(*at) for at in PLACES] == [land.height(*at) for at in PLACES]
    x, y = zip(*PLACES, strict=True)
    # Between the corners of a cell triangles and even steps differ by a quarter of its twist at most.
    assert ground.heights(np.array(x), np.array(y)) == pytest.approx([land.height(*at) for at in PLACES], abs=0.02)


@pytest.mark.parametrize("at", PLACES)
def test_a_vehicle_stands_on_it_whatever_height_it_is_given(at: tuple[float, float]) -> None:
    put = {**CAR, "pose": {"position": [*at, 7.0], "rotation_deg": [0.0, 0.0, 30.0]}}
    placed = set_down(a_plan(LAND, put))
    ground, pose, spec = survey(placed.objects[0]), placed.objects[1].pose, preset("car")
    assert (*pose.position[:2], pose.rotation_deg[2]) == (*at, 30.0)
    gaps = [float(foot[2] - ground.heights(*foot[:2, None])[0]) for foot in feet(pose, spec)]
    assert -1e-4 < min(gaps) < 0.1  # none is in the ground
    assert set_down(placed) == placed


def feet(pose: Pose, spec: VehicleSpec) -> np.ndarray:
    """Where the lowest points of its wheels are, (4, 3) [m]."""
    own = np.array([(*spec.place(corner), 0.0) for corner in CORNERS])
    return np.array(pose.position) + rotate(quaternion(pose.rotation_deg), own)


@pytest.mark.parametrize(("turn", "rise"), [(0.0, (0.2, 0.0)), (0.0, (0.0, -0.25)), (50.0, (0.15, 0.2))])
def test_on_a_slope_it_leans_as_the_slope_does(turn: float, rise: tuple[float, float]) -> None:
    """A hill so wide that its flank is a plane: the vehicle's up is the ground's normal, its wheels on it."""
    flank = math.pi * 20.0 / (2.0 * 100.0)  # the steepest of a cosine's wave
    at = 100.0 / 2.0  # [m] from its top, halfway down
    way = np.array(rise) / np.hypot(*rise)
    hill = {"kind": "hill", "position": (at * way).tolist(), "radius": 100.0, "height": 20.0}
    land = {**LAND, "construction": {"kind": "terrain", "extent": [30.0, 30.0], "layers": [hill]}}
    put = {**CAR, "pose": {"position": [0.0, 0.0, 0.0], "rotation_deg": [0.0, 0.0, turn]}, "velocity": [
        3.0 * math.cos(math.radians(turn)), 3.0 * math.sin(math.radians(turn)), 0.0]}  # fmt: skip
    plan = set_down(a_plan(land, put))
    pose, ground = plan.objects[1].pose, survey(plan.objects[0])
    up = rotate(quaternion(pose.rotation_deg), np.array([0.0, 0.0, 1.0]))
    normal = np.array([*(-flank * way), 1.0]) / math.hypot(flank, 1.0)
    assert math.degrees(math.acos(min(1.0, float(up @ normal)))) < 0.1
    assert [foot[2] - ground.height(*foot[:2]) for foot in feet(pose, preset("car"))] == pytest.approx(
        [0] * 4, abs=5e-3
    )
    assert plan.objects[1].speed_ahead == pytest.approx(3.0)
    assert set_down(plan) == plan
    (body,) = [b for b in world_of(plan).bodies if b.prim == "/World/car"]
    assert rotate(np.array(body.rotation), np.array([0.0, 0.0, 1.0])) == pytest.approx(up, abs=1e-5)
    assert body.position == pytest.approx(pose.position, abs=1e-5)


def world_of(plan: Plan) -> World:
    """What a plan's program builds."""
    space: dict = {}
    exec(compile(compose(plan), "program.py", "exec"), space)
    scene = Scene()
    space["build"](scene)
    return describe(scene.stage)


def test_where_it_would_not_stay_it_is_refused() -> None:
    hill = {"kind": "hill", "position": [0.0, 0.0], "radius": 6.0, "height": 5.0}
    land = {**LAND, "construction": {"kind": "terrain", "extent": [30.0, 30.0], "layers": [hill]}}
    with pytest.raises(LayoutError, match=r"car starts at \(3, 0\) m on ground of 4\d(\.\d)? degrees, .* level layer"):
        set_down(a_plan(land, {**CAR, "pose": {"position": [3.0, 0.0, 0.0]}}))


def test_rows_place_a_vehicle_and_the_ground_its_height() -> None:
    put = {**CAR, "topology": {"relation": [{"predicate": "PLACE-ON-BASE"}]}}
    placed = layout(a_plan(LAND, put))
    x, y, z = placed.objects[1].pose.position
    assert z == pytest.approx(survey(placed.objects[0]).height(x, y), abs=0.1)
    level = layout(a_plan({**CAR, "pose": {"position": [1.0, 2.0, 0.0]}}))
    assert level.objects[0].pose.position == (1.0, 2.0, 0.0)


@pytest.mark.parametrize(("turn", "velocity"), [((0.0, 10.0, 30.0), (4.3301270, 2.5, 0.0)),
                                                ((0.0, 0.0, 30.0), (-4.3301270, -2.5, 0.1))])  # fmt: skip
def test_on_terrain_its_velocity_is_along_its_yaw_and_the_ground_leans_it(turn: tuple, velocity: tuple) -> None:
    put = {**CAR, "pose": {"position": [8.0, 3.0, 0.0], "rotation_deg": turn}, "velocity": velocity}
    placed = set_down(a_plan(LAND, put))
    assert placed.objects[1].speed_ahead == pytest.approx(math.copysign(math.hypot(*velocity), velocity[0]))
    assert set_down(placed) == placed


@pytest.mark.parametrize(
    ("what", "says"),
    [
        ("unheard_of", "rock is to scatter 'unheard_of': "),
        ("seesaw", "rock is to scatter 'seesaw', whose parts move on a joint"),
    ],
)
def test_what_no_scatter_takes_is_refused_in_a_line(what: str, says: str) -> None:
    with pytest.raises(LayoutError, match=says) as caught:
        set_down(a_plan(LAND, {**ROCKS, "construction": {**ROCKS["construction"], "what": ["crate", what]}}))
    assert "\n" not in str(caught.value)


def test_beside_the_terrain_there_is_nothing_to_stand_on() -> None:
    with pytest.raises(LayoutError, match=r"car starts at \(30, 0\) m with a wheel where land is not; move it, or"):
        set_down(a_plan(LAND, {**CAR, "pose": {"position": [30.0, 0.0, 0.0]}}))


def test_what_the_scene_refuses_is_refused_in_its_words() -> None:
    rough = {"kind": "noise", "amplitude": 0.5, "wavelength": 2.0, "octaves": 4}
    land = {**LAND, "construction": {**LAND["construction"], "layers": [rough]}}
    with pytest.raises(UserError, match=r"octaves = 4: the finest bumps are 0\.25 m wide, cells 0\.5 m; take fewer"):
        survey(PlanObject.model_validate(land))


def test_the_kinds_and_sizes_of_vehicles_are_the_scenes() -> None:
    assert get_args(VehicleKind) == presets()
    for kind in presets():
        item = PlanObject.model_validate({**CAR, "construction": {"kind": "vehicle", "vehicle": kind}})
        spec = preset(kind)
        assert local_size(item)[0] == spec.length and local_size(item)[2] == spec.height
        assert local_size(item)[1] >= max(spec.width, spec.track + spec.wheel_width)


ROCKS = {"name": "rock", "role": "background", "state": "static", "construction": {"kind": "scatter", "on": "land",
         "count": 2}}  # fmt: skip
DRIVER = {"kind": "driver", "route": [[10.0, 0.0]], "speed": 5.0}


def driven(**actuation: object) -> dict:
    return {**CAR, "pose": {"position": [-10.0, 0.0, 0.0]}, "registration": {"actuation": [{**DRIVER, **actuation}]}}


@pytest.mark.parametrize(
    ("objects", "problem"),
    [
        ([LAND, {**ROCKS, "construction": {**ROCKS["construction"], "on": "car"}}, CAR], "'car' is no terrain"),
        ([LAND, ROCKS, {**CAR, "name": "rock_1"}], "rock_1 would be a part of rock_1 and of rock; rename one"),
        ([LAND, CAR, {**CAR, "name": "car_axle_front_left"}], "car_axle_front_left would be a part of car_a"),
        ([LAND, {**CAR, "name": "car_spring_rear_left"}, CAR], "car_spring_rear_left would be a part of car and of"),
        ([LAND, {**LAND, "name": "more"}], "land and more are both the ground; keep one"),
        ([{**LAND, "pose": {"position": [0, 0, 1]}}], "land: terrain lies about the origin; remove its pose"),
        ([{**LAND, "material": None}], 'land: terrain needs a "material"'),
        ([LAND, {**CAR, "material": {"name": "tin", "density": 900}}], "car: a vehicle has materials of its own"),
        ([LAND, {**CAR, "topology": {"relation": [{"predicate": "PLACE-ON", "ref": "land"}]}}],
         "land is a terrain, which has no sides and no top; give car a pose"),
        ([LAND, driven(speed=None)], "a driver is a vehicle's, with its \"speed\""),
        ([LAND, driven(route=[])], 'a driver follows a "route" from where the vehicle starts; it has none'),
        ([LAND, driven(kind="drive")], 'what is driven straight on, or in a circle, has no route'),
        ([LAND, driven(waits=[1.0, 2.0])], "waits has 2 times for the route's 1 points"),
        ([LAND, driven(kind="drive", route=[], waits=[1.0])], 'waits are of the kind "driver"; this is of \'drive\''),
        ([LAND, driven(brake={})], 'a brake says when: "at" a place, at a "time", or "near" a body'),
        ([LAND, driven(brake={"near": "ball"})], '"near" and "within" of a brake go together; give both'),
        ([LAND, driven(brake={"near": "land", "within": 3.0})], "brake.near: 'land' is no other object that moves"),
        ([LAND, driven(brake={"near": "car", "within": 3.0})], "brake.near: 'car' is no other object that moves"),
        ([LAND, driven(kind="drive", route=[], brake={"time": 1.0})], 'a brake is of the kind "driver"; this is of'),
        ([LAND, driven(route=[{"radius": 5.0, "angle_deg": 0.0}])], "route.0.angle_deg: angle_deg is 0; an arc tur"),
        ([LAND, driven(route=[{"radius": "wide", "angle_deg": 5.0}])], "route.0.radius: it must be a nu"),
        ([LAND, driven(route=[[5, 0], [1]])], "actuation.0.route.1.1: it is missing; add it"),
        ([LAND, driven(route=["a"])], 'actuation.0.route.0: it must be a list, [...]; it is "a"'),
        ([LAND, driven(route=[[5, 0], {"radius": 5.0}])], "actuation.0.route.1.angle_deg: it is missing; add it"),
        ([LAND, driven(route=[{"radius": 5.0, "angle_deg": 9.0, "x": 1}])], "actuation.0.route.0.x: there is no such"),
        ([LAND, driven(brake={"time": 1.0, "share": 0.0})], "brake.share: it must be >="),
        ([LAND, driven(brake={"time": 1.0, "share": 1e-9})], "brake.share: it must be >="),
        ([LAND, driven(steer_deg=5.0)], 'steer_deg is of the kind "drive"; this is of \'driver\''),
        ([{**driven(), "role": "rigid_body", "construction": {"kind": "proxy", "primitive": "box", "size": [1, 1, 1]},
           "material": {"name": "tin", "density": 900}}], "car: a driver is of a vehicle"),
        ([{**CAR, "construction": {"kind": "vehicle", "vehicle": "tank"}}], "it must be 'hmmwv', 'polaris'"),
        ([{**CAR, "state": "static"}], 'state of a vehicle is dynamic or kinematic; it is "static"'),
        # what it is of itself
        ([{**CAR, "state": "kinematic"}], "car: state 'kinematic': a vehicle has its own; leave it out"),
        ([{**CAR, "registration": {"mass": 900.0}}], "car: registration.mass 900.0: a vehicle has its own; leave"),
        ([{**CAR, "angular_velocity_deg": [0, 0, 9]}], "car: angular_velocity_deg (0.0, 0.0, 9.0): a vehicle has its"),
        ([{**LAND, "registration": {"collision": "none"}}], "land: registration.collision 'none': a terrain has its"),
        ([{**LAND, "registration": {"mass": 5.0}}], "land: registration.mass 5.0: a terrain has its own; leave it out"),
        ([LAND, {**ROCKS, "registration": {"density": 5.0}}], "rock: registration.density 5.0: a scatter has its own"),
        # how it starts, and is driven
        ([{**CAR, "velocity": [1.0, 3.0, 0.0]}], "velocity: [1.0, 3.0, 0.0] m/s of car is not along its heading"),
        ([LAND, {**CAR, "velocity": [3.0, 1.0, 0.0]}], "velocity: [3.0, 1.0, 0.0] m/s of car is not along its heading"),
        ([LAND, {**CAR, "velocity": [0.0, 0.0, 3.0]}], "velocity: [0.0, 0.0, 3.0] m/s of car is not along its heading"),
        ([{**CAR, "registration": {"actuation": [{"kind": "velocity", "target": [3.0]}]}}],
         "actuation.0.kind: 'velocity': car is a vehicle, which a \"driver\" or a \"drive\" moves; take one of these"),
        ([{**CAR, "velocity": [300.0, 0.0, 0.0]}], "velocity: 300 m/s of car must be <= 100 m/s; start it slower"),
        ([{**CAR, "pose": {"position": [0, 0, 0], "rotation_deg": [5.0, 0, 0]}}],
         "pose.rotation_deg: [5.0, 0.0, 0.0]: car stands level on the ground; give it a yaw alone"),
        ([LAND, driven(route=[[5, 0], [25, 0]])],
         "objects.1.registration.actuation.0.route.1: (25, 0) m is not on land, 40 x 30 m about the origin; move it"),
        ([driven(route=[[2e4, 0]])], "route.0: (20000, 0) m must be within 10000 m; move it"),
        ([driven(speed=300.0)], "actuation.0.speed: 300 m/s must be <= 100 m/s; drive slower"),
        ([driven(kind="drive", route=[], steer_deg=50.0)],
         "actuation.0.steer_deg: 50 deg: a car turns its wheels by 32 deg at most; steer less"),
    ],
)  # fmt: skip
def test_each_mistake_is_refused_with_a_way_out(objects: list[dict], problem: str) -> None:
    with pytest.raises(ValueError) as caught:
        a_plan(*objects)
    said = explain(caught.value) if isinstance(caught.value, ValidationError) else str(caught.value)
    assert problem in said
    assert "tuple[" not in said


def test_a_leg_that_is_wrong_is_told_once() -> None:
    with pytest.raises(ValidationError) as caught:
        a_plan(driven(route=[{"radius": 5.0, "angle_deg": 0.0}]))
    assert len(caught.value.errors()) == 1


@pytest.mark.parametrize(
    "objective",
    [
        {"kind": "formula", "object": "car", "formula": {"op": "touches", "object": "car", "ref": "rock"}},
        {"kind": "collides_with", "object": "car", "ref": "rock"},
        {"kind": "settles", "object": "rock"},
    ],
)
def test_what_is_scattered_is_no_one_thing_to_an_objective(objective: dict) -> None:
    data = {"title": "", "prompt": "", "objects": [LAND, ROCKS, driven()], "objectives": [objective]}
    with pytest.raises(ValueError, match=r"objectives\.0\.\w+: 'rock' is 2 things, which an objective cannot call by"):
        Plan.model_validate(data)


def test_a_driver_has_the_time_that_its_way_takes() -> None:
    """20 m from rest to rest at 2 and 3 m/s^2, at 5 m/s at most: 20 / 5 + 5 (1 / 2 + 1 / 3) / 2 s."""
    takes = drive_time("car", [(-10.0, 0.0), (10.0, 0.0)], 5.0)
    assert takes == pytest.approx(20.0 / 5.0 + 0.5 * 5.0 * (1.0 / 2.0 + 1.0 / 3.0), rel=0.03)
    data = {"title": "", "prompt": "", "objects": [driven()], "simulation": {"duration": 3.0}}
    with pytest.raises(LayoutError, match=r"duration: 3 s: car takes 6\.\d+ s along its route at 5 m/s; give it 8"):
        set_down(Plan.model_validate(data))
    assert set_down(Plan.model_validate({**data, "simulation": {"duration": 8.0}}))


def test_a_driver_that_brakes_has_the_time_that_its_stop_takes() -> None:
    """From 5 m/s, 10 m on: 10 / 5 s, and v / (mu g) = 5 / (0.9 g) s; before the place, at its time."""

    def takes(**brake: object) -> None:
        car = {**driven(brake=brake), "velocity": [5.0, 0.0, 0.0]}
        data = {"title": "", "prompt": "", "objects": [car], "simulation": {"duration": 0.1}}
        set_down(Plan.model_validate(data))

    stop = 5.0 / (0.9 * 9.81)
    with pytest.raises(LayoutError, match=rf"duration: 0\.1 s: car takes {2.0 + stop:.3g} s along its"):
        takes(at=[0.0, 0.0])
    for brake, begins in (({"at": [0.0, 0.0], "time": 1.0}, 1.0), ({"time": 3.0}, 3.0)):
        with pytest.raises(
            LayoutError, match=rf"brake\.time: {begins:g} s: car then stands at {begins + stop:.3g} s, and"
        ):
            takes(**brake)
    with pytest.raises(LayoutError, match=r"brake\.at = \(0\.0, 3\.0\) is 3 m beside the path"):
        takes(at=[0.0, 3.0])


def test_an_arc_is_no_tighter_than_the_vehicle_turns_and_stays_on_terrain() -> None:
    """L / tan(32 deg) = 4.16 m of the rear axle are hypot(4.16, 1.3) = 4.36 m of the car."""
    set_down(a_plan(driven(route=[{"radius": 4.4, "angle_deg": 90.0}])))
    with pytest.raises(LayoutError, match=r"car is to drive round an arc of 4\.3 m; .* it goes round 4\.36 m"):
        set_down(a_plan(driven(route=[{"radius": 4.3, "angle_deg": 90.0}])))
    with pytest.raises(LayoutError, match=r"car is driven to \(.*\) m, where land is not; move its route"):
        set_down(a_plan(LAND, driven(route=[{"radius": 12.0, "angle_deg": 180.0}])))


def test_formulas_may_name_wheels() -> None:
    def objective(name: str) -> dict:
        formula = {"op": "touches", "object": name, "ref": "ground"}
        ground = {
            "name": "ground",
            "role": "terrain",
            "state": "static",
            "construction": {"kind": "proxy", "primitive": "ground"},
            "material": {"name": "a", "density": 1},
        }
        asked = {"kind": "formula", "object": "car", "formula": formula}
        return {"title": "", "prompt": "", "objects": [driven(), ground], "objectives": [asked]}

    assert Plan.model_validate(objective("car_wheel_rear_left")).objectives
    with pytest.raises(
        ValueError, match=r"no object 'car_wheel'; the plan has car, ground, and the wheels car_wheel_fr"
    ):
        Plan.model_validate(objective("car_wheel"))
    asked = objective("car_wheel_rear_left")
    asked["objectives"][0]["object"] = "car_hub_rear_left"
    with pytest.raises(ValueError, match=r"objectives\.0\.object: no object 'car_hub_rear_left'.*; as a part of a veh"):
        Plan.model_validate(asked)


def test_a_driver_that_the_scene_refuses_is_refused_in_its_words() -> None:
    with pytest.raises(LayoutError, match=r"0\.001 m apart or more"):
        set_down(a_plan(driven(route=[[5.0, 0.0], [5.0, 0.0]])))


@pytest.mark.parametrize(
    ("change", "problem"),
    [
        ({"extent": [600.0, 30.0]}, "each at most 500 m"),
        ({"cell": 0.01}, "makes 12,000,000 cells; at most 250,000: make it larger"),
        ({"areas": [{"name": "geometry", "points": [[0, 0], [1, 0]], "material": {"name": "a", "density": 1}}]},
         'none be "geometry"'),
        ({"layers": []}, "at least 1 item"),
        ({"layers": [{"kind": "road", "points": [[-600, 0], [600, 0]]}]}, "points are 1200 m long"),
        ({"layers": [{"kind": "road", "points": [[0, 0], [0, 0]]}]}, "are in one place; leave one out"),
    ],
)  # fmt: skip
def test_terrain_that_would_be_too_much_is_refused(change: dict, problem: str) -> None:
    with pytest.raises(ValueError, match=problem):
        a_plan({**LAND, "construction": {**LAND["construction"], **change}})


def test_what_is_laid_out_reads_as_it_was_written() -> None:
    made = a_plan(LAND, ROCKS, driven())
    assert Plan.model_validate_json(made.model_dump_json()) == made
    assert "size" in made.objects[1].construction.model_dump()
    trees = {**ROCKS, "construction": {**ROCKS["construction"], "what": ["conifer"]}}
    assert "size" not in a_plan(LAND, trees).objects[1].construction.model_dump()


def test_terrain_that_the_scene_refuses_is_refused_without_a_vehicle() -> None:
    steep = {**LAND["construction"]["layers"][0], "amplitude": 1e6}
    with pytest.raises(LayoutError, match="amplitude"):
        layout(a_plan({**LAND, "construction": {**LAND["construction"], "layers": [steep]}}))


def test_a_driver_is_given_no_headings() -> None:
    driver = {"kind": "driver", "route": [[5.0, 0.0, 90.0]], "speed": 3.0}
    with pytest.raises(ValueError, match="leave their headings out"):
        a_plan({**CAR, "registration": {"actuation": [driver]}})
