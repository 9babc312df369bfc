"""Fills Warp's cache of kernels: small worlds of what most worlds have are made, moved and drawn, and thrown away."""

from __future__ import annotations

import tempfile
from collections.abc import Callable
from pathlib import Path

import warp as wp

from wsim.progress import Progress, silent
from wsim.scene import Scene
from wsim.sim.devices import known_device
from wsim.sim.simulation import Simulation

FRAMES = 2


def _floating(scene: Scene) -> None:
    """Water, and loose bodies in it and beside it: MuJoCo's kernels are made for their number."""
    scene.ground()
    tank = scene.tank("tank", inner_size=(0.8, 0.5, 0.5))
    scene.fluid("water", fills=tank, level=0.5, spacing=0.05)
    for k in range(3):
        scene.box(f"block_{k}", size=(0.15, 0.15, 0.15), density=600.0, position=(0.25 * (k - 1), 0.0, 0.35))
    scene.sphere("ball", radius=0.08, density=7800.0, position=(0.25, 0.0, 0.7))


def _dry(scene: Scene) -> None:
    """Bodies on a floor, and one on a hinge with a drive."""
    scene.ground()
    scene.box("block", size=(0.2, 0.2, 0.2), density=600.0, position=(0.0, 0.0, 0.12))
    scene.sphere("ball", radius=0.1, density=900.0, position=(0.5, 0.0, 0.3))
    rod = scene.box("rod", size=(0.05, 0.05, 0.4), density=600.0, position=(1.0, 0.0, 0.7))
    scene.joint_revolute("hinge", None, rod, anchor=(1.0, 0.0, 0.9), axis="Y")


WORLDS: dict[str, tuple[Callable[[Scene], None], int]] = {  # and how many of each at once
    "bodies in water": (_floating, 1),
    "bodies": (_dry, 1),
    "a batch of bodies": (_dry, 2),
}


def fill(device: str = "auto", progress: Progress = silent) -> Path:
    """Compile what these worlds need, and a picture of them.

    What is made for the size of a world is still compiled where a world of that size is first met.

    Args:
        device: "cpu", "cuda:0", …; "auto" is the first CUDA device, or the CPU.
        progress: Told what is being compiled.

    Returns:
        The folder of the cache.
    """
    device = known_device(device)
    for k, (name, (build, count)) in enumerate(WORLDS.items()):
        progress("kernels", k, len(WORLDS))

        def of_this(stage: str, done: float, total: float, name: str = name) -> None:
            progress(f"{name}: {stage}", done, total)

        with tempfile.TemporaryDirectory() as folder:
            scene = Scene()
            scene.simulation(duration=FRAMES / 24.0, frame_rate=24.0)
            build(scene)
            stage = scene.save(Path(folder) / "stage.usda")
            simulation = Simulation(stage, device, count, draws=count == 1, progress=of_this)
            video = Path(folder) / "video.mp4" if count == 1 else None
            simulation.run(Path(folder) / "recording.rrd", video=video, progress=of_this)
    progress("kernels", len(WORLDS), len(WORLDS))
    return Path(wp.config.kernel_cache_dir)
