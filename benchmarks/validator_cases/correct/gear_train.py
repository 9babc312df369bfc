"""A flywheel driven at constant speed, a brake that slows it, and a free one for comparison."""
from wsim.scene import Scene, Drive

def flywheel(scene, name, y, *, drive=None):
    wheel = scene.cylinder(name, radius=0.25, height=0.05, axis="y", position=(0, y, 0.6), density=7850)
    scene.joint_revolute(name + "_axle", None, wheel, anchor=(0, y, 0.6), axis="Y", drive=drive)
    return wheel

def build(scene: Scene):
    scene.ground()
    cases = {
        "driven": Drive(velocity=360, damping=15),
        "braked": Drive(velocity=0, damping=0.8, max_force=3),
        "free": None,
    }
    for k, (name, drive) in enumerate(cases.items()):
        flywheel(scene, name, (k - 1) * 0.4, drive=drive)
    scene.camera("side", eye=(0, -3, 1.2), target=(0, 0, 0.6)); scene.light("sun")
