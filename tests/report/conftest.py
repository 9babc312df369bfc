from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from wsim.judge.verdict import Finding, RepairTarget, Verdict
from wsim.recording import FluidFrame, Frame, RecordingWriter
from wsim.recording.video import write_video
from wsim.rules.planner import plan as make_plan
from wsim.runs.folder import RunFolder
from wsim.scene.world import Body, Camera, Container, Fluid, Parameter, Shape, World

PROMPT = "A wooden block floats in a glass tank of water and a steel ball drops into it and sinks"
PROGRAM = '''"""A wooden block floats in a tank; a steel ball sinks."""

from wsim.scene import Scene


def build(scene: Scene) -> None:
    scene.ground()
    tank = scene.tank("tank", inner_size=(1.0, 0.5, 0.5))
    water = scene.fluid("water", fills=tank, level=0.3, spacing=0.05)
    density = scene.param("wood_density", 600.0, low=300.0, high=900.0, unit="kg/m^3")
    scene.box("block", size=(0.2, 0.2, 0.15), density=density, position=(-0.25, 0.0, water.surface + 0.08))
    scene.sphere("ball", radius=0.06, density=7850.0, position=(0.25, 0.0, water.surface + 0.2))
    scene.camera("side", eye=(0.0, -2.4, 0.9), target=(0.0, 0.0, 0.25))
'''
BLOCK_LINE, BALL_LINE = 11, 12
FLOOR, LEVEL, SPACING = 0.02, 0.3, 0.05
DRAUGHT = 0.09  # [m], of the block by Archimedes
RISE = (0.0036 + 0.0009) / 0.5  # [m], of the water by what block and ball displace
FRAMES, RATE, DURATION = 91, 30.0, 3.0
INERTIA = (0.01, 0.0, 0.0, 0.0, 0.01, 0.0, 0.0, 0.0, 0.01)


def make_world() -> World:
    def body(name: str, kind: str, size: tuple[float, ...], mass: float, x: float, z: float, line: int) -> Body:
        prim = f"/World/{name}"
        return Body(
            prim=prim,
            mass=mass,
            volume=0.006,
            inertia=INERTIA,
            position=(x, 0.0, z),
            rotation=(0.0, 0.0, 0.0, 1.0),
            shapes=[Shape(prim=f"{prim}/geometry", kind=kind, size=size)],
            line=f"program.py:{line}",
        )

    inner = (1.0, 0.5, 0.5)
    return World(
        name="block and ball",
        duration=DURATION,
        bodies=[
            body("block", "box", (0.2, 0.2, 0.15), 3.6, -0.25, 0.475, BLOCK_LINE),
            body("ball", "sphere", (0.06,), 7.1, 0.25, 0.58, BALL_LINE),
        ],
        containers=[Container(prim="/World/tank", inner_size=inner, inner_center=(0.0, 0.0, FLOOR + 0.25))],
        fluids=[
            Fluid(
                prim="/World/water",
                density=1000.0,
                viscosity=0.001,
                spacing=SPACING,
                size=(1.0, 0.5, LEVEL),
                center=(0.0, 0.0, FLOOR + LEVEL / 2),
                container="/World/tank",
            )
        ],
        cameras=[Camera(prim="/World/side", eye=(0.0, -2.4, 0.9), target=(0.0, 0.0, 0.25), width=320, height=180)],
        parameters=[Parameter(name="wood_density", value=600.0, default=600.0, low=300.0, high=900.0, unit="kg/m^3")],
    )


def heights(t: float) -> tuple[float, float]:
    """Centres of block and ball [m]: the block bobs and comes to rest, the ball falls to the floor."""
    rest = FLOOR + LEVEL + RISE - DRAUGHT + 0.075
    block = rest + 0.11 * np.exp(-1.6 * t) * np.cos(6.0 * t)
    return float(block), float(max(FLOOR + 0.06, 0.58 - 1.2 * t * t))


