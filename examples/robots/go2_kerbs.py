"""A robot dog walks over two kerbs, up and down again, of which its policy sees nothing."""

from __future__ import annotations

from wsim.scene import Scene

KERBS = ((0.7, 1.5), (2.1, 2.9))  # where each begins and ends along x [m]


def build(scene: Scene) -> None:
    height = scene.param("height", 0.03, low=0.01, high=0.2, unit="m")
    scene.simulation(duration=6.0, frame_rate=25.0)
    scene.ground()
    for k, (first, last) in enumerate(KERBS):
        size, place = (last - first, 2.0, height), (0.5 * (first + last), 0.0, 0.5 * height)
        scene.box(f"kerb_{k}", size=size, position=place, static=True, color=(0.55, 0.5, 0.45))
    scene.policy("walk", scene.robot("go2"), "go2_walk", command=(0.7, 0.0, 0.0))
    scene.camera("beside", eye=(1.8, -3.2, 0.9), target=(1.8, 0.0, 0.1))
    scene.camera("ahead", eye=(6.4, -2.2, 1.3), target=(2.2, 0.0, 0.2))


if __name__ == "__main__":
    from wsim import run

    run(build)
