"""A steel marble rolls down a gutter, through a loop, round a helix and into a bowl-shaped hollow, where it stays."""

import math

from wsim.scene import Scene


def build(scene: Scene) -> None:
    scene.simulation(duration=9.0, frame_rate=30.0)
    scene.ground()
    steel = scene.material("steel", density=7800.0, friction=0.3, restitution=0.3, color=(0.55, 0.57, 0.6))
    wood = scene.material("wood", friction=0.3, color=(0.5, 0.3, 0.12))

    down, ring = 0.9, 0.2
    run = scene.track(
        "run",
        pieces=[
            ("line", down), ("up", 0.4, 30.0), ("line", 0.3), ("loop", ring, 0.16), ("line", 0.3),
            ("down", 0.4, 5.0), ("left", 0.4, 450.0), ("line", 0.15),
        ],
        start=(-1.0, 0.0, 1.15),
        slope_deg=-30.0,
        profile="round",
        width=0.1,
        wall=0.04,
        thickness=0.008,
        material=wood,
    )  # fmt: skip

    # The marble leaves the run and falls into a hollow of the ground below its end.
    x, y, _ = run.end
    hollow = (x + 0.12 * run.direction(run.length)[0], y + 0.12 * run.direction(run.length)[1])

    def height(east: float, north: float) -> float:
        return 0.12 * (1.0 - math.exp(-(east**2 + north**2) / 0.08))

    scene.height_field("hollow", heights=height, size=(1.4, 1.4), cells=(56, 56), thickness=0.05,
                       position=(hollow[0], hollow[1], 0.06), friction=0.3, color=(0.25, 0.4, 0.2))  # fmt: skip
    scene.sphere("marble", radius=0.02, position=run.place(0.03, 0.02), material=steel)
    scene.light("sun", direction=(-0.4, 0.6, -1.0))
    scene.camera("side", eye=(0.6, -2.6, 1.4), target=(0.3, 0.2, 0.5))


if __name__ == "__main__":
    from wsim import run

    run(build)
