"""A pendulum swings over a table; the names come from constants and a helper."""
from wsim.scene import Scene

BOB, ROD = "bob", "rod"


def named(*parts: str) -> str:
    return "_".join(parts)


def build(scene: Scene) -> None:
    scene.simulation(duration=5.0)
    scene.ground("ground")
    scene.asset("table", "table", position=(0, 0, 0), static=True)
    rod = scene.box(ROD, size=(0.02, 0.02, 0.6), position=(0.0, 0.0, 1.6), rotation_deg=(0, 0, 0), density=2700)
    bob = scene.sphere(BOB, radius=0.08, position=(0.0, 0.0, 1.3), density=7850)
    scene.joint_revolute("pivot", None, rod, anchor=(0, 0, 1.9), axis="Y")
    scene.joint_fixed(named("rod", "bob"), rod, bob)
    scene.box(named("target", "box"), size=(0.1, 0.1, 0.1), position=(0.3, 0, 0.85), density=300)
    scene.camera("side", eye=(0, -3, 1.4), target=(0, 0, 1.2))
