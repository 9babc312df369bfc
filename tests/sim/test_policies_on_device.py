"""Policies as kernels, against the same in NumPy on the host, which `test_policies` holds against theory."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import warp as wp
from scipy.spatial.transform import Rotation

from tests.assets import policies
from tests.sim.test_policies import SIZE, own, spec
from wsim.kernels.policy import set_targets
from wsim.kernels.policy_network import dense
from wsim.scene import Scene
from wsim.sim import Simulation
from wsim.sim.layers import layers_of
from wsim.sim.networks import read_network
from wsim.sim.policies import PolicyController, PolicyOnDevice, controller_of
from wsim.sim.walked import walked

__all__ = ["own"]
CLOSE = 1e-5  # single precision against NumPy's double: 6e-8 of each of some tens of numbers that are summed
GPU = pytest.param("cuda:0", marks=pytest.mark.cuda)
RANDOM = np.random.default_rng(5)


def weights(*shape: int) -> np.ndarray:
    return RANDOM.normal(size=shape) / np.sqrt(shape[0])


LAYERS = [
    ("Sub", {}, [weights(SIZE)]),
    ("Div", {}, [1.0 + RANDOM.random((1, SIZE))]),
    ("Gemm", {"alpha": 0.5, "beta": 2.0, "transB": 1}, [weights(40, SIZE), weights(40)]),
    ("Elu", {"alpha": 0.7}, []),
    ("MatMul", {}, [weights(40, 30)]),
    ("Add", {}, [weights(30)]),
    ("Softplus", {}, []),
    ("MatMul", {}, [weights(30, 2)]),
    ("Mul", {}, [np.array(0.3)]),
]
SPEC: dict[str, Any] = {
    "observations": [
        {"of": "linear_velocity", "scale": 2.0},
        {"of": "angular_velocity", "scale": [0.25, 0.5, 0.1], "offset": 0.2},
        {"of": "gravity", "offset": [0.0, 0.0, -1.0]},
        {"of": "command"},
        {"of": "joint_position", "offset": [0.1, -0.2]},
        {"of": "joint_velocity", "scale": 0.3},
        {"of": "last_action"},
    ],
    "observation_limit": 3.0, "action_limit": 0.6, "action_scale": [0.5, 0.25], "action_offset": [0.1, 0.0],
}  # fmt: skip
BROUGHT_ON = {
    "command_slew": [2.5, 2.0, 5.0],
    "trim": {"smoothing": 0.1, "gain": [1.5, 1.5, 2.0], "limit": [0.4, 0.3, 0.6]},
}
TIMES = [
    {"times": (0.0, 0.1, 0.24), "commands": ((0.8, 0.0, 0.0), (-0.4, 0.3, 2.0), (2.0, -2.0, 0.3))},
    {"command": (0.3, -0.1, 0.5)},
    {"times": (0.0, 0.3), "commands": ((0.0, 0.0, 0.0), (1.0, 0.2, -1.0))},
]
WAYS = [{"route": ((0.5, 0.0), (0.6, 0.0), (0.6, 0.4, 170.0)), "speed": speed} for speed in (0.3, 0.6, 0.9)]


def stages(folder: Path, told: list[dict[str, Any]], **changed: Any) -> list[Path]:
    """Worlds in which a network of several layers sets two joints of an arm that flies."""
    policies.write(folder, "layers", spec(**SPEC, **changed), policies.onnx(LAYERS))
    found = []
    for k, each in enumerate(told):
        scene = Scene()
        scene.simulation(duration=1.0, frame_rate=50.0, time_step=0.002)
        arm = scene.robot("arm", "desk_arm", position=(0.0, 0.0, 5.0), fixed=False)
        scene.policy("steer", arm, "layers", **each)
        found.append(scene.save(folder / f"stage_{k}.usda"))
    return found


def stir(simulation: Simulation) -> None:
    """Put all bodies and joints anywhere, near enough to the origin for way-points to be passed."""
    state, random = simulation.state, RANDOM
    poses = state.body_q.numpy()
    poses[:, :3], poses[:, 3:] = random.normal(size=(len(poses), 3)), Rotation.random(len(poses), rng=random).as_quat()
    state.body_q.assign(poses)
    for array in (state.body_qd, state.joint_q, state.joint_qd):
        array.assign(random.normal(size=array.numpy().shape).astype(np.float32))


@pytest.mark.parametrize("device", ["cpu", GPU])
@pytest.mark.parametrize("told", [TIMES, WAYS], ids=["times", "route"])
@pytest.mark.parametrize("brought_on", [{}, BROUGHT_ON], ids=["at once", "brought on"])
def test_kernels_see_make_and_set_what_numpy_does(own: Path, device: str, told: list, brought_on: dict) -> None:
    """Over 25 turns of states drawn at random, in three worlds; and the drives' efforts move along."""
    simulation = Simulation(stages(own, told, **brought_on), device=device)
    robot = walked(simulation.model, simulation.built.worlds, simulation.built.bodies, 0)
    host, kernels = PolicyController(robot), PolicyOnDevice(robot, layers(robot), simulation.device)
    ledger, kept = simulation.rigid.ledger, simulation.control.joint_target_q
    moved = set()
    for turn in range(25):
        stir(simulation)
        found = []
        targets, efforts = kept.numpy().copy(), RANDOM.normal(size=ledger.dofs).astype(np.float32)
        for policy in (host, kernels):
            kept.assign(targets)
            ledger.last.assign(efforts)
            policy(0.02 * turn, simulation)
            found.append((kept.numpy().copy(), ledger.last.numpy().copy()))
        np.testing.assert_allclose(kernels.seen.numpy(), host.seen, rtol=CLOSE, atol=CLOSE)
        np.testing.assert_allclose(kernels.made.numpy(), host.made, rtol=CLOSE, atol=CLOSE)
        np.testing.assert_allclose(found[1][0], found[0][0], rtol=CLOSE, atol=CLOSE)
        np.testing.assert_allclose(found[1][1], found[0][1], rtol=CLOSE, atol=30.0 * CLOSE)  # 30 N m/rad
        moved |= set(np.flatnonzero(found[1][0] != targets))
    assert len(moved) == 3 * 2