def make_frame(t: float, seed: int) -> Frame:
    grid = [np.arange(SPACING / 2, length, SPACING) for length in (1.0, 0.5, LEVEL)]
    points = np.stack(np.meshgrid(*grid, indexing="ij"), axis=-1).reshape(-1, 3) + np.array([-0.5, -0.25, FLOOR])
    noise = np.random.default_rng(seed).normal(size=len(points))
    calm = float(np.exp(-1.5 * t))
    block, ball = heights(t)
    q = np.zeros((2, 7), np.float32)
    q[:, 6] = 1.0
    q[:, :3] = (-0.25, 0.0, block), (0.25, 0.0, ball)
    density = (1000.0 * (1.0 + 0.004 * noise)).astype(np.float32)
    kinetic = {"energy/kinetic_bodies": 9.0 * calm, "energy/kinetic_fluid": 3.0 * t * calm}
    potential = {"energy/potential_bodies": 9.81 * (3.6 * block + 7.1 * ball), "energy/potential_fluid": 220.7 + t}
    scalars = {
        **kinetic,
        **potential,
        "energy/kinetic": sum(kinetic.values()),
        "energy/potential": sum(potential.values()),
        "fluid/density_error_mean": 0.003 + 0.002 * calm,
        "fluid/density_error_max": 0.011 + 0.01 * calm,
        "contact/penetration": 2e-4 if ball <= FLOOR + 0.0601 else 0.0,
    }
    fluid = FluidFrame(points.astype(np.float32), np.zeros((len(points), 3), np.float32), density)
    return Frame(q, np.zeros((2, 6), np.float32), np.zeros((2, 3), np.float32), {"/World/water": fluid}, scalars)


def picture(t: float, width: int = 320, height: int = 180) -> np.ndarray:
    """A side view drawn by hand."""
    image = np.full((height, width, 3), 225, np.uint8)
    scale = height / 0.7

    def fill(x0: float, x1: float, z0: float, z1: float, color: tuple[int, int, int]) -> None:
        columns = slice(max(0, int(width / 2 + x0 * scale)), max(0, int(width / 2 + x1 * scale)))
        rows = slice(max(0, int(height - z1 * scale)), max(0, int(height - z0 * scale)))
        image[rows, columns] = color

    block, ball = heights(t)
    fill(-0.5, 0.5, 0.0, FLOOR + LEVEL, (110, 160, 205))
    fill(-0.35, -0.15, block - 0.075, block + 0.075, (150, 95, 45))
    fill(0.19, 0.31, ball - 0.06, ball + 0.06, (110, 115, 125))
    return image


def record(folder: Path) -> None:
    """A recording, a video and stills of the hand-made world."""
    times = [k / RATE for k in range(FRAMES)]
    versions = {"newton": "1.8.0", "warp-lang": "1.19.0", "mujoco": "3.17.0", "usd-core": "26.8"}
    facts = {"device": "cpu", "time_step": 4.17e-4, "time_step_reason": "the fluid's sound", "versions": versions}
    with RecordingWriter(folder / "recording.rrd", make_world(), {**facts, "particles": 1200}) as writer:
        writer.log(0.0, "INFO", "2 bodies, 1200 fluid particles")
        for k, t in enumerate(times):
            writer.frame(t, make_frame(t, k))
            if k % 5 == 0:
                writer.image(t, "/World/side", picture(t))
    write_video(folder / "video.mp4", (picture(t) for t in times), fps=RATE)
    (folder / "frames").mkdir()
    for t in np.linspace(0.0, DURATION, 6):
        Image.fromarray(picture(t, 640, 360)).save(folder / "frames" / f"side_{t:06.3f}s.png")


