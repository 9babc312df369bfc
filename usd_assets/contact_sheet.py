"""Draw a picture of each family of assets into docs/images/assets_FAMILY.png, with wsim's own camera.

python usd_assets/contact_sheet.py [FAMILY...] [--into FOLDER]
"""

from __future__ import annotations

import argparse
import json
import tempfile
from pathlib import Path

import numpy as np
from authoring import FAMILIES
from PIL import Image, ImageDraw, ImageFont
from pxr import Sdf, Usd, UsdGeom, UsdShade

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
COLORS = 192  # of a sheet: so its file is a third as large
STYLE = Style(zenith=(0.55, 0.62, 0.70), horizon=(0.74, 0.77, 0.80), checker_contrast=0.0)


def picture(folder: Path, work: Path) -> np.ndarray:
    """One asset on the ground, (height, width, 3) uint8, sRGB."""
    data = json.loads((folder / "asset.json").read_text(encoding="utf-8"))
    image, seen = drawn(folder / data["file"], work)
    if "opacity" in (folder / data["file"]).read_text(encoding="utf-8"):
        # Glass hides nothing: where it is seen is where it would be, if it did.
        _, seen = drawn(folder / data["file"], work, glass=False)
    return np.asarray(Image.fromarray(cut_out(image, seen)).resize(TILE, Image.Resampling.BOX))


def drawn(file: Path, work: Path, *, glass: bool = True) -> tuple[np.ndarray, np.ndarray]:
    """An asset on the ground and which pixels are its own; without `glass` nothing is seen through."""
    scene = Scene()
    scene.ground(color=(0.42, 0.42, 0.40))
    prim = UsdGeom.Xform.Define(scene.stage, "/World/asset")
    prim.AddRotateZOp().Set(YAW)
    prim.GetPrim().GetReferences().AddReference(str(file.resolve()))
    if not glass:
        for part in Usd.PrimRange(prim.GetPrim()):
            if part.IsA(UsdShade.Shader):
                part.CreateAttribute("inputs:opacity", Sdf.ValueTypeNames.Float).Set(1.0)
    stage = scene.save(work / "stage.usda")
    world = describe(stage)
    model = build_model(stage, world, "cpu").model
    # Drawn far larger, cut out and shrunk: fine parts stay whole.
    renderer = CameraRenderer(model, world, 4 * TILE[0], 4 * TILE[1], style=STYLE)
    (image,) = renderer.render(model.state()).values()
    is_ground = np.array([prim.startswith("/World/ground") for prim in renderer.shape_prims])
    seen = (image.shape_index >= 0) & ~is_ground[image.shape_index]
    return image.rgb, seen


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


def sheet(ids: list[str]) -> np.ndarray:
    """Assets in rows."""
    with tempfile.TemporaryDirectory() as work:
        tiles = [labelled(picture(ASSETS / id, Path(work)), id.replace("_", " ")) for id in ids]
    while len(tiles) % COLUMNS:
        tiles.append(np.full_like(tiles[0], 255))
    rows = [np.concatenate(tiles[k : k + COLUMNS], axis=1) for k in range(0, len(tiles), COLUMNS)]
    return np.concatenate(rows)


def main() -> None:
    """Write the sheets."""
    parser = argparse.ArgumentParser(description="Draw the families of the catalogue, a picture each.")
    parser.add_argument("families", nargs="*", metavar="FAMILY", help=f"of {', '.join(FAMILIES)}; all by default")
    parser.add_argument("--into", type=Path, default=ASSETS.parent / "docs" / "images")
    given = parser.parse_args()
    unknown = [family for family in given.families if family not in FAMILIES]
    if unknown:
        parser.error(f"unknown: {', '.join(unknown)}; known: {', '.join(FAMILIES)}")
    given.into.mkdir(parents=True, exist_ok=True)
    for family in given.families or FAMILIES:
        image = Image.fromarray(sheet([function.__name__ for function in FAMILIES[family]]))
        image.quantize(COLORS, dither=Image.Dither.NONE).save(given.into / f"assets_{family}.png", optimize=True)


if __name__ == "__main__":
    main()
