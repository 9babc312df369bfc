"""A hovering drone: four thrusters as one force, PD on height and attitude, in all worlds at once."""
import numpy as np

from wsim.scene import Scene

MASS, G, TARGET = 1.2, 9.81, 1.5
integral = None


def build(scene: Scene):
    scene.simulation(duration=5)
    scene.ground()
    scene.box('drone', size=(0.3, 0.3, 0.06), position=(0, 0, 0.05), mass=MASS)
    for i, (sx, sy) in enumerate(((1, 1), (1, -1), (-1, -1), (-1, 1))):
        arm = scene.cylinder(f'rotor_{i}', radius=0.08, height=0.02, position=(0.2*sx, 0.2*sy, 0.09), mass=0.02)
        scene.joint_fixed(f'mount_{i}', 'drone', arm)
    scene.camera('side', eye=(0, -4, 1.5), target=(0, 0, 1))


def control(world, t):
    global integral
    drone = world.body('drone')
    height, climb = drone.position[:, 2], drone.velocity[:, 2]
    error = TARGET - height
    integral = error.copy() if integral is None else integral + 0.01 * error
    lift = (MASS + 0.08) * G + 6.0 * error - 4.0 * climb + 0.1 * np.clip(integral, -1, 1)
    force = np.zeros((world.world_count, 3), dtype=np.float32)
    force[:, 2] = np.maximum(lift, 0.0)
    torque = -0.5 * drone.rotation[:, :3] - 0.1 * drone.angular_velocity
    world.apply_force('drone', force, torque=torque)
