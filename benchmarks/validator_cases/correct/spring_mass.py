"""A mass on a spring and damper along Z, modelled as a sliding joint with a position drive."""

from wsim.scene import Drive, Scene

MASS = 2.0  # kg
G = 9.81


def build(scene: Scene) -> None:
    scene.simulation(duration=5.0, frame_rate=100.0)
    scene.ground()
    k = scene.param("stiffness", 80.0, low=20.0, high=400.0, unit="N/m")
    c = scene.param("damping", 0.8, low=0.0, high=20.0, unit="N s/m")
    sag = MASS * G / k

    ceiling = scene.box("ceiling", size=(0.6, 0.6, 0.04), position=(0, 0, 2.0), static=True)
    weight = scene.box("weight", size=(0.15, 0.15, 0.15), position=(0, 0, 1.2), mass=MASS, color=(0.1, 0.3, 0.7))
    scene.joint_prismatic(
        "spring",
        ceiling,
        weight,
        axis="Z",
        limits=(-1.0, 0.6),
        drive=Drive(position=0.0, stiffness=k, damping=c),
    )
    print(f"static sag {sag:.3f} m")
    scene.camera("side", eye=(0, -3, 1.2), target=(0, 0, 1.2))
