"""A column of water collapses and runs through a row of posts."""

from __future__ import annotations

from wsim.scene import Scene

TANK = (1.6, 0.4, 0.6)
COLUMN = (0.4, 0.4, 0.42)


def build(scene: Scene) -> None:
    scene.simulation(duration=2.0, frame_rate=60.0)
    scene.ground()
    tank = scene.tank("tank", inner_size=TANK, color=(0.8, 0.9, 0.95))

    low_x, low_y, floor = tank.low
    scene.fluid(
        "water",
        size=COLUMN,
        position=(low_x + COLUMN[0] / 2, low_y + COLUMN[1] / 2, floor + COLUMN[2] / 2),
        spacing=0.03,
        container=tank,
        speed_of_sound=30.0,
    )

    steel = scene.material("steel", density=7850.0, friction=0.3, color=(0.5, 0.5, 0.52))
    for row in range(2):
        for col in range(3):
            y = -0.12 + 0.12 * col + (0.06 if row else 0.0)
            if abs(y) > 0.15:
                continue
            scene.cylinder(
                f"post_{row}_{col}",
                radius=0.02,
                height=0.3,
                position=(0.2 + 0.2 * row, y, tank.floor + 0.15),
                static=True,
                material=steel,
            )

    scene.light("sun", "distant", direction=(-0.4, 0.6, -1.0), intensity=1800.0)
    scene.light("sky", "dome", intensity=300.0, color=(0.85, 0.9, 1.0))
    scene.camera("side", eye=(0.0, -2.6, 0.9), target=(0.0, 0.0, 0.25), width=960, height=540)
