"""Plank catapult throws a ball over a low wall.

Asked for: A catapult: a heavy weight falls on one end of a plank on a pivot and throws
a ball from the other end over a low wall.

What must happen:
- The weight lands on the plank and tilts it.
- touches(ball, plank) then crosses(ball, x, at 1.5 m)
- always[0, 2.4] (never_touches(ball, wall))
- crosses(ball, x, at 1.5 m) then touches(ball, ground)
"""

from wsim.scene import Scene


def build(scene: Scene) -> None:
    """Author the world."""
    # Assumed: arms: the pivot is 0.3 m off the plank's middle: weight arm 0.55 m, ball
    #   arm 0.88 + 0.3 = 1.18 m; hinge stop at 35 deg (the long arm gives the ball about
    #   6 m/s at some 55 deg above the level, so it lands near x = 3.4 m; the long arm's
    #   own weight keeps the plank on its rest before)
    # Assumed: rims: two small rims fixed to the plank hold the ball, the outer one
    #   higher than its centre (without them the ball slides off outwards while the
    #   plank turns)
    # Assumed: rest: a block holds the ball's end of the plank level until the weight
    #   lands (a stroke from level up to 35 deg throws forwards, over the pivot and the
    #   wall)
    # Assumed: friction: 0.9 between weight and plank (tan 35 deg = 0.7: the weight
    #   stays on the plank and holds it down)

    earth = scene.material("earth", friction=0.6, color=(0.45, 0.5, 0.4))
    steel = scene.material("steel", friction=0.5, color=(0.35, 0.37, 0.4))
    wood = scene.material("wood", friction=0.5, color=(0.4, 0.28, 0.16))
    wood_2_density = scene.param(
        "wood_2_density",
        600.0,
        low=300.0,
        high=900.0,
        unit="kg/m^3",
    )
    wood_2 = scene.material(
        "wood_2",
        density=wood_2_density,
        friction=0.9,
        color=(0.72, 0.52, 0.3),
    )
    wood_3_density = scene.param(
        "wood_3_density",
        600.0,
        low=300.0,
        high=900.0,
        unit="kg/m^3",
    )
    wood_3 = scene.material(
        "wood_3",
        density=wood_3_density,
        friction=0.2,
        color=(0.55, 0.36, 0.2),
    )
    light_wood_density = scene.param(
        "light_wood_density",
        400.0,
        low=200.0,
        high=600.0,
        unit="kg/m^3",
    )
    light_wood = scene.material(
        "light_wood",
        density=light_wood_density,
        friction=0.3,
        color=(0.9, 0.15, 0.1),
    )
    steel_2_density = scene.param(
        "steel_2_density",
        7850.0,
        low=3925.0,
        high=11775.0,
        unit="kg/m^3",
    )
    steel_2 = scene.material(
        "steel_2",
        density=steel_2_density,
        friction=0.9,
        color=(0.2, 0.25, 0.35),
    )
    brick = scene.material("brick", friction=0.6, color=(0.65, 0.3, 0.22))

    scene.ground("ground", material=earth)
    fulcrum = scene.box(
        "fulcrum",
        size=(0.02, 0.24, 0.49),
        position=(0.0, 0.0, 0.245),
        static=True,
        material=steel,
    )
    scene.box(
        "rest",
        size=(0.1, 0.2, 0.499),
        position=(-1.15, 0.0, 0.2495),
        static=True,
        material=wood,
    )
    plank = scene.box(
        "plank",
        size=(2.0, 0.2, 0.04),
        position=(-0.3, 0.0, 0.52),
        material=wood_2,
    )
    rim_outer = scene.box(
        "rim_outer",
        size=(0.02, 0.2, 0.09),
        position=(-1.272, 0.0, 0.586),
        material=wood_3,
    )
    rim_inner = scene.box(
        "rim_inner",
        size=(0.02, 0.2, 0.04),
        position=(-1.088, 0.0, 0.561),
        material=wood_3,
    )
    scene.sphere("ball", radius=0.08, position=(-1.18, 0.0, 0.621), material=light_wood)
    scene.box(
        "weight",
        size=(0.2, 0.2, 0.1),
        position=(0.55, 0.0, 1.29),
        material=steel_2,
    )
    scene.box(
        "wall",
        size=(0.1, 1.2, 0.5),
        position=(1.5, 0.0, 0.25),
        static=True,
        material=brick,
    )
    scene.joint_revolute(
        "pivot",
        fulcrum,
        plank,
        anchor=(0.0, 0.0, 0.5),
        axis="Y",
        limits_deg=(-2.0, 35.0),
    )
    scene.joint_fixed("rim_outer_fix", plank, rim_outer, anchor=(-1.272, 0.0, 0.5405))
    scene.joint_fixed("rim_inner_fix", plank, rim_inner, anchor=(-1.088, 0.0, 0.5405))
    scene.camera("side", eye=(2.2, -9.0, 1.8), target=(2.2, 0.0, 1.1))
    scene.simulation(duration=2.4, frame_rate=24.0)


if __name__ == "__main__":
    from wsim import run

    run(build)
