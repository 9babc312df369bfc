"""A wave maker: a paddle on a driven slider pushes water down a flume; a duck bobs."""
import numpy as np
from wsim.scene import Drive, Scene

H = 0.04
LEVEL = 0.24
PERIOD = 1.2


def build(scene: Scene) -> None:
    scene.simulation(duration=5.0, frame_rate=30.0)
    scene.ground()
    flume = scene.tank("flume", inner_size=(2.4, 0.4, 0.6), wall=0.03)
    left = flume.low[0]
    paddle = scene.box("paddle", size=(0.04, 0.38, 0.5), position=(left + 0.2, 0, flume.floor + 0.26), mass=20.0)
    scene.joint_prismatic("stroke", flume, paddle, axis="X", limits=(-0.15, 0.15), drive=Drive(stiffness=8e3, damping=4e2))
    front = left + 0.2 + 0.02 + H
    length = flume.inner_size[0] + left - front
    scene.fluid("water", size=(length, 0.4, LEVEL), position=(front + length / 2, 0, flume.floor + LEVEL / 2), spacing=H)
    scene.box("duck", size=(0.2, 0.2, 0.2), position=(0.4, 0, flume.floor + LEVEL + 0.11), density=300, color=(1, 0.85, 0))
    scene.camera("side", eye=(0, -3.2, 0.9), target=(0, 0, 0.3))


def control(world, t):
    ramp = np.minimum(t / PERIOD, 1.0)
    world.joint("stroke").target = 0.1 * ramp * np.sin(2 * np.pi * t / PERIOD)
