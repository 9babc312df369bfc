"""Three balls roll at 1 m/s: one goes on, one is stopped by its own rubber, one by the carpet that it comes to."""

import math

from wsim.scene import Scene

RADIUS, SPEED = 0.1, 1.0  # [m], [m/s]
CARPET = (0.6, 0.01)  # where it starts, how thick it is [m]


def build(scene: Scene) -> None:
    scene.simulation(duration=3.5, frame_rate=30.0)
    scene.ground(friction=0.8, color=(0.5, 0.47, 0.42))
    steel = scene.material("steel", density=7850.0, friction=0.8, color=(0.45, 0.47, 0.5))
    # It stops after 7/5 v^2 / (2 C g) = 1.43 m.
    rubber = scene.material("rubber", density=1100.0, friction=0.9, rolling=0.05, color=(0.6, 0.05, 0.03))
    for k, (name, material) in enumerate((("free", steel), ("slowed", rubber), ("caught", steel))):
        scene.sphere(
            name,
            radius=RADIUS,
            position=(0.0, 0.5 * (k - 1), RADIUS + (CARPET[1] if name == "caught" else 0.0)),
            velocity=(SPEED, 0.0, 0.0),
            angular_velocity_deg=(0.0, math.degrees(SPEED / RADIUS), 0.0),
            material=material,
        )

    # Boards as high as the carpet lead to it: the third ball meets no edge.
    start, thick = CARPET
    scene.box("board", size=(1.0, 0.3, thick), position=(start - 0.5, 0.5, thick / 2), static=True, material=steel)
    scene.box("carpet", size=(1.5, 0.3, thick), position=(start + 0.75, 0.5, thick / 2), static=True,
              friction=0.8, color=(0.05, 0.2, 0.35))  # fmt: skip
    scene.contact("caught", "carpet", rolling=0.1)

    scene.light("sun", direction=(-0.4, 0.6, -1.0))
    scene.camera("corner", eye=(1.8, -4.2, 2.8), target=(1.8, 0.2, 0.0))


if __name__ == "__main__":
    from wsim import run

    run(build)
