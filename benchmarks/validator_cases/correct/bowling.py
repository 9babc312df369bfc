"""Ten-pin bowling."""
from math import sqrt

from wsim.scene import Scene

PIN_HEIGHT, PIN_RADIUS, PIN_MASS = 0.38, 0.055, 1.53
SPACING = 0.3048  # centre to centre
LANE = dict(length=8.0, width=1.05, thickness=0.05)


def pin_spots(rows=4):
    """Yield (number, x, y) of the pins, head pin first."""
    number = 1
    for row in range(rows):
        for column in range(row + 1):
            yield number, row * SPACING * sqrt(3) / 2, (column - row / 2) * SPACING
            number += 1


def build(scene: Scene) -> None:
    scene.simulation(duration=5.0, frame_rate=60.0)
    scene.ground(height=-LANE["thickness"])
    scene.box(
        "lane",
        size=(LANE["length"], LANE["width"], LANE["thickness"]),
        position=(-LANE["length"] / 2 + 1.2, 0.0, -LANE["thickness"] / 2),
        static=True,
        friction=0.12,
        color=(0.7, 0.5, 0.25),
    )
    plastic = scene.material("plastic", friction=0.3, restitution=0.4, color=(0.95, 0.95, 0.92))
    for number, x, y in pin_spots():
        scene.cylinder(
            f"pin_{number}", radius=PIN_RADIUS, height=PIN_HEIGHT, position=(x, y, PIN_HEIGHT / 2), mass=PIN_MASS, material=plastic
        )
    speed = scene.param("ball_speed", 7.0, low=3.0, high=10.0, unit="m/s")
    aim = scene.param("aim", 0.03, low=-0.3, high=0.3, unit="m")
    scene.sphere("ball", radius=0.108, position=(-4.0, aim, 0.109), velocity=(speed, 0.0, 0.0), mass=6.5, friction=0.1)
    scene.camera("lane_view", eye=(-5.5, -0.6, 1.2), target=(0.3, 0.0, 0.2))
    scene.camera("pins", eye=(0.3, -2.2, 0.8), target=(0.3, 0.0, 0.2), fov=40)
