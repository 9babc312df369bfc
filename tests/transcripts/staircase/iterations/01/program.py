"""A bouncy ball bounces down a staircase.

Asked for: a bouncy ball goes bonk bonk bonk down a big staircase

What must happen:
- ordered(touches(ball, step_1, 3 cm), touches(ball, step_2, 3 cm), touches(ball,
  step_3, 3 cm), touches(ball, step_4, 3 cm), touches(ball, step_5, 3 cm), touches(ball,
  step_6, 3 cm), touches(ball, floor, 3 cm))
- bounces_to(ball, step_1, 0.32 m, 0.08 m)
- bounces_to(ball, step_2, 0.32 m, 0.08 m)
- bounces_to(ball, step_4, 0.32 m, 0.08 m)
- finally (crosses(ball, x, 3 m))
"""

from wsim.scene import Scene


def build(scene: Scene) -> None:
    """Author the world."""
    # Assumed: staircase: six steps of 0.25 m rise and 0.5 m depth, the top one 1 m deep
    #   (big; no size is stated)
    # Assumed: ball: restitution 0.75, 0.84 m/s forward with the spin of rolling (so the
    #   steady bounce of 0.6 s takes it one step further each time: v = 0.5 m / 0.597 s)

    stone = scene.material(
        "stone",
        friction=0.7,
        restitution=0.95,
        color=(0.55, 0.6, 0.55),
    )
    stone_2 = scene.material(
        "stone_2",
        friction=0.7,
        restitution=0.95,
        color=(0.72, 0.68, 0.6),
    )
    stone_3 = scene.material(
        "stone_3",
        friction=0.7,
        restitution=0.95,
        color=(0.6, 0.56, 0.5),
    )
    rubber_density = scene.param(
        "rubber_density",
        300.0,
        low=150.0,
        high=450.0,
        unit="kg/m^3",
    )
    rubber = scene.material(
        "rubber",
        density=rubber_density,
        friction=0.7,
        restitution=0.75,
        rolling=0.02,
        color=(0.9, 0.2, 0.15),
    )

    scene.ground("floor", material=stone)
    scene.box(
        "step_1",
        size=(0.998, 1.6, 1.498),
        position=(0.0, 0.0, 0.751),
        static=True,
        material=stone_2,
    )
    scene.box(
        "step_2",
        size=(0.498, 1.6, 1.248),
        position=(0.75, 0.0, 0.626),
        static=True,
        material=stone_3,
    )
    scene.box(
        "step_3",
        size=(0.498, 1.6, 0.998),
        position=(1.25, 0.0, 0.501),
        static=True,
        material=stone_2,
    )
    scene.box(
        "step_4",
        size=(0.498, 1.6, 0.748),
        position=(1.75, 0.0, 0.376),
        static=True,
        material=stone_3,
    )
    scene.box(
        "step_5",
        size=(0.498, 1.6, 0.498),
        position=(2.25, 0.0, 0.251),
        static=True,
        material=stone_2,
    )
    scene.box(
        "step_6",
        size=(0.498, 1.6, 0.248),
        position=(2.75, 0.0, 0.126),
        static=True,
        material=stone_3,
    )
    scene.sphere(
        "ball",
        radius=0.1,
        position=(-0.036, 0.0, 2.171),
        velocity=(0.837, 0.0, 0.0),
        rolling=True,
        material=rubber,
    )
    scene.camera("side", eye=(1.8, -6.5, 2.2), target=(1.8, 0.0, 1.0))
    scene.camera("below", eye=(6.0, -2.5, 2.4), target=(1.6, 0.0, 0.9))
    scene.simulation(duration=5.0, frame_rate=60.0)


if __name__ == "__main__":
    from wsim import run

    run(build)
