"""Three wooden blocks float in a glass tank; a steel ball dropped beside them sinks."""

from wsim.scene import Scene


def build(scene: Scene) -> None:
    scene.simulation(duration=4.0, frame_rate=30.0)
    scene.ground()
    tank = scene.tank("tank", inner_size=(1.2, 0.5, 0.5))
    water = scene.fluid("water", fills=tank, level=0.3, spacing=0.03)

    density = scene.param("wood_density", 600.0, low=300.0, high=900.0, unit="kg/m^3")
    wood = scene.material("wood", density=density, friction=0.4, color=(0.45, 0.25, 0.1))
    for i, x in enumerate((-0.42, -0.1, 0.22)):
        scene.box(f"block_{i}", size=(0.2, 0.2, 0.15), position=(x, 0.0, water.surface + 0.085), material=wood)

    steel = scene.material("steel", density=7850.0, friction=0.3, color=(0.5, 0.52, 0.55))
    scene.sphere("ball", radius=0.06, position=(0.48, 0.0, water.surface + 0.08), material=steel)

    scene.light("sun", direction=(-0.4, 0.6, -1.0))
    scene.camera("side", eye=(0.0, -2.2, 0.9), target=(0.0, 0.0, 0.25))
    scene.camera("corner", eye=(1.4, -1.5, 1.0), target=(0.0, 0.0, 0.25))


if __name__ == "__main__":
    from wsim import run

    run(build)
