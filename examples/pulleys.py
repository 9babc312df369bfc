"""Two weights on a rope over a wheel, and beside them one that lifts another of twice its mass on a movable pulley."""

from wsim.scene import Scene

TOP = 2.0  # height of the wheels [m]


def build(scene: Scene) -> None:
    scene.simulation(duration=0.9, frame_rate=60.0)
    scene.ground()
    steel = scene.material("steel", density=7850.0, color=(0.5, 0.52, 0.55))
    brass = scene.material("brass", density=8500.0, color=(0.72, 0.5, 0.16))
    scene.box("beam", size=(2.2, 0.06, 0.06), position=(0.0, 0.12, TOP), static=True, material=steel)

    # Atwood's machine: the heavier weight falls with (m1 - m2) / (m1 + m2) g.
    scene.cylinder("wheel", radius=0.2, height=0.06, axis="Y", position=(-0.7, 0.0, TOP), static=True, material=brass)
    heavy = scene.param("heavy", 1.5, low=1.0, high=3.0, unit="kg")
    scene.cylinder("left", radius=0.06, height=0.14, position=(-0.9, 0.0, 1.2), mass=heavy, color=(0.09, 0.45, 0.81))
    scene.cylinder("right", radius=0.05, height=0.12, position=(-0.5, 0.0, 0.7), mass=1.0, color=(0.79, 0.35, 0.0))
    scene.rope("rope", "left", "right", around=["wheel"])

    # The rope carries the block twice: the small weight lifts it.
    scene.cylinder("fixed", radius=0.12, height=0.06, axis="Y", position=(0.4, 0.0, TOP), static=True, material=brass)
    scene.cylinder("block", radius=0.12, height=0.06, axis="Y", position=(0.64, 0.0, 0.7), mass=0.4, material=brass)
    scene.box("load", size=(0.2, 0.12, 0.2), position=(0.64, 0.0, 0.4), mass=1.2, color=(0.6, 0.19, 0.39))
    scene.joint_fixed("hook", "block", "load")
    scene.cylinder("small", radius=0.05, height=0.12, position=(0.28, 0.0, 1.6), mass=1.2, color=(0.0, 0.34, 0.17))
    scene.rope("tackle", "small", "beam", anchor_b=(0.76, 0.0, TOP), around=["fixed", ("block", "under")])

    scene.light("sun", direction=(-0.4, 0.6, -1.0))
    scene.camera("side", eye=(0.0, -4.2, 1.6), target=(0.0, 0.0, 1.15))


if __name__ == "__main__":
    from wsim import run

    run(build)
