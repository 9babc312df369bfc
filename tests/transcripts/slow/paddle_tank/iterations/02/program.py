"""Paddle makes waves.

Asked for: In a small tank of water, 80 cm long and 20 cm wide, a paddle hinged near the
floor at one end swings to and fro once a second and makes waves.

What must happen:
- eventually[0, 0.5] (reaches(paddle, (-0.2515, 0, 0.166), within 1 cm)) and
  eventually[0.5, 1] (reaches(paddle, (-0.3085, 0, 0.166), within 1 cm)) and
  eventually[1, 1.5] (reaches(paddle, (-0.2515, 0, 0.166), within 1 cm)) and
  eventually[1.5, 2] (reaches(paddle, (-0.3085, 0, 0.166), within 1 cm))
- eventually[2, 2.5] (reaches(paddle, (-0.2515, 0, 0.166), within 1 cm)) and
  eventually[2.5, 3] (reaches(paddle, (-0.3085, 0, 0.166), within 1 cm)) and
  eventually[3, 3.5] (reaches(paddle, (-0.2515, 0, 0.166), within 1 cm)) and
  eventually[3.5, 4] (reaches(paddle, (-0.3085, 0, 0.166), within 1 cm))
- the water stays in the tank
"""

from math import pi, radians, sin

from wsim.scene import Drive, Scene

SWING = radians(15.0)  # to either side of upright [rad]
PERIOD = 1.0  # of a swing to and fro [s]


def build(scene: Scene) -> None:
    """Author the world."""
    # Assumed: paddle: 12 cm wide, 22 cm high, hinged 4 cm above the tank's floor, 12 cm
    #   from its end, swings by 15 deg each way (3.2 spacings (4 cm) from floor and
    #   walls, also when it leans; it moves the surface by 3 cm each way)
    # Assumed: water: 15 cm deep, 12,288 particles (waves of 1 Hz are then 1.1 m long
    #   and a centimetre or so high; the height of a wave is no objective, since none of
    #   the kinds measures it)

    concrete = scene.material("concrete", friction=0.6, color=(0.5, 0.5, 0.52))
    glass = scene.material("glass", friction=0.4, color=(0.8, 0.9, 0.95), opacity=0.2)
    acrylic_density = scene.param(
        "acrylic_density",
        1200.0,
        low=600.0,
        high=1800.0,
        unit="kg/m^3",
    )
    acrylic = scene.material(
        "acrylic",
        density=acrylic_density,
        friction=0.4,
        color=(0.75, 0.08, 0.05),
    )

    scene.ground("ground", material=concrete)
    tank = scene.tank("tank", inner_size=(0.8, 0.2, 0.3), material=glass)
    scene.fluid(
        "water",
        fills=tank,
        level=0.15,
        spacing=0.0125,
        viscosity=0.001,
        density=1000.0,
        color=(0.15, 0.4, 0.75),
    )
    paddle = scene.box(
        "paddle",
        size=(0.025, 0.12, 0.22),
        position=(-0.28, 0.0, 0.17),
        material=acrylic,
    )
    scene.joint_revolute(
        "paddle_hinge",
        None,
        paddle,
        anchor=(-0.28, 0.0, 0.06),
        axis="Y",
        drive=Drive(stiffness=50.0, damping=1.0, max_force=20.0),
    )
    scene.camera("side", eye=(0.0, -1.35, 0.45), target=(0.0, 0.0, 0.16))
    scene.simulation(duration=4.0, frame_rate=24.0)


def control(world, t):
    """Swing the paddle to and fro: the target of its hinge [rad]."""
    world.joint("paddle_hinge").target = SWING * sin(2.0 * pi * t / PERIOD)


if __name__ == "__main__":
    from wsim import run

    run(build)
