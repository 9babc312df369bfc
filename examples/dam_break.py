"""A column of water stands at one end of a tank; it falls and runs into a box."""

from wsim.scene import Scene

LENGTH, WIDTH, HEIGHT = 1.6, 0.4, 0.6  # of the tank's hollow [m]
COLUMN = 0.45  # [m]


def build(scene: Scene) -> None:
    scene.simulation(duration=2.0, frame_rate=60.0)
    scene.ground()
    tank = scene.tank("tank", inner_size=(LENGTH, WIDTH, HEIGHT))

    depth = scene.param("column_height", 0.45, low=0.3, high=0.55, unit="m")
    scene.fluid(
        "water",
        size=(COLUMN, WIDTH, depth),
        position=(-LENGTH / 2 + COLUMN / 2, 0.0, tank.floor + depth / 2),
        spacing=0.03,
        container=tank,
    )
    scene.box(
        "obstacle",
        size=(0.12, 0.16, 0.15),
        position=(0.35, 0.0, tank.floor + 0.075),
        static=True,
        color=(0.67, 0.11, 0.0),
    )

    scene.light("sun", direction=(-0.4, 0.6, -1.0))
    scene.camera("side", eye=(0.0, -2.6, 0.9), target=(0.0, 0.0, 0.25))
    scene.camera("end", eye=(2.2, -0.9, 1.0), target=(0.1, 0.0, 0.2))


if __name__ == "__main__":
    from wsim import run

    run(build)
