"""What is known of each asset, read from the `asset.json` beside its USD file."""

from __future__ import annotations

import json
from collections.abc import Mapping
from difflib import get_close_matches
from functools import cache
from pathlib import Path
from types import MappingProxyType
from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field, PrivateAttr, ValidationError, model_validator

from wsim.errors import UserError

METADATA = "asset.json"
_SHIPPED = Path(__file__).parents[1] / "_usd_assets"  # in a wheel
_SOURCE = Path(__file__).parents[3] / "usd_assets"  # in the repository
_ROUNDING = 1e-3  # [m]: by which an anchor or a hollow may stand out of the asset's box

Length = Annotated[float, Field(gt=0.0, le=1e3)]
Coordinate = Annotated[float, Field(ge=-1e3, le=1e3)]
Share = Annotated[float, Field(ge=0.0, le=1.0)]
Text = Annotated[str, Field(min_length=1, max_length=400)]
Name = Annotated[str, Field(pattern=r"^[a-z0-9][a-z0-9 -]*$", max_length=60)]
Identifier = Annotated[str, Field(pattern=r"^[A-Za-z_][A-Za-z0-9_]*$", max_length=60)]
Point = tuple[Coordinate, Coordinate, Coordinate]


class AssetError(UserError):
    """There is no such asset, or its metadata is wrong: one line with the way out."""


class _Model(BaseModel):
    model_config = ConfigDict(strict=True, frozen=True, extra="forbid", allow_inf_nan=False)


class Hollow(_Model):
    """An upright box inside an asset that is free: its edges and its centre, in the asset's frame [m]."""

    size: tuple[Length, Length, Length]
    center: Point


class Units(_Model):
    """Units of the metadata."""

    length: Literal["m"]
    mass: Literal["kg"]


class Asset(_Model):
    """One asset. Lengths in metres, in its own frame: Z up, +X forward, origin at the centre of its bottom face."""

    id: Annotated[str, Field(pattern=r"^[a-z][a-z0-9_]*$", max_length=60)] = Field(
        description="the name of its folder: lower-case letters, digits and _"
    )
    file: Annotated[str, Field(pattern=r"^[A-Za-z0-9_]+\.usd[ac]?$")] = Field(
        description='the name of the USD file beside this one, such as "asset.usda"'
    )
    names: tuple[Name, ...] = Field(min_length=1, description="what people call it, lower case, the usual name first")
    category: Annotated[str, Field(pattern=r"^[a-z]+(/[a-z]+)+$")] = Field(
        description='a path from the general to the special, such as "furniture/table"'
    )
    description: Text = Field(description="a sentence for people")
    size: tuple[Length, Length, Length] = Field(description="three edges (x, y, z) of its bounding box in m, each > 0")
    mass: float = Field(gt=0.0, le=1e5, description="a number > 0 in kg, of all its bodies together")
    up_axis: Literal["+Z"] = Field(description='"+Z"')
    forward_axis: Literal["+X"] = Field(description='"+X"')
    forward: Text = Field(description="words that say which side of it faces +X: the one that a user faces")
    origin: Literal["centre of the bottom face"] = Field(description='"centre of the bottom face"')
    anchors: dict[Identifier, Point] = Field(
        description="points (x, y, z) in m by the name of an Xform in the USD file"
    )
    hollow: Hollow | None = Field(description="the size and center of an upright box in it that is free, in m, or null")
    articulated: bool = Field(description="true if it has joints, else false")
    colors: dict[Identifier, tuple[Share, Share, Share]] = Field(
        description="linear red, green and blue, each 0 to 1, by the name of a material; the main one first"
    )
    units: Units = Field(description='{"length": "m", "mass": "kg"}')
    source: Text = Field(description="where it comes from")
    license: Text = Field(description="its licence as an SPDX identifier")
    _folder: Path = PrivateAttr(default=Path())

    @property
    def path(self) -> Path:
        """The USD file."""
        return self._folder / self.file

    @model_validator(mode="after")
    def _inside(self) -> Asset:
        """Everything that has a place lies in the box."""
        for name, point in self.anchors.items():
            if not self._holds(point):
                raise ValueError(f"anchors.{name} = {list(point)} lies outside the box of size {list(self.size)}")
        if self.hollow:
            ends = [
                tuple(c + side * s / 2 for c, s in zip(self.hollow.center, self.hollow.size, strict=True))
                for side in (-1, 1)
            ]
            if not all(self._holds(end) for end in ends):
                raise ValueError(f"hollow reaches out of the box of size {list(self.size)}")
        if len(set(self.names)) < len(self.names):
            raise ValueError("names has a name twice")
        return self

    def _holds(self, point: tuple[float, ...]) -> bool:
        x, y, z = self.size
        across = all(abs(p) <= s / 2 + _ROUNDING for p, s in zip(point[:2], (x, y), strict=True))
        return across and -_ROUNDING <= point[2] <= z + _ROUNDING


