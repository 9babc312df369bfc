"""A parallelogram lift: closed loops of revolute joints driven by one prismatic actuator."""
from wsim.scene import Scene, Drive

ARM = 0.6
BASE_Z = 0.3
OFFSETS = {"near": -0.2, "far": 0.2}


def build(scene: Scene) -> None:
    scene.simulation(duration=4.0, frame_rate=60.0)
    scene.ground()
    stand = scene.box("stand", size=(0.6, 0.3, BASE_Z), position=(0.0, 0.0, BASE_Z / 2), static=True)

    arms = {}
    for (label, x), y in zip(OFFSETS.items(), (0.2, -0.2)):
        arms[label] = scene.box(f"arm_{label}", size=(0.05, 0.03, ARM), position=(x, y, BASE_Z + ARM / 2 + 0.02), mass=1.0)
    top = BASE_Z + ARM + 0.02
    platform = scene.box("platform", size=(0.7, 0.3, 0.04), position=(0.0, 0.0, top + 0.03), mass=2.0)

    near, far = arms.values()
    servo = Drive(position=20.0, stiffness=200.0, damping=20.0)
    foot, head = BASE_Z + 0.02, top
    scene.joint_revolute(
        "foot_near", stand, near, anchor=(OFFSETS["near"], 0.2, foot), axis="Y", limits_deg=(-45.0, 45.0)
    )
    scene.joint_revolute("head_near", near, platform, anchor=(OFFSETS["near"], 0.2, head), axis="Y", drive=servo)
    # One chain round, closed at the stand by a hinge that is free.
    for name, parent, z in (("head_far", platform, head), ("foot_far", None, foot)):
        scene.joint_revolute(name, parent, far, anchor=(OFFSETS["far"], -0.2, z), axis="Y")
    load = scene.param("load", 3.0, low=0.5, high=10.0, unit="kg")
    scene.cylinder("load", radius=0.08, height=0.12, position=(0.0, 0.0, top + 0.12), mass=load, friction=0.9)
    scene.camera("side", eye=(0.0, -3.0, 1.0), target=(0.0, 0.0, 0.6))
