"""Tools that look into the catalogue of assets."""

from __future__ import annotations

from pydantic import Field

from wsim.assets import get, search
from wsim.tools.base import Arguments, Result, Tool, Workspace
from wsim.tools.text import number, numbers, table

MOST = 20


class Words(Arguments):
    """Words to look for."""

    words: str = Field(description="what people call it: a noun or a phrase", min_length=1, max_length=200)
    limit: int = Field(5, ge=1, le=MOST, description="most hits")


class AssetId(Arguments):
    """An asset."""

    id: str = Field(description="the asset's id, as search_catalogue gives it", min_length=1, max_length=100)


def search_catalogue(workspace: Workspace, asked: Words) -> Result:
    """Assets that may be meant, the best first."""
    hits = search(asked.words, asked.limit)
    if not hits:
        return Result(f"nothing in the catalogue is called {asked.words[:60]!r}; build it of primitives, or ask wider")
    rows = [
        [hit.asset.id, number(hit.score), hit.matched, numbers(hit.asset.size, " x "), number(hit.asset.mass)]
        for hit in hits
    ]
    return Result("\n".join(table(("id", "score", "matched", "size x y z [m]", "mass [kg]"), rows)))


def show_asset(workspace: Workspace, asked: AssetId) -> Result:
    """What is known of one asset."""
    asset = get(asked.id)
    anchors = [[name, numbers(point)] for name, point in asset.anchors.items()]
    joints = "has joints" if asset.articulated else "no joints"
    lines = [
        f"{asset.id}: {asset.description}",
        f"size {numbers(asset.size, ' x ')} m, mass {number(asset.mass)} kg, {joints}",
        f"+X is {asset.forward}; its origin is the {asset.origin}",
        f"colours: {', '.join(f'{name} ({numbers(color)})' for name, color in asset.colors.items())}",
        f"licence {asset.license}; {asset.source}",
    ]
    if asset.hollow:
        lines.insert(2, f"hollow of {numbers(asset.hollow.size, ' x ')} m about ({numbers(asset.hollow.center)})")
    return Result("\n".join([*lines, *table(("anchor", "at [m]"), anchors)]))


TOOLS = (
    Tool(
        "search_catalogue", "Find assets by what people call them: id, size and mass.", Words, search_catalogue,
        needs_run=False, narrow="lower limit",
    ),
    Tool(
        "show_asset", "One asset: size, mass, anchors, hollow, which way it faces, licence.", AssetId, show_asset,
        needs_run=False,
    ),
)  # fmt: skip
