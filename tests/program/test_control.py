from __future__ import annotations

import os
import threading
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from tests.patience import STUCK
from wsim.program.control import ControlError, ControlLayout, ControlProcess, has_control
from wsim.program.control_world import ControlWorld
from wsim.program.sandbox import Limits

W = 3
LAYOUT = ControlLayout(["/World/block", "/World/cart/wheel"], ["/World/hinge"], W)
LIMITS = Limits(call_seconds=STUCK, first_call_seconds=STUCK, memory_bytes=2048 << 20, log_bytes=10_000, threads=16)


@pytest.fixture
def start(tmp_path: Path, isolation: str):
    """Start a control process for the text of a program."""
    started: list[ControlProcess] = []

    def one(text: str, limits: Limits = LIMITS, layout: ControlLayout = LAYOUT) -> ControlProcess:
        program = tmp_path / "program.py"
        program.write_text(text)
        started.append(ControlProcess(program, layout, limits, isolation))
        return started[-1]

    yield one
    for process in started:
        process.close()


def _state() -> dict[str, np.ndarray]:
    body_q = np.zeros((W, 2, 7))
    body_q[..., 6] = 1.0
    body_q[:, 0, 2] = (1.0, 2.0, 3.0)
    return {
        "body_q": body_q,
        "body_qd": np.full((W, 2, 6), 0.5),
        "joint_q": np.full((W, 1), 0.25),
        "joint_qd": np.full((W, 1), -2.0),
    }


def test_control_reads_states_and_sets_targets_and_forces(start) -> None:
    process = start(
        "import numpy as np\n"
        "def control(world, t):\n"
        "    hinge, block = world.joint('hinge'), world.body('/World/block')\n"
        "    assert world.world_count == 3 and block.rotation.shape == (3, 4)\n"
        "    hinge.target = t\n"
        "    hinge.force = -0.5 * hinge.velocity + hinge.position\n"
        "    world.apply_force('block', -2.0 * block.position, torque=(0.0, 0.0, 1.0))\n"
        "    world.apply_force('wheel', world.body('wheel').velocity)\n"
        "    world.apply_force('wheel', (1.0, 0.0, 0.0))\n"
    )
    for t in (0.5, 1.5):  # forces do not pile up
        out = process.step(t, _state())
        assert {name: array.shape for name, array in out.items()} == {
            "joint_target": (W, 1),
            "joint_force": (W, 1),
            "body_force": (W, 2, 6),
        }
        np.testing.assert_allclose(out["joint_target"], t)
        np.testing.assert_allclose(out["joint_force"], 1.25)
        np.testing.assert_allclose(out["body_force"][:, 0, 2], (-2.0, -4.0, -6.0))
        np.testing.assert_allclose(out["body_force"][:, 0, 5], 1.0)
        np.testing.assert_allclose(out["body_force"][:, 1, :3], [(1.5, 0.5, 0.5)] * W)


def test_worlds_that_are_apart_have_the_program_to_themselves(start) -> None:
    """Each is the only one that its call sees, and what the program remembers is of that one alone."""
    process = start(
        "seen = []\n"
        "def control(world, t):\n"
        "    block = world.body('block')\n"
        "    assert world.world_count == 1 and block.position.shape == (1, 3)\n"
        "    seen.append(float(block.position[0, 2]))\n"
        "    world.joint('hinge').target = sum(seen)\n"
        "    world.apply_force('block', (0.0, 0.0, seen[-1]))\n",
        layout=replace(LAYOUT, apart=True),
    )
    for call in (1, 2):
        out = process.step(0.1 * call, _state())
        np.testing.assert_allclose(out["joint_target"][:, 0], [call * 1.0, call * 2.0, call * 3.0])
        np.testing.assert_allclose(out["body_force"][:, 0, 2], (1.0, 2.0, 3.0))


def test_a_target_stays_and_a_force_does_not(start) -> None:
    process = start(
        "def control(world, t):\n"
        "    if t == 0.0:\n"
        "        world.joint('hinge').target = 0.75\n"
        "        world.joint('hinge').force = 2.0\n"
    )
    process.step(0.0, _state())
    out = process.step(0.01, {})
    assert out["joint_target"].tolist() == [[0.75]] * W
    assert not out["joint_force"].any()


