from math import *
from wsim.scene import *

# a ring of leaning slabs
def build(scene: Scene):
    scene.ground()
    n = 10
    for i in range(n):
        a = 2 * pi * i / n
        scene.box("slab_" + str(i), size=(0.05, 0.2, 0.4), position=(0.8 * cos(a), 0.8 * sin(a), 0.2), rotation_deg=(0, 0, degrees(a)), density=800)
    motor = Drive(velocity=90, damping=10)
    bar = scene.box("bar", size=(1.4, 0.05, 0.05), position=(0, 0, 0.1), mass=3)
    scene.joint_revolute("spin", None, bar, axis="Z", drive=motor)
    scene.camera("top", eye=(0, -0.5, 4), target=(0, 0, 0))
