"""Vehicles, terrain and what is scattered, as a program makes them."""

from __future__ import annotations

from tests.plan.layout.test_land import LAND, ROCKS, a_plan, driven
from wsim.plan.schema import Plan
from wsim.program.compose import compose
from wsim.program.validator import validate
from wsim.scene import Scene
from wsim.scene.describe import describe


def test_a_program_lays_the_land_and_drives_over_it() -> None:
    """Its driver leads the car from where it stands."""
    trees = {**ROCKS, "name": "tree", "construction": {"kind": "scatter", "on": "land", "count": 1, "what": ["conifer"],
             "clear": [{"points": [[0, 0]], "by": 4.0}, {"points": [[0, 0], [9, 0]], "by": 2.0}]}}  # fmt: skip
    made = a_plan(driven(), trees, LAND)
    text = compose(made)
    assert text.index("scene.terrain(") < text.index("scene.scatter(") and text.index("scene.terrain(") < text.index(
        "scene.vehicle("
    )
    assert "from wsim.scene import Driver, Hill, Level, Noise, Road, Scene\n" in text
    assert "    (-10.0, 0.0),\n    (10.0, 0.0),\n]" in text
    assert 'Driver("car", "car", path=Road(' in text and "speed=5.0)" in text
    assert 'scene.vehicle("car", "car", position=land.place(-10.0, 0.0, above=' in text
    assert "clear=[((0.0, 0.0), 4.0), (WAY" in text
    assert [problem.message for problem in validate(text, made)] == []
    space: dict = {}
    exec(compile(text, "program.py", "exec"), space)  # what it is, is known here
    scene = Scene()
    space["build"](scene)
    names = {str(prim.GetPath()).split("/")[2] for prim in scene.stage.Traverse() if str(prim.GetPath()).count("/") > 1}
    assert {prim for item in made.objects for prim in item.prims} <= names
    assert callable(space["control"])


def test_a_camera_follows_a_vehicle() -> None:
    follow = {"name": "follow", "eye": [-19.0, -2.0, 5.0], "target": [-9.0, 0.0, 1.0], "follows": "car"}
    plan = Plan.model_validate(a_plan(driven()).model_dump() | {"cameras": [follow]})
    assert plan.model_dump()["cameras"][0]["follows"] == "car"
    text = compose(plan)
    assert validate(text, plan) == []
    space: dict = {}
    exec(compile(text, "program.py", "exec"), space)  # what it is, is known here
    scene = Scene()
    space["build"](scene)
    assert [camera.follows for camera in describe(scene.stage).cameras] == ["/World/car"]


def test_a_driver_has_its_arcs_and_its_brake() -> None:
    legs = [[-5.0, 0.0], {"radius": 6.0, "angle_deg": 90.0}, {"radius": 8.0, "angle_deg": -45.0}]
    plan = a_plan(driven(route=legs, waits=[0.0, 1.5], brake={"at": [-5.0, 0.0], "time": 9.0, "share": 0.5}))
    assert Plan.model_validate_json(plan.model_dump_json()) == plan
    text = compose(plan)
    assert "path=Legs((-10.0, 0.0), 0.0, [(-5.0, 0.0), Arc(6.0, 90.0), Arc(8.0, -45.0)]).line()" in text
    assert "brake=Brake(at=(-5.0, 0.0), time=9.0, share=0.5)" in text
    assert "waits=[(-5.0, 0.0, 0.0), (1.0, 6.0, 1.5)]" in text
    assert "from wsim.scene import Arc, Brake, Driver, Legs, Scene\n" in text
    assert [problem.message for problem in validate(text, plan)] == []
    exec(compile(text, "program.py", "exec"), {})


def test_a_vehicle_of_its_own_speed_starts_its_driver_with_it() -> None:
    text = compose(a_plan({**driven(), "velocity": [4.0, 0.0, 0.0]}))
    assert "position=(-10.0, 0.0, 0.0), speed=4.0)" in text and "start_speed=4.0" in text
