"""Three wooden blocks float in a glass tank while a steel ball drops in.

What must happen:
- block_0, block_1 and block_2 float on the water.
- steel_ball sinks and rests on the tank's floor.
"""

from wsim.scene import Scene


def build(scene: Scene) -> None:
    """Author the world."""
    tank_glass = scene.material("tank_glass", friction=0.3, color=(0.75, 0.88, 0.9), opacity=0.25)
    wood_density = scene.param("wood_density", 600.0, low=300.0, high=900.0, unit="kg/m^3")
    wood = scene.material("wood", density=wood_density, friction=0.4, restitution=0.1, color=(0.5, 0.27, 0.11))
    steel = scene.material("steel", density=7850.0, friction=0.4, restitution=0.2, color=(0.45, 0.47, 0.5))

    scene.ground("ground", color=(0.32, 0.32, 0.32))
    tank = scene.tank("tank", inner_size=(1.2, 0.51, 0.45), material=tank_glass)
    water = scene.fluid("water", fills=tank, level=0.3, spacing=0.03, density=1000.0, color=(0.15, 0.4, 0.6))
    for i, x in enumerate((-0.404, -0.108, 0.404)):
        scene.box(f"block_{i}", size=(0.2, 0.2, 0.14), position=(x, 0.0, water.surface + 0.075), material=wood)
    scene.sphere("steel_ball", radius=0.06, position=(0.148, 0.0, 0.53), material=steel)
    scene.camera("side", eye=(-0.337, -1.871, 0.732), target=(0.0, 0.0, 0.295))
    scene.simulation(duration=3.5, frame_rate=24.0)


if __name__ == "__main__":
    from wsim import run

    run(build)
