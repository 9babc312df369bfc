"""Balls on circles without gravity; initial velocities from numpy cross products."""
import numpy as np
from wsim.scene import Scene

OMEGA = np.array([0.0, 0.0, np.pi / 3])


def build(scene: Scene) -> None:
    scene.simulation(gravity=(0, 0, 0), duration=6)
    hub = scene.sphere("hub", radius=0.15, position=(0, 0, 1), static=True, color=(0.9, 0.8, 0.1))
    radii = np.linspace(0.5, 1.5, 4)
    angles = np.arange(4) * np.pi / 2
    positions = np.stack([radii * np.cos(angles), radii * np.sin(angles), np.ones_like(radii)], axis=1)
    for i, p in enumerate(positions):
        v = np.cross(OMEGA, p - np.array([0.0, 0.0, 1.0]))
        spin = np.degrees(OMEGA)
        planet = scene.sphere(f"planet_{i}", radius=0.05 + 0.01 * i, position=p, velocity=v.round(6), angular_velocity_deg=spin)
        scene.joint_revolute(f"arm_{i}", hub, planet, anchor=(0, 0, 1), axis=OMEGA / np.linalg.norm(OMEGA))
    print("total speed", float(np.sum(np.linalg.norm(positions[:, :2], axis=1) * OMEGA[2])))
    scene.camera("top", eye=(0, 0, 6), target=(0, 0, 1))
