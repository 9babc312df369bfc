"""What Newton's own importer makes of the stages."""

import math
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from pxr import Gf, Usd, UsdGeom, UsdPhysics, UsdShade

from wsim.scene import Scene
from wsim.scene.describe import describe
from wsim.scene.world import Shape, World

newton = pytest.importorskip("newton")


def load(path: Path) -> SimpleNamespace:
    builder = newton.ModelBuilder()
    fluids = [fluid.prim for fluid in describe(path).fluids]
    result = builder.add_usd(str(path), ignore_paths=[f"{prim}/volume" for prim in fluids])
    return SimpleNamespace(
        builder=builder, result=result, body={label: i for i, label in enumerate(builder.body_label)}
    )


def assert_same_masses(path: Path) -> World:
    """Mass, centre and inertia of every body as Newton has them and as `describe` does, to 1e-4."""
    world, loaded = describe(path), load(path)
    builder = loaded.builder
    assert {body.prim for body in world.bodies} == set(loaded.body)
    for body in world.bodies:
        i = loaded.body[body.prim]
        inertia = np.array(builder.body_inertia[i]).reshape(3, 3)
        scale = np.abs(inertia).max()
        assert builder.body_mass[i] == pytest.approx(body.mass, rel=1e-4), body.prim
        np.testing.assert_allclose(np.array(builder.body_com[i]), body.com, atol=1e-5, err_msg=body.prim)
        np.testing.assert_allclose(np.reshape(body.inertia, (3, 3)), inertia, atol=1e-4 * scale, err_msg=body.prim)
    return world


def test_labels_are_prim_paths_and_the_volume_is_left_out(stage_path: Path) -> None:
    builder = load(stage_path).builder
    names = {"block", "rod", "pill", "ball", "lid", "lift"}
    assert set(builder.body_label) == {f"/World/{name}" for name in names}
    statics = {"ground/geometry", "shelf/geometry"} | {
        f"tank/{part}" for part in ("floor", "wall_minus_x", "wall_plus_x", "wall_minus_y", "wall_plus_y")
    }
    assert set(builder.shape_label) == {f"/World/{name}" for name in {f"{n}/geometry" for n in names} | statics}


def test_shapes_have_the_sizes_and_poses_that_describe_says(stage_path: Path) -> None:
    world, builder = describe(stage_path), load(stage_path).builder
    index = {label: i for i, label in enumerate(builder.shape_label)}
    shapes = [s for body in world.bodies for s in body.shapes] + [s for static in world.statics for s in static.shapes]
    assert len(shapes) == builder.shape_count
    for shape in shapes:
        i = index[shape.prim]
        assert newton.GeoType(builder.shape_type[i]).name.lower() == shape.kind
        np.testing.assert_allclose(np.array(builder.shape_scale[i])[: len(shape.size)], newton_scale(shape), rtol=1e-5)
        pose = np.array(builder.shape_transform[i])
        np.testing.assert_allclose(pose[:3], shape.position, atol=1e-6)
        assert abs(np.dot(pose[3:], shape.rotation)) == pytest.approx(1.0, abs=1e-6), shape.prim
        if shape.friction is not None:
            assert builder.shape_material_mu[i] == pytest.approx(shape.friction)
        if shape.restitution is not None:
            assert builder.shape_material_restitution[i] == pytest.approx(shape.restitution)


def newton_scale(shape: Shape) -> list[float]:
    if shape.kind == "box":
        return [edge / 2 for edge in shape.size]
    if shape.kind in ("cylinder", "capsule"):
        return [shape.size[0], shape.size[1] / 2]
    return list(shape.size)


def test_masses_agree(stage_path: Path) -> None:
    world = assert_same_masses(stage_path)
    assert world.body("/World/block").mass == pytest.approx(650.0 * 0.2 * 0.3 * 0.4, rel=1e-6)
    assert world.body("/World/pill").mass == pytest.approx(3.0)
    assert world.body("/World/rod").mass == pytest.approx(1000.0 * math.pi * 0.05**2 * 0.6, rel=1e-6)


def test_velocities_are_in_the_world(stage_path: Path) -> None:
    loaded = load(stage_path)
    qd = np.array(loaded.builder.body_qd[loaded.body["/World/block"]])
    np.testing.assert_allclose(qd, (1.0, 2.0, 3.0, 0.0, 0.0, math.pi / 2), atol=1e-5)
    block = describe(stage_path).body("/World/block")
    np.testing.assert_allclose((*block.velocity, *block.angular_velocity), qd, atol=1e-5)


