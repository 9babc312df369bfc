"""An arm takes a cube between two fingers, lifts it by 20 cm, and puts it down 25 cm aside.

Nothing but friction holds the cube: fingers that press with F each carry 2 mu F, so that with a cube of weight m g they
hold it while mu > m g / 2 F. Here that is 0.98 N / 14.4 N = 0.068: at `--set friction=0.05` it stays where it was.
"""

from __future__ import annotations

from wsim.scene import Scene

SIZE, MASS = 0.04, 0.1  # of the cube [m], [kg]
TAKEN, PUT = (0.35, 0.1), (0.35, -0.15)  # where it stands at the start and at the end, x and y [m]
LIFT = 0.2  # [m]
DOWN = (180.0, 0.0, 90.0)  # the hand points down, its fingers close along the world's x
GRIP = (0.0, 0.0, 0.07)  # between the fingers, in the hand's frame [m]
OPEN, CLOSED = 0.03, 0.0  # of the left finger; the right one follows it [m]


def build(scene: Scene) -> None:
    scene.simulation(duration=7.5, frame_rate=50.0)
    scene.ground()
    friction = scene.param("friction", 0.5, low=0.01, high=1.0)
    cube = scene.material("cube", friction=friction, color=(0.75, 0.2, 0.1))
    low = SIZE / 2.0
    scene.box("cube", size=(SIZE, SIZE, SIZE), position=(*TAKEN, low), mass=MASS, material=cube)

    arm = scene.robot("arm", "desk_arm")
    goal = {"rotation_deg": DOWN, "point": GRIP}
    arm.reach("hand", position=(*TAKEN, 0.12), by=1.2, **goal)
    arm.follow("hand", path=[(*TAKEN, low)], times=[2.0], **goal)
    lifted = [(*TAKEN, low + LIFT), (*PUT, low + LIFT), (*PUT, low)]
    arm.follow("hand", path=lifted, times=[3.5, 4.3, 5.3], start=2.5, **goal)
    arm.follow("hand", path=[(*PUT, 0.15)], times=[6.6], start=5.9, **goal)
    arm.drive("left_finger", times=[2.05, 2.45, 5.4, 5.8], positions=[OPEN, CLOSED, CLOSED, OPEN])
    scene.camera("side", eye=(1.05, -0.9, 0.6), target=(0.2, 0.0, 0.24))


if __name__ == "__main__":
    from wsim import run

    run(build)
