"""Vehicles of a plan: what is composed of it is it, and whatever is built otherwise is found, part by part."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import pytest

from tests.judge.checks.test_plan_closed import scene_of, still
from tests.judge.theory import ask
from wsim.judge import judge
from wsim.judge.checks.plan_vehicles import CheckPlanVehicles
from wsim.plan.layout.land import set_down
from wsim.plan.schema import Actuation, Plan, Registration
from wsim.program.compose import compose
from wsim.program.control_world import OUTPUTS, ControlLayout
from wsim.recording import read
from wsim.rules.planner import plan as make_plan
from wsim.scene import Scene
from wsim.scene.describe import describe
from wsim.scene.vehicle_spec import CORNERS, VehicleSpec, preset, presets
from wsim.sim import Simulation
from wsim.sim.control import ArrayController, driven_joints

if TYPE_CHECKING:
    from pathlib import Path

CART = "/World/cart"
HUB, KNUCKLE, WHEEL = (f"{CART}_{part}_front_left" for part in ("hub", "knuckle", "wheel"))
SPRING, STEER, AXLE = (f"{CART}_{joint}_front_left" for joint in ("spring", "steer", "axle"))
HELPERS = """
from pxr import Gf, UsdGeom, UsdPhysics
def put(prim, name, value):
    p(prim).GetAttribute(name).Set(value)
def body(path, mass, at=(0, 0, 0)):
    cube = UsdGeom.Cube.Define(scene.stage, path)
    cube.GetSizeAttr().Set(0.1)
    UsdGeom.XformCommonAPI(cube).SetTranslate(at)
    UsdPhysics.RigidBodyAPI.Apply(cube.GetPrim())
    UsdPhysics.MassAPI.Apply(cube.GetPrim()).GetMassAttr().Set(mass)
def box(path, at, solid=True):
    cube = UsdGeom.Cube.Define(scene.stage, path)
    cube.GetSizeAttr().Set(0.2)
    UsdGeom.XformCommonAPI(cube).SetTranslate(at)
    if solid:
        UsdPhysics.CollisionAPI.Apply(cube.GetPrim())
def joint(kind, path, parent, child, axis="Z"):
    made = getattr(UsdPhysics, kind).Define(scene.stage, path)
    made.CreateBody0Rel().SetTargets([parent])
    made.CreateBody1Rel().SetTargets([child])
    return made
