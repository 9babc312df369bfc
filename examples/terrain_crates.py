"""Three crates are set down on hilly ground: the rough ones stay on the slope, the smooth one slides to its foot."""

import math

from wsim.scene import Scene


def height(x: float, y: float) -> float:
    """A hill with a valley around it [m]."""
    return 0.5 * math.exp(-(x * x + y * y) / 0.5) + 0.1 * (x * x + y * y)


def build(scene: Scene) -> None:
    scene.simulation(duration=5.0, frame_rate=30.0)
    scene.height_field("hill", heights=height, size=(4.0, 4.0), cells=(80, 80), friction=0.8, color=(0.3, 0.42, 0.2))
    wood = scene.material("wood", density=500.0, friction=0.8, color=(0.55, 0.35, 0.15))
    ice = scene.material("ice", density=917.0, friction=0.15, color=(0.7, 0.85, 0.95))
    edge = 0.2
    for k, (turn, material) in enumerate(((0.0, wood), (120.0, wood), (240.0, ice))):
        way = math.radians(turn)
        far = 0.5
        rise = (height(far + 1e-4, 0.0) - height(far - 1e-4, 0.0)) / 2e-4
        lean = math.atan(-rise)
        off = far + edge / 2 * math.sin(lean)
        scene.box(
            f"crate_{k}",
            size=(edge, edge, edge),
            position=(off * math.cos(way), off * math.sin(way), height(far, 0.0) + edge / 2 * math.cos(lean) + 0.005),
            rotation_deg=(0.0, math.degrees(lean), turn),
            material=material,
        )
    scene.light("sun", direction=(-0.4, 0.6, -1.0))
    scene.camera("side", eye=(0.6, -3.6, 2.2), target=(0.0, 0.0, 0.2))


if __name__ == "__main__":
    from wsim import run

    run(build)
