"""A twelve-joint quadruped trots: legs of capsules, sine targets for hip and knee drives."""
import math
from collections import defaultdict
from types import SimpleNamespace

import numpy as np

from wsim.scene import Drive, Scene

P = SimpleNamespace(length=0.5, width=0.25, hip=0.42, thigh=0.2, shank=0.2, r=0.025)
LEGS = {"fl": (1, 1), "fr": (1, -1), "rl": (-1, 1), "rr": (-1, -1)}
GAIT = {"fl": 0.0, "rr": 0.0, "fr": 0.5, "rl": 0.5}
JOINTS: dict[str, list[str]] = defaultdict(list)


def build(scene: Scene):
    scene.simulation(duration=4, frame_rate=50)
    scene.ground(friction=1.0)
    trunk = scene.box("trunk", size=(P.length, P.width, 0.1), position=(0, 0, P.hip + 0.02), mass=8)
    servo = Drive(stiffness=80.0, damping=3.0, max_force=40.0)
    for leg, (fx, fy) in LEGS.items():
        x, y = fx * P.length / 2, fy * (P.width / 2 + 0.05)
        thigh = scene.capsule(f"{leg}_thigh", radius=P.r, height=P.thigh - 2 * P.r, position=(x, y, P.hip - P.thigh / 2), mass=0.8)
        shank = scene.capsule(f"{leg}_shank", radius=P.r * 0.8, height=P.shank - 2 * P.r, position=(x, y, P.hip - P.thigh - P.shank / 2), mass=0.3, friction=1.2)
        scene.joint_revolute(f"{leg}_hip", trunk, thigh, anchor=(x, y, P.hip), axis="Y", limits_deg=[-60, 60], drive=servo)
        scene.joint_revolute(f"{leg}_knee", thigh, shank, anchor=(x, y, P.hip - P.thigh), axis="Y", limits_deg=[-90, 30], drive=servo)
        JOINTS[leg].extend([f"{leg}_hip", f"{leg}_knee"])
    scene.camera("side", eye=(0.2, -2.2, 0.7), target=(0.2, 0, 0.3))


def control(world, t):
    for leg, offset in GAIT.items():
        phase = 2 * math.pi * (1.5 * t + offset)
        hip, knee = (world.joint(f"{leg}_{part}") for part in ("hip", "knee"))
        hip.target = 0.35 * math.sin(phase)
        knee.target = -0.5 * max(0.0, math.cos(phase))
    trunk = world.body("trunk")
    fallen = trunk.position[:, 2] < 0.2
    if np.any(fallen):
        world.apply_force("trunk", np.where(fallen[:, None], (0.0, 0.0, 5.0), 0.0))
