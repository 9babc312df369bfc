"""Five balls of growing bounciness are dropped side by side."""

from wsim.scene import Scene

BALLS = 5
RADIUS = 0.08
SPACING = 0.35
DROP_HEIGHT = 1.5


def build(scene: Scene) -> None:
    scene.simulation(duration=4.0, frame_rate=60.0)
    scene.ground(friction=0.6, restitution=1.0)

    for i in range(BALLS):
        bounce = i / (BALLS - 1)
        x = (i - (BALLS - 1) / 2) * SPACING
        scene.sphere(
            f"ball_{i}",
            radius=RADIUS,
            position=(x, 0.0, DROP_HEIGHT),
            mass=0.25,
            restitution=bounce,
            color=(bounce, 0.2, 1.0 - bounce),
        )

    scene.light("sun", direction=(-0.4, 0.6, -1.0))
    scene.camera("front", eye=(0.0, -3.5, 1.0), target=(0.0, 0.0, 0.6))


if __name__ == "__main__":
    from wsim import run

    run(build)
