"""A Polaris drives from a dock onto a floating block, waits in its middle, and drives on to the other dock.

Held by nothing, the block draws its mass over rho A, for the water's density rho and its own area A: 250 kg/m^3 x 0.8 m
are 0.2 m. The vehicle's m = 1360 kg on A = 10.56 m^2 add m / (rho A) = 0.129 m, and 0.471 m stay above the water with
it in the middle. They are least under the rear axle as it comes over an end: with GM = 4.3 m the weight, then 1.03 m
from the middle, leans the block by 5.4 degrees, which takes that end 0.21 m lower, and 0.26 m are left. (Of a block of
400 kg/m^3, 0.4 m thick, 0.11 m would be left in the middle, and its ends go under.)

What sinks in lifts the water of the basin, whose area is A' = 20.8 m^2: over its floor the block goes down by
m / rho (1 / A - 1 / A') = 63.4 mm.
"""

from wsim.scene import Driver, Scene

SPACING = 0.1  # of the water's particles [m]: 18,700; at 0.025, for a GPU, 1.2 million
BLOCK = (4.4, 2.4, 0.8)  # [m]
BASIN = (5.2, 4.0, 1.4)  # its hollow [m]
LEVEL, WALL = 1.0, 0.1  # of the water over the basin's floor; thickness of its floor and walls [m]
DOCK, WIDTH, APRON = 5.0, 3.0, 0.1  # length and width of the docks; thickness of what of them is over the water [m]
TOP = WALL + BASIN[2] + APRON  # of the docks: 0.1 m below that of the empty block
EDGE = BLOCK[0] / 2 + 0.1  # where the docks end [m]
START, GOAL = -5.0, 5.0  # x of the middle between the axles [m]
MIDDLE = 0.19  # with the weight over the block's middle: 43 % are on the front axle
WAITS_UNTIL = 9.0  # [s]
PACE = {"speed": 1.5, "acceleration": 1.0, "braking": 1.0}
ONTO = Driver("buggy", "polaris", path=[(START, 0.0), (MIDDLE, 0.0)], **PACE)
OFF = Driver("buggy", "polaris", path=[(MIDDLE, 0.0), (GOAL, 0.0)], **PACE)


def build(scene: Scene) -> None:
    scene.simulation(duration=scene.param("duration", 16.0, low=0.1, high=60.0, unit="s"), frame_rate=20.0)
    density = scene.param("block_density", 250.0, low=100.0, high=1000.0, unit="kg/m^3")
    spacing = scene.param("spacing", SPACING, low=0.02, high=0.2, unit="m")
    scene.ground(color=(0.3, 0.32, 0.28))
    basin = scene.tank("basin", inner_size=BASIN, wall=WALL, friction=0.3)
    water = scene.fluid("water", fills=basin, level=LEVEL, spacing=spacing)
    foam = scene.material("foam", density=density, friction=0.9, color=(0.85, 0.62, 0.03))
    bottom = water.surface - density / 1000.0 * BLOCK[2]
    block = scene.box("block", size=BLOCK, position=(0.0, 0.0, bottom + BLOCK[2] / 2), material=foam)

    concrete = scene.material("concrete", density=2400.0, friction=0.9, color=(0.45, 0.44, 0.42))
    wall = BASIN[0] / 2 + WALL
    for name, side in (("near", -1.0), ("far", 1.0)):
        middle, over = side * (wall + DOCK / 2), side * (wall + EDGE) / 2
        scene.box(
            f"dock_{name}", size=(DOCK, WIDTH, TOP), position=(middle, 0.0, TOP / 2), static=True, material=concrete
        )
        apron = scene.box(
            f"apron_{name}",
            size=(wall - EDGE, WIDTH, APRON),
            position=(over, 0.0, TOP - APRON / 2),
            static=True,
            material=concrete,
        )
        scene.contact(block, apron, friction=0.1)  # a fender: it keeps the block's place and lets it go up and down
    scene.vehicle("buggy", "polaris", position=(START, 0.0, TOP))

    scene.light("sun", direction=(-0.4, 0.6, -1.0))
    scene.camera("side", eye=(0.0, -10.5, 3.4), target=(0.0, 0.0, 1.2), fov=74.0, width=1280, height=720)
    scene.camera("quarter", eye=(4.5, -8.0, 4.2), target=(0.2, 0.0, 1.3), fov=62.0, width=960, height=540)


def control(world, t):
    (ONTO if t < WAITS_UNTIL else OFF).drive(world, t)


if __name__ == "__main__":
    from wsim import run

    run(build)