"""


@pytest.fixture(scope="module")
def cart() -> Plan:
    return make_plan("A golf cart drives 10 m at 2 m/s.")


def wrong(plan: Plan, more: str = "", change: tuple[str, str] = ("", "")) -> dict[str | None, str]:
    """Prims of what is found, and what it says."""
    recording = still(describe(scene_of(plan, HELPERS + more, change).stage))
    return {f.prim: f.message for f in ask(CheckPlanVehicles(), recording, plan) if not f.passed}


@pytest.mark.parametrize("kind", presets())
def test_each_kind_that_is_composed_is_the_plans(kind: str, cart: Plan) -> None:
    data = cart.model_dump(mode="json")
    item = next(each for each in data["objects"] if each["name"] == "cart")
    item["construction"]["vehicle"], item["pose"]["rotation_deg"] = kind, [0.0, 0.0, 37.0]
    assert wrong(Plan.model_validate(data)) == {}


@pytest.mark.parametrize(
    ("more", "prim", "says"),
    [
        # axes and stops of its joints
        (f'put("{SPRING}", "physics:upperLimit", 0.6)', SPRING, "stops of"),
        (f'put("{STEER}", "physics:lowerLimit", -5.0)', STEER, "stops of"),
        (f'put("{AXLE}", "physics:upperLimit", 40.0)', AXLE, "stops of"),
        (f'put("{AXLE}", "physics:axis", "Y")', AXLE, "90 degrees off that of the plan's cart"),
        (f'put("{SPRING}", "physics:localPos1", Gf.Vec3f(0.1, 0, 0))', SPRING, "a place on its child of"),
        (f'put("{AXLE}", "physics:breakForce", 50.0)', AXLE, "may break"),
        # its tyres
        (f'put("{WHEEL}/part_0", "height", 0.5)', WHEEL, "a size of"),
        (f'put("{WHEEL}/part_0", "radius", 0.3)', WHEEL, "a size of"),
        ('put("/World/Looks/cart_wheel_front_left", "physics:restitution", 0.6)', WHEEL, "a restitution of 0.6"),
        # what hangs on it
        (f'box("{CART}/ram", (2, 0, 0.3))', CART, "/World/cart/ram is a shape that the plan's cart has not"),
        (f'box("{WHEEL}/spike", (0, 0, 0.3), False)', WHEEL, "/spike is a shape that"),
        (f'p("{CART}/part_0").RemoveAPI(UsdPhysics.CollisionAPI)', CART, "takes part in no collision"),
        (f'scene.stage.RemovePrim("{CART}/part_0")', CART, "lacks the box"),
        (f'body("{CART}/ballast", 400.0)', f"{CART}/ballast", "is a body of cart that the plan's cart has not"),
        (f'body("{WHEEL}/ballast", 9.0)', f"{WHEEL}/ballast", "is a body of cart that the plan's cart has not"),
        (f'joint("FixedJoint", "/World/weld", "{CART}", "{HUB}")', "/World/weld", "is a fixed joint between"),
        ('scene.spring("tug", "cart", "cart_hub_rear_left", stiffness=9.0)', "/World/tug", "pulls at cart"),
        (f'UsdPhysics.FilteredPairsAPI.Apply(p("{CART}")).CreateFilteredPairsRel().AddTarget("/World/ground")', CART,
         "and /World/ground are kept from touching"),
        # what each of its bodies weighs
        (f'put("{CART}", "physics:centerOfMass", Gf.Vec3f(0.6, 0, 0.4))', CART, "a centre of mass of"),
        (f'put("{CART}", "physics:diagonalInertia", Gf.Vec3f(20, 20, 20))', CART, "moments of inertia of"),
        (f'put("{HUB}", "physics:mass", 60.0); put("{CART}", "physics:mass", p("{CART}").GetAttribute("physics:mass")'
         f'.Get() - 56.0)', HUB, "a mass of 60 kg"),
        # where a part is, and how it starts
        (f'put("{KNUCKLE}", "xformOp:translate", Gf.Vec3d(0, 0, 1))', KNUCKLE, "a place on it of"),
        (f'put("{WHEEL}", "physics:angularVelocity", Gf.Vec3f(0, 900, 0))', WHEEL, "a starting angular velocity of"),
        (f'put("{WHEEL}", "physics:velocity", Gf.Vec3f(3, 0, 0))', WHEEL, "a starting velocity of"),
    ],
)  # fmt: skip
def test_a_part_that_is_made_otherwise_is_found(more: str, prim: str, says: str, cart: Plan) -> None:
    assert says in wrong(cart, more).get(prim, "")


@pytest.mark.parametrize("change", [{"travel_up": 0.4}, {"wheel_width": 0.3}, {"upright_mass": 30.0},
                                    {"inertia": (40.0, 80.0, 90.0)}, {"com_height": 0.9}, {"spring_rear": 60e3},
                                    {"steer_limit_deg": 12.0}, {"looks": "car"}])  # fmt: skip
def test_a_spec_of_its_own_is_found(change: dict, cart: Plan) -> None:
    """Each number of a kind makes something that is another."""
    own = preset("cart")
    fields = {name: getattr(own, name) for name in VehicleSpec.__dataclass_fields__} | change
    given = f"__import__('wsim.scene').scene.VehicleSpec(**{fields!r})"
    assert wrong(cart, change=('scene.vehicle("cart", "cart"', f'scene.vehicle("cart", {given}')) != {}


def test_an_engine_that_is_set_once_holds_the_plans_speed(cart: Plan) -> None:
    """Its axles turn at v / r of the bend; without the engine, or with another speed, that is found."""
    ask_for = Registration(actuation=[Actuation(kind="drive", speed=3.0, steer_deg=10.0)])
    items = [each.model_copy(update={"registration": ask_for}) if each.primitive == "vehicle" else each
             for each in cart.objects]  # fmt: skip
    once = cart.model_copy(update={"objects": items})
    assert "cart.drive(3.0)" in compose(once) and "cart.steer(10.0)" in compose(once)
    assert "def control" not in compose(once)
    assert wrong(once) == {}
    axles = {f"{CART}_axle_{corner}" for corner in preset("cart").driven_corners}
    assert wrong(once, change=("cart.drive(3.0)", "cart.drive(4.0)")).keys() == axles
    assert wrong(once, change=("cart.drive(3.0)", "pass")).keys() == axles
    steered = {f"{CART}_steer_{corner}" for corner in CORNERS[:2]}
    assert wrong(once, change=("cart.steer(10.0)", "cart.steer(-10.0)")).keys() == steered | axles


def test_a_vehicle_that_heads_the_other_way_is_told_by_how_much(cart: Plan) -> None:
    for turn in (150, 180, 210):
        assert CART in wrong(cart, change=("(-5.0, 0.0, 0.0)", f"(-5.0, 0.0, 0.0), yaw_deg={turn}"))


def test_on_a_slope_it_leans_and_a_level_one_is_found() -> None:
    hill = {"kind": "hill", "position": [30.0, 20.0], "radius": 80.0, "height": 14.0}
    land = {"name": "land", "role": "terrain", "state": "static", "material": {"name": "soil", "density": 1600},
            "construction": {"kind": "terrain", "extent": [20.0, 20.0], "layers": [hill]}}  # fmt: skip
    cart = {"name": "cart", "role": "vehicle", "construction": {"kind": "vehicle", "vehicle": "cart"},
            "pose": {"position": [0.0, 0.0, 0.0], "rotation_deg": [0.0, 0.0, 20.0]},
            "velocity": [1.8793852, 0.6840403, 0.0]}  # fmt: skip
    plan = set_down(Plan.model_validate({"title": "", "prompt": "", "objects": [land, cart]}))
    roll, pitch, _ = plan.objects[1].pose.rotation_deg
    assert abs(roll) > 2.0 and pitch < -8.0
    assert wrong(plan) == {}
    assert "starts turned" in wrong(plan, change=(f"pitch_deg={pitch}", "pitch_deg=0.0"))[CART]
    assert wrong(plan, change=("speed=2.0", "speed=0.0")) != {}


# ---- in the simulator
@pytest.fixture(scope="module")
def short() -> Plan:
    """A metre, in so short a time that three runs of it are bearable."""
    data = make_plan("A golf cart drives 10 m.").model_dump(mode="json")
    (cart,) = [item for item in data["objects"] if item["name"] == "cart"]
    cart["registration"]["actuation"][0]["route"] = [[-4.0, 0.0]]  # it starts at -5 m
    data["objectives"][0]["formula"]["least"] = 0.8
    data["simulation"]["duration"] = 2.75
    return Plan.model_validate(data)


def failed(plan: Plan, path: Path, change: tuple[str, str] = ("", ""), drives: bool = True) -> set[str]:
    """The checks that fail of a plan's program, as it runs; `drives`: its control does what it says."""
    text, space = compose(plan).replace(*change), {}
    exec(compile(text, "program.py", "exec"), space)
    scene = Scene()
    space["build"](scene)
    arrays: dict[str, np.ndarray] = {}

    def exchange(t, state):
        for name, values in state.items():
            arrays[name][...] = values
        arrays["joint_force"][...] = 0.0
        if drives:
            space["control"](world, t)
        return {name: arrays[name].copy() for name in OUTPUTS}

    simulation = Simulation(scene.save(path / "v.usda"), device="cpu", controller=ArrayController(exchange))
    layout = ControlLayout([body.prim for body in simulation.world.bodies], driven_joints(simulation.world))
    arrays |= {name: np.zeros(shape, np.float32) for name, shape in layout.shapes().items() if name != "t"}
    (world,) = layout.worlds(arrays)
    simulation.run(path / "r.rrd")
    verdict = judge(read(path / "r.rrd"), plan)
    assert verdict.crashes == []
    return {finding.check for finding in verdict.failures} - {"CheckSeen", "CheckInFrame"}  # no pictures are taken


