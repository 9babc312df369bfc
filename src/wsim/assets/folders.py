"""Where assets lie: those that wsim ships, and the user's own."""

from __future__ import annotations

import os
from pathlib import Path

from wsim.errors import UserError

VARIABLE = "WSIM_ASSETS"  # names the user's folder
_SHIPPED = Path(__file__).parents[1] / "_usd_assets"  # in a wheel
_SOURCE = Path(__file__).parents[3] / "usd_assets"  # in the repository


class AssetError(UserError):
    """There is no such asset, or its metadata is wrong: one line with the way out."""


def assets_folder() -> Path:
    """The folder of the shipped assets.

    Raises:
        AssetError: If it is nowhere.
    """
    for folder in (_SHIPPED, _SOURCE):
        if folder.is_dir():
            return folder
    raise AssetError(f"the assets are in neither {_SHIPPED} nor {_SOURCE}; install wsim again")


def user_folder() -> Path:
    """The folder of the user's own assets, which need not be there.

    $WSIM_ASSETS, else $XDG_DATA_HOME/wsim/assets, else ~/.local/share/wsim/assets.
    """
    named = os.environ.get(VARIABLE)
    if named:
        return Path(named).absolute()
    base = os.environ.get("XDG_DATA_HOME") or str(Path.home() / ".local" / "share")
    return Path(base) / "wsim" / "assets"


def asset_folders() -> list[Path]:
    """Every folder that programs may read assets from: the shipped one, and the user's where it is there."""
    return [folder for folder in (assets_folder(), user_folder()) if folder.is_dir()]


def stamp() -> tuple[str, int]:
    """Changes when an asset of the user's is added, replaced or removed: the folder, and when it last changed [ns]."""
    folder = user_folder()
    try:
        return str(folder), folder.stat().st_mtime_ns
    except OSError:
        return str(folder), 0