def test_poses_and_kinematic_bodies_agree(stage_path: Path) -> None:
    world, loaded = describe(stage_path), load(stage_path)
    for body in world.bodies:
        i = loaded.body[body.prim]
        pose = np.array(loaded.builder.body_q[i])
        np.testing.assert_allclose(pose[:3], body.position, atol=1e-6)
        assert abs(np.dot(pose[3:], body.rotation)) == pytest.approx(1.0, abs=1e-6)
        assert bool(loaded.builder.body_flags[i] & int(newton.BodyFlags.KINEMATIC)) == body.kinematic


def test_joints_keep_types_limits_and_drives(stage_path: Path) -> None:
    loaded = load(stage_path)
    b = loaded.builder
    joints = {label.rsplit("/", 1)[-1]: i for i, label in enumerate(b.joint_label)}
    kinds = {
        name: newton.JointType(b.joint_type[i]).name for name, i in joints.items() if not name.startswith("joint_")
    }
    assert kinds == {"hinge": "REVOLUTE", "slide": "PRISMATIC", "socket": "BALL", "weld": "FIXED"}
    body = {name: loaded.body[f"/World/{name}"] for name in ("rod", "pill", "ball", "lid")}
    ends = {name: (b.joint_parent[joints[name]], b.joint_child[joints[name]]) for name in kinds}
    assert ends == {
        "hinge": (-1, body["rod"]),
        "slide": (body["rod"], body["pill"]),
        "socket": (body["pill"], body["ball"]),
        "weld": (body["ball"], body["lid"]),
    }
    hinge, slide = (b.joint_qd_start[joints[name]] for name in ("hinge", "slide"))
    np.testing.assert_allclose(b.joint_limit_lower[hinge], math.radians(-30), rtol=1e-5)
    np.testing.assert_allclose(b.joint_limit_upper[hinge], math.radians(60), rtol=1e-5)
    np.testing.assert_allclose((b.joint_limit_lower[slide], b.joint_limit_upper[slide]), (-0.1, 0.2), rtol=1e-5)
    np.testing.assert_allclose((b.joint_target_ke[hinge], b.joint_target_kd[hinge]), (10.0, 1.0), rtol=1e-5)
    np.testing.assert_allclose((b.joint_target_ke[slide], b.joint_target_kd[slide]), (50.0, 5.0), rtol=1e-5)
    np.testing.assert_allclose(b.joint_effort_limit[hinge], 5.0)
    target = b.joint_target_q[b.joint_q_start[joints["hinge"]]]
    np.testing.assert_allclose(target, math.radians(20), rtol=1e-5)


def test_joints_start_where_the_bodies_stand(stage_path: Path) -> None:
    builder = load(stage_path).builder
    model = builder.finalize(device="cpu")
    state = model.state()
    newton.eval_fk(model, model.joint_q, model.joint_qd, state)
    np.testing.assert_allclose(state.body_q.numpy(), np.array(builder.body_q), atol=2e-6)


def test_closed_loop_still_loads(tmp_path: Path) -> None:
    scene = Scene()
    bodies = [scene.box(f"b{i}", size=(0.1, 0.1, 0.1), position=(i, 0.0, 0.0)) for i in range(3)]
    scene.joint_revolute("a", None, bodies[0], axis="Y")
    scene.joint_revolute("b", bodies[0], bodies[1], anchor=(0.5, 0, 0), axis="Y")
    scene.joint_revolute("c", bodies[1], bodies[2], anchor=(1.5, 0, 0), axis="Y")
    scene.joint_revolute("d", None, bodies[2], anchor=(2.5, 0, 0), axis="Y")
    builder = load(scene.save(tmp_path / "loop.usda")).builder
    assert builder.joint_count == 4
    assert builder.joint_articulation[builder.joint_label.index("/World/d")] == -1
    builder.finalize(device="cpu")


def test_gravity_reaches_newton(tmp_path: Path) -> None:
    scene = Scene()
    scene.simulation(gravity=(0.0, 0.0, -1.62))
    scene.sphere("ball", radius=0.1)
    np.testing.assert_allclose(load(scene.save(tmp_path / "moon.usda")).builder.gravity, (0, 0, -1.62), rtol=1e-6)


