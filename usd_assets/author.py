"""Write the catalogue: asset.usda and asset.json of each asset, or of those that are named.

    python usd_assets/author.py [ID...] [--into FOLDER]
    python usd_assets/author.py --table    # the table of docs/assets.md

Run again after a change in `authoring`; a test holds files and table against what this writes.
"""

from __future__ import annotations

import argparse
import json
import sys
from pathlib import Path

from authoring import ASSETS


def table(folder: Path) -> str:
    """The assets in a folder as Markdown, in the order of their ids."""
    rows = ["| id | what it is | size x, y, z [m] | mass [kg] | anchors | hollow x, y, z [m] |", "|" + " --- |" * 6]
    for path in sorted(folder.glob("*/asset.json")):
        data = json.loads(path.read_text(encoding="utf-8"))
        hollow = _edges(data["hollow"]["size"]) if data["hollow"] else ""
        anchors = ", ".join(f"`{name}`" for name in data["anchors"])
        cells = (f"`{data['id']}`", data["description"], _edges(data["size"]), f"{data['mass']:.3g}", anchors, hollow)
        rows.append("| " + " | ".join(cells) + " |")
    return "\n".join(rows) + "\n"


def _edges(size: list[float]) -> str:
    return " × ".join(f"{edge:.3g}" for edge in size)


def main() -> None:
    """Write the assets."""
    parser = argparse.ArgumentParser(description="Write the assets of the catalogue.")
    parser.add_argument("ids", nargs="*", metavar="ID", help=f"one of {', '.join(ASSETS)}; all by default")
    parser.add_argument("--into", type=Path, default=Path(__file__).parent, help="folder of the assets' folders")
    parser.add_argument("--table", action="store_true", help="write nothing; show the catalogue as a table")
    given = parser.parse_args()
    unknown = [id for id in given.ids if id not in ASSETS]
    if unknown:
        parser.error(f"unknown: {', '.join(unknown)}; known: {', '.join(ASSETS)}")
    if given.table:
        sys.stdout.write(table(given.into))
        return
    for id in given.ids or ASSETS:
        asset = ASSETS[id]()
        asset.center()
        asset.write(given.into / id)


if __name__ == "__main__":
    main()
