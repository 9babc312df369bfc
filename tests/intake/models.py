"""Files of models, as a user has them, made by trimesh and pxr."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import trimesh

BOX = (0.2, 0.3, 0.4)  # [m], Z up and +X forward
Z_TO_Y = np.array([[0, 1, 0, 0], [0, 0, 1, 0], [1, 0, 0, 0], [0, 0, 0, 1.0]])  # +X forward, Z up to +Z forward, Y up
CABINET = (0.35, 0.6, 0.9)  # [m]
BOARD = 0.018  # [m]
BOWL_RADIUS, BOWL_WALL = 0.085, 0.006  # [m]


def box() -> trimesh.Trimesh:
    return trimesh.creation.box(extents=BOX)


def bowl() -> trimesh.Trimesh:
    """A part of a ball's shell, open at the top: a surface of revolution."""
    angle = np.linspace(0.0, 1.35, 15)
    outer = BOWL_RADIUS * np.stack([np.sin(angle), 1.0 - np.cos(angle)], axis=1)
    r = BOWL_RADIUS - BOWL_WALL
    inner = np.stack([r * np.sin(angle), BOWL_RADIUS - r * np.cos(angle)], axis=1)[::-1]
    outer[:, 1] = np.maximum(outer[:, 1], outer[2, 1])  # a foot to stand on
    outer = np.concatenate([[(0.0, outer[2, 1])], outer[2:]])
    return trimesh.creation.revolve(np.concatenate([outer, inner]), sections=40)


def cabinet() -> trimesh.Scene:
    """Six boards: open in front, with a shelf half way up."""
    d, w, h = CABINET
    t = BOARD
    boards = [
        ((d, t, h), (0.0, -w / 2 + t / 2, h / 2)), ((d, t, h), (0.0, w / 2 - t / 2, h / 2)),
        ((d, w - 2 * t, t), (0.0, 0.0, t / 2)), ((d, w - 2 * t, t), (0.0, 0.0, h - t / 2)),
        ((d - t, w - 2 * t, t), (t / 2, 0.0, h / 2)), ((t, w - 2 * t, h - 2 * t), (-d / 2 + t / 2, 0.0, h / 2)),
    ]  # fmt: skip
    meshes = []
    for k, (extents, centre) in enumerate(boards):
        board = trimesh.creation.box(extents=extents)
        board.apply_translation(centre)
        color = [150, 100, 50, 255] if k < 5 else [200, 200, 190, 255]
        board.visual = trimesh.visual.TextureVisuals(
            material=trimesh.visual.material.PBRMaterial(baseColorFactor=color, name="oak")
        )
        meshes.append(board)
    scene = trimesh.Scene(meshes)
    scene.apply_transform(Z_TO_Y)
    return scene


def write(model: trimesh.Trimesh | trimesh.Scene, path: Path) -> Path:
    model.export(path)
    return path


def write_usd(path: Path, up: str = "Y", unit: float = 0.01) -> Path:
    """The box in centimetres with Y up, as a stage of one scaled cube."""
    from pxr import Usd, UsdGeom

    stage = Usd.Stage.CreateNew(str(path))
    UsdGeom.SetStageUpAxis(stage, up)
    UsdGeom.SetStageMetersPerUnit(stage, unit)
    root = UsdGeom.Xform.Define(stage, "/box")
    stage.SetDefaultPrim(root.GetPrim())
    cube = UsdGeom.Cube.Define(stage, "/box/cube")
    cube.CreateSizeAttr(1.0)
    x, y, z = (edge / unit for edge in BOX)
    cube.AddTranslateOp().Set((100.0, 50.0, -20.0))
    cube.AddScaleOp().Set((y, z, x) if up == "Y" else (x, y, z))
    cube.CreateDisplayColorAttr([(0.5, 0.05, 0.03)])
    stage.Save()
    return path
