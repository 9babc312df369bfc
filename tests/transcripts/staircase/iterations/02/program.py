"""A bouncy ball bounces down a staircase.

Asked for: a bouncy ball goes bonk bonk bonk down a big staircase

What must happen:
- ordered(touches(ball, step_1, 3 cm), touches(ball, step_2, 3 cm), touches(ball,
  step_3, 3 cm), touches(ball, step_4, 3 cm), touches(ball, step_5, 3 cm), touches(ball,
  step_6, 3 cm), touches(ball, floor, 3 cm))
- bounces_to(ball, step_1, 0.32 m, 0.08 m)
- bounces_to(ball, step_2, 0.25 m, 0.095 m)
- bounces_to(ball, step_4, 0.25 m, 0.095 m)
- finally[1] (crosses(ball, x, 4.85 m))
"""

from wsim.scene import Scene


def build(scene: Scene) -> None:
    """Author the world."""
    # Assumed: staircase: six steps of 0.25 m rise and 0.8 m depth, the top one longer
    #   (big; deeper than the longest flight, so that no step is left out)
    # Assumed: ball: restitution 0.75, 0.75 m/s forward with the spin of rolling (a
    #   flight of at most 0.65 s goes 0.49 m, 0.3 m less than a tread)
    # Assumed: the plan, changed: With treads of 0.5 m and flights of 0.50 m planned,
    #   the ball left out step_3 (0.06 m beside at 1.75 s) and step_5 (0.18 m at 2.40
    #   s); treads of 0.8 m and 0.75 m/s leave 0.3 m to spare, so each step is touched
    #   whatever the phase. (a world of the plan before it could not be made right)

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
        color=(0.9, 0.2, 0.15),
    )

    scene.ground("floor", material=stone)
    scene.box(
        "step_1",
        size=(1.298, 1.6, 1.498),
        position=(0.15, 0.0, 0.751),
        static=True,
        material=stone_2,
    )
    scene.box(
        "step_2",
        size=(0.798, 1.6, 1.248),
        position=(1.2, 0.0, 0.626),
        static=True,
        material=stone_3,
    )
    scene.box(
        "step_3",
        size=(0.798, 1.6, 0.998),
        position=(2.0, 0.0, 0.501),
        static=True,
        material=stone_2,
    )
    scene.box(
        "step_4",
        size=(0.798, 1.6, 0.748),
        position=(2.8, 0.0, 0.376),
        static=True,
        material=stone_3,
    )
    scene.box(
        "step_5",
        size=(0.798, 1.6, 0.498),
        position=(3.6, 0.0, 0.251),
        static=True,
        material=stone_2,
    )
    scene.box(
        "step_6",
        size=(0.798, 1.6, 0.248),
        position=(4.4, 0.0, 0.126),
        static=True,
        material=stone_3,
    )
    scene.sphere(
        "ball",
        radius=0.1,
        position=(-0.1, 0.0, 2.171),
        velocity=(0.75, 0.0, 0.0),
        rolling=True,
        material=rubber,
    )
    scene.camera("side", eye=(2.3, -8.0, 2.6), target=(2.3, 0.0, 0.9))
    scene.camera("below", eye=(8.0, -2.5, 2.6), target=(2.3, 0.0, 0.8))
    scene.simulation(duration=9.5, frame_rate=60.0)


if __name__ == "__main__":
    from wsim import run

    run(build)