def test_raw_physics_prims_agree(tmp_path: Path) -> None:
    """Prims of other hands: a body that is a Gprim, nested and scaled Xforms, two shapes, densities of all kinds."""
    scene = Scene()
    stage = scene.stage
    cube = UsdGeom.Cube.Define(stage, "/World/cube")
    cube.CreateSizeAttr(0.4)
    cube.AddTranslateOp().Set(Gf.Vec3d(0, 0, 2))
    cube.AddScaleOp().Set(Gf.Vec3f(1, 2, 3))
    for api in (UsdPhysics.RigidBodyAPI, UsdPhysics.CollisionAPI):
        api.Apply(cube.GetPrim())

    group = UsdGeom.Xform.Define(stage, "/World/group")
    group.AddTranslateOp().Set(Gf.Vec3d(3, 0, 1))
    group.AddRotateXYZOp().Set(Gf.Vec3f(20, 30, 40))
    hammer = UsdGeom.Xform.Define(stage, "/World/group/hammer")
    hammer.AddTranslateOp().Set(Gf.Vec3d(1, 0, 0))
    UsdPhysics.RigidBodyAPI.Apply(hammer.GetPrim())
    handle = UsdGeom.Cylinder.Define(stage, "/World/group/hammer/parts/handle")
    handle.CreateRadiusAttr(0.03)
    handle.CreateHeightAttr(0.5)
    handle.CreateAxisAttr("X")
    UsdPhysics.CollisionAPI.Apply(handle.GetPrim())
    head = UsdGeom.Cube.Define(stage, "/World/group/hammer/parts/head")
    head.CreateSizeAttr(0.1)
    head.AddTranslateOp().Set(Gf.Vec3d(0.3, 0.0, 0.05))
    head.AddRotateZOp().Set(25.0)
    UsdPhysics.CollisionAPI.Apply(head.GetPrim())
    iron = UsdShade.Material(stage.GetPrimAtPath(scene.material("iron", density=7000.0).path))
    UsdShade.MaterialBindingAPI.Apply(head.GetPrim()).Bind(iron)
    cap = UsdGeom.Sphere.Define(stage, "/World/group/hammer/parts/cap")
    cap.CreateRadiusAttr(0.05)
    cap.AddTranslateOp().Set(Gf.Vec3d(-0.25, 0.0, 0.0))
    UsdPhysics.CollisionAPI.Apply(cap.GetPrim())
    UsdPhysics.MassAPI.Apply(cap.GetPrim()).CreateMassAttr(0.3)

    world = assert_same_masses(scene.save(tmp_path / "raw.usda"))
    assert world.body("/World/cube").mass == pytest.approx(1000 * 0.4 * 0.8 * 1.2, rel=1e-5)
    assert world.body("/World/cube").shapes[0].size == pytest.approx((0.4, 0.8, 1.2))
    handle_mass, head_mass = 1000 * math.pi * 0.03**2 * 0.5, 7000 * 0.1**3
    assert world.body("/World/group/hammer").mass == pytest.approx(handle_mass + head_mass + 0.3, rel=1e-5)


@pytest.mark.parametrize("axis", "XYZ")
def test_a_cone_is_round_though_it_is_drawn_with_flat_sides(tmp_path: Path, axis: str) -> None:
    scene = Scene()
    cone = UsdGeom.Cone.Define(scene.stage, "/World/cone")
    cone.CreateRadiusAttr(0.05)
    cone.CreateHeightAttr(0.12)
    cone.CreateAxisAttr(axis)
    UsdPhysics.CollisionAPI.Apply(cone.GetPrim())
    UsdPhysics.RigidBodyAPI.Apply(cone.GetPrim())
    UsdPhysics.MassAPI.Apply(cone.GetPrim()).CreateDensityAttr(600.0)
    world = assert_same_masses(scene.save(tmp_path / "stage.usda"))
    assert world.bodies[0].mass == pytest.approx(600.0 * math.pi * 0.05**2 * 0.12 / 3.0, rel=1e-6)


def test_reading_first_does_not_hinder_newton(stage_path: Path) -> None:
    Usd.Stage.Open(str(stage_path))
    assert load(stage_path).result["path_body_map"].keys() == {body.prim for body in describe(stage_path).bodies}
