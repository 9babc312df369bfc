"""A wooden block is let go near the floor of a tank: it comes to rest at its draught, or stands on the bottom.

It sinks into water by r h, for r its density over water's and h its height. That lifts the surface by a²/A of as much,
for a² its cross-section and A the tank's. So it touches the bottom where r h (1 - a²/A) is more than the depth of the
water that was there before it came.
"""

from wsim.scene import Scene

HEIGHT, EDGE, WIDTH = 0.16, 0.2, 0.4  # [m] of the block, of its cross-section, and of the tank, both squares
WALL, UNDER = 0.02, 2  # [m], of the tank's floor too; layers of particles under the block at the start
SHARE = EDGE**2 / WIDTH**2


def build(scene: Scene) -> None:
    scene.simulation(duration=2.5, frame_rate=20.0)
    density = scene.param("density", 400.0, low=250.0, high=1000.0, unit="kg/m^3")
    level = scene.param("level", 0.08, low=0.04, high=0.12, unit="m")  # of the water without the block
    spacing = scene.param("spacing", 0.02, low=0.005, high=0.02, unit="m")
    scene.ground(friction=0.7)
    tank = scene.tank("tank", inner_size=(WIDTH, WIDTH, 0.4), wall=WALL, friction=0.3)

    # Where the block is, whole layers of particles are left out: all but the lowest two, over which it starts.
    def filled(layers: int) -> float:
        return level / (1.0 - SHARE + SHARE * UNDER / layers)

    layers = next(n for n in range(1, 100) if round(filled(n) / spacing) == n)
    scene.fluid("water", fills=tank, level=filled(layers), spacing=spacing)
    wood = scene.material("wood", density=density, friction=0.4, color=(0.45, 0.25, 0.1))
    bottom = WALL + UNDER * filled(layers) / layers
    scene.box("block", size=(EDGE, EDGE, HEIGHT), position=(0.0, 0.0, bottom + HEIGHT / 2), material=wood)

    scene.light("sun", direction=(-0.4, 0.6, -1.0))
    scene.camera("side", eye=(0.0, -1.2, 0.5), target=(0.0, 0.0, 0.12))


if __name__ == "__main__":
    from wsim import run

    run(build)
