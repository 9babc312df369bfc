"""A conveyor carries a crate onto a lift, whose own belt draws it in; the lift takes it up; a ball rolls by."""

from wsim.scene import Scene

TOP = 0.5  # of the belt [m]
RAISE = 0.7  # by the lift [m]
LEAVES, ARRIVES = 2.8, 4.2  # the lift [s]


def build(scene: Scene) -> None:
    scene.simulation(duration=5.0, frame_rate=30.0)
    scene.ground()
    rubber = scene.material("rubber", friction=0.9, color=(0.05, 0.05, 0.05))
    steel = scene.material("steel", density=7850.0, friction=0.4, color=(0.45, 0.47, 0.5))
    wood = scene.material("wood", density=600.0, friction=0.4, color=(0.5, 0.27, 0.11))

    speed = scene.param("belt_speed", 0.6, low=0.2, high=1.5, unit="m/s")
    belt = scene.box("belt", size=(2.4, 0.6, 0.1), position=(-0.7, 0.0, TOP - 0.05), static=True, material=rubber)
    scene.surface_velocity(belt, velocity=(speed, 0.0, 0.0))
    for name, x in (("tail_stand", -1.7), ("head_stand", 0.3)):
        scene.box(name, size=(0.08, 0.5, TOP - 0.1), position=(x, 0.0, TOP / 2 - 0.05), static=True, material=steel)
    scene.box("crate", size=(0.4, 0.4, 0.4), position=(-0.6, 0.0, TOP + 0.2), material=wood)

    keys = (0.0, LEAVES, ARRIVES)
    deck = scene.box("deck", size=(0.7, 0.6, 0.08), position=(0.88, 0.0, TOP - 0.042), kinematic=True, material=rubber)
    scene.surface_velocity(deck, velocity=(speed, 0.0, 0.0))
    stop = scene.box("stop", size=(0.06, 0.6, 0.3), position=(1.27, 0.0, TOP + 0.12), kinematic=True, material=steel)
    for part, (x, z) in ((deck, (0.88, TOP - 0.042)), (stop, (1.27, TOP + 0.12))):
        scene.path(part, times=keys, positions=((x, 0.0, z), (x, 0.0, z), (x, 0.0, z + RAISE)))

    scene.sphere(
        "ball", radius=0.12, position=(-1.8, -0.7, 0.12), velocity=(0.7, 0.0, 0.0), rolling=True, material=wood
    )

    scene.light("sun", direction=(-0.4, 0.6, -1.0))
    scene.camera("side", eye=(-0.8, -4.8, 1.9), target=(0.0, 0.0, 0.6))


if __name__ == "__main__":
    from wsim import run

    run(build)
