"""A crank at 30 rpm drives a slider over 20 cm.

Asked for: A motor turns a crank at 30 rpm and the crank drives a slider back and forth
over 20 cm.

What must happen:
- always[1, 6] (spin_between(crank, y, 170 deg/s, 190 deg/s))
- always (gone_between(slider, x, -20.3 cm, 0.3 cm))
- always[0, 3.4] (eventually[0, 2.5] (gone_between(slider, x, -20.3 cm, -19.7 cm)))
- always[0, 3.4] (eventually[0, 2.5] (gone_between(slider, x, -0.3 cm, 0.3 cm)))
"""

import numpy as np

from wsim.scene import Scene

CRANK_SPEED = np.pi  # rad/s, 30 rpm
CRANK_INERTIA = 0.142  # kg m^2 about its shaft
CRANK_GAIN = 7.0  # N m s/rad, half of the inertia over 0.01 s
RAMP = 0.5  # s


def control(world, t) -> None:
    """Turn the crank at 30 rpm about +Y, from rest within half a second."""
    speed = np.asarray(world.body("crank").angular_velocity)
    target = CRANK_SPEED * min(t / RAMP, 1.0)
    gain_of_speed = CRANK_SPEED / RAMP if t < RAMP else 0.0
    torque = np.zeros((speed.shape[0], 3))
    torque[:, 1] = CRANK_GAIN * (target - speed[:, 1]) + CRANK_INERTIA * gain_of_speed
    world.apply_force("crank", np.zeros_like(torque), torque)


def build(scene: Scene) -> None:
    """Author the world."""
    # Assumed: crank: a balanced disc of 14.5 kg with its pin 10 cm from the shaft (the
    #   stroke is twice 10 cm, and its inertia keeps the speed even)
    # Assumed: rod: 30 cm from pin to pin (three times the crank, in a plane of its own
    #   in front of it)
    # Assumed: start: at the outer dead centre (the slider then goes from 0 to -20 cm
    #   and back)

    floor = scene.material("floor", friction=0.6, color=(0.6, 0.58, 0.55))
    cast_iron = scene.material("cast_iron", friction=0.5, color=(0.3, 0.32, 0.36))
    motor = scene.material("motor", friction=0.5, color=(0.85, 0.45, 0.1))
    aluminium_density = scene.param(
        "aluminium_density",
        2700.0,
        low=1350.0,
        high=4050.0,
        unit="kg/m^3",
    )
    aluminium = scene.material(
        "aluminium",
        density=aluminium_density,
        friction=0.2,
        color=(0.2, 0.5, 0.85),
    )
    aluminium_2_density = scene.param(
        "aluminium_2_density",
        2700.0,
        low=1350.0,
        high=4050.0,
        unit="kg/m^3",
    )
    aluminium_2 = scene.material(
        "aluminium_2",
        density=aluminium_2_density,
        friction=0.2,
        color=(0.8, 0.8, 0.82),
    )
    steel_density = scene.param(
        "steel_density",
        7850.0,
        low=3925.0,
        high=11775.0,
        unit="kg/m^3",
    )
    steel = scene.material(
        "steel",
        density=steel_density,
        friction=0.2,
        color=(0.75, 0.2, 0.15),
    )

    scene.ground("ground", material=floor)
    scene.box(
        "motor_block",
        size=(0.1, 0.08, 0.346),
        position=(0.0, 0.08, 0.175),
        static=True,
        material=cast_iron,
    )
    scene.cylinder(
        "motor",
        radius=0.05,
        height=0.08,
        position=(0.0, 0.08, 0.4),
        rotation_deg=(90.0, 0.0, 0.0),
        static=True,
        material=motor,
    )
    scene.box(
        "rail",
        size=(0.32, 0.04, 0.04),
        position=(0.32, 0.0, 0.345),
        static=True,
        material=cast_iron,
    )
    scene.box(
        "rail_post_near",
        size=(0.03, 0.04, 0.32),
        position=(0.18, 0.0, 0.162),
        static=True,
        material=cast_iron,
    )
    scene.box(
        "rail_post_far",
        size=(0.03, 0.04, 0.32),
        position=(0.46, 0.0, 0.162),
        static=True,
        material=cast_iron,
    )
    slider = scene.box(
        "slider",
        size=(0.1, 0.04, 0.06),
        position=(0.4, 0.0, 0.4),
        material=aluminium,
    )
    rod = scene.box(
        "rod",
        size=(0.34, 0.02, 0.03),
        position=(0.25, -0.04, 0.4),
        material=aluminium_2,
    )
    crank = scene.cylinder(
        "crank",
        radius=0.14,
        height=0.03,
        position=(0.0, 0.0, 0.4),
        rotation_deg=(90.0, 0.0, 0.0),
        material=steel,
    )
    scene.joint_prismatic("guide", None, slider, anchor=(0.4, 0.0, 0.4), axis="X")
    scene.joint_revolute("wrist", slider, rod, anchor=(0.4, -0.04, 0.4), axis="Y")
    scene.joint_revolute("pin", rod, crank, anchor=(0.1, 0.0, 0.4), axis="Y")
    scene.joint_revolute("shaft", None, crank, anchor=(0.0, 0.0, 0.4), axis="Y")
    scene.camera("side", eye=(0.2, -1.3, 0.6), target=(0.2, 0.0, 0.33))
    scene.simulation(duration=6.0, frame_rate=24.0)


if __name__ == "__main__":
    from wsim import run

    run(build)