def test_a_drive_is_accepted(short: Plan, tmp_path: Path) -> None:
    assert failed(short, tmp_path) == set()


def test_on_ice_it_is_rejected_for_its_friction_and_for_what_comes_of_that(short: Plan, tmp_path: Path) -> None:
    friction = next(item.material.friction for item in short.objects if item.name == "ground")
    assert failed(short, tmp_path, (f"friction={friction}", "friction=0.0")) == {
        "CheckPlanLooks",
        "ObjectiveFormula",
    }


def test_with_its_motor_off_it_is_rejected_for_not_coming_there(short: Plan, tmp_path: Path) -> None:
    assert failed(short, tmp_path, drives=False) == {"ObjectiveFormula"}


@pytest.mark.parametrize("brakes", [True, False])
def test_a_hard_stop_is_what_theory_says_and_one_that_does_not_brake_is_rejected(brakes: bool, tmp_path: Path) -> None:
    """From 6 m/s a car stops within v^2 / (2 mu g) = 2.04 m of where it is to brake, to 5 %."""
    stop = 6.0**2 / (2.0 * 0.9 * 9.81)
    driver = {"kind": "driver", "route": [[1.0, 0.0]], "speed": 6.0, "brake": {"at": [1.0, 0.0]}}
    gone = {"op": "gone_between", "object": "car", "axis": "x", "low": 1.0 + 0.95 * stop, "high": 1.0 + 1.05 * stop}
    formula = {"op": "finally", "seconds": 1.0, "of": gone}
    plan = Plan.model_validate({
        "title": "", "prompt": "", "simulation": {"duration": 2.2, "frame_rate": 20},
        "objects": [
            {"name": "ground", "role": "terrain", "state": "static", "construction": {"kind": "proxy",
             "primitive": "ground"}, "material": {"name": "asphalt", "density": 2300, "friction": 0.9}},
            {"name": "car", "role": "vehicle", "construction": {"kind": "vehicle", "vehicle": "car"},
             "pose": {"position": [0, 0, 0]}, "velocity": [6, 0, 0], "registration": {"actuation": [driver]}},
        ],
        "steps": [{"title": "drive", "objects": ["ground", "car"], "shows": "it stops"}],
        "objectives": [{"kind": "formula", "object": "car", "formula": formula}],
    })  # fmt: skip
    change = ("", "") if brakes else ("brake=Brake(at=(1.0, 0.0))", "stop=False")
    assert change[0] in compose(plan)
    assert failed(plan, tmp_path, change) == (set() if brakes else {"ObjectiveFormula"})