# body of control: (kind, part of the message, line)
FAILS = {
    "raise RuntimeError('no')": ("exception", "RuntimeError: no", "program.py:2"),
    "world.body('blok')": ("exception", "no body 'blok'; known: block, wheel, /World/block", "program.py:2"),
    "world.body('block').position[0] = 1.0": ("exception", "read-only", "program.py:2"),
    "while True: pass": ("timeout", "control(world, t) at t = 0.25 s did not end within 0.5 s", None),
    "import os; os._exit(0)": ("crash", "ended its process", None),
    "import ctypes; ctypes.string_at(0)": ("crash", "SIGSEGV", None),
    "import sys; sys.exit(0)": ("exception", "called exit(0)", "program.py:2"),
    "x = bytes(10**10)": ("memory", "2048 MiB", "program.py:2"),
    "while True: print('x' * 1000)": ("output", "printed more than 10000 bytes", None),
    "world.joint('hinge').target = float('nan')": ("value", "joint_target[0][0] = nan (/World/hinge, world 0)", None),
    "world.joint('hinge').force[2] = float('inf')": ("value", "joint_force[2][0] = inf (/World/hinge, world 2)", None),
    "world.apply_force('wheel', (0.0, -1e9, 0.0))": (
        "value",
        "body_force[0][1][1] = -1e+09 (/World/cart/wheel, world 0)",
        None,
    ),
    "import os\n    for n in range(3, 40):\n        try: os.ftruncate(n, 0)\n        except OSError: pass\n"
    "    raise SystemError('still here')": ("exception", "still here", "program.py:6"),
    "import os; os.closerange(3, 64); import time; time.sleep(100)": ("timeout", "", None),
}


@pytest.mark.parametrize("body", FAILS)
def test_a_control_that_fails_is_an_error(start, body: str) -> None:
    kind, message, line = FAILS[body]
    short = {"call_seconds": 0.5} if kind == "timeout" else {}
    process = start(f"def control(world, t):\n    {body}\n", LIMITS.model_copy(update=short))
    process._first = False  # the short limit, from the first call on
    with pytest.raises(ControlError) as caught:
        process.step(0.25, _state())
    assert (caught.value.kind, caught.value.line) == (kind, line), caught.value.message
    assert message in caught.value.message
    with pytest.raises(ControlError, match="has ended"):
        process.step(0.5, _state())


@pytest.mark.parametrize(
    ("text", "kind", "message"),
    [
        ("def build(scene): pass", "exception", "no function control(world, t)"),
        ("def control(world, t:", "exception", "SyntaxError"),
        ("while True: pass", "timeout", "loading the program did not end within 1 s"),
    ],
)
def test_a_control_that_does_not_load_is_an_error(start, text: str, kind: str, message: str) -> None:
    with pytest.raises(ControlError) as caught:
        start(text, LIMITS.model_copy(update={"first_call_seconds": 1.0} if kind == "timeout" else {}))
    assert caught.value.kind == kind
    assert message in caught.value.message


def test_arrays_of_the_wrong_shape_are_refused(start) -> None:
    process = start("def control(world, t): pass")
    with pytest.raises(ValueError, match=r"joint_q has shape \(2, 1\); the layout says \(3, 1\)"):
        process.step(0.0, {"joint_q": np.zeros((2, 1))})
    with pytest.raises(ValueError, match="no array 'joint_f'"):
        process.step(0.0, {"joint_f": np.zeros((W, 1))})


def test_it_outlives_the_thread_that_started_it(start) -> None:
    made: list[ControlProcess] = []
    thread = threading.Thread(target=lambda: made.append(start("def control(world, t): pass")))
    thread.start()
    thread.join()
    time.sleep(0.2)
    assert made[0].step(0.0, _state())["joint_force"].shape == (W, 1)


