"""Blocks of cork, pine and oak float at different drafts in a tank of oil."""

from wsim.scene import Scene, Tank, Fluid

SPACING = 0.03
OIL_DENSITY = 900.0
WOODS = {
    "cork": (240.0, (0.62, 0.45, 0.28)),
    "pine": (500.0, (0.65, 0.42, 0.19)),
    "oak": (720.0, (0.38, 0.20, 0.08)),
}


def add_basin(scene: Scene) -> tuple[Tank, Fluid]:
    tank = scene.tank("tank", inner_size=(1.2, 0.48, 0.5), wall=0.015)
    oil = scene.fluid("oil", fills=tank, level=0.3, spacing=SPACING,
                      density=OIL_DENSITY, viscosity=0.05, color=(0.6, 0.45, 0.05))
    return tank, oil


def build(scene: Scene) -> None:
    scene.simulation(duration=3.5, frame_rate=24)
    scene.ground()
    tank, oil = add_basin(scene)

    edge = 0.18
    xs = [-0.38, 0.0, 0.38]
    for x, (name, (density, color)) in zip(xs, WOODS.items()):
        wood = scene.material(name, density=density, friction=0.4, color=color)
        scene.box(f"{name}_block", size=(edge, edge, 0.15), position=(x, 0.0, oil.surface + 0.08), material=wood)

    center = tank.inner_center
    scene.camera("side", eye=(center[0], center[1] - 2.2, 0.8), target=center)