FLOATS = Finding(
    check="ObjectiveFloats",
    passed=True,
    message="The block floats at the depth that Archimedes gives.",
    objective="wooden_block floats on the water.",
    prim="/World/block",
    time=3.0,
    value=0.0903,
    expected=DRAUGHT,
    limit=0.1,
    margin=0.0097,
    unit="m",
    limit_from="a tenth of the block's height and half a spacing",
    line=f"program.py:{BLOCK_LINE}",
)
SINKS = Finding(
    check="ObjectiveRestsOn",
    passed=False,
    message="The ball lies 31 mm above the tank's floor and does not rest on it.",
    objective="steel_ball sinks and rests on the tank's floor.",
    prim="/World/ball",
    time=2.5,
    value=0.031,
    limit=0.01,
    margin=-0.021,
    unit="m",
    limit_from="twice the contact margin",
    line=f"program.py:{BALL_LINE}",
    target=RepairTarget(
        kind="geometry",
        prim="/World/ball",
        parameter="collision",
        direction="change",
        why="it looks smaller than it is",
    ),
)


@pytest.fixture
def floats() -> Finding:
    return FLOATS


@pytest.fixture
def sinks() -> Finding:
    return SINKS


@pytest.fixture(scope="session")
def recorded(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """An iteration's folder with what the simulator leaves; do not write to it."""
    folder = tmp_path_factory.mktemp("recorded")
    record(folder)
    return folder


@pytest.fixture
def make_run(tmp_path: Path, recorded: Path):
    """A run's folder, with a verdict, as the pipeline leaves it."""

    def make(verdict: Verdict, program: str = PROGRAM, prompt: str = PROMPT, name: str = "run") -> Path:
        run = RunFolder(tmp_path / name)
        folder = run.iteration(1)
        for item in ("recording.rrd", "video.mp4", "frames"):
            (folder / item).symlink_to(recorded / item)
        (folder / "program.py").write_text(program, encoding="utf-8")
        (folder / "verdict.json").write_text(verdict.model_dump_json(), encoding="utf-8")
        build = {"ok": True, "kind": "ok", "message": "", "line": None, "log": "two bodies\n", "isolation": "landlock"}
        simulation = {"problems": [], "frames": FRAMES, "steps": 7200, "dt": 4.17e-4, "boundary_particles": 2410}
        seconds = {"build": 1.213, "simulate": 61.8, "judge": 0.412}
        checks = {"build": build, "simulation": simulation, "seconds": seconds}
        (folder / "checks.json").write_text(json.dumps(checks), encoding="utf-8")
        plan = make_plan(PROMPT)
        (run.path / "plan.json").write_text(plan.model_dump_json(), encoding="utf-8")
        run.record(prompt=prompt, title=prompt, models={"planner": "builtin"}, status=verdict.status, seconds=64.2)
        return run.path

    return make


@pytest.fixture
def rejected(make_run) -> Path:
    verdict = Verdict(status="rejected", summary="1 of 2 findings failed: the ball does not rest on the floor.")
    return make_run(verdict.model_copy(update={"findings": [FLOATS, SINKS]}))


@pytest.fixture
def accepted(make_run) -> Path:
    sinks = SINKS.model_copy(
        update={"passed": True, "value": 0.0002, "margin": 0.0098, "message": "The ball rests on the floor."}
    )
    verdict = Verdict(status="accepted", summary="Both findings passed.", findings=[FLOATS, sinks])
    return make_run(verdict)


@pytest.fixture
def failed_build(tmp_path: Path) -> Path:
    """A run whose program raised: no stage, no recording, no video, no plan."""
    run = RunFolder(tmp_path / "broken")
    folder = run.iteration(1)
    (folder / "program.py").write_text(PROGRAM.replace("wood_density", "wood density"), encoding="utf-8")
    finding = Finding(
        check="build",
        passed=False,
        message="SceneError: param 'wood density': a name is letters, digits and _",
        line="program.py:10",
    )
    verdict = Verdict(status="rejected", summary="The program made no world (exception).", findings=[finding])
    (folder / "verdict.json").write_text(verdict.model_dump_json(), encoding="utf-8")
    build = {"ok": False, "kind": "exception", "message": finding.message, "line": finding.line, "log": "building …\n"}
    checks = {"build": build, "seconds": {"build": 0.9}}
    (folder / "checks.json").write_text(json.dumps(checks), encoding="utf-8")
    run.record(prompt=None, program="examples/blocks.py", status="rejected")
    return run.path
