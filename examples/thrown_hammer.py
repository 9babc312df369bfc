"""A hammer is thrown over the ground: it turns about the centre of its mass, near its head, lands and comes to rest."""

from wsim.scene import Part, Scene


def build(scene: Scene) -> None:
    scene.simulation(duration=3.0, frame_rate=30.0)
    scene.ground(friction=0.6)
    wood = scene.material("wood", density=700.0, friction=0.6, color=(0.55, 0.35, 0.15))
    steel = scene.material("steel", density=7800.0, friction=0.6, color=(0.5, 0.52, 0.55))
    scene.compound(
        "hammer",
        parts=[
            Part("cylinder", radius=0.016, height=0.32, material=wood),
            Part("box", size=(0.12, 0.04, 0.04), position=(0.0, 0.0, 0.16), material=steel),
        ],
        position=(-1.0, 0.0, 0.8),
        velocity=(1.5, 0.0, 2.5),
        angular_velocity_deg=(0.0, 500.0, 0.0),
    )
    scene.light("sun", direction=(-0.4, 0.6, -1.0))
    scene.camera("side", eye=(0.1, -3.8, 1.0), target=(0.1, 0.0, 0.7))


if __name__ == "__main__":
    from wsim import run

    run(build)
