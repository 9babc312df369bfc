"""Two tanks of one fluid at different levels, and a ball in each."""
from wsim.scene import Scene

SPACING = 0.04
LEVELS = {"high": 0.4, "low": 0.2}
SIDE = {"high": -0.5, "low": 0.5}


def build(scene: Scene):
    scene.simulation(duration=2.0, frame_rate=24.0)
    scene.ground()
    fluids = {}
    for which in LEVELS:
        tank = scene.tank(f"tank_{which}", inner_size=(0.6, 0.4, 0.56), position=(SIDE[which], 0, 0))
        fluids[which] = scene.fluid(f"water_{which}", fills=tank, level=LEVELS[which], spacing=SPACING)
    for which, fluid in fluids.items():
        x, y, _ = fluid.center
        scene.sphere(f"ball_{which}", radius=0.1, position=(x, y, fluid.surface + 0.12), density=500)
    difference = max(fluids.values(), key=lambda f: f.surface).surface - min(f.surface for f in fluids.values())
    print("levels differ by", round(difference, 3), "m; particles are", fluids["low"].spacing, "m apart")
    scene.camera("front", eye=(0, -3, 1), target=(0, 0, 0.3))
