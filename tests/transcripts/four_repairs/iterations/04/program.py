"""Crank-slider: a 10 cm crank drives a piston over a 30 cm rod.

Asked for: A crank of 10 cm, turned at one revolution per second, moves a piston back
and forth over a connecting rod of 30 cm.

What must happen:
- always[0.3, 3] (speed_between(crank, 0.27 m/s, 0.36 m/s))
- eventually[0.35, 0.65] (reaches(crank, (-0.05, 0, 0.05), within 2 cm)) and
  eventually[0.85, 1.15] (reaches(crank, (0.05, 0, 0.05), within 2 cm)) and
  eventually[1.35, 1.65] (reaches(crank, (-0.05, 0, 0.05), within 2 cm)) and
  eventually[1.85, 2.15] (reaches(crank, (0.05, 0, 0.05), within 2 cm))
- eventually[0.35, 0.65] (reaches(piston, (0.2, 0, 0.035), within 1 cm)) and
  eventually[0.85, 1.15] (reaches(piston, (0.4, 0, 0.035), within 1 cm)) and
  eventually[1.35, 1.65] (reaches(piston, (0.2, 0, 0.035), within 1 cm)) and
  eventually[1.85, 2.15] (reaches(piston, (0.4, 0, 0.035), within 1 cm)) and
  eventually[2.35, 2.65] (reaches(piston, (0.2, 0, 0.035), within 1 cm))
- always[0, 3] (stays_within(piston, (0.3, 0, 0.035), radius 0.11 m))
- eventually[0.1, 0.4] (reaches(rod, (0.141, 0.05, 0.075), within 3 cm)) and
  eventually[0.6, 0.9] (reaches(rod, (0.141, -0.05, 0.075), within 3 cm)) and
  eventually[0.85, 1.15] (reaches(rod, (0.25, 0, 0.075), within 3 cm))
"""

import numpy as np

from wsim.scene import Scene


def build(scene: Scene) -> None:
    """Author the world."""
    # Assumed: plane of motion: horizontal, hinges about Z (gravity then does not load
    #   the motor, and the crank's speed stays even)
    # Assumed: lengths: 10 cm and 30 cm are between the pins; the bars reach 1 to 1.5 cm
    #   past them (the lengths of a mechanism are those between its joints)
    # Assumed: bearings: the crank's bearing and the piston's guide are joints to the
    #   world, with no body (the prompt names only crank, rod and piston)
    # Assumed: start: outer dead centre, at rest (all links lie along X, and the loop
    #   closes exactly)

    concrete = scene.material("concrete", friction=0.5, color=(0.55, 0.55, 0.55))
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
        friction=0.3,
        color=(0.2, 0.4, 0.85),
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
        friction=0.3,
        color=(0.9, 0.75, 0.2),
    )
    steel_density = scene.param(
        "steel_density",
        7800.0,
        low=3900.0,
        high=11700.0,
        unit="kg/m^3",
    )
    steel = scene.material(
        "steel",
        density=steel_density,
        friction=0.3,
        color=(0.8, 0.2, 0.15),
    )

    scene.ground("ground", material=concrete)
    piston = scene.cylinder(
        "piston",
        radius=0.025,
        height=0.06,
        position=(0.4, 0.0, 0.035),
        rotation_deg=(0.0, 90.0, 0.0),
        material=aluminium,
    )
    rod = scene.box(
        "rod",
        size=(0.32, 0.02, 0.02),
        position=(0.25, 0.0, 0.075),
        material=aluminium_2,
    )
    crank = scene.box(
        "crank",
        size=(0.13, 0.04, 0.02),
        position=(0.05, 0.0, 0.05),
        material=steel,
    )
    scene.joint_prismatic("guide", None, piston, anchor=(0.4, 0.0, 0.035), axis="X")
    scene.joint_revolute("wrist_pin", piston, rod, anchor=(0.4, 0.0, 0.0625), axis="Z")
    scene.joint_revolute("crank_pin", rod, crank, anchor=(0.1, 0.0, 0.0625), axis="Z")
    scene.joint_revolute("main_bearing", None, crank, anchor=(0.0, 0.0, 0.05), axis="Z")
    scene.camera("side", eye=(0.16, -0.55, 0.7), target=(0.16, 0.0, 0.05))
    scene.camera("top", eye=(0.16, -0.1, 1.0), target=(0.16, 0.0, 0.05))
    scene.simulation(duration=3.0, frame_rate=24.0)


def control(world, t):
    """Turn the crank."""
    spin = world.body("crank").angular_velocity
    torque = np.zeros((len(spin), 3))
    torque[:, 2] = 0.02 * (2.0 * np.pi - spin[:, 2])
    world.apply_force("crank", np.zeros((len(spin), 3)), torque)


if __name__ == "__main__":
    from wsim import run

    run(build)
