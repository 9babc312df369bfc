"""A Jenga tower of 12 layers; one block is pulled out by a kinematic velocity."""
from wsim.scene import Scene

L, W, H = 0.075, 0.025, 0.015
SCALE = 4
LAYERS = 12
PULLED = (4, 1)


def build(scene: Scene) -> None:
    scene.simulation(duration=4, frame_rate=60)
    scene.ground(friction=0.6)
    l, w, h = (SCALE * v for v in (L, W, H))
    maple = scene.material("maple", density=650, friction=0.45, color=(0.75, 0.55, 0.32))
    for layer in range(LAYERS):
        along_x = layer % 2 == 0
        for k in (-1, 0, 1):
            shift = k * (w + 0.001)
            extra = {"kinematic": True, "velocity": (0.4, 0, 0), "color": (0.8, 0.1, 0.1)} if (layer, k) == PULLED else {"material": maple}
            scene.box(
                f"jenga_{layer}_{k + 1}",
                size=(l, w, h) if along_x else (w, l, h),
                position=(0 if along_x else shift, shift if along_x else 0, (layer + 0.5) * h),
                **extra,
            )
    scene.camera("corner", eye=(1.6, -1.6, 1.0), target=(0, 0, LAYERS * h / 2))
