"""Terrain of a plan and what is on it: what is composed of it is it, and what is built otherwise is found out."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from tests.agents.flies import CAMERA
from tests.judge.checks.test_plan_closed import scene_of, still
from tests.judge.theory import ask
from wsim.agents.planner import read_plan
from wsim.judge.checks.plan import CheckPlanLooks, CheckPlanPlaces, CheckPlanSizes
from wsim.judge.checks.plan_closed import CheckPlanClosed
from wsim.judge.checks.plan_contacts import CheckPlanContacts
from wsim.judge.checks.plan_joints import CheckPlanJoints
from wsim.judge.checks.plan_land import CheckPlanScatter, CheckPlanTerrain
from wsim.judge.checks.plan_motion import CheckPlanMotion
from wsim.judge.checks.plan_vehicles import CheckPlanVehicles
from wsim.judge.checks.run import CheckPlanObjects
from wsim.plan.schema import Plan
from wsim.plan.schema.examples import EXAMPLES
from wsim.plan.store import made
from wsim.program.compose import compose
from wsim.rules.planner import plan as make_plan
from wsim.scene import Scene
from wsim.scene.describe import describe
from wsim.scene.world import World

CHECKS = (
    CheckPlanObjects, CheckPlanClosed, CheckPlanSizes, CheckPlanPlaces, CheckPlanLooks, CheckPlanJoints,
    CheckPlanContacts, CheckPlanMotion, CheckPlanVehicles, CheckPlanTerrain,
    CheckPlanScatter,
)  # fmt: skip
ROUGH = "A Polaris drives 10 m over rough ground with 3 rocks and a tree."
BUGGY, GROUND = "/World/polaris", "/World/ground"


@pytest.fixture(scope="module")
def rough() -> Plan:
    return make_plan(ROUGH)


def faults(plan: Plan, more: str = "", change: tuple[str, str] = ("", "")) -> dict[tuple[str, str | None], str]:
    """What is found, by check and prim."""
    return found(plan, describe(scene_of(plan, more, change).stage))


def found(plan: Plan, world: World) -> dict[tuple[str, str | None], str]:
    """As `faults`, of a world."""
    recording = still(world)
    return {(f.check, f.prim): f.message for check in CHECKS for f in ask(check(), recording, plan) if not f.passed}


def wrong(plan: Plan, more: str = "", change: tuple[str, str] = ("", "")) -> set[tuple[str, str | None]]:
    """Check and prim of what is found."""
    return {*faults(plan, more, change)}


@pytest.mark.parametrize("says", ["A car drives 50 m along a road and stops.", "A golf cart drives 10 m at 2 m/s."])
def test_what_is_composed_is_the_plans(says: str) -> None:
    assert wrong(make_plan(says)) == set()


def test_rough_ground_that_is_composed_is_the_plans(rough: Plan) -> None:
    assert wrong(rough) == set()


HELPERS = """
import numpy as np
from pxr import Gf, UsdGeom, UsdPhysics, UsdShade
def sheet(name, points):
    made = UsdGeom.Mesh.Define(scene.stage, f"/World/ground/{name}")
    made.CreatePointsAttr(points)
    made.CreateFaceVertexCountsAttr([3, 3])
    made.CreateFaceVertexIndicesAttr([0, 1, 2, 0, 2, 3])
    UsdPhysics.CollisionAPI.Apply(made.GetPrim())
    UsdPhysics.MeshCollisionAPI.Apply(made.GetPrim()).CreateApproximationAttr("none")
    for purpose in ("physics", ""):
        of = UsdShade.MaterialBindingAPI(p("/World/ground/geometry")).ComputeBoundMaterial(purpose)
        UsdShade.MaterialBindingAPI.Apply(made.GetPrim()).Bind(of[0], materialPurpose=purpose)
