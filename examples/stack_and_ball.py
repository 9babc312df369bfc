"""A heavy ball flies into a stack of five boxes and knocks it over."""

from wsim.scene import Scene

EDGE = 0.2  # [m]


def build(scene: Scene) -> None:
    scene.simulation(duration=3.0, frame_rate=60.0)
    scene.ground(friction=0.6)
    wood = scene.material("wood", density=500.0, friction=0.5, color=(0.45, 0.25, 0.1))
    for i in range(5):
        scene.box(f"box_{i}", size=(EDGE, EDGE, EDGE), position=(0.0, 0.0, (i + 0.5) * EDGE), material=wood)

    speed = scene.param("ball_speed", 5.0, low=1.0, high=10.0, unit="m/s")
    iron = scene.material("iron", density=7200.0, friction=0.4, color=(0.1, 0.1, 0.12))
    scene.sphere("ball", radius=0.1, position=(-1.2, 0.0, 0.9), velocity=(speed, 0.0, 0.0), material=iron)

    scene.light("sun", direction=(-0.4, 0.6, -1.0))
    scene.camera("side", eye=(1.15, -6.0, 1.8), target=(1.15, 0.0, 0.5))


if __name__ == "__main__":
    from wsim import run

    run(build)
