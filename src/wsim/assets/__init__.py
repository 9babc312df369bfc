"""The catalogue of assets: USD files with metadata, found by what people call them.

    from wsim.assets import get, search

    search("coffee cup")[0].asset.id     # "mug"
    get("mug").path                      # .../mug/asset.usda

Imports pydantic only: no USD, no simulator.
"""

from __future__ import annotations

from wsim.assets.catalogue import Asset, Collision, Hollow, Room, get, is_own, load_catalogue, unreadable
from wsim.assets.folders import AssetError, asset_folders, assets_folder, user_folder
from wsim.assets.search import Hit, search

__all__ = [
    "Asset",
    "AssetError",
    "Collision",
    "Hit",
    "Hollow",
    "Room",
    "asset_folders",
    "assets_folder",
    "get",
    "is_own",
    "load_catalogue",
    "search",
    "unreadable",
    "user_folder",
]
