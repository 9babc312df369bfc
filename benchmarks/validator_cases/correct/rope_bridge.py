"""A plank bridge: planks on ball joints between two posts, with a weight dropped on it."""

from itertools import pairwise

from wsim.scene import Handle, Scene

PLANKS = 9
LENGTH = 0.28
GAP = 0.02
HEIGHT = 1.0
half = PLANKS * (LENGTH + GAP) / 2


def plank_x(i: int) -> float:
    return -half + (i + 0.5) * (LENGTH + GAP)


def build(scene: Scene) -> None:
    scene.simulation(duration=5.0, frame_rate=60.0)
    scene.ground()
    posts: dict[str, Handle] = {}
    for side, x in (("back", -half - 0.1), ("front", half + 0.1)):
        posts[side] = scene.box(f"post_{side}", size=(0.15, 0.6, HEIGHT), position=(x, 0, HEIGHT / 2), static=True)

    planks: list[Handle] = []
    for i in range(PLANKS):
        planks.append(
            scene.box(f"plank_{i}", size=(LENGTH, 0.5, 0.03), position=(plank_x(i), 0, HEIGHT), density=500, friction=0.7)
        )

    scene.joint_revolute("end_back", posts["back"], planks[0], anchor=(-half, 0, HEIGHT), axis="Y")
    for i, (one, after) in enumerate(pairwise(planks)):
        x = (plank_x(i) + plank_x(i + 1)) / 2
        scene.joint_revolute(f"hinge_{i}", one, after, anchor=(x, 0, HEIGHT), axis="Y", limits_deg=(-60, 60))
    scene.joint_revolute("end_front", posts["front"], planks[-1], anchor=(half, 0, HEIGHT), axis="Y")

    weight = scene.param("weight", 8.0, low=1.0, high=30.0, unit="kg")
    scene.box("weight", size=(0.2, 0.2, 0.2), position=(0, 0, HEIGHT + 0.4), mass=weight, color=(0.3, 0.3, 0.35))
    scene.camera("side", eye=(0, -4.5, 1.6), target=(0, 0, 0.8))