def test_no_file_is_left_open(start) -> None:
    start("def control(world, t): pass").close()
    before = len(os.listdir("/proc/self/fd"))  # noqa: PTH208
    for _ in range(3):
        start("def control(world, t): pass").close()
    assert len(os.listdir("/proc/self/fd")) == before  # noqa: PTH208


def test_a_world_without_bodies_or_joints() -> None:
    layout = ControlLayout([])
    world = ControlWorld(layout, layout.views(bytearray(layout.size)))
    with pytest.raises(LookupError, match="known: none"):
        world.body("block")


def test_control_reads_what_sensors_told(start) -> None:
    channels = [
        ("/World/arm/imu", "accelerometer", (3,)),
        ("/World/clock", "effort", ()),
        ("/World/arm/q", "effort", (2,)),
    ]
    process = start(
        "import numpy as np\n"
        "def control(world, t):\n"
        "    imu, q = world.sensor('imu'), world.sensor('/World/arm/q')\n"
        "    assert world.sensors == ['/World/arm/imu', '/World/clock', '/World/arm/q']\n"
        "    assert world.sensor('clock').effort.shape == (3,) and q.effort.shape == (3, 2)\n"
        "    world.apply_force('block', imu.accelerometer, np.stack([*q.effort.T, q.effort[:, 0]], axis=1))\n",
        layout=replace(LAYOUT, channels=channels),
    )
    sensed = np.arange(6.0 * W).reshape(W, 6)
    pushed = process.step(0.0, _state() | {"sensed": sensed})["body_force"][:, 0]
    np.testing.assert_array_equal(pushed, sensed[:, [0, 1, 2, 4, 5, 4]])


def test_a_sensor_tells_what_it_has_alone() -> None:
    layout = ControlLayout([], channels=[("/World/imu", "gyroscope", (3,))])
    world = ControlWorld(layout, layout.views(bytearray(layout.size)))
    with pytest.raises(AttributeError, match="the sensor /World/imu tells no effort; it tells gyroscope"):
        _ = world.sensor("imu").effort
    with pytest.raises(LookupError, match="no sensor 'lidar'; known: imu, /World/imu"):
        world.sensor("lidar")
    with pytest.raises(ValueError, match="read-only"):
        world.sensor("imu").gyroscope[:] = 1.0


def test_a_camera_tells_numbers_of_what_its_labels_name() -> None:
    channels = [
        ("/World/eye", "color", (2, 3, 3)),
        ("/World/eye", "depth", (2, 3)),
        ("/World/eye", "segmentation", (2, 3)),
    ]
    layout = ControlLayout([], world_count=2, channels=channels, labels=["", "/World/ball", "/World/arm"])
    arrays = layout.views(bytearray(layout.size))
    arrays["sensed"][:] = np.arange(2 * 30).reshape(2, 30)
    eye = ControlWorld(layout, arrays).sensor("eye")
    assert eye.labels == ["", "ball", "arm"]
    eye.labels.clear()
    assert eye.labels == ["", "ball", "arm"]  # a copy
    assert (eye.color.shape, eye.color.dtype) == ((2, 2, 3, 3), np.uint8) and eye.color[0, 0, 1].tolist() == [3, 4, 5]
    assert (eye.depth.shape, eye.depth[1, 0, 0]) == ((2, 2, 3), 48.0)
    assert (eye.segmentation.dtype, eye.segmentation[0, 1].tolist()) == (np.int32, [27, 28, 29])


def test_a_name_that_two_prims_have_needs_its_path() -> None:
    layout = ControlLayout(["/World/a/wheel", "/World/b/wheel"])
    world = ControlWorld(layout, layout.views(bytearray(layout.size)))
    assert world.body("/World/b/wheel").position.shape == (1, 3)
    with pytest.raises(LookupError, match="no body 'wheel'"):
        world.body("wheel")


@pytest.mark.parametrize(
    ("source", "expected"),
    [
        ("def control(world, t): pass", True),
        ("def build(scene):\n    def control(world, t): pass", False),
        ("# def control(world, t)", False),
        ("def control(", False),
        ("(" * 10_000, False),
        ("\0", False),
    ],
)
def test_control_is_seen_without_running_it(source: str, expected: bool) -> None:
    assert has_control(source) is expected
