"""A row of dominoes toppled by a rolling ball."""
from wsim.scene import Scene
import math


def domino_positions(count, pitch, start=0.0):
    """x of each domino [m]"""
    return [start + k * pitch for k in range(count)]


def build(scene: Scene):
    scene.simulation(duration=5.0, frame_rate=60)
    scene.ground(friction=0.6)

    ivory = scene.material('ivory', density=1200, friction=0.45, restitution=0.05, color=(0.9, 0.87, 0.75))
    w, d, h = 0.02, 0.1, 0.2
    for k, x in enumerate(domino_positions(12, pitch=0.09)):
        scene.box('domino_%02d' % k, size=(w, d, h), position=(x, 0, h / 2), material=ivory)

    speed = scene.param('ball_speed', 1.5, low=0.5, high=4.0, unit='m/s')
    r = 0.06
    spin = math.degrees(speed / r)
    scene.sphere('ball', radius=r, position=(-0.5, 0, r), velocity=(speed, 0, 0),
                 angular_velocity_deg=(0, spin, 0), density=2500)

    scene.camera('side', eye=(0.5, -2.2, 0.9), target=(0.4, 0, 0.1))
    scene.camera('top', eye=(0.5, 0, 3.0), target=(0.5, 0.01, 0), fov=40)
