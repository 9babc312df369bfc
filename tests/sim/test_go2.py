"""The Unitree Go2 and its policy: by kernels, pushed, over kerbs, and four in one world."""

from __future__ import annotations

import runpy
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from tests.intake.go2 import go2
from tests.sim.test_policies_on_device import by_kernels
from wsim.intake.robots import TakenIn
from wsim.plan.store import load
from wsim.runs.iteration import Iteration
from wsim.scene import Scene
from wsim.scene.describe import describe
from wsim.sim import Simulation

__all__ = ["go2"]
EXAMPLES = Path(__file__).parents[2] / "examples"
MASS = 15.2  # [kg]


def walking(folder: Path, command: tuple[float, float, float], kerbs: float = 0.0) -> Path:
    """A Go2 that walks from the origin, at will over two kerbs of a height [m]."""
    scene = Scene()
    scene.simulation(duration=5.0, frame_rate=50.0)
    scene.ground()
    for k in range(2 if kerbs else 0):
        place = (0.65 + 0.8 * k, 0.0, 0.5 * kerbs)
        scene.box(f"kerb_{k}", size=(0.5, 2.0, kerbs), position=place, static=True)
    scene.policy("walk", scene.robot("go2"), "go2_walk", command=command)
    return scene.save(folder / "stage.usda")


def base_of(simulation: Simulation, robot: str = "go2") -> int:
    return simulation.built.bodies[[body.prim for body in simulation.world.bodies].index(f"/World/{robot}/base")]


def lean(pose: np.ndarray) -> float:
    """How far a body's z axis is from the vertical [deg]."""
    return float(np.degrees(np.arccos(1.0 - 2.0 * (pose[3] ** 2 + pose[4] ** 2))))


@pytest.mark.parametrize(
    ("device", "worlds"), [("cpu", 1), pytest.param("cuda:0", 1, marks=pytest.mark.cuda),
                           pytest.param("cuda:0", 16, marks=pytest.mark.cuda)]
)  # fmt: skip
def test_a_second_of_walking_is_the_same_by_kernels(go2: TakenIn, tmp_path: Path, device: str, worlds: int) -> None:
    """What differs is rounding, which feet on the ground make more of: on a GPU another solver, too, steps it."""
    stage = walking(tmp_path, (0.5, 0.0, 0.3))
    host, kernels = Simulation(stage, device="cpu"), Simulation(stage, device=device, world_count=worlds)
    by_kernels(kernels)
    for _ in range(50):
        host.advance_frame()
        kernels.advance_frame()
    assert host.problems() == kernels.problems() == []
    one, all_ = host.state.joint_q.numpy(), kernels.state.joint_q.numpy().reshape(worlds, -1)
    assert one[0] > 0.2
    place, angle = (1e-5, 5e-5) if device == "cpu" else (0.03, 0.3)
    assert np.abs(all_[:, :3] - one[:3]).max() < place
    assert np.abs(all_[:, 7:] - one[7:]).max() < angle


@pytest.mark.parametrize(("change", "stays"), [(1.0, True), (6.0, False)])
def test_a_push_from_the_side_does_not_fell_it_unless_it_is_a_blow(
    go2: TakenIn, tmp_path: Path, change: float, stays: bool
) -> None:
    """By 1 m/s, as policies of its kind are trained with: 152 N for 0.1 s, after a second of walking."""

    def push(t: float, simulation: Simulation) -> None:
        force = np.zeros_like(simulation.control_force.numpy())
        if 1.0 - 1e-6 < t < 1.1 - 1e-6:
            force[base, 1] = MASS * change / 0.1
        simulation.control_force.assign(force)

    simulation = Simulation(walking(tmp_path, (0.5, 0.0, 0.0)), device="cpu", controller=push)
    base, leans = base_of(simulation), []
    for _ in range(100):
        simulation.advance_frame()
        leans.append(lean(simulation.state.body_q.numpy()[base]))
        if leans[-1] > 60.0:
            break
    assert max(leans[:49]) < 6.0
    assert (max(leans) < 20.0) == stays
    if stays:
        assert leans[-1] < 6.0 and max(leans[49:]) > max(leans[25:49])


