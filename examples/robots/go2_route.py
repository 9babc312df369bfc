"""A robot dog walks round a crate, from one way-point to the next, and looks at the crate at the end."""

from __future__ import annotations

from wsim.scene import Scene

SPEED = 0.5  # [m/s]
# x, y [m], and where it matters how it stands there [deg]
ROUTE = ((1.6, 0.0), (1.6, 1.6), (0.0, 1.6, -45.0))


def build(scene: Scene) -> None:
    scene.simulation(duration=12.0, frame_rate=50.0)
    scene.ground()
    scene.box("crate", size=(0.4, 0.4, 0.4), position=(0.8, 0.8, 0.2), mass=8.0, color=(0.6, 0.4, 0.2))
    dog = scene.robot("go2")
    scene.policy("walk", dog, "go2_walk", route=ROUTE, speed=SPEED)
    scene.camera("above", eye=(-1.8, -2.6, 2.6), target=(0.8, 0.8, 0.2))


if __name__ == "__main__":
    from wsim import run

    run(build)
