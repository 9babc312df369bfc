"""The catalogue's assets, each a function of its measures that draws, weighs and names it."""

from __future__ import annotations

from collections.abc import Callable

from . import devices, furniture, goods, plants, vessels
from .asset import Asset

_FUNCTIONS: tuple[Callable[[], Asset], ...] = (
    furniture.table,
    furniture.desk,
    furniture.chair,
    furniture.bench,
    furniture.shelf,
    furniture.cabinet,
    devices.laptop,
    devices.monitor,
    devices.lamp,
    plants.plant,
    vessels.mug,
    vessels.bowl,
    vessels.bucket,
    vessels.barrel,
    vessels.crate,
    goods.pallet,
    goods.plank,
    goods.ramp,
    goods.seesaw,
    goods.domino,
)
ASSETS: dict[str, Callable[[], Asset]] = {function.__name__: function for function in _FUNCTIONS}