def assets_folder() -> Path:
    """The folder of the shipped assets.

    Raises:
        AssetError: If it is nowhere.
    """
    for folder in (_SHIPPED, _SOURCE):
        if folder.is_dir():
            return folder
    raise AssetError(f"the assets are in neither {_SHIPPED} nor {_SOURCE}; install wsim again")


def load_catalogue(folder: Path | None = None) -> Mapping[str, Asset]:
    """All assets by id, in the order of their ids; read once.

    Args:
        folder: Holds a folder for each asset; the shipped ones by default.

    Raises:
        AssetError: If metadata is wrong: names the file, the field, the value and what it must be.
    """
    return _load((folder or assets_folder()).resolve())


def get(id: str) -> Asset:
    """The asset of an id.

    Raises:
        AssetError: If there is none; it names those that may be meant.
    """
    catalogue = load_catalogue()
    if id in catalogue:
        return catalogue[id]
    called = {name: asset.id for asset in catalogue.values() for name in (asset.id, *asset.names)}
    near = dict.fromkeys(called[name] for name in get_close_matches(str(id).lower(), called, n=3, cutoff=0.7))
    hint = f"did you mean {' or '.join(map(repr, near))}?" if near else f"known: {', '.join(catalogue)}"
    raise AssetError(f"no asset {str(id)[:60]!r}; {hint}")


@cache
def _load(folder: Path) -> Mapping[str, Asset]:
    return MappingProxyType({path.parent.name: _read(path) for path in sorted(folder.glob(f"*/{METADATA}"))})


def _read(path: Path) -> Asset:
    where = f"{path.parent.name}/{path.name}"
    text = path.read_text(encoding="utf-8")
    try:
        asset = Asset.model_validate_json(text)
    except ValidationError as error:
        raise AssetError(f"{where}: {'; '.join(_problem(each) for each in error.errors()[:3])}") from None
    if asset.id != path.parent.name:
        raise AssetError(f"{where}: id = {json.dumps(asset.id)} must be the name of its folder, {path.parent.name!r}")
    asset._folder = path.parent
    if not asset.path.is_file():
        raise AssetError(f"{where}: file = {json.dumps(asset.file)} is not there; put it beside the metadata")
    return asset


def _problem(error: Any) -> str:
    """One mistake that pydantic found, with the way out."""
    place = [str(part) if isinstance(part, str) else f"[{part}]" for part in error["loc"]]
    name = ".".join(place).replace(".[", "[")
    if not place:
        return str(error["msg"]).removeprefix("Value error, ")
    field = Asset.model_fields.get(place[0])
    wanted = field.description if field else ""
    if error["type"] == "missing":
        return f"{name} is missing; add it: {wanted}"
    if error["type"] == "extra_forbidden":
        close = get_close_matches(place[-1], Asset.model_fields, n=1)
        return f"{name} is not a field; remove it" + (f", or call it {close[0]!r}" if close else "")
    return f"{name} = {json.dumps(error['input'], default=str)[:60]} must be {wanted}"
