"""How an object of a plan is made: a primitive, something of the catalogue, a robot, a vehicle, terrain, a scatter."""

from __future__ import annotations

import math
from itertools import pairwise
from typing import Annotated, Any, Literal

from pydantic import Field, SerializerFunctionWrapHandler, model_serializer, model_validator

from wsim.defaults import FRICTION
from wsim.plan.schema.base import Color, Name, NotNegative, Number, Positive, Share, Sparse, Strict, Word

Primitive = Literal["box", "sphere", "cylinder", "capsule", "tank", "fluid", "ground"]
SIZE_COUNT: dict[str, tuple[int, ...]] = {
    "box": (3,),
    "sphere": (1,),
    "cylinder": (2,),
    "capsule": (2,),
    "tank": (3,),
    "fluid": (0, 3),
    "ground": (0,),
}
SIZE_MEANING = {
    "box": "the edge lengths (x, y, z)",
    "sphere": "(radius,)",
    "cylinder": "(radius, height)",
    "capsule": "(radius, height without the caps)",
    "tank": "the inner edge lengths (x, y, z)",
    "fluid": "the edge lengths (x, y, z), or nothing when it fills a container",
    "ground": "nothing",
}
VEHICLES = ("hmmwv", "polaris", "car", "truck", "cart")  # kinds, by wsim.scene.vehicle_spec
VehicleKind = Literal["hmmwv", "polaris", "car", "truck", "cart"]
CORNERS = ("front_left", "front_right", "rear_left", "rear_right")
ROCKS = "rocks"
MOST_EDGE = 500.0  # of terrain [m]
MOST_CELLS = 250_000  # of terrain: what the layout works out in seconds
MOST_WAY = 1000.0  # along the points of a road [m]


class Material(Sparse):
    """Bulk and surface properties."""

    name: Word
    density: Positive  # [kg/m^3]
    friction: NotNegative = FRICTION
    restitution: Share = 0.0  # 0 leaves it to what it touches; a contact's 0 is 0
    rolling: Share | None = None  # rolling resistance: a torque, of radius times push
    color: Color = (0.7, 0.7, 0.7)
    opacity: Share = 1.0  # of a solid
    attenuation_length: NotNegative | None = None  # of a liquid [m]: how clear it is; 0 hides what is in it


class Proxy(Strict):
    """A primitive that stands for the object."""

    kind: Literal["proxy"] = "proxy"
    primitive: Primitive
    size: tuple[Positive, ...] = Field((), max_length=3)  # [m], as SIZE_MEANING has it

    @model_validator(mode="after")
    def _count(self) -> Proxy:
        counts = SIZE_COUNT[self.primitive]
        if len(self.size) not in counts:
            wanted = " or ".join(str(count) for count in counts)
            raise ValueError(
                f"size of a {self.primitive} has {wanted} numbers, {SIZE_MEANING[self.primitive]}, in metres; "
                f"it has {len(self.size)}"
            )
        return self


class FromAsset(Strict):
    """An entry of the catalogue."""

    kind: Literal["asset"] = "asset"
    asset: Word  # its id


class FromRobot(Strict):
    """A robot that was taken in or can be pulled (docs/robots.md): links and joints of its own."""

    kind: Literal["robot"] = "robot"
    robot: Word  # its id
    size: tuple[Positive, Positive, Positive]  # of the box round it as it stands [m]


class FromVehicle(Strict):
    """A vehicle of four sprung wheels (docs/vehicles.md): body, hubs, knuckles and wheels, and their joints."""

    kind: Literal["vehicle"] = "vehicle"
    vehicle: VehicleKind


Spot = tuple[Number, Number]  # x, y from the terrain's middle, which is the world's origin [m]


class NoiseLayer(Strict):
    """Rough ground: bumps of several widths, each half as wide as the one before."""

    kind: Literal["noise"] = "noise"
    amplitude: NotNegative  # [m], which it seldom comes near
    wavelength: Positive  # of the widest bumps [m]
    octaves: Annotated[int, Field(ge=1, le=8)] = 4
    seed: Annotated[int, Field(ge=0, lt=2**31)] = 0


class HillLayer(Strict):
    """A round hill; a negative height is a hollow."""

    kind: Literal["hill"] = "hill"
    position: Spot
    radius: Positive  # [m]
    height: Number  # [m]


