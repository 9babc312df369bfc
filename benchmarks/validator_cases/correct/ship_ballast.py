"""A box-shaped hull with ballast and a mast floats and rolls upright."""

from wsim.scene import Scene

SPACING = 0.03
HULL = (0.5, 0.24, 0.15)


def build(scene: Scene) -> None:
    """Hull of 350 kg/m^3, an iron keel welded below, and a mast on top that starts heeled."""
    scene.simulation(duration=4.0, frame_rate=30.0)
    scene.ground()
    tank = scene.tank("basin", inner_size=(1.2, 0.9, 0.6))
    sea = scene.fluid("sea", fills="basin", level=0.36, spacing=SPACING, density=1025.0, viscosity=0.001)
    z = sea.surface + HULL[2] / 2 + 0.06

    hull = scene.box("hull", size=HULL, position=(0, 0, z), density=350.0, color=(0.1, 0.2, 0.5))
    keel = scene.box("keel", size=(0.3, 0.05, 0.03), position=(0, 0, z - HULL[2] / 2 - 0.015), density=7200.0)
    mast = scene.cylinder("mast", radius=0.015, height=0.3, position=(0, 0, z + HULL[2] / 2 + 0.15), density=500.0)
    for name, part in [("keel_bolt", keel), ("mast_step", mast)]:
        scene.joint_fixed(name, hull, part)

    if sea.center[2] >= tank.floor:
        scene.camera("side", eye=(0.0, -2.4, 1.0), target=(0.0, 0.0, 0.35))
    scene.camera("bow", eye=(2.2, 0.0, 0.9), target=(0.0, 0.0, 0.35))
