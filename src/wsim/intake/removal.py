"""Take an asset of a user's out of the catalogue."""

from __future__ import annotations

import shutil
from pathlib import Path

from wsim.assets import get, load_catalogue, unreadable, user_folder
from wsim.intake.model import IntakeError


def remove(id: str) -> Path:
    """Remove an asset of the user's; where it was.

    Raises:
        IntakeError: If it is a shipped one, or there is none.
    """
    folder = user_folder() / id
    if id not in (*load_catalogue(), *unreadable()) or "/" in id or id.startswith("."):
        get(id)
    if not folder.is_dir():
        raise IntakeError(f"{id!r} is shipped with wsim and stays; `wsim assets list` marks your own")
    shutil.rmtree(folder)
    user_folder().touch()
    return folder
