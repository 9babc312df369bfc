"""A double pendulum let go with both arms held out level."""

from wsim.scene import Scene

ARM = 0.5  # [m]
PIVOT = 1.6  # height [m]


def build(scene: Scene) -> None:
    scene.simulation(duration=5.0, frame_rate=60.0)
    scene.ground()
    density = scene.param("arm_density", 2700.0, low=500.0, high=8000.0, unit="kg/m^3")
    aluminium = scene.material("aluminium", density=density, color=(0.1, 0.2, 0.45))
    upper = scene.box("upper", size=(ARM, 0.04, 0.04), position=(ARM / 2, 0.0, PIVOT), material=aluminium)
    lower = scene.box("lower", size=(ARM, 0.04, 0.04), position=(1.5 * ARM, 0.0, PIVOT), material=aluminium)
    scene.joint_revolute("shoulder", None, upper, anchor=(0.0, 0.0, PIVOT), axis="Y")
    scene.joint_revolute("elbow", upper, lower, anchor=(ARM, 0.0, PIVOT), axis="Y")

    scene.light("sun", direction=(-0.4, 0.6, -1.0))
    scene.camera("side", eye=(0.0, -4.5, 1.5), target=(0.0, 0.0, 1.2))


if __name__ == "__main__":
    from wsim import run

    run(build)
