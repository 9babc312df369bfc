from pathlib import Path

import numpy as np
import pytest
from pxr import Gf, Usd, UsdGeom, UsdPhysics

from wsim.errors import UserError
from wsim.scene import Drive, Scene
from wsim.scene.check import check_stage
from wsim.scene.describe import describe
from wsim.scene.world import Parameter, World


@pytest.fixture
def world(stage_path: Path) -> World:
    return describe(stage_path)


def test_run_settings_come_back(world: World) -> None:
    assert (world.duration, world.frame_rate, world.time_step, world.seed) == (2.0, 25.0, 0.001, 3)
    np.testing.assert_allclose(world.gravity, (0.0, 0.0, -9.81), rtol=1e-6)


def test_world_is_plain_data(world: World) -> None:
    assert World.model_validate_json(world.model_dump_json()) == world


def test_an_open_stage_reads_as_its_file_does(workshop: Scene, world: World) -> None:
    assert describe(workshop.stage) == world


def test_bodies_come_back(world: World) -> None:
    assert [body.prim for body in world.bodies] == [
        f"/World/{name}" for name in ("block", "rod", "pill", "ball", "lid", "lift")
    ]
    block = world.body("/World/block")
    assert block.line is not None and block.line.startswith("conftest.py:")
    (shape,) = block.shapes
    assert shape.prim == "/World/block/geometry"
    assert shape.kind == "box"
    assert shape.size == pytest.approx((0.2, 0.3, 0.4))
    assert shape.color == pytest.approx((0.4, 0.2, 0.1))
    assert shape.opacity == pytest.approx(0.9)
    assert (shape.friction, shape.restitution) == pytest.approx((0.4, 0.2))
    assert [body.kinematic for body in world.bodies] == [False] * 5 + [True]


def test_roll_pitch_yaw_turn_about_fixed_axes_in_this_order(world: World) -> None:
    from scipy.spatial.transform import Rotation

    expected = Rotation.from_euler("xyz", (10, 20, 30), degrees=True).as_quat()
    assert abs(np.dot(world.body("/World/block").rotation, expected)) == pytest.approx(1.0, abs=1e-9)


def test_statics_come_back_in_the_world(world: World) -> None:
    statics = {static.prim: static for static in world.statics}
    assert set(statics) == {"/World/ground", "/World/tank", "/World/shelf"}
    assert [shape.kind for shape in statics["/World/ground"].shapes] == ["plane"]
    assert statics["/World/ground"].shapes[0].friction == pytest.approx(0.7)
    walls = {shape.prim.rsplit("/", 1)[-1]: shape for shape in statics["/World/tank"].shapes}
    assert walls["wall_plus_x"].position == pytest.approx((0.515, 2.0, 0.28))
    assert walls["wall_plus_x"].size == pytest.approx((0.03, 0.6, 0.5))
    assert walls["floor"].position == pytest.approx((0.0, 2.0, 0.015))
    assert all(0.2 < wall.opacity < 0.3 for wall in walls.values())


def test_container_and_fluid_come_back(world: World) -> None:
    (tank,), (water,) = world.containers, world.fluids
    assert tank.inner_size == pytest.approx((1.0, 0.6, 0.5))
    assert tank.inner_center == pytest.approx((0.0, 2.0, 0.28))
    assert water.size == pytest.approx((1.0, 0.6, 0.3))
    assert water.center == pytest.approx((0.0, 2.0, 0.18))
    assert (water.density, water.viscosity, water.spacing, water.speed_of_sound) == (1000.0, 0.001, 0.05, 0.0)
    assert water.velocity == (0.0, 0.0, 0.0)
    assert water.container == tank.prim == "/World/tank"
    assert water.color == pytest.approx((0.15, 0.4, 0.6))
    assert water.attenuation_length is None


@pytest.mark.parametrize(("length", "opacity"), [(0.0, 1.0), (0.02, 1.0 - np.exp(-10.0)), (1.0, 1.0 - np.exp(-0.2))])
def test_how_clear_a_fluid_is_comes_back(length: float, opacity: float) -> None:
    """As it was stated, and to tools that know no such law as the opacity of its longest edge."""
    scene = Scene()
    scene.fluid(
        "cola",
        size=(0.2, 0.1, 0.1),
        position=(0, 0, 1),
        spacing=0.02,
        color=(0.1, 0.03, 0.01),
        attenuation_length=length,
    )
    (cola,) = describe(scene.stage).fluids
    assert cola.attenuation_length == length
    look = scene.stage.GetPrimAtPath("/World/Looks/cola/surface")
    assert look.GetAttribute("inputs:opacity").Get() == pytest.approx(opacity)


def test_joints_come_back(world: World) -> None:
    found = [(joint.kind, joint.parent, joint.child, joint.axis) for joint in world.joints]
    assert found == [
        ("revolute", None, "/World/rod", "Y"),
        ("prismatic", "/World/rod", "/World/pill", "X"),
        ("spherical", "/World/pill", "/World/ball", "X"),
        ("fixed", "/World/ball", "/World/lid", "X"),
    ]


def test_cameras_come_back(world: World) -> None:
    side, top = world.cameras
    assert side.eye == pytest.approx((0.0, -4.0, 1.5))
    assert side.target == pytest.approx((0.0, 0.0, 0.5))
    assert (side.fov, side.width, side.height) == (pytest.approx(60.0), 320, 240)
    forward = np.subtract(side.target, side.eye)
    assert np.dot(side.up, forward) == pytest.approx(0.0, abs=1e-6)
    assert side.up[2] > 0.9
    assert top.up == pytest.approx((0.0, 1.0, 0.0), abs=1e-9)