class LevelLayer(Sparse):
    """A level disc, as high as the ground in its middle, which goes over to the ground beside it within `blend`."""

    kind: Literal["level"] = "level"
    position: Spot
    radius: Positive  # [m]
    blend: NotNegative = 3.0  # [m]


class Way(Strict):
    """A smooth line through points, and how wide what lies along it is."""

    points: tuple[Spot, ...] = Field(min_length=2, max_length=50)
    width: Positive = 5.0  # [m]

    @model_validator(mode="after")
    def _short(self) -> Way:
        length = sum(math.dist(a, b) for a, b in pairwise(self.points))
        if length > MOST_WAY:
            raise ValueError(f"points are {length:.4g} m long along their way; at most {MOST_WAY:g} m")
        if any(math.dist(a, b) < 1e-3 for a, b in pairwise(self.points)):
            raise ValueError("points: two of them, one after the other, are in one place; leave one out")
        return self


class RoadLayer(Way):
    """A road bed: level across, and as high as the ground along its line, averaged over `smooth`."""

    kind: Literal["road"] = "road"
    shoulder: NotNegative = 3.0  # within which it goes over to the ground beside it [m]
    smooth: NotNegative = 10.0  # [m]


Layer = Annotated[NoiseLayer | HillLayer | LevelLayer | RoadLayer, Field(discriminator="kind")]


class AreaPlan(Way):
    """A band of the terrain with a surface of its own."""

    name: Name
    material: Material


class FromTerrain(Strict):
    """Ground of layers, one upon another, about the world's origin (docs/terrain.md)."""

    kind: Literal["terrain"] = "terrain"
    extent: tuple[Positive, Positive]  # along X and Y [m]
    cell: Positive = 0.5  # edge of a cell at most [m]
    layers: list[Layer] = Field(min_length=1, max_length=50)
    areas: list[AreaPlan] = Field(default_factory=list, max_length=10)

    @model_validator(mode="after")
    def _works(self) -> FromTerrain:
        if max(self.extent) > MOST_EDGE:
            raise ValueError(f"extent {list(self.extent)} m: each at most {MOST_EDGE:g} m")
        cells = math.prod(math.ceil(edge / self.cell) for edge in self.extent)
        if cells > MOST_CELLS:
            raise ValueError(f"cell {self.cell:g} m makes {cells:,} cells; at most {MOST_CELLS:,}: make it larger")
        names = [area.name for area in self.areas]
        if "geometry" in names or len({*names}) < len(names):
            raise ValueError(f'areas: names {", ".join(names)} must differ, and none be "geometry"')
        return self


class Clearance(Strict):
    """A line, or a place, that what is scattered keeps away from."""

    points: tuple[Spot, ...] = Field(min_length=1, max_length=50)
    by: NotNegative  # beyond its own width [m]


class FromScatter(Strict):
    """Rocks, or things of the catalogue, that are set on terrain by chance: name_0, name_1, ..., none of them moves."""

    kind: Literal["scatter"] = "scatter"
    what: tuple[Word, ...] = Field((ROCKS,), min_length=1, max_length=20)  # "rocks", or ids of assets
    on: Name
    count: Annotated[int, Field(ge=1, le=500)]
    size: tuple[Positive, Positive] = (0.3, 1.0)  # least and greatest length of a rock [m]
    clear: list[Clearance] = Field(default_factory=list, max_length=50)
    seed: Annotated[int, Field(ge=0, lt=2**31)] = 0

    @model_validator(mode="after")
    def _of_one_sort(self) -> FromScatter:
        if ROCKS in self.what and len(self.what) > 1:
            raise ValueError(f'what {list(self.what)}: "rocks" are scattered by themselves; give the rest a scatter')
        if self.size[0] > self.size[1]:
            raise ValueError(f"size {list(self.size)} m: the least is above the greatest; swap them")
        return self

    @model_serializer(mode="wrap")
    def _written(self, write: SerializerFunctionWrapHandler) -> dict[str, Any]:
        """Without the size of rocks where there are none."""
        return {name: value for name, value in write(self).items() if name != "size" or self.what == (ROCKS,)}


class External(Strict):
    """Something to be found elsewhere; until it is, the stand-in is built."""

    kind: Literal["external"] = "external"
    candidate: Word  # what to look for
    stand_in: Proxy


Built = Proxy | FromAsset | FromRobot | FromVehicle | FromTerrain | FromScatter
Construction = Annotated[Built | External, Field(discriminator="kind")]