def layers(robot: Any) -> list:
    found = layers_of(robot.network, robot.spec.size)
    assert found is not None
    return found


@pytest.mark.parametrize("device", ["cpu", GPU])
def test_a_flight_is_the_same_by_kernels(own: Path, device: str) -> None:
    """Half a second of an arm that its policy swings: on the host of a CPU, and by kernels."""
    told = stages(own, TIMES, **BROUGHT_ON)
    host, kernels = Simulation(told, device="cpu"), Simulation(told, device=device)
    by_kernels(kernels)
    for _ in range(25):
        host.advance_frame()
        kernels.advance_frame()
    started = host.model.joint_q.numpy().reshape(3, -1)
    ends = [each.state.joint_q.numpy().reshape(3, -1) for each in (host, kernels)]
    assert np.abs(ends[0] - started)[:, 7:9].min() > 0.02
    np.testing.assert_allclose(ends[1], ends[0], atol=1e-4)


def by_kernels(simulation: Simulation) -> None:
    """Let kernels ask a simulation's one policy, on whatever device it is; a GPU's do anyway."""
    if simulation.device.is_cuda:
        assert isinstance(simulation.policies[0], PolicyOnDevice)
        return
    robot = walked(simulation.model, simulation.built.worlds, simulation.built.bodies, 0)
    simulation._turns._all[0] = (simulation._turns._all[0][0], PolicyOnDevice(robot, layers(robot), simulation.device))


def test_a_cpu_asks_numpy(own: Path) -> None:
    simulation = Simulation(stages(own, TIMES[:1])[0], device="cpu")
    assert [type(each) for each in simulation.policies] == [PolicyController]


def written(folder: Path, layers: list) -> Any:
    path = folder / "net.onnx"
    path.write_bytes(policies.onnx(layers))
    return path


BENDS = [("Relu", {}), ("Elu", {}), ("LeakyRelu", {"alpha": 0.2}), ("LeakyRelu", {}), ("Tanh", {}), ("Sigmoid", {}),
         ("Softplus", {}), ("Identity", {})]  # fmt: skip