def test_camera_that_was_moved_looks_along_its_axis(workshop: Scene) -> None:
    camera = workshop.stage.GetPrimAtPath("/World/side")
    UsdGeom.Xformable(camera).ClearXformOpOrder()
    UsdGeom.Xformable(camera).AddTransformOp().Set(Gf.Matrix4d(1.0).SetTranslate(Gf.Vec3d(1.0, 2.0, 9.0)))
    side = describe(workshop.stage).cameras[0]
    assert side.eye == pytest.approx((1.0, 2.0, 9.0))
    assert side.target[:2] == pytest.approx((1.0, 2.0))
    assert side.target[2] < 9.0


def test_lights_come_back(world: World) -> None:
    sun, sky, lamp = world.lights
    assert (sun.kind, sky.kind, lamp.kind) == ("distant", "dome", "sphere")
    assert sun.direction == pytest.approx((0.0, 0.6, -0.8))
    assert lamp.position == pytest.approx((1.0, 2.0, 3.0))


def test_parameters_come_back(world: World) -> None:
    assert world.parameters == [
        Parameter(name="wood_density", value=650.0, default=600.0, low=300.0, high=900.0, unit="kg/m^3")
    ]


def test_material_of_other_hands_and_visuals_that_do_not_collide() -> None:
    scene = Scene()
    body = scene.box("body", size=(1, 1, 1), density=100.0)
    decoration = UsdGeom.Sphere.Define(scene.stage, f"{body.path}/decoration")
    decoration.CreateRadiusAttr(0.2)
    decoration.AddTranslateOp().Set(Gf.Vec3d(0, 0, 0.5))
    decoration.CreateDisplayColorAttr([Gf.Vec3f(0.1, 0.2, 0.3)])
    hidden = UsdGeom.Sphere.Define(scene.stage, f"{body.path}/hidden")
    hidden.MakeInvisible()
    (found,) = describe(scene.stage).bodies
    assert [shape.prim.rsplit("/", 1)[-1] for shape in found.shapes] == ["geometry", "decoration"]
    shape = found.shapes[1]
    assert (shape.collides, shape.size, shape.position) == (False, (pytest.approx(0.2),), pytest.approx((0, 0, 0.5)))
    assert shape.color == pytest.approx((0.1, 0.2, 0.3))
    assert (found.mass, found.volume) == (pytest.approx(100.0), pytest.approx(1.0))


def test_quads_and_left_handed_meshes_have_positive_volume() -> None:
    scene = Scene()
    mesh = UsdGeom.Mesh.Define(scene.stage, "/World/crate")
    corners = [(x, y, z) for x in (0, 1) for y in (0, 2) for z in (0, 3)]
    mesh.CreatePointsAttr([Gf.Vec3f(*c) for c in corners])
    mesh.CreateFaceVertexCountsAttr([4] * 6)
    mesh.CreateFaceVertexIndicesAttr([0, 1, 3, 2, 4, 6, 7, 5, 0, 4, 5, 1, 2, 3, 7, 6, 0, 2, 6, 4, 1, 5, 7, 3])
    for api in (UsdPhysics.RigidBodyAPI, UsdPhysics.CollisionAPI):
        api.Apply(mesh.GetPrim())
    for orientation in ("rightHanded", "leftHanded"):
        mesh.CreateOrientationAttr(orientation)
        (body,) = describe(scene.stage).bodies
        assert body.volume == pytest.approx(6.0)
        assert body.com == pytest.approx((0.5, 1.0, 1.5))
        expected = 6000.0 / 12.0 * np.diag([4 + 9, 1 + 9, 1 + 4])
        np.testing.assert_allclose(np.reshape(body.inertia, (3, 3)), expected, atol=1e-2)


def test_stage_in_other_units_is_refused(tmp_path: Path) -> None:
    stage = Usd.Stage.CreateInMemory()
    UsdGeom.SetStageMetersPerUnit(stage, 0.01)
    with pytest.raises(UserError, match=r"metersPerUnit = 0.01.*in metres"):
        describe(stage)


@pytest.mark.parametrize(("text", "message"), [(None, "no such stage"), ("rubbish", "not a USD stage")])
def test_what_is_no_stage_is_refused(tmp_path: Path, text: str | None, message: str) -> None:
    path = tmp_path / "stage.usda"
    if text is not None:
        path.write_text(text)
    with pytest.raises(UserError, match=message):
        describe(path)


def test_a_drive_says_that_it_saturates(tmp_path: Path) -> None:
    scene = Scene()
    for k, saturates in enumerate((True, False)):
        scene.box(f"box_{k}", size=(0.1, 0.1, 0.1), position=(k, 0.0, 1.0))
        drive = Drive(damping=1.0, max_force=5.0, saturates=saturates)
        scene.joint_revolute(f"joint_{k}", None, f"box_{k}", drive=drive)
    path = scene.save(tmp_path / "stage.usda")
    assert check_stage(path, [tmp_path]) == []
    assert [joint.drive.saturates for joint in describe(path).joints if joint.drive] == [True, False]
    scene.stage.GetPrimAtPath("/World/joint_0").GetAttribute("drive:angular:physics:maxForce").Set(np.inf)
    UsdPhysics.Joint(scene.stage.GetPrimAtPath("/World/joint_1")).CreateBreakForceAttr(1e-30)
    assert check_stage(scene.save(path), [tmp_path]) == [
        "/World/joint_0.wsim:saturates: 1 needs a max_force: that is where a drive saturates "
        "(drive:angular:physics:maxForce, or linear)",
        "/World/joint_1.physics:breakForce: 1e-30 must be >= 1e-12 N; inf never breaks",
        "/World/joint_1: it breaks, and such a joint can have no drive; put that on another joint",
    ]
