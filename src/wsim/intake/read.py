"""Read a user's file as bodies of coloured meshes, by the format that its name ends in."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import trimesh
from numpy.typing import NDArray

from wsim.intake.model import GREY, Body, Color, IntakeError, Mesh, Model
from wsim.intake.read_mujoco import read_mujoco
from wsim.intake.read_usd import read_usd

Bools = NDArray[np.bool_]
MOST_BYTES = 400_000_000
MOST_FACES = 500_000  # what a stage holds as text in some 50 MB
TRIMESH = (".glb", ".gltf", ".obj", ".stl", ".ply")
USD = (".usd", ".usda", ".usdc", ".usdz")
MUJOCO = (".urdf", ".xml", ".mjcf")
FORMATS = (*TRIMESH, *USD, *MUJOCO)
_Y_UP = (".glb", ".gltf", ".obj")  # glTF says so, and faces +Z; what writes OBJ mostly does the same


def read(path: Path) -> Model:
    """What a file holds, in its own axes and units.

    Raises:
        IntakeError: If it is missing, too large, of another format, or holds no sound triangles.
    """
    if not path.is_file():
        raise IntakeError(f"file = {path} is not there; give the path of a {', '.join(FORMATS)} file")
    kind = path.suffix.lower()
    if kind not in FORMATS:
        raise IntakeError(f"file = {path.name} must end in one of {', '.join(FORMATS)}; export it as .glb")
    size = path.stat().st_size
    if not 0 < size <= MOST_BYTES:
        raise IntakeError(f"file = {path.name} has {size} bytes; it must have 1 to {MOST_BYTES}: export it again")
    _few(path.name, _announced(path, kind))
    reader: Callable[[Path], Model] = read_usd if kind in USD else read_mujoco if kind in MUJOCO else _read_trimesh
    try:
        model = reader(path)
    except IntakeError:
        raise
    except MemoryError:
        raise IntakeError(f"file = {path.name} does not fit into memory; give it fewer triangles") from None
    except Exception as error:  # noqa: BLE001 - each of the readers raises its own kinds
        why = " ".join(str(error).split())[:160] or type(error).__name__
        raise IntakeError(f"file = {path.name} cannot be read: {why}; export it again, best as .glb") from None
    _check(path.name, model)
    return model


def _announced(path: Path, kind: str) -> int:
    """How many faces the head of a file says that it has, before all of it is read; 0 where it says nothing."""
    with path.open("rb") as stream:
        head = stream.read(4096)
    if kind == ".stl" and len(head) >= 84:
        count = int.from_bytes(head[80:84], "little")
        return count if path.stat().st_size >= 84 + 50 * count else 0  # the text of another would be any number
    found = re.search(rb"element face (\d{1,18})", head) if kind == ".ply" else None
    return int(found[1]) if found else 0


def _few(name: str, faces: int) -> None:
    if faces > MOST_FACES:
        raise IntakeError(f"faces = {faces} of {name}; at most {MOST_FACES}: decimate it in the tool that it is from")


def _check(name: str, model: Model) -> None:
    """Triangles are there, are not too many, and name points that are there; points that are not finite are let go."""
    _few(name, sum(len(mesh.faces) for body in model.bodies for mesh in body.meshes))
    for body in model.bodies:
        body.meshes = [sound for mesh in body.meshes if (sound := _sound(mesh, model.notes)) is not None]
    if not any(body.meshes for body in model.bodies):
        raise IntakeError(f"file = {name} holds no triangles with finite points; export its meshes, not only curves")


def _sound(mesh: Mesh, notes: list[str]) -> Mesh | None:
    points = np.asarray(mesh.points, dtype=np.float64).reshape(-1, 3)
    faces = np.asarray(mesh.faces, dtype=np.int64).reshape(-1, 3)
    there: Bools = np.asarray(((faces >= 0) & (faces < len(points))).all(axis=1))
    finite: Bools = np.asarray((np.isfinite(points) & (np.abs(points) < 1e9)).all(axis=1))
    good = there.copy()
    good[there] &= finite[faces[there]].all(axis=1)
    if not good.all():
        notes.append(
            f"{int((~good).sum())} triangles of {mesh.name} had points that are missing or no numbers; left out"
        )
    faces = faces[good]
    if not len(faces):
        return None
    used, index = np.unique(faces, return_inverse=True)
    return Mesh(mesh.name, points[used], index.reshape(-1, 3), mesh.color)


def _read_trimesh(path: Path) -> Model:
    loaded = trimesh.load(path, process=False)
    notes: list[str] = []
    meshes: list[Mesh] = []
    if isinstance(loaded, trimesh.Scene):
        for node in sorted(loaded.graph.nodes_geometry):
            matrix, name = loaded.graph[node]
            meshes += _meshes(loaded.geometry[name], str(name), np.asarray(matrix, dtype=np.float64), notes)
    else:
        meshes += _meshes(loaded, path.stem, np.eye(4), notes)
    kind = path.suffix.lower()
    up, forward = ("y", "+z") if kind in _Y_UP else ("z", "+x")
    unit = 1.0 if kind in (".glb", ".gltf") else None
    return Model([Body("", meshes)], up, forward, unit, notes=list(dict.fromkeys(notes)))


def _meshes(geometry: Any, name: str, matrix: np.ndarray, notes: list[str]) -> list[Mesh]:
    if not isinstance(geometry, trimesh.Trimesh) or not len(geometry.faces):
        notes.append(f"{name[:40]} holds no triangles (points or lines alone); left out")
        return []
    mesh = Mesh(name, np.asarray(geometry.vertices, float), np.asarray(geometry.faces), _color(geometry, notes))
    return [mesh.moved(matrix[:3, :3], matrix[:3, 3])]


def _color(geometry: Any, notes: list[str]) -> Color:
    """One linear colour of a mesh: its material's, a texture's or its vertices' mean; grey where it has none."""
    visual = geometry.visual
    rgb: Any = None
    if visual.kind == "texture":
        material = visual.material
        image = getattr(material, "baseColorTexture", None) or getattr(material, "image", None)
        factor = getattr(material, "baseColorFactor", None)
        if image is not None:
            rgb = np.asarray(image.convert("RGB"), dtype=np.float64).reshape(-1, 3).mean(axis=0)
            notes.append("textures are not carried: each part has its texture's mean colour")
        elif factor is not None:
            return _linear_of(np.asarray(factor, dtype=np.float64)[:3] / 255.0, linear=True)
        else:
            rgb = np.asarray(material.main_color, dtype=np.float64)[:3]
    elif visual.kind in ("vertex", "face"):
        colors = np.asarray(visual.vertex_colors if visual.kind == "vertex" else visual.face_colors)
        rgb = colors[:, :3].astype(np.float64).mean(axis=0)
        if len(np.unique(colors, axis=0)) > 1:
            notes.append("colours of single points are not carried: each part has their mean")
    return GREY if rgb is None else _linear_of(rgb / 255.0, linear=False)


def _linear_of(rgb: np.ndarray, *, linear: bool) -> Color:
    """Linear RGB; sRGB is decoded by its curve's power, near enough for a mean."""
    if not np.isfinite(rgb).all():
        return GREY
    clipped = np.clip(rgb, 0.0, 1.0)
    red, green, blue = (round(float(v), 4) for v in (clipped if linear else clipped**2.2))
    return red, green, blue
