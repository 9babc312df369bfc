"""A motor turns a pinion, that a wheel of twice its size, and that a rack along its guide against friction."""

from wsim.scene import Drive, Scene

PINION, WHEEL = 0.1, 0.2  # pitch radii [m]
HEIGHT = 0.6  # of both axles [m]


def build(scene: Scene) -> None:
    scene.simulation(duration=3.0, frame_rate=60.0)
    scene.ground()
    steel = scene.material("steel", density=7850.0, color=(0.35, 0.38, 0.42))
    brass = scene.material("brass", density=8500.0, color=(0.75, 0.55, 0.2))
    red = scene.material("red", density=1200.0, color=(0.7, 0.08, 0.05))
    slate = scene.material("slate", density=2700.0, color=(0.55, 0.62, 0.66))
    plate = scene.box("plate", size=(1.6, 0.05, 1.0), position=(0.3, 0.12, 0.5), material=slate, static=True)

    def wheel(name: str, radius: float, x: float, material: object) -> None:
        """A wheel on an axle of its own, with a peg that shows how it turns."""
        disc = scene.cylinder(name, radius=radius, height=0.04, axis="Y", position=(x, 0.0, HEIGHT), material=material)
        peg = scene.cylinder(
            f"{name}_peg",
            radius=0.015,
            height=0.04,
            axis="Y",
            position=(x, -0.041, HEIGHT + 0.75 * radius),
            material=red,
        )
        scene.joint_fixed(f"{name}_rivet", disc, peg)

    wheel("pinion", PINION, 0.0, brass)
    wheel("wheel", WHEEL, PINION + WHEEL, steel)
    rack = scene.box("rack", size=(0.9, 0.04, 0.05), position=(0.6, 0.0, HEIGHT + WHEEL + 0.025), material=steel)

    speed = scene.param("motor_speed", 90.0, low=10.0, high=360.0, unit="deg/s")
    motor = Drive(velocity=speed, damping=20.0)
    scene.joint_revolute("motor", plate, "pinion", axis="Y", drive=motor)
    scene.joint_revolute("axle", plate, "wheel", axis="Y", friction=0.2)
    scene.joint_prismatic("guide", plate, rack, axis="X", friction=20.0)
    scene.gear("mesh", "motor", "axle", ratio=-PINION / WHEEL)  # they turn against each other
    scene.gear("teeth", "axle", "guide", ratio=WHEEL)  # right-handed about +Y, its top goes to +X

    scene.light("sun", direction=(-0.4, 0.6, -1.0))
    scene.camera("side", eye=(0.3, -2.2, 0.95), target=(0.3, 0.0, 0.6))


if __name__ == "__main__":
    from wsim import run

    run(build)
