"""Pendulum knocks a wooden box off a table.

Asked for: A pendulum swings and knocks a wooden box off a table.

What must happen:
- The pendulum swings on its hinge.
- always[0.1, 0.4] (rests_on(wooden_box, table))
- The bob of the pendulum hits the wooden box.
- eventually[0.4, 1.5] (crosses(wooden_box, x, at 0.5 m))
- At the end the wooden box lies on the ground, off the table.
"""

from wsim.scene import Scene


def build(scene: Scene) -> None:
    """Author the world."""
    # Assumed: pendulum: 1 m from pivot to bob, a steel bob of 16.7 kg, released from
    #   rest at 45 degrees; speed at the bottom about 2.4 m/s (the box of 4 kg leaves
    #   the blow at about 2 m/s, which carries it past the edge 0.16 m ahead against
    #   friction)
    # Assumed: pivot: a hinge to the world at (0.05, 0, 1.852) without a frame (the
    #   prompt names no stand, and the bob passes 2 cm above the table top)
    # Assumed: table: static (only the box is to be knocked off)

    concrete = scene.material("concrete", friction=0.6, color=(0.55, 0.55, 0.55))
    wood_density = scene.param(
        "wood_density",
        500.0,
        low=250.0,
        high=750.0,
        unit="kg/m^3",
    )
    wood = scene.material(
        "wood",
        density=wood_density,
        friction=0.4,
        restitution=0.05,
        color=(0.72, 0.5, 0.28),
    )
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
        color=(0.8, 0.8, 0.82),
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
        restitution=0.05,
        color=(0.25, 0.28, 0.35),
    )

    scene.ground("ground", material=concrete)
    scene.asset("table", "table", position=(0.0, 0.0, 0.001), static=True)
    scene.box(
        "wooden_box",
        size=(0.2, 0.2, 0.2),
        position=(0.24, 0.0, 0.852),
        material=wood,
    )
    pendulum_rod = scene.cylinder(
        "pendulum_rod",
        radius=0.012,
        height=0.915,
        position=(-0.27527, 0.0, 1.52673),
        rotation_deg=(0.0, 45.0, 0.0),
        material=aluminium,
    )
    pendulum_bob = scene.sphere(
        "pendulum_bob",
        radius=0.08,
        position=(-0.65711, 0.0, 1.14489),
        rotation_deg=(0.0, 45.0, 0.0),
        material=steel,
    )
    scene.joint_revolute(
        "pivot",
        None,
        pendulum_rod,
        anchor=(0.049999, 0.0, 1.851999),
        axis="Y",
    )
    scene.joint_fixed(
        "bob_mount",
        pendulum_rod,
        pendulum_bob,
        anchor=(-0.600541, 0.0, 1.201459),
    )
    scene.camera("side", eye=(0.5, -4.8, 1.4), target=(0.5, 0.0, 0.9))
    scene.simulation(duration=3.0, frame_rate=60.0)


if __name__ == "__main__":
    from wsim import run

    run(build)
