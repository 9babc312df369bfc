"""A door is pushed open against a damper.

Asked for: A door on hinges is pushed with 15 N at its handle and swings open past 70
degrees against a damper.

What must happen:
- eventually[0, 4] (turned_between(door, z, 70 deg, 112 deg))
- finally (turned_between(door, z, 70 deg, 112 deg))
- always (spin_between(door, z, -10 deg/s, 52 deg/s))
- eventually[0, 1.5] (gone_between(handle, x, 5 cm, 90 cm))
"""

from wsim.scene import Drive, Scene


def build(scene: Scene) -> None:
    """Author the world."""
    # Assumed: damper: a damper of 15 N m s/rad in the hinge, no spring (12 N m of the
    #   push then turn the door at no more than 47 deg/s; without it, it would pass 70
    #   degrees at about 100 deg/s)
    # Assumed: push: 15 N along +x at the handle, 0.82 m from the hinges, from 0.5 s to
    #   4 s (70 degrees are passed about 2.6 s after it begins)
    # Assumed: mass: 25.2 kg (a light wooden inner door)

    floor = scene.material("floor", friction=0.6, color=(0.6, 0.58, 0.55))
    painted_wood = scene.material(
        "painted_wood",
        friction=0.5,
        color=(0.85, 0.85, 0.82),
    )
    wood_density = scene.param(
        "wood_density",
        350.0,
        low=175.0,
        high=525.0,
        unit="kg/m^3",
    )
    wood = scene.material(
        "wood",
        density=wood_density,
        friction=0.5,
        color=(0.55, 0.33, 0.16),
    )
    steel_density = scene.param(
        "steel_density",
        7850.0,
        low=3925.0,
        high=11775.0,
        unit="kg/m^3",
    )
    steel = scene.material(
        "steel",
        density=steel_density,
        friction=0.5,
        color=(0.8, 0.8, 0.85),
    )

    scene.ground("ground", material=floor)
    scene.box(
        "hinge_post",
        size=(0.1, 0.1, 2.048),
        position=(0.0, 0.09, 1.026),
        static=True,
        material=painted_wood,
    )
    scene.box(
        "lock_post",
        size=(0.1, 0.1, 2.048),
        position=(0.0, -1.0, 1.026),
        static=True,
        material=painted_wood,
    )
    scene.box(
        "lintel",
        size=(0.1, 1.19, 0.1),
        position=(0.0, -0.455, 2.102),
        static=True,
        material=painted_wood,
    )
    door = scene.box(
        "door",
        size=(0.04, 0.9, 2.0),
        position=(0.0, -0.45, 1.02),
        mass=25.2,
        material=wood,
    )
    handle = scene.box(
        "handle",
        size=(0.04, 0.12, 0.03),
        position=(-0.04, -0.82, 1.02),
        material=steel,
    )
    scene.joint_revolute(
        "hinges",
        None,
        door,
        anchor=(0.0, 0.0, 1.02),
        axis="Z",
        limits_deg=(-2.0, 110.0),
        drive=Drive(damping=15.0),
    )
    scene.joint_fixed("handle_on_door", door, handle, anchor=(-0.02, -0.82, 1.02))
    scene.schedule(
        "push",
        "handle",
        "force",
        times=[0.5, 4.0],
        values=[(15.0, 0.0, 0.0), (0.0, 0.0, 0.0)],
    )
    scene.camera("view", eye=(-2.2, -4.0, 2.7), target=(0.2, -0.5, 0.95))
    scene.simulation(duration=5.5, frame_rate=24.0)


if __name__ == "__main__":
    from wsim import run

    run(build)
