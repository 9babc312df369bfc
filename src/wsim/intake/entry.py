"""Make a user's file an asset of the catalogue: read, orient, mend, find what collides, weigh, write, draw."""

from __future__ import annotations

import json
import re
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from pydantic import ValidationError

from wsim.assets import Asset, Collision, assets_folder, get, load_catalogue, user_folder
from wsim.assets.catalogue import METADATA, THUMBNAIL
from wsim.intake import thumbnail
from wsim.intake.collide import Collided, collide
from wsim.intake.measure import Seen
from wsim.intake.model import Array, Body, IntakeError, Model
from wsim.intake.orient import Placing, orient
from wsim.intake.read import read
from wsim.intake.repair import Solid, repair
from wsim.intake.rooms import room
from wsim.intake.weigh import DENSITY, check_numbers, weigh
from wsim.intake.write import Part, look_names, write_usd
from wsim.progress import Progress, silent
from wsim.scene.check import check_stage

USD_FILE = "asset.usda"
CATEGORY = "own/model"
FRICTION = 0.5


@dataclass(frozen=True)
class Wanted:
    """What the user says of an asset beside its file; None is taken from the file, or is usual."""

    name: str
    placing: Placing = field(default_factory=Placing)
    density: float | None = None  # [kg/m^3]
    mass: float | None = None  # [kg]
    category: str | None = None
    synonyms: Sequence[str] = ()
    description: str | None = None
    license: str = "NOASSERTION"
    friction: float = FRICTION
    threshold: float | None = None  # [m]
    replace: bool = False
    picture: bool = True


def add(file: Path, wanted: Wanted, progress: Progress = silent) -> Asset:
    """Make a file an asset in the user's folder; all of it is there at the end, or nothing.

    Args:
        file: GLB, glTF, OBJ, STL, PLY, USD, URDF or MJCF.
        wanted: What to call it, how large and how heavy it is.
        progress: Told how far it is.

    Returns:
        The asset as the catalogue has it; its `notes` say what was taken, mended and left out.

    Raises:
        IntakeError: Naming the field, its value and the way out.
    """
    id = _id(wanted)
    _check(wanted)
    progress("reading", 0, 1)
    model = orient(read(file), wanted.placing)
    made = _Made.of(model, wanted, progress)
    home = user_folder()
    home.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(prefix=".adding-", dir=home) as name:
        folder = Path(name) / id
        folder.mkdir()
        anchors = made.anchors()
        write_usd(folder / USD_FILE, id, made.parts, model.joints, anchors, wanted.friction)
        problems = check_stage(folder / USD_FILE, [folder])
        if problems:
            raise IntakeError(f"file = {file.name} makes no world: {problems[0]}; mend that, and try again")
        if wanted.picture:
            thumbnail.draw(folder / USD_FILE, folder / THUMBNAIL, progress)
        entry = _entry(id, file, wanted, made, anchors)
        _write_json(folder / METADATA, entry)
        if (home / id).exists():
            (home / id).replace(Path(name) / "old")
        folder.replace(home / id)
    home.touch()  # so that whoever has the catalogue open reads it again
    return get(id)


def _id(wanted: Wanted) -> str:
    """The id that a name makes.

    Raises:
        IntakeError: If it makes none, or one that is taken.
    """
    id = re.sub(r"[^a-z0-9]+", "_", wanted.name.lower()).strip("_")
    if not re.fullmatch(r"[a-z][a-z0-9_]{0,59}", id):
        raise IntakeError(f"name = {wanted.name[:80]!r} must begin with a letter a to z and have at most 60 characters")
    if id in load_catalogue(assets_folder()):
        raise IntakeError(f"name = {wanted.name!r} is that of a shipped asset; choose another, such as 'own {id}'")
    if (user_folder() / id).exists() and not wanted.replace:
        raise IntakeError(f"name = {wanted.name!r} is there already; --replace, or `wsim assets remove {id}`")
    return id


def _check(wanted: Wanted) -> None:
    """Numbers and names that would be refused in the end, at once."""
    check_numbers(wanted.density, wanted.mass)
    if not 0.0 <= wanted.friction <= 10.0:
        raise IntakeError(f"friction = {wanted.friction:g} must be 0 to 10")
    if wanted.threshold is not None and not 1e-4 <= wanted.threshold <= 1.0:
        raise IntakeError(f"threshold = {wanted.threshold:g} must be 0.0001 to 1 m")
    if wanted.category is not None and not re.fullmatch(r"[a-z]+(/[a-z]+)+", wanted.category):
        raise IntakeError(f"category = {wanted.category!r} must be a path such as furniture/chair, in lower case")
    for name in wanted.synonyms:
        if not re.fullmatch(r"[a-z0-9][a-z0-9 -]{0,59}", name.lower()):
            raise IntakeError(f"synonyms: {name[:60]!r} must be of letters, digits, blanks and hyphens")


