"""A desk with a laptop, a lamp and a mug; the mug slides off a tilted book."""

from wsim.scene import Scene

DESK_TOP = 0.74
THINGS = [
    ("laptop", "laptop", (0.0, 0.0), 0.0),
    ("lamp", "lamp", (-0.15, 0.45), 0.0),
    ("screen", "monitor", (-0.2, -0.4), 15.0),
]


def build(scene: Scene) -> None:
    scene.simulation(duration=3.0, seed=7)
    scene.ground()
    scene.asset("desk", "desk", position=(0.0, 0.0, 0.0), static=True)
    scene.asset("chair", "chair", position=(0.9, 0.1, 0.0), rotation_deg=(0.0, 0.0, 170.0))
    for name, kind, (x, y), yaw in THINGS:
        scene.asset(name, kind, position=(x, y, DESK_TOP + 0.002), rotation_deg=(0.0, 0.0, yaw))
    book = scene.box(
        "book", size=(0.24, 0.17, 0.03), position=(0.2, -0.45, DESK_TOP + 0.05), rotation_deg=(0, 12, 0), density=800
    )
    scene.asset("mug", id="mug", position=(0.2, 0.3, DESK_TOP + 0.005))
    print("book is at", book.path, "and is named", book.name, str(book))
    scene.light("ceiling", "sphere", position=(0.0, 0.0, 2.4), radius=0.15, intensity=4.0e4)
    scene.camera("seated", eye=(1.6, 0.0, 1.5), target=(0.0, 0.0, 0.8))