@pytest.mark.parametrize("device", ["cpu", GPU])
@pytest.mark.parametrize("seed", range(6))
def test_networks_drawn_at_random_are_their_layers(tmp_path: Path, device: str, seed: int) -> None:
    """Of sums, differences, products and what bends, in any order; numbers of 0.01 to 100."""
    random = np.random.default_rng(seed)
    width, made = 7, []
    for _ in range(random.integers(2, 9)):
        kind, scale = random.integers(4), random.choice([0.3, 1.0, 2.0])
        if kind == 0:
            made.append((*BENDS[random.integers(len(BENDS))], []))
        elif kind == 1:
            name = ("Add", "Sub", "Mul", "Div")[random.integers(4)]
            made.append((name, {}, [(0.5 + random.random(width)) * random.choice([-1.0, 1.0])]))
        else:
            to = int(random.integers(1, 20))
            weight = scale * random.normal(size=(width, to)) / np.sqrt(width)
            made.append(("MatMul", {}, [weight]) if kind == 2 else ("Gemm", {}, [weight, random.normal(size=to)]))
            width = to
    network = read_network(written(tmp_path, made), 7, width)
    x = (random.normal(size=(9, 7)) * 10.0 ** random.integers(-2, 3, size=(9, 1))).astype(np.float32)
    wanted = network(x)
    scale = max(1.0, float(np.abs(wanted).max()))
    np.testing.assert_allclose(evaluated(layers_of(network, 7), x, device), wanted, rtol=CLOSE, atol=CLOSE * scale)


def evaluated(found: list, x: np.ndarray, device: str) -> np.ndarray:
    at = wp.array(x, dtype=float, device=device)
    for each in found:
        y = wp.zeros((len(x), len(each.bias)), dtype=float, device=device)
        given = [at, *(wp.array(own, dtype=float, device=device) for own in (each.weight, each.bias))]
        wp.launch(dense, dim=y.shape, inputs=[*given, each.bend, each.alpha], outputs=[y], device=device)
        at = y
    return at.numpy()


@pytest.mark.parametrize("device", ["cpu", GPU])
@pytest.mark.parametrize("bend", [each for each in BENDS if each[0] != "Identity"], ids=lambda each: each[0])
def test_what_is_no_number_goes_through_to_the_targets(tmp_path: Path, device: str, bend: tuple) -> None:
    """A maximum would make a number of it, and a robot that sees nothing walk on."""
    network = read_network(written(tmp_path, [("MatMul", {}, [np.eye(3)]), (*bend, [])]), 3, 3)
    found = evaluated(layers_of(network, 3), np.array([[np.nan, 1.0, 2.0]], dtype=np.float32), device)
    assert np.isnan(found).any()
    action, target, moved = (wp.zeros(shape, dtype=float, device=device) for shape in ((1, 3), 3, (1, 3)))
    own = [wp.array(each, dtype=float, device=device) for each in (found, np.ones(3), np.zeros(3))]
    place = wp.array([[0, 1, 2]], dtype=int, device=device)
    wp.launch(set_targets, dim=(1, 3), inputs=[own[0], 5.0, *own[1:], place], outputs=[action, target, moved],
              device=device)  # fmt: skip
    assert np.isnan(target.numpy()).any()


def branched() -> bytes:
    """x + tanh(x): what is seen goes two ways."""
    nodes = b"".join(
        policies.field(1, b"".join(policies.field(1, name) for name in names) + policies.field(2, to)
                       + policies.field(4, operator))
        for operator, names, to in (("Tanh", ["obs"], "bent"), ("Add", ["obs", "bent"], "actions"))
    )  # fmt: skip
    ends = policies.field(11, policies.field(1, "obs")) + policies.field(12, policies.field(1, "actions"))
    return policies.field(1, 8) + policies.field(7, nodes + ends)


def test_a_network_that_branches_is_no_row_of_layers_and_stays_on_the_host(tmp_path: Path) -> None:
    (tmp_path / "net.onnx").write_bytes(branched())
    network = read_network(tmp_path / "net.onnx", 3, 3)
    np.testing.assert_allclose(network(np.ones((1, 3), dtype=np.float32)), 1.0 + np.tanh(1.0), rtol=1e-6)
    assert layers_of(network, 3) is None


@pytest.mark.cuda
def test_a_gpu_leaves_a_network_that_branches_to_the_host(own: Path) -> None:
    policies.write(own, "branched", spec(observations=[{"of": "joint_position"}]), branched())
    scene = Scene()
    scene.simulation(duration=1.0, frame_rate=50.0, time_step=0.002)
    scene.policy("steer", scene.robot("arm", "desk_arm", position=(0.0, 0.0, 5.0), fixed=False), "branched")
    simulation = Simulation(scene.save(own / "stage.usda"), device="cuda:0")
    robot = walked(simulation.model, simulation.built.worlds, simulation.built.bodies, 0)
    assert isinstance(controller_of(robot, simulation.device), PolicyController)
