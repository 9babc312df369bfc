"""Four robot dogs in one world, each with its own policy and command."""

from __future__ import annotations

from wsim.scene import Scene


def build(scene: Scene) -> None:
    scene.simulation(duration=8.0, frame_rate=50.0)
    scene.ground()
    ways = {
        "ahead": {"command": (0.6, 0.0, 0.0)},
        "aside": {"command": (0.0, 0.3, 0.0)},
        "round": {"command": (0.4, 0.0, 0.6)},
        "route": {"route": ((1.2, -4.5), (1.2, -3.3, 180.0)), "speed": 0.5},
    }
    for k, (name, told) in enumerate(ways.items()):
        dog = scene.robot(name, "go2", position=(0.0, 3.0 - 2.0 * k - (1.0 if k == 3 else 0.0), 0.0))
        scene.policy(f"walk_{name}", dog, "go2_walk", **told)
    scene.camera("above", eye=(-3.5, -6.5, 3.2), target=(0.8, -0.5, 0.2))


if __name__ == "__main__":
    from wsim import run

    run(build)
