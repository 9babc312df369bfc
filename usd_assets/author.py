"""Write the catalogue: asset.usda and asset.json of each asset, or of those that are named.

    python usd_assets/author.py [ID...] [--into FOLDER]
    python usd_assets/author.py --table    # the tables of docs/assets.md, written into it

Run again after a change in `authoring`; a test holds files and tables against what this writes.
"""

from __future__ import annotations

import argparse
import json
from pathlib import Path

from authoring import ASSETS, FAMILIES

PAGE = Path(__file__).parents[1] / "docs" / "assets.md"
MARKS = ("<!-- made by usd_assets/author.py --table -->", "<!-- to here -->")


def tables(folder: Path) -> str:
    """The assets in a folder as Markdown, by family, each with its picture."""
    written = {path.parent.name for path in folder.glob("*/asset.json")}
    parts = [f"There are {len(written)}, in {len(FAMILIES)} families. Those marked * have parts that move on joints.\n"]
    for family, functions in FAMILIES.items():
        ids = [function.__name__ for function in functions]
        picture = f"![{family.capitalize()}: {', '.join(ids).replace('_', ' ')}.](images/assets_{family}.png)"
        parts.append(f"### {family.capitalize()}\n\n{picture}\n\n{_table(folder, [id for id in ids if id in written])}")
    return "\n".join(parts)


def _table(folder: Path, ids: list[str]) -> str:
    rows = ["| id | what it is | size x, y, z [m] | mass [kg] | anchors | hollow x, y, z [m] |", "|" + " --- |" * 6]
    for id in ids:
        data = json.loads((folder / id / "asset.json").read_text(encoding="utf-8"))
        hollow = _edges(data["hollow"]["size"]) if data["hollow"] else ""
        anchors = ", ".join(f"`{name}`" for name in data["anchors"])
        name = f"`{id}`" + (" *" if data["articulated"] else "")
        cells = (name, data["description"], _edges(data["size"]), f"{data['mass']:.3g}", anchors, hollow)
        rows.append("| " + " | ".join(cells) + " |")
    return "\n".join(rows) + "\n"


def document(text: str, made: str) -> str:
    """The page with what stands between its marks replaced."""
    before, _, rest = text.partition(MARKS[0])
    _, _, after = rest.partition(MARKS[1])
    return f"{before}{MARKS[0]}\n\n{made}\n{MARKS[1]}{after}"


def _edges(size: list[float]) -> str:
    return " × ".join(f"{edge:.3g}" for edge in size)


def main() -> None:
    """Write the assets."""
    parser = argparse.ArgumentParser(description="Write the assets of the catalogue.")
    parser.add_argument("ids", nargs="*", metavar="ID", help=f"one of {', '.join(ASSETS)}; all by default")
    parser.add_argument("--into", type=Path, default=Path(__file__).parent, help="folder of the assets' folders")
    parser.add_argument("--table", action="store_true", help="write no asset, but the tables of docs/assets.md")
    given = parser.parse_args()
    unknown = [id for id in given.ids if id not in ASSETS]
    if unknown:
        parser.error(f"unknown: {', '.join(unknown)}; known: {', '.join(ASSETS)}")
    if given.table:
        PAGE.write_text(document(PAGE.read_text(encoding="utf-8"), tables(given.into)), encoding="utf-8")
        return
    for id in given.ids or ASSETS:
        asset = ASSETS[id]()
        asset.center()
        asset.write(given.into / id)


if __name__ == "__main__":
    main()
