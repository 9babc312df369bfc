"""What is known of each asset, read from the `asset.json` beside its USD file."""

from __future__ import annotations

import json
from collections.abc import Mapping
from difflib import get_close_matches
from functools import cache, lru_cache
from pathlib import Path
from types import MappingProxyType
from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field, PrivateAttr, ValidationError, model_validator

from wsim.assets.folders import AssetError, assets_folder, stamp, user_folder

METADATA = "asset.json"
THUMBNAIL = "thumbnail.png"  # beside it, of what came in
_ROUNDING = 1e-3  # [m]: by which an anchor or a hollow may stand out of the asset's box

Length = Annotated[float, Field(gt=0.0, le=1e3)]
Coordinate = Annotated[float, Field(ge=-1e3, le=1e3)]
Share = Annotated[float, Field(ge=0.0, le=1.0)]
Text = Annotated[str, Field(min_length=1, max_length=400)]
Name = Annotated[str, Field(pattern=r"^[a-z0-9][a-z0-9 -]*$", max_length=60)]
Identifier = Annotated[str, Field(pattern=r"^[A-Za-z_][A-Za-z0-9_]*$", max_length=60)]
Point = tuple[Coordinate, Coordinate, Coordinate]


class _Model(BaseModel):
    model_config = ConfigDict(strict=True, frozen=True, extra="forbid", allow_inf_nan=False)


class Hollow(_Model):
    """An upright box inside an asset that is free: its edges and its centre, in the asset's frame [m]."""

    size: tuple[Length, Length, Length]
    center: Point


class Room(_Model):
    """A hollow of what is seen, and the share of it that what collides leaves open."""

    center: Point
    volume: Annotated[float, Field(gt=0.0, description="a number > 0 in m^3")]
    open: Share


class Collision(_Model):
    """How well what collides stands for what is seen; measured, `null` where what is seen has no inside."""

    method: Literal["box", "sphere", "cylinder", "hull", "shapes", "coacd", "given"]
    parts: Annotated[int, Field(ge=1)]
    threshold: Annotated[float, Field(gt=0.0)] | None = None  # [m], CoACD's bound on a part's concavity
    volume_ratio: Annotated[float, Field(gt=0.0)] | None = None  # of what collides, to what is seen
    hausdorff: Annotated[float, Field(ge=0.0)] | None = None  # [m], the most by which either surface lies off the other
    hollow_open: tuple[Room, ...] = ()


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
    collision: Collision | None = Field(None, description="how well what collides stands for what is seen, or null")
    notes: tuple[Text, ...] = Field((), description="sentences: what was taken, mended or left out when it came in")
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


def load_catalogue(folder: Path | None = None) -> Mapping[str, Asset]:
    """All assets by id, in the order of their ids; read once, and again when the user's folder has changed.

    An asset of the user's that cannot be read is left out, so that the others can be used; `get` says what is wrong
    with it, and `unreadable` has them all.

    Args:
        folder: Holds a folder for each asset; by default the shipped ones and the user's own, which come first where
            both have an id.

    Raises:
        AssetError: If metadata is wrong: names the file, the field, the value and what it must be.
    """
    if folder is not None:
        return _load(folder.resolve())
    return _merged(assets_folder().resolve(), *stamp())[0]


def unreadable() -> Mapping[str, str]:
    """What is wrong with each of the user's assets that cannot be read, by its folder's name."""
    return _merged(assets_folder().resolve(), *stamp())[1]


def get(id: str) -> Asset:
    """The asset of an id.

    Raises:
        AssetError: If there is none; it names those that may be meant.
    """
    catalogue = load_catalogue()
    if id in catalogue:
        return catalogue[id]
    if id in unreadable():
        raise AssetError(unreadable()[id])
    called = {name: asset.id for asset in catalogue.values() for name in (asset.id, *asset.names)}
    near = dict.fromkeys(called[name] for name in get_close_matches(str(id).lower(), called, n=3, cutoff=0.7))
    hint = f"did you mean {' or '.join(map(repr, near))}?" if near else f"known: {', '.join(catalogue)}"
    raise AssetError(f"no asset {str(id)[:60]!r}; {hint}")


def is_own(asset: Asset) -> bool:
    """Whether an asset is one of the user's own."""
    return asset.path.parents[1] == user_folder()


@cache
def _load(folder: Path) -> Mapping[str, Asset]:
    return MappingProxyType({path.parent.name: _read(path) for path in sorted(folder.glob(f"*/{METADATA}"))})


@lru_cache(maxsize=4)
def _merged(shipped: Path, own: str, _changed: int) -> tuple[Mapping[str, Asset], Mapping[str, str]]:
    """The shipped assets and those of a user's folder, and what is wrong with which of the latter."""
    found, wrong = dict(_load(shipped)), {}
    for path in sorted(Path(own).glob(f"[!.]*/{METADATA}")):
        try:
            found[path.parent.name] = _read(path)
        except (AssetError, OSError, UnicodeDecodeError) as error:
            wrong[path.parent.name] = str(error)
            found.pop(path.parent.name, None)
    return MappingProxyType(dict(sorted(found.items()))), MappingProxyType(wrong)


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
