from wsim.scene import Scene


def build(scene: Scene) -> None:
    """A double pendulum whose lengths and start angle may be swept."""
    scene.simulation(duration=6.0, frame_rate=60.0, time_step=0.001)
    scene.ground()

    l1 = scene.param("upper_length", 0.5, low=0.2, high=1.0, unit="m")
    l2 = scene.param("lower_length", 0.4, low=0.2, high=1.0, unit="m")
    pivot = (0.0, 0.0, 1.8)

    steel = scene.material("steel", density=7800.0, friction=0.3, color=(0.55, 0.56, 0.58))
    upper = scene.capsule("upper", radius=0.015, height=l1, axis="X", position=(l1 / 2, 0.0, pivot[2]), material=steel)
    lower = scene.capsule(
        "lower", radius=0.015, height=l2, axis="X", position=(l1 + l2 / 2, 0.0, pivot[2]), material="steel"
    )
    bob = scene.sphere("bob", radius=0.05, position=(l1 + l2, 0.0, pivot[2]), mass=1.0, color=(0.8, 0.1, 0.1))

    scene.joint_revolute("shoulder", None, upper, anchor=pivot, axis="Y")
    scene.joint_revolute("elbow", upper, lower, anchor=(l1, 0.0, pivot[2]), axis="Y")
    scene.joint_fixed("weld", lower, bob)

    scene.camera("side", eye=(0.0, -4.0, 1.5), target=(0.0, 0.0, 1.2))
