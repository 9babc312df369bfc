"""Stages written by other means: what the check accepts Newton builds, and what it refuses is said in one line."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest
from pxr import Gf, Sdf, Usd, UsdGeom, UsdPhysics

from wsim import sim
from wsim.scene import Scene, schema
from wsim.scene.check import check_stage
from wsim.scene.describe import describe

GAP = 0.3  # [m] between the boxes
BOXES = "abcd"
SQUARE = [(0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (1.0, 1.0, 0.0), (0.0, 1.0, 0.0)]
Joined = tuple[str, str, str]  # kind, body0 and body1; "" is the world


def _boxes() -> Scene:
    scene = Scene()
    scene.ground()
    for k, name in enumerate(BOXES):
        scene.box(name, size=(0.2, 0.2, 0.2), position=(GAP * k, 0.0, 1.0), density=500.0)
    return scene


def _join(stage: Usd.Stage, *joints: Joined) -> None:
    """Joints as USD alone makes them, without any mark of an articulation."""
    for k, (kind, first, second) in enumerate(joints):
        joint = getattr(UsdPhysics, kind).Define(stage, f"/World/joint{k}")
        middle = Gf.Vec3f(GAP / 2.0 * sum(BOXES.find(end) for end in (first, second) if end), 0.0, 1.0)
        for end, targets, place in (
            (first, joint.CreateBody0Rel(), joint.CreateLocalPos0Attr()),
            (second, joint.CreateBody1Rel(), joint.CreateLocalPos1Attr()),
        ):
            if end:
                targets.SetTargets([f"/World/{end}"])
            place.Set(middle - Gf.Vec3f(GAP * BOXES.find(end), 0.0, 1.0) if end in BOXES and end else middle)


def _root(*paths: str) -> Callable[[Usd.Stage], None]:
    return lambda stage: [UsdPhysics.ArticulationRootAPI.Apply(stage.GetPrimAtPath(path)) for path in paths] and None


def _export(stage: Usd.Stage, folder: Path) -> Path:
    path = folder / "raw.usda"
    stage.GetRootLayer().Export(str(path))
    return path


KINDS = ("RevoluteJoint", "PrismaticJoint", "SphericalJoint", "FixedJoint", "Joint")
WORK: dict[str, list[Joined]] = {
    **{kind: [(kind, "a", "b")] for kind in KINDS},
    "chain": [("RevoluteJoint", "a", "b"), ("RevoluteJoint", "b", "c")],
    "ring": [("RevoluteJoint", "a", "b"), ("RevoluteJoint", "b", "c"), ("RevoluteJoint", "c", "a")],
    "there and back": [("RevoluteJoint", "a", "b"), ("RevoluteJoint", "b", "a")],
    "two hinges of a door": [("RevoluteJoint", "a", "b"), ("RevoluteJoint", "a", "b")],
    "from the world": [("RevoluteJoint", "", "a"), ("RevoluteJoint", "a", "b")],
    "to the world": [("RevoluteJoint", "a", ""), ("RevoluteJoint", "a", "b")],
    "from what stands still": [("RevoluteJoint", "ground", "a"), ("RevoluteJoint", "a", "b")],
    "two pairs": [("RevoluteJoint", "a", "b"), ("PrismaticJoint", "c", "d")],
    "two of the world": [("RevoluteJoint", "", "a"), ("RevoluteJoint", "", "b")],
}


@pytest.mark.parametrize("joints", WORK.values(), ids=WORK.keys())
def test_joints_of_usd_alone_are_saved_so_that_they_simulate(tmp_path: Path, joints: list[Joined]) -> None:
    scene = _boxes()
    _join(scene.stage, *joints)
    path = scene.save(tmp_path / "stage.usda")
    assert check_stage(path, [tmp_path]) == []
    simulation = sim.Simulation(path, device="cpu")
    simulation.step()


def test_roots_set_by_hand_stay(tmp_path: Path) -> None:
    """A stage that the simulator takes is saved as it is."""
    scene = _boxes()
    _join(scene.stage, ("RevoluteJoint", "a", "b"))
    _root("/World")(scene.stage)
    saved = Usd.Stage.Open(str(scene.save(tmp_path / "stage.usda")))
    marked = [str(prim.GetPath()) for prim in saved.Traverse() if prim.HasAPI(UsdPhysics.ArticulationRootAPI)]
    assert marked == ["/World"]
    assert check_stage(tmp_path / "stage.usda", [tmp_path]) == []
    sim.Simulation(tmp_path / "stage.usda", device="cpu")


def _excluded(stage: Usd.Stage) -> None:
    UsdPhysics.Joint(stage.GetPrimAtPath("/World/joint0")).CreateExcludeFromArticulationAttr(True)


def _limited(stage: Usd.Stage) -> None:
    _excluded(stage)
    UsdPhysics.RevoluteJoint(stage.GetPrimAtPath("/World/joint0")).CreateLowerLimitAttr(-1.0)


def _rubbing(stage: Usd.Stage) -> None:
    _root("/World/a")(stage)
    stage.GetPrimAtPath("/World/joint0").CreateAttribute("newton:friction", Sdf.ValueTypeNames.Float).Set(-1.0)


def _brittle(stage: Usd.Stage) -> None:
    UsdPhysics.Joint(stage.GetPrimAtPath("/World/joint0")).CreateBreakForceAttr(5.0)


def _breaking(stage: Usd.Stage) -> None:
    UsdPhysics.Joint(stage.GetPrimAtPath("/World/joint0")).CreateBreakForceAttr(0.0)


def _kinematic(stage: Usd.Stage) -> None:
    for name in "ab":
        UsdPhysics.RigidBodyAPI(stage.GetPrimAtPath(f"/World/{name}")).CreateKinematicEnabledAttr(True)


def _gear(stage: Usd.Stage) -> None:
    prim = stage.DefinePrim("/World/gear", "Scope")
    schema.apply(prim, schema.GEAR, {"ratio": (Sdf.ValueTypeNames.Double, 0.0)})
    for name, target in (("joint0", "joint0"), ("joint1", "b")):
        prim.CreateRelationship(f"wsim:{name}", custom=False).SetTargets([f"/World/{target}"])


REFUSED: list[tuple[list[Joined], Callable[[Usd.Stage], None], str]] = [
    ([("FixedJoint", "a", "b")], _root(), "/World/a: its joints have no articulation root; apply"),
    (
        [("RevoluteJoint", "", "a"), ("RevoluteJoint", "a", "b")],
        _root(),
        "/World/joint0: its joints have no articulation root",
    ),
    ([("RevoluteJoint", "a", "b")], _root("/World/joint0"), "/World/a: its joints have no articulation root"),
    ([("RevoluteJoint", "a", "b")], _root("/World/a", "/World/b"), "/World/b: its joints have another articulation"),
    (
        [("RevoluteJoint", "a", "b"), ("RevoluteJoint", "c", "d")],
        _root("/World"),
        "/World: its joints have another articulation root, or it has two chains; give each chain one",
    ),
    (
        [("RevoluteJoint", "a", "b"), ("RevoluteJoint", "b", "a")],
        _root("/World/a"),
        "/World/joint1: closes a loop of joints; give it physics:excludeFromArticulation = 1",
    ),
    (
        [("RevoluteJoint", "a", "b"), ("RevoluteJoint", "c", "b")],
        _root("/World/a"),
        "joint1.physics:body1: </World/b> is the body1 of </World/joint0>, too; swap body0 and body1 in one of",
    ),
    (
        [("PrismaticJoint", "a", "b")],
        _excluded,
        "joint0: a PhysicsPrismaticJoint closes a loop; only a fixed, revolute",
    ),
    (
        [("PrismaticJoint", "a", "b")],
        _brittle,
        "joint0: a PhysicsPrismaticJoint breaks; only a fixed, revolute or spherical joint can: let a carriage slide",
    ),
    ([("RevoluteJoint", "a", "b")], _limited, "joint0: it closes a loop, and such a joint can have no limits"),
    ([("RevoluteJoint", "a", "b")], _rubbing, "joint0.newton:friction: -1 must be finite and >= 0"),
    ([("RevoluteJoint", "a", "b")], _breaking, "joint0.physics:breakForce: 0 must be > 0; inf never breaks"),
    ([("RevoluteJoint", "a", "b")], _kinematic, "joint0: a kinematic body goes its own way; a joint needs a body at"),
    ([("RevoluteJoint", "a", "b")], _gear, "/World/gear.wsim:joint1: </World/b> is no revolute or prismatic joint"),
    ([("RevoluteJoint", "a", "b")], _gear, "/World/gear.wsim:ratio: 0.0 must be finite and not 0"),
    ([("DistanceJoint", "", "a")], _root(), "/World/joint0: a distance joint is not supported"),
]


@pytest.mark.parametrize(("joints", "spoil", "message"), REFUSED, ids=[message for *_, message in REFUSED])
def test_joints_that_the_simulator_cannot_take_are_refused(
    tmp_path: Path, joints: list[Joined], spoil: Callable[[Usd.Stage], None], message: str
) -> None:
    stage = _boxes().stage
    _join(stage, *joints)
    spoil(stage)
    problems = check_stage(_export(stage, tmp_path), [tmp_path])
    assert any(message in problem for problem in problems), problems


def test_a_save_turns_joints_round_that_join_two_chains(tmp_path: Path) -> None:
    scene = _boxes()
    _join(scene.stage, ("RevoluteJoint", "a", "b"), ("PrismaticJoint", "c", "b"))
    path = scene.save(tmp_path / "stage.usda")
    assert check_stage(path, [tmp_path]) == []
    simulation = sim.Simulation(path, device="cpu")
    assert len(simulation.model.joint_qd) == 6 + 2 + 6  # a floats with b and c, d by itself


def test_a_slider_makes_another_joint_of_its_loop_the_closing_one(tmp_path: Path) -> None:
    scene = _boxes()
    _join(scene.stage, ("RevoluteJoint", "a", "b"), ("RevoluteJoint", "b", "c"), ("PrismaticJoint", "c", "a"))
    path = scene.save(tmp_path / "stage.usda")
    assert check_stage(path, [tmp_path]) == []
    assert [joint.prim for joint in describe(path).joints if joint.closing] == ["/World/joint1"]
    sim.Simulation(path, device="cpu").step()


def test_a_loop_of_sliders_is_refused(tmp_path: Path) -> None:
    scene = _boxes()
    _join(scene.stage, *(("PrismaticJoint", *ends) for ends in ("ab", "bc", "ca")))
    (problem,) = check_stage(scene.save(tmp_path / "stage.usda"), [tmp_path])
    assert problem.startswith("/World/joint2: a PhysicsPrismaticJoint closes a loop; only a fixed, revolute or")


def _prim(kind: str, moves: bool = False, **values: object) -> Callable[[Usd.Stage], None]:
    """A collider of a kind at /World/other."""

    def add(stage: Usd.Stage) -> None:
        prim = stage.DefinePrim("/World/other", kind)
        UsdGeom.Xformable(prim).AddTranslateOp().Set(Gf.Vec3d(0.0, 0.0, 3.0))
        for name, value in values.items():
            prim.GetAttribute(name).Set(value)
        UsdPhysics.CollisionAPI.Apply(prim)
        if moves:
            UsdPhysics.RigidBodyAPI.Apply(prim)

    return add


def _mesh(points: list[tuple[float, float, float]], counts: list[int], indices: list[int], moves: bool = True):
    return _prim("Mesh", moves, points=points, faceVertexCounts=counts, faceVertexIndices=indices)


def _axis_of_a_joint(stage: Usd.Stage) -> None:
    _join(stage, ("RevoluteJoint", "", "a"))
    stage.GetPrimAtPath("/World/joint0").GetAttribute("physics:axis").Set("Q")


def _nested(stage: Usd.Stage) -> None:
    for api in (UsdPhysics.RigidBodyAPI, UsdPhysics.CollisionAPI):
        api.Apply(stage.DefinePrim("/World/a/inner", "Cube"))


def _switched_off(stage: Usd.Stage) -> None:
    _prim("Cube", True)(stage)
    UsdPhysics.CollisionAPI(stage.GetPrimAtPath("/World/other")).CreateCollisionEnabledAttr(False)


FLAT = "/World/other.points: a flat mesh cannot collide"
UNTAKEN: list[tuple[Callable[[Usd.Stage], None], str]] = [
    *((_prim(kind, axis="W"), "other.axis: 'W' must be one of X, Y, Z") for kind in ("Cylinder", "Capsule", "Plane")),
    (_prim("Cone", axis="W"), "other.axis: 'W' must be one of X, Y, Z"),
    (_axis_of_a_joint, "/World/joint0.physics:axis: 'Q' must be one of X, Y, Z"),
    (_nested, "/World/a/inner: a rigid body inside the rigid body </World/a>; put it beside"),
    (_mesh(SQUARE, [4], [0, 1, 2, 3]), FLAT),
    (_mesh(SQUARE, [4], [0, 1, 2, 3], moves=False), FLAT),
    (_mesh(SQUARE, [3], [0, 0, 0]), FLAT),
    (_mesh([(0.0, 0.0, 0.0), (1.0, 1.0, 1.0), (2.0, 2.0, 2.0)], [3], [0, 1, 2]), FLAT),
    (_mesh(SQUARE, [], []), "/World/other.faceVertexCounts: a mesh that collides needs faces"),
    (_mesh([], [], [], moves=False), "/World/other.points: a mesh needs points"),
    (_prim("Capsule_1", True), "/World/other: a rigid body without mass"),
    (_switched_off, "/World/other: a rigid body without mass; give it a collider that is switched on"),
]


@pytest.mark.parametrize(("spoil", "message"), UNTAKEN)
def test_what_the_simulator_cannot_take_is_refused(
    tmp_path: Path, spoil: Callable[[Usd.Stage], None], message: str
) -> None:
    stage = _boxes().stage
    spoil(stage)
    problems = check_stage(_export(stage, tmp_path), [tmp_path])
    assert any(message in problem for problem in problems), problems


def test_what_is_near_to_that_is_taken(tmp_path: Path) -> None:
    """A thin mesh, a mesh that only shows, a body that starts its transforms anew, one that has a mass alone."""
    scene = _boxes()
    stage = scene.stage
    _mesh([*SQUARE, (0.5, 0.5, 1e-3)], [4, 3, 3, 3, 3], [3, 2, 1, 0, 0, 1, 4, 1, 2, 4, 2, 3, 4, 3, 0, 4])(stage)
    shown = UsdGeom.Mesh.Define(stage, "/World/shown")
    shown.CreatePointsAttr(SQUARE)
    shown.CreateFaceVertexCountsAttr([4])
    shown.CreateFaceVertexIndicesAttr([0, 1, 2, 3])
    _nested(stage)
    UsdGeom.Xformable(stage.GetPrimAtPath("/World/a/inner")).SetResetXformStack(True)
    bare = UsdGeom.Xform.Define(stage, "/World/bare").GetPrim()
    UsdPhysics.RigidBodyAPI.Apply(bare)
    UsdPhysics.MassAPI.Apply(bare).CreateMassAttr(1.0)
    path = scene.save(tmp_path / "stage.usda")
    assert check_stage(path, [tmp_path]) == []
    sim.Simulation(path, device="cpu")
