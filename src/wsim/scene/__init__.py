"""What programs import: author a physical world as an OpenUSD stage.

    from wsim.scene import Scene

    def build(scene: Scene) -> None:
        scene.ground()
        scene.box("block", size=(0.2, 0.2, 0.2), position=(0.0, 0.0, 0.5), density=600.0)

Imports pxr and numpy only. To read a stage back see `wsim.scene.describe`; to check one, `wsim.scene.check`.
"""

from __future__ import annotations

from wsim.scene import schema

# Before the first stage is made: that is when USD reads its schemas.
schema.register()

from wsim.scene.areas import Area  # noqa: E402
from wsim.scene.authoring import Handle  # noqa: E402
from wsim.scene.brakes import Brake  # noqa: E402
from wsim.scene.compounds import Part  # noqa: E402
from wsim.scene.driver import Driver  # noqa: E402
from wsim.scene.errors import SceneError  # noqa: E402
from wsim.scene.fluids import Fluid  # noqa: E402
from wsim.scene.joints import Drive  # noqa: E402
from wsim.scene.layers import Hill, Image, Kerb, Level, Noise, Ramp, Step, Surface  # noqa: E402
from wsim.scene.legs import Arc, Legs  # noqa: E402
from wsim.scene.materials import Material  # noqa: E402
from wsim.scene.roads import Road  # noqa: E402
from wsim.scene.robots import Robot  # noqa: E402
from wsim.scene.scene import Scene  # noqa: E402
from wsim.scene.schedules import Event  # noqa: E402
from wsim.scene.tanks import Tank  # noqa: E402
from wsim.scene.terrain import Terrain  # noqa: E402
from wsim.scene.tracks import Track  # noqa: E402
from wsim.scene.vehicle_spec import VehicleSpec  # noqa: E402
from wsim.scene.vehicles import Vehicle  # noqa: E402

__all__ = [
    "Arc",
    "Area",
    "Brake",
    "Drive",
    "Driver",
    "Event",
    "Fluid",
    "Handle",
    "Hill",
    "Image",
    "Kerb",
    "Legs",
    "Level",
    "Material",
    "Noise",
    "Part",
    "Ramp",
    "Road",
    "Robot",
    "Scene",
    "SceneError",
    "Step",
    "Surface",
    "Tank",
    "Terrain",
    "Track",
    "Vehicle",
    "VehicleSpec",
]
