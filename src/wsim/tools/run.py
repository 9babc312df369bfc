"""The tool that runs a program: its build, its physics, a frame a camera, or all of it."""

from __future__ import annotations

import contextlib
import shutil
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Literal

from pydantic import Field

from wsim import sim
from wsim.runs.folder import write_json
from wsim.runs.iteration import Iteration, no_world
from wsim.scene.describe import describe
from wsim.sim.seen import still_name, write_png
from wsim.tools.base import Result, Tool, Workspace
from wsim.tools.iterations import OfIteration, file_of
from wsim.tools.text import name_of, number, numbers, table
from wsim.tools.verdict import verdict_lines

if TYPE_CHECKING:
    from wsim.scene.world import Body, Shape, World

Pass = Literal["build", "physics", "frames", "full"]
LOG_LINES = 5  # of what the program printed


class RunProgram(OfIteration):
    """A pass over a program."""

    passes: Pass = Field(
        "physics",
        description="build: the stage alone; frames: a picture a camera at t = 0, nothing simulated; "
        "physics: simulated and judged, no pictures; full: simulated and judged, with video and stills",
    )


def run_program(workspace: Workspace, asked: RunProgram) -> Result:
    """Run a pass of an iteration, and what it needs before it; what is there already is not run again."""
    program = file_of(workspace, asked.iteration, "program.py", "write one with write_program")
    failed = _build(workspace, program)
    if failed is not None:
        return failed
    passes: dict[Pass, Callable[[Workspace, Path], Result]] = {
        "build": _built, "frames": _frames, "physics": _physics, "full": _full,
    }  # fmt: skip
    return passes[asked.passes](workspace, program.parent)


def _build(workspace: Workspace, program: Path) -> Result | None:
    """Make the stage; the answer where there is none to be had."""
    folder = program.parent
    if (folder / "stage.usda").is_file():
        return None
    iteration = Iteration(folder, workspace.plan, workspace.settings, workspace.progress)
    built = iteration.build()
    if built.ok:
        return None
    iteration.conclude(no_world(built))
    where = f" [{built.line}]" if built.line else ""
    lines = [f"iterations/{folder.name}: the program made no world ({built.kind}){where}: {built.message}"]
    return Result("\n".join([*lines, *built.problems[1:], *_printed(built.log)]), ok=False)


def _built(workspace: Workspace, folder: Path) -> Result:
    world = describe(folder / "stage.usda")
    log = Iteration(folder).checks.get("build", {}).get("log", "")
    head = f"iterations/{folder.name}/stage.usda: {number(world.duration)} s at {number(world.frame_rate)} frames/s"
    return Result("\n".join([head, *_contents(world), *_printed(log)]))


def _frames(workspace: Workspace, folder: Path) -> Result:
    """A still of each camera at the start, as the full pass has them too."""
    lines, shares, first = [], [], None
    for still in sim.Stills(folder / "stage.usda", workspace.settings.device, progress=workspace.progress).draw_start():
        path = folder / "frames" / still_name(still.camera.prim, still.time)
        if not path.is_file():
            write_png(path, still.rgb)
        first = first or path
        lines += picture_lines(f"iterations/{folder.name}/frames/{path.name}", still.pixels, still.rgb.shape)
        size = still.rgb.shape[0] * still.rgb.shape[1]
        seen = {prim: round(n / size, 5) for prim, n in still.pixels.items() if n}
        shares.append({"camera": still.camera.prim, "time": still.time, "objects": seen})
    if not (folder / "review.json").is_file():
        write_json(folder / "review.json", {"share_of_picture": shares})
    return Result("\n".join(lines), image=first)


def picture_lines(path: str, pixels: dict[str, int], shape: tuple[int, ...]) -> list[str]:
    """A picture's path, size and what is in it, the largest first."""
    height, width = shape[:2]
    seen = sorted((item for item in pixels.items() if item[1]), key=lambda item: (-item[1], item[0]))
    parts = [f"{name_of(prim)} {n} ({100 * n / (height * width):.3g} %)" for prim, n in seen]
    lines = [f"{path}: {width} x {height} px", f"  pixels: {', '.join(parts) or 'of no object'}"]
    unseen = [name_of(prim) for prim, n in pixels.items() if not n]
    return [*lines, *([f"  no pixel (out of sight, or glass): {', '.join(unseen)}"] if unseen else [])]


