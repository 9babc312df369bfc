"""An off-road truck drives 115 m over rough ground, past rocks and trees and over a hill, and stops at the goal."""

from wsim.scene import Area, Driver, Hill, Level, Noise, Road, Scene

TRACK = Road(points=[(-58.0, 0.0), (-35.0, 5.0), (-12.0, -4.0), (10.0, 2.0), (32.0, 0.0), (55.0, -5.0)], width=4.0)
START, GOAL = TRACK.points[0], TRACK.points[-1]
SOIL = Road(points=[(-62.6, -1.9), *TRACK.points, (59.9, -6.0)], width=4.0)  # under all of the truck at both ends, too
DRIVER = Driver("truck", "hmmwv", path=TRACK.line(), speed=8.0, acceleration=2.5, braking=2.5, lateral=2.5)


def build(scene: Scene) -> None:
    scene.simulation(duration=scene.param("duration", 20.0, low=1.0, high=20.0, unit="s"), frame_rate=20.0)
    # The track is another soil, not a road bed: it is as rough as the ground beside it.
    land = scene.terrain(
        "land",
        size=(150.0, 50.0),
        cell=0.5,
        layers=[
            Noise(scene.param("roughness", 0.6, low=0.0, high=1.0, unit="m"), 16.0, octaves=4, seed=4),
            Hill((20.0, 1.0), 17.0, 2.6),
            Level(START, 4.0),
            Level(GOAL, 4.0),
        ],
        areas=[Area("track", road=SOIL, rolling_friction=0.03, color=(0.27, 0.19, 0.11))],
        friction=0.85,
        color=(0.15, 0.22, 0.08),
    )
    # It stands where the track begins, its nose along it.
    truck = scene.vehicle("truck", "hmmwv", position=land.place(*START), yaw_deg=22.8)
    scene.scatter("rock", on=land, count=70, size=(0.3, 1.6), clear=[(TRACK, 1.0), (START, 6.0), (GOAL, 6.0)], seed=2)
    scene.scatter("tree", ["conifer", "deciduous_tree"], on=land, count=22, clear=[(TRACK, 2.5)], seed=5)
    scene.light("sun", direction=(-0.4, 0.5, -1.0))
    behind, ahead = (-66.5, -2.5, 5.0), (-55.0, 0.65, 1.0)
    scene.camera("follow", eye=behind, target=ahead, fov=60.0, width=1280, height=720, follows=truck)
    scene.camera("side", eye=(-1.0, -68.0, 40.0), target=(-1.0, 4.0, 0.0), fov=82.0, width=1280, height=720)
    scene.camera("start", eye=(-68.0, -10.0, 6.0), target=(-30.0, 0.0, 0.0), fov=70.0, width=960, height=540)
    scene.camera("goal", eye=(66.0, -14.0, 7.0), target=(15.0, 0.0, 1.0), fov=60.0, width=960, height=540)


def control(world, t):
    DRIVER.drive(world, t)


if __name__ == "__main__":
    from wsim import run

    run(build)
