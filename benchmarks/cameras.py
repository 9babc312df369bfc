"""Whether pictures show what a world is about: ten worlds, their stills measured, before and after a change.

    python benchmarks/cameras.py make runs/before      # once with the sources of before on PYTHONPATH
    python benchmarks/cameras.py make runs/after
    python benchmarks/cameras.py compare runs/before runs/after --image strip.jpg

Seven worlds are planned from a sentence, or are examples without their cameras; three have the camera that a plan
guesses which looks at how it starts. A subject, what the plan's objectives name or else what moves, is seen in a still
if it has as many pixels as a disc of 12 px, or half a per cent of the picture, and most of it is in the picture.
"""

from __future__ import annotations

import argparse
import json
import math
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from PIL import Image, ImageDraw

EXAMPLES = Path(__file__).parents[1] / "examples"
ENOUGH = min(math.pi / 4.0 * 12.0**2, 0.005 * 640 * 360)  # [px]
TILE = (192, 108)  # [px] of the strip


@dataclass(frozen=True)
class World:
    """One of the ten: a sentence for the builtin planner or an example, and a camera in place of its own."""

    name: str
    prompt: str = ""
    example: str = ""
    camera: str | None = None  # the arguments of a camera that is guessed; empty: none


WORLDS = (
    World("bounce", "A rubber ball is dropped from 3 m and bounces."),
    World("stack", example="stack_and_ball", camera='"main", eye=(0.0, -2.2, 1.0), target=(0.0, 0.0, 0.5)'),
    World("pendulum", example="double_pendulum", camera=""),
    World("throw", "A ball is thrown at 8 m/s at 45 degrees.",
          camera='"main", eye=(0.0, -3.0, 1.2), target=(0.5, 0.0, 0.5)'),
    World("ramp", "A ball rolls down a ramp."),
    World("conveyor", "A box rides on a conveyor belt."),
    World("afloat", "Three wooden blocks float in a tank of water."),
    World("drive", "A truck drives 12 m over a road.", camera='"main", eye=(-6.0, -8.0, 4.0), target=(0.0, 0.0, 1.0)'),
    World("balls", "A ball rolls into a row of three balls."),
    World("pulleys", example="pulleys", camera=""),
)  # fmt: skip


def make(folder: Path, only: list[str]) -> None:
    """Run each world with pictures, with the wsim that is imported."""
    from wsim.program.compose import compose
    from wsim.rules.planner import plan as planned
    from wsim.runs.iteration import Iteration
    from wsim.runs.settings import Settings

    for world in WORLDS:
        if only and world.name not in only:
            continue
        plan = planned(world.prompt) if world.prompt else None
        text = compose(plan) if plan else (EXAMPLES / f"{world.example}.py").read_text(encoding="utf-8")
        if world.camera is not None:
            text = with_camera(text, world.camera)
        place = folder / world.name
        place.mkdir(parents=True, exist_ok=True)
        (place / "program.py").write_text(text, encoding="utf-8")
        if plan is not None:
            (place / "plan.json").write_text(plan.model_dump_json(), encoding="utf-8")
        began = time.perf_counter()
        verdict = Iteration(place, plan, Settings()).run()
        seconds = json.loads((place / "checks.json").read_text(encoding="utf-8")).get("seconds", {})
        print(f"{world.name:10} {verdict.status:9} {time.perf_counter() - began:6.1f} s", seconds, flush=True)


def with_camera(text: str, camera: str) -> str:
    """A program with one camera in the place of its own, or with none."""
    lines, kept, depth = text.splitlines(), [], 0
    for line in lines:
        if depth == 0 and "scene.camera(" not in line:
            kept.append(line)
            continue
        if depth == 0 and camera:
            kept.append(f"    scene.camera({camera})")
            camera = ""
        depth += line.count("(") - line.count(")")
    return "\n".join(kept) + "\n"


@dataclass(frozen=True)
class Measured:
    """Of one run: means over its stills of the first camera, and its subjects."""

    seen: float  # share of stills and subjects
    height: float  # of the picture, that a subject takes
    hidden: float  # share of subjects in the frame of which few pixels are seen
    stills: list[Path]