def test_it_walks_over_two_kerbs_of_three_centimetres(go2: TakenIn, tmp_path: Path) -> None:
    """Each of its feet, balls of 22 mm, stands on the ground, on a kerb, on the other one, and beyond."""
    simulation = Simulation(walking(tmp_path, (0.8, 0.0, 0.0), kerbs=0.03), device="cpu")
    base, labels = base_of(simulation), [str(label) for label in simulation.model.body_label]
    calves = [k for k, label in enumerate(labels) if label.endswith("_calf")]
    poses, feet = [], []
    while simulation.time < 2.8:
        simulation.advance_frame()
        found = simulation.state.body_q.numpy()
        poses.append(found[base].copy())
        feet.append(found[calves, :3] + Rotation.from_quat(found[calves, 3:]).apply((0.0, 0.0, -0.213)))
    way, places = np.array(poses), np.array(feet)
    assert way[-1, 0] > 1.9 and abs(way[-1, 1]) < 0.15
    assert max(map(lean, way)) < np.degrees(2.0 * 0.03 / 0.38) + 5.0  # from hip to hip; its gait on the flat adds 5
    for first, last, up in ((-1.0, 0.4, 0.0), (0.4, 0.9, 0.03), (1.2, 1.7, 0.03), (1.7, 3.0, 0.0)):
        for x, z in zip(places[..., 0].T, places[..., 2].T, strict=True):
            assert z[(x > first + 0.03) & (x < last - 0.03)].min() == pytest.approx(up + 0.022, abs=0.003)


def test_four_in_one_world_go_each_as_it_is_told(go2: TakenIn, tmp_path: Path) -> None:
    """More kinds of shape than MuJoCo's masks have bits: `wsim.solvers.collision_masks` lets robots share them."""
    scene = Scene()
    runpy.run_path(str(EXAMPLES / "robots" / "go2_four.py"))["build"](scene)
    simulation = Simulation(scene.save(tmp_path / "stage.usda"), device="cpu")
    bases = {name: base_of(simulation, name) for name in ("ahead", "aside", "round", "route")}
    start = simulation.state.body_q.numpy()
    start = {name: start[base].copy() for name, base in bases.items()}
    while simulation.time < 0.5:
        simulation.advance_frame()
    assert simulation.problems() == []
    ends = simulation.state.body_q.numpy()
    gone = {name: ends[base, :2] - start[name][:2] for name, base in bases.items()}
    turned = {name: np.degrees(2.0 * np.arcsin(ends[base, 5])) for name, base in bases.items()}
    assert gone["ahead"][0] > 0.1 and abs(gone["ahead"][1]) < 0.05
    assert gone["aside"][1] > 0.04 and abs(gone["aside"][0]) < 0.05
    assert turned["round"] > 6.0 and abs(turned["ahead"]) < 5.0
    assert gone["route"][0] > 0.08
    assert all(lean(ends[base]) < 10.0 for base in bases.values())


@pytest.mark.parametrize("name", ["pushed", "kerbs"])
def test_an_example_builds_what_its_plan_has(go2: TakenIn, tmp_path: Path, name: str) -> None:
    """That the walk is accepted takes minutes: docs/robots.md."""
    plan = load(EXAMPLES / "plans" / f"go2_{name}.json")
    iteration = Iteration.of(EXAMPLES / "robots" / f"go2_{name}.py", tmp_path, plan)
    assert iteration.build().ok
    world = describe(iteration.stage)
    made = {each.prim.split("/")[2] for each in (*world.bodies, *world.statics)}
    assert made == {item.name for item in plan.objects}
    assert len(world.policies) == 1
