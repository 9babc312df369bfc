"""A weight bobs on a spring; beside it another's spring has a damper at its side, and comes to rest."""

import math

from wsim.scene import Scene

MASS, TOP = 2.0, 1.6  # of a weight [kg]; height of the beam [m]


def build(scene: Scene) -> None:
    scene.simulation(duration=5.0, frame_rate=60.0)
    scene.ground()
    oak = scene.material("oak", density=700.0, color=(0.42, 0.26, 0.12))
    steel = scene.material("steel", density=7850.0, color=(0.5, 0.52, 0.55))
    scene.box("beam", size=(1.5, 0.12, 0.08), position=(0.0, 0.0, TOP + 0.04), static=True, material=oak)
    for side in (-1.0, 1.0):
        post = f"post_{'left' if side < 0.0 else 'right'}"
        scene.box(post, size=(0.08, 0.12, TOP), position=(0.71 * side, 0.0, 0.5 * TOP), static=True, material=oak)

    stiffness = scene.param("stiffness", 120.0, low=60.0, high=400.0, unit="N/m")
    damping = 0.3 * math.sqrt(stiffness * MASS)  # zeta = 0.15
    for name, x in (("free", -0.35), ("damped", 0.35)):
        scene.cylinder(name, radius=0.07, height=0.12, position=(x, 0.0, 0.9), mass=MASS, material=steel)
        ends = {"anchor_a": (x, 0.0, TOP), "anchor_b": (x, 0.0, 0.96)}
        scene.spring(f"spring_{name}", "beam", name, stiffness=stiffness, **ends)
    ends = {"anchor_a": (0.35, 0.0, TOP), "anchor_b": (0.35, 0.0, 0.96)}
    scene.spring("damper", "beam", "damped", stiffness=0.0, damping=damping, radius=0.03, **ends)

    scene.light("sun", direction=(-0.4, 0.6, -1.0))
    scene.camera("side", eye=(0.0, -3.2, 1.3), target=(0.0, 0.0, 0.9))


if __name__ == "__main__":
    from wsim import run

    run(build)