def measure(folder: Path) -> Measured:
    """How well the stills of a run show its subjects."""
    from wsim import recording
    from wsim.plan.store import load
    from wsim.plan.subjects import asked_about
    from wsim.sim.framing.hidden import FILLS
    from wsim.sim.framing.motion import Motion
    from wsim.sim.framing.shown import IN, Scenario, shown
    from wsim.sim.framing.subjects import subjects
    from wsim.sim.render_views import default_camera

    found = recording.read(folder / "recording.rrd")
    plan = load(folder / "plan.json") if (folder / "plan.json").is_file() else None
    motion = Motion.of(found)
    cords = {cord.prim for cord in found.world.cords}  # too thin to be counted
    every = subjects(found.world, motion, asked_about(plan) if plan else ())
    main = [s for s in every if s.main and s.prim not in cords]
    ones = np.ones(len(motion.time))
    scenario = Scenario(found.world, motion, main, ones / len(ones), ones > 0.0)
    camera = (found.views or [default_camera(found.world)])[0]
    view = shown(camera, scenario)
    rows = json.loads((folder / "review.json").read_text(encoding="utf-8"))["share_of_picture"]
    rows = [row for row in rows if row["camera"] == camera.prim]
    clear = {f"/World/{item.name}" for item in plan.objects if item.primitive == "fluid"} if plan else set()
    pixels = camera.width * camera.height
    seen, heights, hidden, stills = [], [], [], []
    for row in rows:
        k = int(np.abs(motion.time - row["time"]).argmin())
        stills.append(folder / "frames" / f"{camera.prim.rsplit('/', 1)[-1]}_{row['time']:06.3f}s.png")
        for s, subject in enumerate(main):
            if subject.prim in clear:
                continue
            count = pixels * sum(row["objects"].get(part, 0.0) for part in subject.parts)
            left, top, right, bottom = view.box[k, s]
            area = 0.25 * (right - left) * (bottom - top) * pixels
            seen.append(count >= ENOUGH and view.inside[k, s] >= IN)
            heights.append(0.5 * (bottom - top) if view.inside[k, s] > 0.0 else 0.0)
            if view.inside[k, s] >= IN:
                hidden.append(count < FILLS * area)
    return Measured(float(np.mean(seen)), float(np.mean(heights)), float(np.mean(hidden or [0.0])), stills)


def compare(before: Path, after: Path, image: Path | None) -> None:
    """Print a table, and draw a strip: of each world three stills before, and three after."""
    print("| world | seen before | after | height before | after | hidden before | after |")
    print("| --- | ---: | ---: | ---: | ---: | ---: | ---: |")
    pairs = [(world.name, measure(before / world.name), measure(after / world.name)) for world in WORLDS]
    for name, old, new in pairs:
        print(
            f"| {name} | {old.seen:.0%} | {new.seen:.0%} | {old.height:.1%} | {new.height:.1%} "
            f"| {old.hidden:.0%} | {new.hidden:.0%} |"
        )
    sides = [[pair[k] for pair in pairs] for k in (1, 2)]
    means = [np.mean([(one.seen, one.height, one.hidden) for one in side], axis=0) for side in sides]
    (a, b, c), (d, e, f) = means
    print(f"| all | {a:.0%} | {d:.0%} | {b:.1%} | {e:.1%} | {c:.0%} | {f:.0%} |")
    if image is not None:
        strip(pairs, image)


def strip(pairs: list[tuple[str, Measured, Measured]], image: Path) -> None:
    """Three stills of each world before, and three after, side by side."""
    width, height = TILE
    sheet = Image.new("RGB", (6 * width + 12, len(pairs) * height), "white")
    write = ImageDraw.Draw(sheet)
    for row, (name, old, new) in enumerate(pairs):
        for side, run in enumerate((old, new)):
            chosen = [run.stills[k] for k in (0, len(run.stills) // 2, len(run.stills) - 1)]
            for column, path in enumerate(chosen):
                with Image.open(path) as still:
                    tile = still.convert("RGB").resize(TILE, Image.Resampling.LANCZOS)
                sheet.paste(tile, ((3 * side + column) * width + 12 * side, row * height))
        write.text((4, row * height + 2), name, fill="black")
    sheet.save(image, quality=72, optimize=True)


def main() -> None:
    """Read the command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    verbs = parser.add_subparsers(required=True)
    making = verbs.add_parser("make")
    making.add_argument("folder", type=Path)
    making.add_argument("worlds", nargs="*")
    making.set_defaults(call=lambda given: make(given.folder, given.worlds))
    comparing = verbs.add_parser("compare")
    comparing.add_argument("before", type=Path)
    comparing.add_argument("after", type=Path)
    comparing.add_argument("--image", type=Path)
    comparing.set_defaults(call=lambda given: compare(given.before, given.after, given.image))
    given = parser.parse_args()
    given.call(given)


if __name__ == "__main__":
    main()
