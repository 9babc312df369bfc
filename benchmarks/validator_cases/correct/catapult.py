"""A lever catapult: a heavy counterweight falls on the short arm and throws a ball."""
from typing import Final

from wsim.scene import Scene

ARM_LENGTH: Final = 1.6
PIVOT_HEIGHT: Final[float] = 0.5
PIVOT_OFFSET: float = 0.4


def build(scene: Scene) -> None:
    scene.simulation(duration=3.0, frame_rate=60.0)
    scene.ground(color=(0.25, 0.35, 0.2), friction=0.8)

    oak = scene.material("oak", density=720.0, friction=0.6, color=(0.38, 0.20, 0.08))
    iron = scene.material("iron", density=7200.0, friction=0.5, color=(0.15, 0.15, 0.17))

    base = scene.box("base", size=(0.1, 0.3, PIVOT_HEIGHT), position=(PIVOT_OFFSET, 0, PIVOT_HEIGHT / 2), static=True, material=oak)
    arm = scene.box("arm", size=(ARM_LENGTH, 0.12, 0.05), position=(0, 0, PIVOT_HEIGHT + 0.06), material=oak)
    scene.joint_revolute("pivot", base, arm, anchor=(PIVOT_OFFSET, 0, PIVOT_HEIGHT + 0.06), axis=(0, 1, 0), limits_deg=(-70, 20))

    scene.sphere("projectile", radius=0.05, position=(-ARM_LENGTH / 2 + 0.06, 0, PIVOT_HEIGHT + 0.14), mass=0.3, color=(0.9, 0.6, 0.1))
    drop = scene.param("drop_height", 0.6, low=0.2, high=2.0, unit="m")
    scene.box(
        "counterweight",
        size=(0.22, 0.22, 0.22),
        position=(ARM_LENGTH / 2 - 0.1, 0, PIVOT_HEIGHT + 0.09 + 0.11 + drop),
        material=iron,
    )

    target = scene.cylinder("target", radius=0.1, height=0.6, position=(-3.0, 0, 0.3), density=300, friction=0.5)
    assert target.kind == "body"
    scene.camera("wide", eye=(-1, -6, 2), target=(-1, 0, 0.7), fov=60)
