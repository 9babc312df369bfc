"""Where robots lie that were taken in: a USD layer each, in a folder of the user's assets."""

from __future__ import annotations

from difflib import get_close_matches
from pathlib import Path

from wsim.assets.folders import AssetError, user_folder

SUFFIX = ".usdc"


def robots_folder() -> Path:
    """The folder of the user's robots, which need not be there."""
    return user_folder() / "robots"


def robots() -> list[str]:
    """The ids of all robots that were taken in."""
    return sorted(path.stem for path in robots_folder().glob(f"*{SUFFIX}"))


def robot_path(id: str) -> Path:
    """The layer of a robot.

    Raises:
        AssetError: If there is none of that id; it names those that may be meant.
    """
    path = robots_folder() / f"{id}{SUFFIX}"
    if path.is_file():
        return path
    near = get_close_matches(str(id).lower(), robots(), n=3, cutoff=0.6)
    hint = f"did you mean {' or '.join(map(repr, near))}?" if near else f"known: {', '.join(robots()) or 'none'}"
    raise AssetError(f"no robot {str(id)[:60]!r}; {hint}; `wsim assets robot FILE --name {str(id)[:60]}` takes one in")
