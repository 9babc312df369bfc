"""A small picture of an asset, by wsim's own camera: on the ground, its front turned to the viewer."""

from __future__ import annotations

import tempfile
from pathlib import Path

import numpy as np
from PIL import Image
from pxr import UsdGeom

from wsim.intake.model import Array
from wsim.progress import Progress, silent
from wsim.scene import Scene
from wsim.scene.describe import describe
from wsim.sim.cameras import CameraRenderer, Style
from wsim.sim.devices import start_warp
from wsim.sim.model import build_model

SIZE = (320, 270)  # width and height [px]
FILLED = 0.84  # share of it that the asset fills
YAW = -28.0  # [deg]: the default camera looks from the front right; this turns an asset's front to it
_FINER = 4
_STYLE = Style(zenith=(0.55, 0.62, 0.70), horizon=(0.74, 0.77, 0.80), checker_contrast=0.0)


def draw(usd: Path, picture: Path, progress: Progress = silent) -> None:
    """Draw the asset of a USD file into a PNG."""
    start_warp()
    scene = Scene()
    scene.ground(color=(0.42, 0.42, 0.40))
    prim = UsdGeom.Xform.Define(scene.stage, "/World/asset")
    prim.AddRotateZOp().Set(YAW)
    prim.GetPrim().GetReferences().AddReference(str(usd.resolve()))
    with tempfile.TemporaryDirectory(prefix="wsim-thumbnail-") as folder:
        stage = scene.save(Path(folder) / "stage.usda")
        world = describe(stage)
        model = build_model(stage, world, "cpu").model
    # Drawn far larger, cut out and shrunk: fine parts stay whole.
    renderer = CameraRenderer(model, world, _FINER * SIZE[0], _FINER * SIZE[1], style=_STYLE, progress=progress)
    (image,) = renderer.render(model.state()).values()
    is_ground = np.array([path.startswith("/World/ground") for path in renderer.shape_prims])
    seen = (image.shape_index >= 0) & ~is_ground[image.shape_index]
    cut = _cut_out(image.rgb, seen) if seen.any() else image.rgb
    Image.fromarray(cut).resize(SIZE, Image.Resampling.BOX).save(picture, "PNG")


def _cut_out(image: Array, seen: Array) -> Array:
    """The part of a picture around the pixels that are `seen`, in the picture's own shape."""
    rows, columns = np.flatnonzero(seen.any(axis=1)), np.flatnonzero(seen.any(axis=0))
    share = max(np.ptp(columns) / image.shape[1], np.ptp(rows) / image.shape[0]) / FILLED
    wide, tall = (min(max(1, round(share * n)), n) for n in (image.shape[1], image.shape[0]))
    left = min(max((columns[0] + columns[-1] - wide) // 2, 0), image.shape[1] - wide)
    top = min(max((rows[0] + rows[-1] - tall) // 2, 0), image.shape[0] - tall)
    return image[top : top + tall, left : left + wide]
