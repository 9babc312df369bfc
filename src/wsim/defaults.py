"""Numbers that hold where nothing else is said: one place for the plan, the program and the stage.

It stands outside of `wsim.scene`, which loads USD: a plan is made and judged without it. Where a call of `Scene` shows
such a number in its signature it stays written out there, for those who read it; a test holds the two together.
"""

from __future__ import annotations

GRAVITY = 9.81  # [m/s^2]
DURATION = 5.0  # of a simulation [s]
FRAME_RATE = 30.0  # [1/s]
WALL = 0.02  # thickness of a tank's walls and floor [m]
BODY_DENSITY = 1000.0  # [kg/m^3], what UsdPhysics takes
FLUID_DENSITY = 1000.0  # of water [kg/m^3]
FLUID_VISCOSITY = 0.001  # of water [Pa s]
FRICTION = 0.5
FIELD_OF_VIEW = 50.0  # of a camera, horizontal [deg]
SENSOR_RATE = 100.0  # samples a second [Hz]
PIXEL_CHANNELS = ("color", "depth", "segmentation")  # of a camera that is a sensor
