"""Ball, ramp, seesaw and a cube thrown onto a shelf.

Asked for: A ball rolls down a ramp and off its end, lands on one side of a seesaw, and
a small cube that lay on the other side is thrown up and comes to rest on a shelf beside
it.

What must happen:
- The ball rolls down the ramp and off its end.
- The ball lands on the seesaw.
- The side on which the ball lands goes down.
- always[0, 0.8] (stays_within(cube, (0.688, 0, 0.086), radius 0.05 m))
- eventually[0.8, 2.2] (crosses(cube, z, at 0.64 m))
- The cube rests on the shelf at the end.
- The cube is still at the end.
"""

from wsim.scene import Scene


def build(scene: Scene) -> None:
    """Author the world."""
    # Assumed: seesaw: a light 1.6 m plank on a fulcrum, not the catalogue's seesaw (its
    #   mass, hinge and tilt decide the throw and must be known)
    # Assumed: ball: 4 kg, landing 0.45 m from the pivot, the cube 0.108 kg at 0.7 m
    #   (the cube must leave with at least 3 m/s)
    # Assumed: stop: a block under the left arm ends the stroke near level (further, the
    #   throw would be turned back over the pivot, away from the shelf)
    # Assumed: shelf: 0.7 m deep board at 0.55 m with a back, from x = 0.90 m (the
    #   cube's drift is 0.3 to 0.8 m)

    floor = scene.material("floor", friction=0.6, color=(0.55, 0.55, 0.52))
    wood = scene.material("wood", friction=0.6, color=(0.72, 0.5, 0.28))
    wood_2 = scene.material("wood_2", friction=0.5, color=(0.5, 0.35, 0.2))
    stone_density = scene.param(
        "stone_density",
        2784.0,
        low=1392.0,
        high=4176.0,
        unit="kg/m^3",
    )
    stone = scene.material(
        "stone",
        density=stone_density,
        friction=0.6,
        color=(0.8, 0.15, 0.12),
    )
    steel = scene.material("steel", friction=0.5, color=(0.35, 0.37, 0.4))
    balsa_density = scene.param(
        "balsa_density",
        160.0,
        low=80.0,
        high=240.0,
        unit="kg/m^3",
    )
    balsa = scene.material(
        "balsa",
        density=balsa_density,
        friction=0.4,
        color=(0.9, 0.78, 0.5),
    )
    foam_density = scene.param(
        "foam_density",
        150.0,
        low=75.0,
        high=225.0,
        unit="kg/m^3",
    )
    foam = scene.material(
        "foam",
        density=foam_density,
        friction=0.5,
        color=(0.6, 0.45, 0.25),
    )
    rubber = scene.material("rubber", friction=0.8, color=(0.2, 0.2, 0.22))
    wood_3_density = scene.param(
        "wood_3_density",
        500.0,
        low=250.0,
        high=750.0,
        unit="kg/m^3",
    )
    wood_3 = scene.material(
        "wood_3",
        density=wood_3_density,
        friction=0.4,
        color=(0.15, 0.4, 0.85),
    )
    felted_wood = scene.material("felted_wood", friction=0.9, color=(0.3, 0.6, 0.35))
    wood_4 = scene.material("wood_4", friction=0.6, color=(0.25, 0.45, 0.3))

    scene.ground("ground", material=floor)
    scene.box(
        "ramp",
        size=(0.8, 0.3, 0.04),
        position=(-1.2136, 0.0, 1.0352),
        rotation_deg=(0.0, 15.0, 0.0),
        static=True,
        material=wood,
    )
    scene.box(
        "ramp_post",
        size=(0.06, 0.3, 1.003),
        position=(-1.2136, 0.0, 0.5015),
        static=True,
        material=wood_2,
    )
    scene.sphere(
        "ball",
        radius=0.07,
        position=(-1.2385, 0.0, 1.1365),
        mass=4.0,
        material=stone,
    )
    fulcrum = scene.box(
        "fulcrum",
        size=(0.06, 0.24, 0.19),
        position=(0.0, 0.0, 0.095),
        static=True,
        material=steel,
    )
    seesaw = scene.box(
        "seesaw",
        size=(1.6, 0.24, 0.03),
        position=(0.0, 0.0, 0.223),
        rotation_deg=(0.0, 15.0, 0.0),
        material=balsa,
    )
    lip = scene.box(
        "lip",
        size=(0.03, 0.2, 0.08),
        position=(-0.1787, 0.0, 0.3289),
        rotation_deg=(0.0, 15.0, 0.0),
        material=foam,
    )
    scene.box(
        "stop",
        size=(0.1, 0.24, 0.168),
        position=(-0.7, 0.0, 0.084),
        static=True,
        material=rubber,
    )
    scene.box(
        "cube",
        size=(0.06, 0.06, 0.06),
        position=(0.688, 0.0, 0.0862),
        rotation_deg=(0.0, 15.0, 0.0),
        mass=0.108,
        material=wood_3,
    )
    scene.box(
        "shelf",
        size=(0.7, 0.4, 0.03),
        position=(1.25, 0.0, 0.535),
        static=True,
        material=felted_wood,
    )
    scene.box(
        "shelf_back",
        size=(0.04, 0.4, 0.9),
        position=(1.622, 0.0, 0.45),
        static=True,
        material=wood_4,
    )
    scene.joint_revolute("pivot", fulcrum, seesaw, anchor=(0.0, 0.0, 0.223), axis="Y")
    scene.joint_fixed("lip_fix", seesaw, lip, anchor=(-0.189182, 0.0, 0.28978))
    scene.camera("side", eye=(0.0, -4.5, 1.2), target=(0.0, 0.0, 0.6))
    scene.camera("corner", eye=(1.8, -4.5, 1.9), target=(0.0, 0.0, 0.5))
    scene.simulation(duration=3.0, frame_rate=60.0)


if __name__ == "__main__":
    from wsim import run

    run(build)
