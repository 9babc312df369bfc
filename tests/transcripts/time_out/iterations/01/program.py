"""A wooden crate slides down a ramp.

What must happen:
- wooden_crate slides down ramp.
"""

from wsim.scene import Scene


def build(scene: Scene) -> None:
    """Author the world."""
    # Assumed: a wooden crate: wood of 600 kg/m^3 (the prompt does not say which wood)
    # Assumed: a wooden crate: 0.4 x 0.4 x 0.4 m (the prompt gives no size)
    # Assumed: a wooden crate: a box stands for it (a program cannot load the
    #   catalogue's assets yet)
    # Assumed: a ramp: of wood (the prompt names no material)
    # Assumed: a ramp: wood of 600 kg/m^3 (the prompt does not say which wood)
    # Assumed: a ramp: 1.5 x 0.6 x 0.04 m (the prompt gives no size)
    # Assumed: a ramp: a box stands for it (a program cannot load the catalogue's assets
    #   yet)
    # Assumed: a ramp: inclined by 30 degrees (steeper than the angle of friction, 21.8
    #   degrees at a friction of 0.4)
    # Assumed: scene: on level ground (something has to carry it)
    # Assumed: scene: 1.9 s long (time to come to rest; the prompt gives no duration)
    # Assumed: cameras: side and top (the prompt names no view)

    ground = scene.material("ground", friction=0.7, color=(0.32, 0.32, 0.32))
    wood_density = scene.param(
        "wood_density",
        600.0,
        low=300.0,
        high=900.0,
        unit="kg/m^3",
    )
    wood = scene.material(
        "wood",
        density=wood_density,
        friction=0.8,
        restitution=0.1,
        color=(0.5, 0.27, 0.11),
    )

    scene.ground("ground", material=ground)
    scene.box(
        "ramp",
        size=(1.5, 0.6, 0.04),
        position=(0.0, 0.0, 0.392321),
        rotation_deg=(0.0, 30.0, 0.0),
        static=True,
        material=wood,
    )
    scene.box(
        "wooden_crate",
        size=(0.4, 0.4, 0.4),
        position=(-0.296532, 0.0, 0.818713),
        rotation_deg=(0.0, 30.0, 0.0),
        material=wood,
    )
    scene.camera("side", eye=(-0.504, -2.798, 1.161), target=(0.0, 0.0, 0.546))
    scene.camera("top", eye=(0.0, -0.139, 2.789), target=(0.0, 0.0, 0.0))
    scene.simulation(duration=1.9, frame_rate=24.0)


if __name__ == "__main__":
    from wsim import run

    run(build)
