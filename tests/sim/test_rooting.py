"""A tree of joints that hangs on nothing begins where single precision takes its mass matrix best."""

import math

import numpy as np
import pytest
from pxr import Sdf, Usd, UsdPhysics

from wsim.scene import Drive, Scene
from wsim.scene.articulation import mark_articulations
from wsim.sim import Simulation


def chain(scene, seed):
    """A cable adrift, with a weight on one or both ends, stretched out or bent."""
    rng = np.random.default_rng(seed)
    links, long = int(rng.integers(10, 30)), float(rng.uniform(0.5, 1.5))
    bend = float(rng.uniform(0.0, math.pi))
    angle = np.linspace(-0.5 * bend, 0.5 * bend, 40)
    way = np.cumsum(np.column_stack([np.cos(angle), 0.0 * angle, np.sin(angle)]) * long / 40, axis=0)
    ends = []
    for name, place in (("one", way[0]), ("two", way[-1])):
        scene.box(name, size=(0.04, 0.04, 0.04), mass=float(10 ** rng.uniform(-2.5, 0.5)), position=place.tolist())
        ends.append(place.tolist())
    scene.cable("c", "one", "two", anchor_a=ends[0], anchor_b=ends[1], through=way[1:-1].tolist(), links=links,
                mass_per_length=float(10 ** rng.uniform(-1.5, 0)), radius=0.005)  # fmt: skip


def twigs(scene, seed):
    """Boxes of all masses, each on a ball joint on one of those before it."""
    rng = np.random.default_rng(seed)
    places = [np.zeros(3)]
    for k in range(int(rng.integers(4, 16))):
        parent = int(rng.integers(max(0, k - 3), k)) if k else None
        way = rng.normal(size=3)
        places.append(places[parent or 0] + 0.2 * way / np.linalg.norm(way) * (k > 0))
        place = places[-1]
        scene.box(f"body_{k}", size=(0.04, 0.04, 0.04), mass=float(10 ** rng.uniform(-3, 1)), position=place.tolist())
        if parent is not None:
            middle = (0.5 * (place + places[parent + 1])).tolist()
            scene.joint_spherical(f"joint_{k}", f"body_{parent}", f"body_{k}", anchor=middle)


def condition(stage):
    """Of the mass matrix at the start, its diagonal scaled to one."""
    solver = Simulation(stage, "cpu").rigid.solver
    mujoco = solver.import_mujoco()[0]
    matrix = np.zeros((solver.mj_model.nv, solver.mj_model.nv))
    mujoco.mj_fullM(solver.mj_model, solver.mj_data, matrix)
    scale = 1.0 / np.sqrt(np.diag(matrix))
    return float(np.linalg.cond(scale[:, None] * matrix * scale))


def roots(stage):
    return [prim.GetName() for prim in stage.Traverse() if prim.HasAPI(UsdPhysics.ArticulationRootAPI)]


def rerooted(stage, top, path):
    mark_articulations(stage, [Sdf.Path(f"/World/{top}")])
    assert roots(stage) == [top]
    stage.GetRootLayer().Export(str(path))
    return path


@pytest.mark.parametrize(("build", "seed"), [*((chain, k) for k in (0, 4, 6)), *((twigs, k) for k in (2, 3))])
def test_no_root_is_much_better(tmp_path, build, seed):
    """Among nine roots; the rule weighs moments alone, hence a factor of 4. Of their first bodies it was 17 to 100."""
    scene = Scene()
    scene.simulation(gravity=(0, 0, 0))
    build(scene, seed)
    path = scene.save(tmp_path / "stage.usda")
    own = condition(path)
    stage = Usd.Stage.Open(str(path))
    bodies = [prim.GetName() for prim in stage.Traverse() if prim.HasAPI(UsdPhysics.RigidBodyAPI)]
    tried = {bodies[k] for k in np.linspace(0, len(bodies) - 1, 9).astype(int)}
    assert own < 4.0 * min(condition(rerooted(stage, top, tmp_path / f"{top}.usda")) for top in tried)


def test_what_bears_little_begins_where_its_joints_say(tmp_path):
    scene = Scene()
    for k in range(5):
        scene.box(f"link_{k}", size=(0.1, 0.02, 0.02), mass=0.2, position=(0.1 * k, 0, 0))
        if k:
            scene.joint_revolute(f"joint_{k}", f"link_{k - 1}", f"link_{k}", anchor=(0.1 * k - 0.05, 0, 0))
    assert roots(Usd.Stage.Open(str(scene.save(tmp_path / "stage.usda")))) == ["link_0"]


def hinges(scene):
    """Light links between two weights, a drive and a spring-loaded stop among their hinges, thrown."""
    scene.simulation(gravity=(0, 0, 0))
    for k in range(10):
        heavy = k in (0, 9)
        place = (0.1 * k, 0, 0.01 * k * k)
        scene.box(f"link_{k}", size=(0.06, 0.02, 0.02), mass=3.0 if heavy else 0.02, position=place)
    for k in range(1, 10):
        extra = {"drive": Drive(position=40.0, stiffness=0.5, damping=0.05)} if k == 3 else {}
        extra |= {"limits_deg": (-5.0, 30.0)} if k == 6 else {}
        scene.joint_revolute(f"joint_{k}", f"link_{k - 1}", f"link_{k}", axis=(0, 1, 0.3 * (k % 2)),
                             anchor=(0.1 * k - 0.05, 0, 0.01 * (k - 0.5) ** 2), **extra)  # fmt: skip


def test_it_moves_as_from_where_its_joints_say(tmp_path):
    """Drives, stops and hinges turn the same way whichever end they hang on."""
    scene = Scene()
    hinges(scene)
    path = scene.save(tmp_path / "stage.usda")
    stage = Usd.Stage.Open(str(path))
    assert roots(stage) != ["link_0"]
    other = rerooted(stage, "link_0", tmp_path / "other.usda")
    ends = []
    for each in (path, other):
        simulation = Simulation(each, "cpu", time_step=2e-4)
        for _ in range(1000):
            simulation.step()
        assert simulation.problems() == []
        ends.append(simulation.state.body_q.numpy()[simulation.built.bodies])
    moved = np.abs(ends[0][:, :3] - np.array([(0.1 * k, 0, 0.01 * k * k) for k in range(10)])).max()
    assert moved > 0.02
    assert np.abs(ends[0][:, :3] - ends[1][:, :3]).max() < 1e-3 * moved
