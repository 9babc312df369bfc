"""A cart-pole balanced by state feedback in `control`."""

import numpy as np

from wsim.scene import Scene

GAINS = np.array([-2.0, -3.5, 38.0, 7.5])
POLE = 0.8


def build(scene: Scene) -> None:
    scene.simulation(duration=6.0, frame_rate=60.0)
    scene.ground()
    cart = scene.box("cart", size=(0.3, 0.2, 0.1), position=(0, 0, 0.5), mass=2.0)
    pole = scene.box("pole", size=(0.03, 0.03, POLE), position=(0, 0, 0.55 + POLE / 2), mass=0.3, rotation_deg=(0, 3, 0))
    scene.joint_prismatic("rail", None, cart, axis="X", limits=(-2.0, 2.0))
    scene.joint_revolute("hinge", cart, pole, anchor=(0, 0, 0.55), axis="Y")
    scene.camera("side", eye=(0, -3, 1), target=(0, 0, 0.7))


def control(world, t):
    rail = world.joint("rail")
    hinge = world.joint("hinge")
    state = np.stack([rail.position, rail.velocity, hinge.position, hinge.velocity], axis=-1)  # (W, 4)
    force = state @ GAINS
    rail.force = np.clip(force, -40.0, 40.0)


if __name__ == "__main__":
    from wsim import run

    run(build)