def rebuilt(part, points, faces):
    mesh = UsdGeom.Mesh(p(f"/World/ground/{part}"))
    mesh.GetPointsAttr().Set(points)
    mesh.GetFaceVertexCountsAttr().Set([3] * len(faces))
    mesh.GetFaceVertexIndicesAttr().Set(np.ravel(faces).tolist())
    mesh.GetNormalsAttr().Clear()
def parts():
    for part in ("geometry", "track"):
        mesh = UsdGeom.Mesh(p(f"/World/ground/{part}"))
        points = np.array(mesh.GetPointsAttr().Get())
        faces = np.array(mesh.GetFaceVertexIndicesAttr().Get()).reshape(-1, 3)
        yield part, points, faces
def hole(low, high):
    for part, points, faces in parts():
        middle = points[faces].mean(axis=1)
        inside = (middle[:, 0] > low[0]) & (middle[:, 0] < high[0]) & (middle[:, 1] > low[1]) & (middle[:, 1] < high[1])
        rebuilt(part, points, faces[~inside])
def beside(corners):
    part, points, faces = next(parts())
    n = len(points)
    rebuilt(part, [*map(tuple, points.tolist()), *corners], [*faces.tolist(), [n, n + 1, n + 2], [n, n + 2, n + 3]])
"""
SET = 'p("{}").GetAttribute("{}").Set({})'


@pytest.mark.parametrize(
    ("more", "change", "check", "prim"),
    [
        ("", ('"polaris", position', '"car", position'), "CheckPlanVehicles", f"{BUGGY}_wheel_rear_left"),
        (SET.format(BUGGY, "physics:mass", 300.0), ("", ""), "CheckPlanVehicles", BUGGY),
        ("", ("place(-", "place(4.0 - "), "CheckPlanVehicles", BUGGY),
        ("", ("    scene.simulation", "    polaris.brake(0.1)\n    scene.simulation"), "CheckPlanVehicles",
         f"{BUGGY}_axle_front_left"),
        ("", ("    scene.simulation", "    polaris.drive(5.0)\n    scene.simulation"), "CheckPlanVehicles",
         f"{BUGGY}_axle_rear_right"),
        (SET.format(f"{BUGGY}_spring_rear_left", "drive:linear:physics:stiffness", 1e5), ("", ""), "CheckPlanVehicles",
         f"{BUGGY}_spring_rear_left"),
        (SET.format("/World/Looks/polaris_wheel_front_left", "physics:dynamicFriction", 0.0), ("", ""),
         "CheckPlanVehicles", f"{BUGGY}_wheel_front_left"),
        (SET.format(f"{BUGGY}_steer_front_left", "drive:angular:physics:targetPosition", 20.0), ("", ""),
         "CheckPlanVehicles", f"{BUGGY}_steer_front_left"),
        (SET.format(f"{BUGGY}_steer_front_right", "drive:angular:physics:stiffness", 0.0), ("", ""),
         "CheckPlanVehicles", f"{BUGGY}_steer_front_right"),
        (f'p("{BUGGY}_wheel_rear_left").GetAttribute("physics:kinematicEnabled").Set(True)', ("", ""),
         "CheckPlanObjects", f"{BUGGY}_wheel_rear_left"),
        ("", ("friction=0.85", "friction=0.0"), "CheckPlanLooks", GROUND),
        ("", ("Noise(0.6", "Noise(0.4"), "CheckPlanTerrain", GROUND),
        ("", ("seed=4", "seed=7"), "CheckPlanTerrain", GROUND),
        ("", ("size=(52.0, 40.0)", "size=(52.0, 44.0)"), "CheckPlanTerrain", GROUND),
        ("", ("size=(0.3, 1.2)", "size=(2.0, 3.0)"), "CheckPlanScatter", "/World/rock_0"),
        ("", ("count=3", "count=2"), "CheckPlanObjects", "/World/rock_2"),
        ('scene.box("wall", size=(1, 1, 1), static=True)', ("", ""), "CheckPlanObjects", "/World/wall"),
        ('scene.contact("polaris_wheel_front_left", "ground", friction=0.1)', ("", ""), "CheckPlanContacts",
         "/World/Contacts/polaris_wheel_front_left_ground"),
        ('scene.joint_fixed("weld", None, "polaris")', ("", ""), "CheckPlanJoints", "/World/weld"),
        ('a = p("/World/ground/geometry").GetAttribute("points"); '
         "a.Set([(x, y, -3.0 if 0.0 < x < 4.0 else z) for x, y, z in a.Get()])", ("", ""), "CheckPlanTerrain", GROUND),
    ],
)  # fmt: skip
def test_what_is_built_otherwise_is_found(
    rough: Plan, more: str, change: tuple[str, str], check: str, prim: str
) -> None:
    assert (check, prim) in wrong(rough, more, change)


def test_how_thick_ground_is_says_nothing_of_its_height(rough: Plan) -> None:
    assert wrong(rough, change=("areas=ground_areas", "thickness=0.04, areas=ground_areas")) == set()


def test_ground_without_the_plans_hill_or_its_road_is_found() -> None:
    """A mesh of a few corners is right at each of them; what an area is made of has nothing to say where it is not."""
    over, along = make_plan("A car drives 60 m over a hill."), make_plan("A car drives 50 m along a road and stops.")
    assert wrong(over) == set()
    assert ("CheckPlanTerrain", GROUND) in wrong(over, change=("areas=ground", "cell=9.0,\n        areas=ground"))
    assert ("CheckPlanTerrain", GROUND) in wrong(along, change=("areas=ground_areas", "areas=()"))


@pytest.mark.parametrize(
    ("more", "change", "check", "prim", "says"),
    [
        # where the ground is, and its areas
        ("", ("areas=ground_areas,", "areas=ground_areas, position=(2.0, 0.0, 0.0),"), "CheckPlanTerrain", GROUND,
         "ends up to 2 m from where"),
        ("", ("WAY_2, width=2.2", "WAY_2, width=5.0"), "CheckPlanTerrain", GROUND, "its area track is not where"),
        ("", ("Road(WAY_2, width", "Road([(x, y + 4.0) for x, y in WAY_2], width"), "CheckPlanTerrain", GROUND,
         "its area track is not where"),
        ("", ("Road(WAY_2, width", "Road([(x, y) for x, y in WAY_2[:3]], width"), "CheckPlanTerrain", GROUND,
         "its area track is not where"),
        ("", ('"track",\n        friction=0.85', '"track",\n        friction=0.1'), "CheckPlanLooks", GROUND,
         "a friction of 0.1"),
        # what is scattered
        ("", ("size=(0.3, 1.2)", "size=(0.05, 0.1)"), "CheckPlanScatter", "/World/rock_0", "m long; the plan's rocks"),
        ('p("/World/rock_1").GetAttribute("xformOp:translate").Set((2.0, 1.0, 0.0))', ("", ""), "CheckPlanScatter",
         "/World/rock_1", "m from a line of clear; the plan keeps 1.92 m clear"),
        ('p("/World/tree_0").GetAttribute("xformOp:translate").Set((0.0, 4.0, 0.0))', ("", ""), "CheckPlanScatter",
         "/World/tree_0", "the plan keeps 2.73 m clear"),
        ('p("/World/rock_0").GetAttribute("xformOp:translate").Set((60.0, 0.0, 0.0))',
         ("", ""), "CheckPlanScatter", "/World/rock_0", "m beyond ground"),
        ('p("/World/rock_0").GetAttribute("xformOp:translate").Set((9.0, 12.0, 5.0))',
         ("", ""), "CheckPlanScatter", "/World/rock_0", "m over ground"),
        ('p("/World/rock_0").GetAttribute("xformOp:translate").Set((9.0, 12.0, -9.0))',
         ("", ""), "CheckPlanScatter", "/World/rock_0", "m deep in ground"),
        ('a, b = (p(f"/World/rock_{k}").GetAttribute("xformOp:translate") for k in (0, 1)); b.Set(a.Get())', ("", ""),
         "CheckPlanScatter", "/World/rock_1", "lies over /World/rock_0"),
        ("", ('["conifer", "deciduous_tree"]', '"bush"'), "CheckPlanScatter", "/World/tree_0",
         "is no conifer or deciduous_tree as the catalogue has it"),
        ('from pxr import UsdPhysics; [each.RemoveAPI(UsdPhysics.CollisionAPI) for each in '
         'p("/World/rock_0").GetChildren()]', ("", ""), "CheckPlanScatter", "/World/rock_0", "is no rock"),
        # walls, roofs and holes
        ('sheet("wall", [(3, -5, -1), (3, 5, -1), (3, 5, 3), (3, -5, 3)])', ("", ""), "CheckPlanTerrain", GROUND,
         "has a part wall that"),
        ('beside([(3, 0, 0), (3, 0.4, 0), (3, 0.4, 3), (3, 0, 3)])', ("", ""), "CheckPlanTerrain", GROUND,
         "is not as high as the plan's layers make it: at (3, 0"),
        ('beside([(3, -5, -1), (3, 5, -1), (3, 5, 3), (3, -5, 3)])', ("", ""), "CheckPlanTerrain", GROUND,
         "has triangles of (0.5, 10)"),
        ('beside([(3, 3, -1), (3.4, 3, -1), (3.4, 3.4, -1), (3, 3.4, -1)])', ("", ""), "CheckPlanTerrain", GROUND,
         "has 2 surfaces to stand on at (3.1"),
        ("hole((2.0, -4.0), (2.5, 4.0))", ("", ""), "CheckPlanTerrain", GROUND, "has 0 surfaces to stand on at (2.1"),
        ("hole((2.0, -4.0), (6.0, 4.0))", ("areas=ground_areas", "cell=0.25, areas=ground_areas"),
         "CheckPlanTerrain", GROUND, "has 0 surfaces to stand on at (2.1"),
        (SET.format("/World/ground/geometry", "physics:approximation", '"convexHull"'), ("", ""), "CheckPlanTerrain",
         GROUND, "is not solid ground whose triangles collide"),
        # how a thing that is scattered is made
        (SET.format("/World/rock_0/geometry", "physics:approximation", '"convexHull"'), ("", ""), "CheckPlanScatter",
         "/World/rock_0", "is no rock"),
        ('q = p("/World/rock_0/geometry").GetAttribute("points"); q.Set([Gf.Vec3f(x, 0.05 * y, z) for x, y, z in '
         'q.Get()])', ("", ""), "CheckPlanScatter", "/World/rock_0", "m across where it is least"),
        ('scene.surface_velocity("rock_0", velocity=(1.0, 0.0, 0.0))', ("", ""), "CheckPlanScatter", "/World/rock_0",
         "a surface velocity of"),
        ('q = p("/World/tree_0").GetAttribute("xformOp:orient"); q.Set(q.Get() * Gf.Quatd(0, 1, 0, 0))', ("", ""),
         "CheckPlanScatter", "/World/tree_0", "leans 180 degrees"),
        (SET.format("/World/tree_0/collision/trunk", "physics:approximation", '"none"'), ("", ""), "CheckPlanScatter",
         "/World/tree_0", "trunk collides as its triangles; that of the catalogue's deciduous_tree collides as its"),
        ('UsdGeom.Xformable(p("/World/tree_0/collision/trunk")).AddRotateXOp().Set(90.0)', ("", ""),
         "CheckPlanScatter", "/World/tree_0", "trunk is turned 90 degrees off"),
        ('[UsdPhysics.MaterialAPI(q).CreateRestitutionAttr().Set(0.95) for q in scene.stage.Traverse() if '
         'str(q.GetPath()).startswith("/World/tree_0") and q.HasAPI(UsdPhysics.MaterialAPI)]', ("", ""),
         "CheckPlanScatter", "/World/tree_0", "a restitution of 0.95"),
    ],
)  # fmt: skip
def test_land_that_is_laid_otherwise_is_found(
    rough: Plan, more: str, change: tuple[str, str], check: str, prim: str, says: str
) -> None:
    assert says in faults(rough, HELPERS + more, change).get((check, prim), "")


def test_another_seed_scatters_as_the_plan_allows(rough: Plan) -> None:
    assert wrong(rough, change=("seed=2,", "seed=3,")) == set()


def test_finer_cells_keep_the_areas(rough: Plan) -> None:
    assert wrong(rough, change=("areas=ground_areas", "cell=0.25, areas=ground_areas")) == set()


def test_things_of_the_catalogue_stand_on_the_lowest_ground_about_them() -> None:
    """On 45 degrees of slope that is 0.3 m under their middle, which is more than half of a small rock."""
    hill = {"kind": "hill", "position": [0, 0], "radius": 16, "height": 8.0}
    land = {"name": "land", "role": "terrain", "state": "static", "material": {"name": "soil", "density": 1600},
            "construction": {"kind": "terrain", "extent": [40, 40], "cell": 1.0, "layers": [hill]}}  # fmt: skip
    spread = [{"name": name, "role": "background", "state": "static",
               "construction": {"kind": "scatter", "on": "land", "count": 12, "seed": 5, "what": [name]}}
              for name in ("rock", "crate")]  # fmt: skip
    plan = made({"title": "", "prompt": "", "objects": [land, *spread]}, Path("plan"))
    assert wrong(plan) == set()
    deep = 'a = p("/World/rock_1").GetAttribute("xformOp:translate"); x, y, z = a.Get(); a.Set((x, y, z - 0.12))'
    assert wrong(plan, deep) == {("CheckPlanScatter", "/World/rock_1")}


def test_the_examples_of_the_prompt_are_accepted() -> None:
    """A robot has joints and gears of its own, the first of them to its base; what is added to it is found."""
    reaches = {"kind": "formula", "object": "truck", "sentence": "finally (reaches(truck, (20, 0, 0), within 3 m))"}
    told = {"title": "", "objects": [*EXAMPLES.values()], "cameras": [CAMERA], "objectives": [reaches],
            "simulation": {"duration": 14}}  # fmt: skip
    plan = read_plan(json.loads(json.dumps(told)), "A truck drives over a hill.")
    world = describe(scene_of(plan).stage)
    assert found(plan, world) == {}
    (pan,) = (joint for joint in world.joints if joint.fixture is not None)
    held = pan.model_copy(update={"prim": "/World/held", "child": "/World/arm/hand"})
    more = world.model_copy(update={"joints": [*world.joints, held]})
    assert found(plan, more).keys() == {("CheckPlanJoints", "/World/held")}


@pytest.mark.parametrize(
    ("says", "change", "value"),
    [
        (ROUGH, ("size=(52.0, 40.0)", 'size=(scene.param("a", 52.0, low=10, high=200), 40.0)'), 60.0),
        (ROUGH, ("Noise(0.6", 'Noise(scene.param("a", 0.6, low=0.1, high=2)'), 0.9),
        ("A golf cart drives 10 m at 2 m/s.",
         ("    scene.simulation", '    cart.drive(scene.param("a", 2.0, low=1, high=9))\n    scene.simulation'), 6.0),
    ],
)  # fmt: skip
def test_what_a_parameter_changes_is_not_held_to_the_plan(says: str, change: tuple[str, str], value: float) -> None:
    plan, space = make_plan(says), {}
    text = compose(plan)
    assert change[0] in text
    exec(compile(text.replace(*change), "program.py", "exec"), space)
    scene = Scene(params={"a": value})
    space["build"](scene)
    assert found(plan, describe(scene.stage)) == {}
