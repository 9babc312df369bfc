"""Newton's cradle: five steel balls on rods, the first one lifted."""

import math

from wsim.scene import Scene

N = 5
R = 0.05
LENGTH = 0.6
TOP = 1.0


def build(scene: Scene) -> None:
    scene.simulation(duration=6.0, frame_rate=120.0, time_step=5e-4)
    scene.ground()
    frame_kw = dict(static=True, color=(0.2, 0.2, 0.22))
    scene.box("beam", size=(1.0, 0.04, 0.04), position=(0, 0, TOP + 0.02), **frame_kw)
    for side, sign in {"left": 1, "right": -1}.items():
        scene.box(f"leg_{side}", size=(0.04, 0.04, TOP), position=(sign * 0.48, 0, TOP / 2), **frame_kw)

    steel = scene.material("steel", density=7850, friction=0.1, restitution=0.98, color=(0.7, 0.7, 0.72))
    lift = math.radians(scene.param("lift_deg", 35.0, low=5.0, high=60.0, unit="deg"))
    for i in range(N):
        x0 = (i - (N - 1) / 2) * 2 * R
        angle = lift if i == 0 else 0.0
        x, z = x0 - LENGTH * math.sin(angle), TOP - LENGTH * math.cos(angle)
        ball = scene.sphere(f"ball_{i}", radius=R, position=(x, 0, z), material=steel)
        scene.joint_revolute(f"hinge_{i}", None, ball, anchor=(x0, 0, TOP), axis="Y")

    scene.camera("front", eye=(0, -2.5, 0.8), target=(0, 0, 0.6), fov=45)
