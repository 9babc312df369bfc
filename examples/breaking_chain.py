"""A ball falls into a pan that hangs on a chain, and the chain breaks at its weakest link."""

from wsim.scene import Scene

LINKS = 8
LINK = 0.1  # [m]
TOP = 2.2  # height of the beam's underside [m]


def build(scene: Scene) -> None:
    scene.simulation(duration=1.5, frame_rate=60.0, time_step=4e-4)  # links that whip about
    scene.ground()
    metal = scene.material("aluminium", density=2700.0, color=(0.6, 0.62, 0.65))
    iron = scene.material("iron", density=7200.0, color=(0.08, 0.08, 0.1))
    beam = scene.box("beam", size=(0.8, 0.1, 0.1), position=(0.0, 0.0, TOP + 0.05), static=True)

    strength = scene.param("strength", 3000.0, low=100.0, high=20000.0, unit="N")
    above = beam
    for k in range(LINKS):
        z = TOP - (k + 0.5) * LINK
        link = scene.cylinder(f"link_{k}", radius=0.03, height=LINK - 0.01, position=(0.0, 0.0, z), material=metal)
        most = strength if k == 3 else 5.0 * strength  # the fourth is worn
        scene.joint_spherical(f"pin_{k}", above, link, anchor=(0.0, 0.0, z + LINK / 2), break_force=most)
        above = link
    bottom = TOP - LINKS * LINK
    pan = scene.box("pan", size=(0.5, 0.5, 0.03), position=(0.0, 0.0, bottom - 0.015), material=metal)
    scene.joint_fixed("hook", above, pan, anchor=(0.0, 0.0, bottom))
    scene.sphere("ball", radius=0.08, position=(0.12, 0.0, bottom + 0.6), material=iron)

    scene.light("sun", direction=(-0.4, 0.6, -1.0))
    scene.camera("side", eye=(0.5, -4.8, 1.5), target=(0.0, 0.0, 1.15))


if __name__ == "__main__":
    from wsim import run

    run(build)