def _physics(workspace: Workspace, folder: Path) -> Result:
    if not (folder / "recording.rrd").is_file() or not (folder / "verdict.json").is_file():
        _simulate(workspace, folder, pictures=False)
    return _judged(folder)


def _full(workspace: Workspace, folder: Path) -> Result:
    if not workspace.settings.pictures:
        return _physics(workspace, folder)
    if not (folder / "video.mp4").is_file() or not (folder / "verdict.json").is_file():
        _simulate(workspace, folder, pictures=True)
    return _judged(folder)


def _simulate(workspace: Workspace, folder: Path, pictures: bool) -> None:
    """Simulate and judge; recording, verdict and the rest replace those of a narrower pass, file by file."""
    settings = replace(workspace.settings, pictures=pictures, verify=workspace.settings.verify and pictures)
    iteration = Iteration(folder, workspace.plan, settings, workspace.progress)
    with _kept(iteration.recording):
        iteration.conclude(iteration.happen())


@contextlib.contextmanager
def _kept(recording: Path) -> Iterator[None]:
    """A run that is stopped leaves the recording of its part; the whole one of a pass before it comes back then."""
    before = recording.with_name(recording.name + ".before")
    if recording.with_name("verdict.json").is_file() and recording.is_file():
        shutil.copyfile(recording, before)
    try:
        yield
    except BaseException:
        if before.is_file():
            before.replace(recording)
        raise
    before.unlink(missing_ok=True)


def _judged(folder: Path) -> Result:
    facts = Iteration(folder).checks.get("simulation", {})
    lines = [f"iterations/{folder.name}:"]
    if "steps" in facts:
        lines[0] += f" {facts['frames']} frames, {facts['steps']} steps of {number(facts['dt'])} s"
        lines[0] += f", {facts['particles']} particles" if facts["particles"] else ""
        lines += [f"problem: {problem}" for problem in facts["problems"]]
    lines += verdict_lines(folder / "verdict.json")
    names = [f"frames/{name}" for name in facts.get("stills", [])]
    pictures = [name for name in ("video.mp4", *names) if (folder / name).is_file()]
    return Result("\n".join([*lines, *([f"pictures: {', '.join(pictures)}"] if pictures else [])]))


def _printed(log: str) -> list[str]:
    own = log.split("Traceback (most recent call last)")[0]  # the answer has its message and line
    lines = own.strip().splitlines()[-LOG_LINES:]
    return ["it printed:", *lines] if lines else []


# ---- what a stage holds
def _contents(world: World) -> list[str]:
    rows = [_body_row(body) for body in world.bodies]
    rows += [
        [
            name_of(item.prim),
            "static",
            "",
            _shapes(item.shapes),
            numbers(item.shapes[0].position) if item.shapes else "",
        ]
        for item in world.statics
    ]
    for fluid in world.fluids:
        cells = round(fluid.amount / fluid.spacing**3)
        row = [name_of(fluid.prim), f"fluid, about {cells} particles", number(cells * fluid.spacing**3 * fluid.density)]
        rows.append([*row, numbers(fluid.size, " x "), numbers(fluid.center)])
    lines = table(("object", "what", "mass [kg]", "size [m]", "place [m]"), rows) if rows else ["nothing is in it"]
    lines += [
        f"joint {name_of(joint.prim)}: {joint.kind}, {name_of(joint.parent) or 'the world'} to {name_of(joint.child)}"
        + (", driven" if joint.drive else "")
        for joint in world.joints
    ]
    for title, items in (("cameras", world.cameras), ("parameters", world.parameters)):
        named = [name_of(getattr(item, "prim", None)) or getattr(item, "name", "") for item in items]
        lines += [f"{title}: {', '.join(named)}"] if named else []
    return lines


def _body_row(body: Body) -> list[str]:
    kind = "kinematic" if body.kinematic else "body"
    return [name_of(body.prim), kind, number(body.mass), _shapes(body.shapes), numbers(body.position)]


def _shapes(shapes: list[Shape]) -> str:
    if len(shapes) != 1:
        return f"{len(shapes)} shapes"
    return f"{shapes[0].kind} {numbers(shapes[0].size, ' x ')}".strip()


TOOLS = (
    Tool(
        "run_program", "Run a program: the build alone, a frame a camera, physics without pictures, or all; and judge.",
        RunProgram, run_program, writes=True, narrow="read_verdict and query_recording show single things",
    ),
)  # fmt: skip
