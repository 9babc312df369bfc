"""A motor turns a crank; its rod, which closes a loop of joints, drives a ram that shoves a crate along a bench."""

from wsim.scene import Drive, Scene

CRANK, ROD = 0.12, 0.36  # [m]
HEIGHT = 0.5  # of the crank's axle and of the ram's line [m]
FACE = 0.25  # of the ram in front of its pin [m]


def build(scene: Scene) -> None:
    scene.simulation(duration=2.5, frame_rate=60.0)
    scene.ground()
    steel = scene.material("steel", density=7850.0, color=(0.45, 0.47, 0.5))
    brass = scene.material("brass", density=8500.0, color=(0.75, 0.55, 0.2))
    oak = scene.material("oak", density=700.0, color=(0.42, 0.26, 0.12), friction=0.35)
    slate = scene.material("slate", density=2700.0, color=(0.55, 0.62, 0.66))

    # The crank points backwards at the start: the ram is at the end of its stroke, 2 CRANK, and comes forward.
    pin = ROD - CRANK
    scene.box("wall", size=(0.6, 0.05, 0.9), position=(0.0, 0.1, 0.45), static=True, material=slate)
    scene.box("bench", size=(1.6, 0.4, 0.4), position=(1.3, -0.08, 0.2), static=True, material=oak)
    wheel = scene.cylinder("wheel", radius=0.15, height=0.03, axis="Y", position=(0.0, 0.03, HEIGHT), material=steel)
    rod = scene.box("rod", size=(ROD, 0.02, 0.04), position=(pin - ROD / 2, -0.02, HEIGHT), material=brass)
    ram = scene.box("ram", size=(FACE + 0.05, 0.06, 0.06), position=(pin + (FACE - 0.05) / 2, -0.08, HEIGHT),
                    material=steel)  # fmt: skip
    crate = scene.box("crate", size=(0.2, 0.2, 0.2), position=(pin + FACE + 0.18, -0.08, HEIGHT), density=250.0,
                      material=oak)  # fmt: skip

    speed = scene.param("crank_speed", 180.0, low=60.0, high=360.0, unit="deg/s")
    motor = Drive(velocity=speed, damping=40.0)
    scene.joint_revolute("motor", None, wheel, anchor=(0.0, 0.03, HEIGHT), axis="Y", drive=motor)
    scene.joint_revolute("crank_pin", wheel, rod, anchor=(-CRANK, 0.0, HEIGHT), axis="Y")
    scene.joint_revolute("wrist_pin", rod, ram, anchor=(pin, -0.05, HEIGHT), axis="Y")  # closes the loop
    scene.joint_prismatic("guide", None, ram, axis="X")
    scene.contact(ram, crate, restitution=0.0)

    scene.light("sun", direction=(-0.4, 0.6, -1.0))
    scene.camera("side", eye=(0.5, -2.0, 0.95), target=(0.5, 0.0, 0.45))


if __name__ == "__main__":
    from wsim import run

    run(build)
