"""A gate opens after a second; a ball rolls down and knocks a skittle over, and that touch lets a weight go.

What happens in time is scheduled: no `control` is needed, a sweep may change the numbers, and the judge knows them.
"""

import math

from wsim.scene import Event, Scene

SLOPE = 15.0  # [deg]
RADIUS = 0.1  # of the ball [m]
MIDDLE, THICK = (-1.0, 0.62), 0.1  # of the chute: x and z, and its thickness [m]


def build(scene: Scene) -> None:
    scene.simulation(duration=4.0, frame_rate=60.0)
    wood = scene.material("wood", density=600.0, friction=0.5, color=(0.5, 0.27, 0.11))
    steel = scene.material("steel", density=7850.0, friction=0.3, color=(0.45, 0.47, 0.5))
    rubber = scene.material("rubber", density=1200.0, friction=0.6, color=(0.7, 0.08, 0.04))
    beech = scene.material("beech", density=500.0, friction=0.5, color=(0.8, 0.65, 0.35))
    scene.ground()

    x, z = MIDDLE
    scene.box(
        "chute",
        size=(2.0, 0.5, THICK),
        position=(x, 0.0, z),
        rotation_deg=(0.0, SLOPE, 0.0),
        static=True,
        material=wood,
    )
    slope, up = math.radians(SLOPE), 0.62  # where the ball waits, up the slope from the chute's middle [m]
    off = 0.5 * THICK + RADIUS
    ball = (x - up * math.cos(slope) + off * math.sin(slope), 0.0, z + up * math.sin(slope) + off * math.cos(slope))
    scene.sphere("ball", radius=RADIUS, position=ball, material=rubber)

    lifts, waits = scene.param("lift_speed", 0.5, low=0.2, high=1.0, unit="m/s"), scene.param("waits", 1.0, unit="s")
    scene.box(
        "gate", size=(0.04, 0.4, 0.4), position=(ball[0] + RADIUS + 0.022, 0.0, 1.0), kinematic=True, material=steel
    )
    scene.schedule("open", "gate", "velocity", times=(waits, waits + 0.8), values=((0.0, 0.0, lifts), (0.0, 0.0, 0.0)))

    scene.box("skittle", size=(0.1, 0.14, 0.4), position=(0.9, 0.0, 0.2), material=beech)
    scene.sphere("weight", radius=0.06, position=(0.9, 0.5, 1.4), mass=1.0, material=steel)
    hook = scene.joint_fixed("hook", None, "weight")
    scene.schedule("drop", hook, "release", times=(0.0,), after=Event(touch=("ball", "skittle"), delay=0.2))

    scene.light("sun", direction=(-0.4, 0.6, -1.0))
    scene.camera("side", eye=(-0.3, -4.2, 1.4), target=(-0.3, 0.0, 0.7))


if __name__ == "__main__":
    from wsim import run

    run(build)
