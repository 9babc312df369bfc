"""The catalogue of assets: USD files with metadata, found by what people call them.

    from wsim.assets import get, search

    search("coffee cup")[0].asset.id     # "mug"
    get("mug").path                      # .../mug/asset.usda

Imports pydantic only: no USD, no simulator.
"""

from __future__ import annotations

from wsim.assets.catalogue import Asset, AssetError, Hollow, assets_folder, get, load_catalogue
from wsim.assets.search import Hit, search

__all__ = ["Asset", "AssetError", "Hit", "Hollow", "assets_folder", "get", "load_catalogue", "search"]
