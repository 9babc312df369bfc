import numpy as xp, numpy.linalg as la
import wsim.scene as ws
from pxr import UsdGeom as geom, UsdPhysics as phys

def build(s):
    s.ground()
    tilt = la.norm(xp.array([3.0, 4.0])) * 2
    plate = s.box("plate", size=(1, 1, 0.05), position=(0, 0, 0.5), rotation_deg=(tilt, 0, 0), static=True)
    h: ws.Handle = s.sphere("ball", radius=.1, position=(0, 0.2, .8), mass=.5)
    prim = s.stage.GetPrimAtPath(h.path)
    assert prim.HasAPI(phys.RigidBodyAPI) and geom.Xformable(prim)
    d = ws.Drive(stiffness=10, damping=1)
    arm = s.box("arm", size=(.4, .05, .05), position=(.9, 0, .6), mass=1)
    s.joint_revolute("j", plate, arm, anchor=(.7, 0, .6), axis=(1, 0, 0), drive=d)
    s.camera("c", eye=(0, -3, 1.2), target=(0, 0, .5))
