"""A slider-crank: a ram pushes the piston along X, a rod turns the crank."""

import math

from wsim.scene import Drive, Scene

CRANK = 0.15
ROD = 0.45
HEIGHT = 0.5


def build(scene: Scene) -> None:
    scene.simulation(duration=5.0, frame_rate=60.0)
    scene.ground()
    alu = scene.material("aluminium", density=2700.0, friction=0.2, color=(0.7, 0.72, 0.75))

    crank = scene.box("crank", size=(CRANK, 0.03, 0.03), position=(CRANK / 2, 0.0, HEIGHT), material=alu)
    rod = scene.box("rod", size=(ROD, 0.02, 0.02), position=(CRANK + ROD / 2, 0.04, HEIGHT), material=alu)
    piston = scene.box("piston", size=(0.1, 0.1, 0.1), position=(CRANK + ROD, 0.12, HEIGHT), material=alu, color=(0.7, 0.2, 0.1))

    speed = scene.param("piston_speed", 0.2, low=0.05, high=1.0, unit="m/s")
    motor = Drive(velocity=speed, damping=200.0, max_force=50.0)
    stroke = 2 * CRANK

    # The loop begins at the slider and closes at the crank's bearing, which turns freely.
    scene.joint_prismatic("guide", None, piston, axis="X", limits=(-stroke * 1.1, 0.1 * stroke), drive=motor)
    scene.joint_revolute("wrist_pin", piston, rod, anchor=(CRANK + ROD, 0.05, HEIGHT), axis="Y")
    scene.joint_revolute("crank_pin", rod, crank, anchor=(CRANK, 0.02, HEIGHT), axis="Y")
    scene.joint_revolute("main_bearing", None, crank, anchor=(0.0, 0.0, HEIGHT), axis="Y")

    eye = (0.3, -1.8 * math.cos(0.2), HEIGHT + 0.3)
    scene.camera("side", eye=eye, target=(0.3, 0.0, HEIGHT))
