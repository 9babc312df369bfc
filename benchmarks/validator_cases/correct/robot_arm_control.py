"""A three-axis arm follows sines with position drives; targets are set in control."""
from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from wsim.scene import Drive, Scene

if TYPE_CHECKING:
    from collections.abc import Sequence

LINKS: Sequence[tuple[str, float]] = (("shoulder", 0.4), ("elbow", 0.35), ("wrist", 0.2))
AMPLITUDE = {"base_yaw": 0.8, "shoulder": 0.5, "elbow": 0.7, "wrist": 0.4}
FREQUENCY = 0.5  # Hz


def build(scene: Scene) -> None:
    scene.simulation(duration=4.0, frame_rate=60.0)
    scene.ground()
    gain = scene.param("stiffness", 400.0, low=50.0, high=2000.0, unit="N m/rad")
    servo = Drive(stiffness=gain, damping=gain / 15, max_force=200.0)

    base = scene.cylinder("base", radius=0.12, height=0.2, position=(0, 0, 0.1), mass=8.0)
    scene.joint_revolute("base_yaw", None, base, axis="Z", drive=servo)
    below, z = base, 0.2
    for name, length in LINKS:
        part = scene.capsule(f"{name}_link", radius=0.04, height=length - 0.08, position=(0, 0, z + length / 2), mass=1.5)
        scene.joint_revolute(name, below, part, anchor=(0, 0, z), axis="Y", limits_deg=(-120, 120), drive=servo)
        below, z = part, z + length

    scene.camera("corner", eye=(2.2, -2.2, 1.2), target=(0, 0, 0.6))


def control(world: Any, t: float) -> None:
    phase = 2.0 * math.pi * FREQUENCY * t
    for k, (name, amplitude) in enumerate(AMPLITUDE.items()):
        world.joint(name).target = amplitude * np.sin(phase + 0.5 * k) * np.ones(world.world_count)
