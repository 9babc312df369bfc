"""Door closed by a spring and a damper.

Asked for: A door on hinges stands ajar by 60 degrees, and a spring with a damper closes
it.

What must happen:
- eventually[0, 0.1] (reaches(door, (0.346, -0.2, 1.01), within 3 cm)) and finally
  (reaches(door, (0, 0, 1.01), within 2 cm))
- always[0, 5] (speed_between(door, 0 m/s, 0.5 m/s))
- always[0, 5] (stays_within(door, (0, -0.4, 1.01), radius 0.42 m))
- the door is still at the end, closed
"""

from wsim.scene import Drive, Scene


def build(scene: Scene) -> None:
    """Author the world."""
    # Assumed: spring and damper: the drive of the hinge: 40 N m/rad towards joint angle
    #   +60 deg (closed), 34 N m s/rad (the door's inertia about the hinge is 32 x 0.8^2
    #   / 3 = 6.8 kg m^2, so the critical damping is 33: it closes to 1 degree in about
    #   2.5 s without overshoot, its centre at most 0.37 m/s)
    # Assumed: hinges: one hinge joint on the vertical line of the door's edge at (0,
    #   -0.4), joint zero is the open pose (several hinges on one line are one joint)
    # Assumed: frame: two posts and a lintel, 2 to 3 cm clear of the door, 1 mm clear of
    #   each other and of the ground (closed must be seen; the door must not rub)

    concrete = scene.material("concrete", friction=0.6, color=(0.55, 0.55, 0.55))
    painted_wood = scene.material("painted_wood", friction=0.5, color=(0.85, 0.85, 0.8))
    wood_density = scene.param(
        "wood_density",
        500.0,
        low=250.0,
        high=750.0,
        unit="kg/m^3",
    )
    wood = scene.material(
        "wood",
        density=wood_density,
        friction=0.5,
        color=(0.6, 0.35, 0.15),
    )

    scene.ground("ground", material=concrete)
    hinge_post = scene.box(
        "hinge_post",
        size=(0.1, 0.1, 2.03),
        position=(0.0, -0.48, 1.016),
        static=True,
        material=painted_wood,
    )
    scene.box(
        "latch_post",
        size=(0.1, 0.1, 2.03),
        position=(0.0, 0.48, 1.016),
        static=True,
        material=painted_wood,
    )
    scene.box(
        "lintel",
        size=(0.1, 1.06, 0.1),
        position=(0.0, 0.0, 2.083),
        static=True,
        material=painted_wood,
    )
    door = scene.box(
        "door",
        size=(0.04, 0.8, 2.0),
        position=(0.34641, -0.2, 1.01),
        rotation_deg=(0.0, 0.0, -60.0),
        mass=32.0,
        material=wood,
    )
    scene.joint_revolute(
        "door_hinge",
        hinge_post,
        door,
        anchor=(-1.615e-07, -0.4, 1.01),
        axis="Z",
        limits_deg=(-5.0, 65.0),
        drive=Drive(position=60.0, stiffness=40.0, damping=34.0, max_force=200.0),
    )
    scene.camera("front", eye=(5.2, -2.8, 2.2), target=(0.2, 0.0, 1.05))
    scene.camera("high", eye=(3.5, -0.6, 5.5), target=(0.2, 0.0, 1.0))
    scene.simulation(duration=5.0, frame_rate=24.0)


if __name__ == "__main__":
    from wsim import run

    run(build)
