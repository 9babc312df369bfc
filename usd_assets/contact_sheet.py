"""Draw a picture of every asset into docs/images/assets.png, with wsim's own camera.

python usd_assets/contact_sheet.py [--to FILE.png]
"""

from __future__ import annotations

import argparse
import json
import tempfile
from pathlib import Path

import numpy as np
from PIL import Image, ImageDraw, ImageFont
from pxr import UsdGeom

from wsim.scene import Scene
from wsim.scene.describe import describe
from wsim.sim.cameras import CameraRenderer, Style
from wsim.sim.model import build_model

ASSETS = Path(__file__).parent
COLUMNS = 5
TILE = (256, 216)  # width and height of a picture [px]
LABEL = 26  # height of the line below it [px]
LETTERS = 16  # height of its letters [px]
FILLED = 0.84  # share of a tile that its asset fills
YAW = -28.0  # [deg]: the default camera looks from the front right; this turns an asset's front to it
STYLE = Style(zenith=(0.55, 0.62, 0.70), horizon=(0.74, 0.77, 0.80), checker_contrast=0.0)


def picture(folder: Path, work: Path) -> np.ndarray:
    """One asset on the ground, (height, width, 3) uint8, sRGB."""
    data = json.loads((folder / "asset.json").read_text(encoding="utf-8"))
    scene = Scene()
    scene.ground(color=(0.42, 0.42, 0.40))
    prim = UsdGeom.Xform.Define(scene.stage, f"/World/{data['id']}")
    prim.AddRotateZOp().Set(YAW)
    prim.GetPrim().GetReferences().AddReference(str((folder / data["file"]).resolve()))
    stage = scene.save(work / f"{data['id']}.usda")
    world = describe(stage)
    model = build_model(stage, world, "cpu").model
    # Drawn far larger, cut out and shrunk: fine parts stay whole.
    renderer = CameraRenderer(model, world, 4 * TILE[0], 4 * TILE[1], style=STYLE)
    (image,) = renderer.render(model.state()).values()
    is_ground = np.array([prim.startswith("/World/ground") for prim in renderer.shape_prims])
    seen = (image.shape_index >= 0) & ~is_ground[image.shape_index]
    return np.asarray(Image.fromarray(cut_out(image.rgb, seen)).resize(TILE, Image.Resampling.BOX))


def cut_out(image: np.ndarray, seen: np.ndarray) -> np.ndarray:
    """The part of a picture around the pixels that are `seen`, in the shape of a tile."""
    rows, columns = np.flatnonzero(seen.any(axis=1)), np.flatnonzero(seen.any(axis=0))
    share = max(np.ptp(columns) / image.shape[1], np.ptp(rows) / image.shape[0]) / FILLED
    wide, tall = (min(round(share * n), n) for n in (image.shape[1], image.shape[0]))
    left = min(max((columns[0] + columns[-1] - wide) // 2, 0), image.shape[1] - wide)
    top = min(max((rows[0] + rows[-1] - tall) // 2, 0), image.shape[0] - tall)
    return image[top : top + tall, left : left + wide]


def labelled(image: np.ndarray, text: str) -> np.ndarray:
    """The picture with a line of text below it."""
    strip = Image.new("RGB", (image.shape[1], LABEL), (255, 255, 255))
    middle = (image.shape[1] / 2, LABEL / 2)
    ImageDraw.Draw(strip).text(middle, text, (40, 40, 40), ImageFont.load_default(LETTERS), anchor="mm")
    return np.concatenate([image, np.asarray(strip)])


def sheet(folders: list[Path]) -> np.ndarray:
    """All assets in rows, in the order of their ids."""
    with tempfile.TemporaryDirectory() as work:
        tiles = [labelled(picture(folder, Path(work)), folder.name) for folder in folders]
    while len(tiles) % COLUMNS:
        tiles.append(np.full_like(tiles[0], 255))
    rows = [np.concatenate(tiles[k : k + COLUMNS], axis=1) for k in range(0, len(tiles), COLUMNS)]
    return np.concatenate(rows)


def main() -> None:
    """Write the sheet."""
    parser = argparse.ArgumentParser(description="Draw every asset of the catalogue into one picture.")
    parser.add_argument("--to", type=Path, default=ASSETS.parent / "docs" / "images" / "assets.png")
    parser.add_argument("ids", nargs="*", metavar="ID", help="all by default")
    given = parser.parse_args()
    folders = sorted(path.parent for path in ASSETS.glob("*/asset.json"))
    image = sheet([folder for folder in folders if not given.ids or folder.name in given.ids])
    given.to.parent.mkdir(parents=True, exist_ok=True)
    Image.fromarray(image).save(given.to, "PNG", compress_level=9)


if __name__ == "__main__":
    main()