@dataclass(frozen=True)
class _Made:
    """The bodies as they are written, and what was measured of them."""

    parts: list[Part]
    collided: list[Collided]
    notes: list[str]
    size: Array
    hollow: tuple[Array, Array] | None
    articulated: bool

    @classmethod
    def of(cls, model: Model, wanted: Wanted, progress: Progress) -> _Made:
        notes = list(model.notes)
        parts, collided = [], []
        total = wanted.mass
        if total is not None and len(model.bodies) > 1:
            raise IntakeError(f"mass = {total:g} of {len(model.bodies)} bodies; leave it out, or give --density")
        for body in model.bodies:
            said: list[str] = []
            solid = repair(body.meshes, said)
            made = _given(body, solid) or collide(solid, wanted.threshold, said, progress)
            _note_density(body, wanted, said)
            weight = weigh(body, solid, made.colliders, density=wanted.density, mass=wanted.mass)
            parts.append(Part(body.name, solid.looks(), made.colliders, weight, body.origin, body.turn))
            collided.append(made)
            notes += [f"{body.name}: {note}" if body.name else note for note in said]
        points = np.concatenate([mesh.points for part in parts for mesh in part.looks])
        size = np.ptp(points, axis=0)
        hollow = room(collided[0].seen, collided[0].colliders) if len(parts) == 1 else None
        return cls(parts, collided, list(dict.fromkeys(notes)), size, hollow, bool(model.joints))

    def anchors(self) -> dict[str, Array]:
        anchors = {"top": np.array([0.0, 0.0, self.size[2]])}
        if self.hollow is not None:
            size, center = self.hollow
            anchors["inside"] = center - np.array([0.0, 0.0, size[2] / 2])
        return anchors

    def collision(self) -> Collision:
        """Of one body its own; of several the parts together, and the worst of each measure."""
        each = [made.collision for made in self.collided]
        if len(each) == 1:
            return each[0]
        methods = {one.method for one in each}
        return Collision(
            method=each[0].method if len(methods) == 1 else "coacd" if "coacd" in methods else "given",
            parts=sum(one.parts for one in each),
            volume_ratio=max((one.volume_ratio for one in each if one.volume_ratio is not None), default=None),
            hausdorff=max((one.hausdorff for one in each if one.hausdorff is not None), default=None),
            hollow_open=tuple(hollow for one in each for hollow in one.hollow_open),
        )


def _given(body: Body, solid: Solid) -> Collided | None:
    """The colliders that a file brings along, measured."""
    if not body.colliders:
        return None
    seen = Seen.of(solid)
    fitted = seen.measure(body.colliders)
    ratio = None if fitted.volume_ratio is None else round(fitted.volume_ratio, 4)
    collision = Collision(
        method="given", parts=len(body.colliders), volume_ratio=ratio or None, hausdorff=round(fitted.hausdorff, 6)
    )
    return Collided(body.colliders, collision, seen, fitted)


def _note_density(body: Body, wanted: Wanted, notes: list[str]) -> None:
    if wanted.density is None and wanted.mass is None and body.mass is None:
        notes.append(f"taken: a density of {DENSITY:g} kg/m^3, as of oak; --density or --mass say otherwise")


def _entry(id: str, file: Path, wanted: Wanted, made: _Made, anchors: dict[str, Array]) -> dict[str, Any]:
    name = " ".join(wanted.name.lower().replace("_", " ").split())
    names = [name if re.fullmatch(r"[a-z0-9][a-z0-9 -]*", name) else id.replace("_", " ")]
    names += [each.lower() for each in wanted.synonyms]
    hollow = made.hollow
    return {
        "id": id,
        "file": USD_FILE,
        "names": list(dict.fromkeys(names)),
        "category": wanted.category or CATEGORY,
        "description": wanted.description or f"{names[0].capitalize()}, from {file.name}.",
        "size": _rounded(made.size),
        "mass": float(f"{sum(part.weight.mass for part in made.parts):.6g}"),
        "up_axis": "+Z",
        "forward_axis": "+X",
        "forward": "the side that was said, or taken, to be its front",
        "origin": "centre of the bottom face",
        "anchors": {key: _rounded(at) for key, at in anchors.items()},
        "hollow": None if hollow is None else {"size": _rounded(hollow[0]), "center": _rounded(hollow[1])},
        "articulated": made.articulated,
        "colors": {each: [round(v, 4) for v in color] for color, each in look_names(made.parts).items()},
        "units": {"length": "m", "mass": "kg"},
        "source": f"imported from {file.name[:200]} by wsim assets add",
        "license": wanted.license,
        "collision": made.collision().model_dump(mode="json"),
        "notes": [note[:400] for note in made.notes],
    }


def _write_json(path: Path, entry: dict[str, Any]) -> None:
    text = "{\n" + ",\n".join(f'  "{key}": {json.dumps(value)}' for key, value in entry.items()) + "\n}\n"
    try:
        Asset.model_validate_json(text)
    except ValidationError as error:
        first = error.errors()[0]
        named = ".".join(map(str, first["loc"])) or "asset"
        raise IntakeError(f"{named}: {first['msg']}; give another, or export the file again") from None
    path.write_text(text, encoding="utf-8")


def _rounded(values: Array) -> list[float]:
    return [round(float(v), 5) + 0.0 for v in values]
