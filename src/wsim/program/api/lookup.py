"""The index of what programs may use: search it, or look a name up."""

from __future__ import annotations

import functools
import os
from collections.abc import Callable
from difflib import get_close_matches
from pathlib import Path

from wsim.assets.search import search as search_assets
from wsim.errors import UserError
from wsim.program.api.entry import Entry
from wsim.program.api.search import Hit, Searcher
from wsim.program.api.sources import all as sources
from wsim.program.api.store import Store
from wsim.program.api.vocabulary import vocabulary
from wsim.search.ranking import meant
from wsim.search.words import stem

_KEPT = 4  # files of a part in the cache
Progress = Callable[[str], None]
# Of names that end alike, the one that a program means: the scene's own before USD's before the rest.
_ORDER = (
    "wsim.scene.Scene.", "wsim.scene.", "wsim.", "pxr.UsdPhysics.", "pxr.UsdGeom.", "pxr.Usd.", "pxr.Gf.", "pxr.",
    "numpy.", "math.", "builtins.", "Physics", "Newton", "newton.", "warp.",
)  # fmt: skip


class Index:
    """All that programs may use, and newton and warp beside them.

    Args:
        programs: What programs may use.
        lower: Gives newton and warp; called when they are first asked for.
    """

    def __init__(self, programs: Store, lower: Callable[[], Store]) -> None:
        self.programs = programs
        self._lower = functools.cache(lower)
        self._searcher = _searcher

    def search(self, words: str, limit: int = 8) -> list[Hit]:
        """The entries that fit some words best, by the words, and by those of the same meaning.

        Args:
            words: What is wanted, in a person's words or a name's: "hinge", "how heavy", "GetPrimAtPath".
            limit: At most so many.
        """
        words = words.encode("utf-8", "replace").decode("utf-8")  # half a character is in no index, and has no bytes
        stores = (self.programs, self._lower())
        asked = [
            meant(word, vocabulary(), *(store.ranking for store in stores))
            for word in dict.fromkeys(vocabulary().stems(words))
        ]
        if _is_an_asset(words):
            asked.append({stem("asset"): 1.3})
        found = [hit for store in stores for hit in self._searcher(store).search(words, asked, limit)]
        return sorted(found, key=lambda hit: -hit.score)[:limit]

    def show(self, name: str) -> Entry:
        """The entry of a name, whole or its last parts: "wsim.scene.Scene.box", "Scene.box", "box".

        Raises:
            UserError: If there is none; the nearest names are named.
        """
        text = name.strip().removesuffix("()")
        found = self._named(text)
        if found is None:
            near = self.near(text.rpartition(".")[2])
            hint = f"did you mean {', '.join(near)}?" if near else "search for it by what it does"
            raise UserError(f'"{name}" is not in the API index; {hint}')
        return found

    def near(self, short: str, limit: int = 3) -> list[str]:
        """Whole names whose last part is spelt like this."""
        names = []
        for close in get_close_matches(short.lower(), self.programs.shorts(), n=limit, cutoff=0.7):
            names += sorted(self.programs.ending(close), key=rank)[:1]
        return names

    def _named(self, text: str) -> Entry | None:
        aliases = {"np.": "numpy.", "wp.": "warp.", "scene.": "wsim.scene.Scene."}
        for short, whole in aliases.items():
            if text.startswith(short):
                text = whole + text.removeprefix(short)
        for store in (self.programs, None):
            store = store or self._lower()
            exact = store.find(text)
            if exact is not None:
                return exact
            ending = [n for n in store.ending(text.rpartition(".")[2]) if f".{n}".lower().endswith(f".{text}".lower())]
            if ending:
                return store.find(min(ending, key=rank))
        return None


def _is_an_asset(words: str) -> bool:
    """Whether a thing of the catalogue is meant: it is placed by `Scene.asset`, whose text names few of them."""
    return any(hit.score > 0.5 for hit in search_assets(words, 1))  # above a half the noun is what it is called


@functools.cache
def _searcher(store: Store) -> Searcher:
    return Searcher(store)


def rank(name: str) -> tuple[int, int, str]:
    """Orders names that end alike by what a program reaches for first."""
    place = next((i for i, start in enumerate(_ORDER) if name.startswith(start)), len(_ORDER))
    return place, len(name), name


def index(progress: Progress | None = None) -> Index:
    """The index of what is installed: from the cache, else built, which takes some seconds, and kept there.

    The cache is ~/.cache/wsim/api, or $XDG_CACHE_HOME/wsim/api; where it cannot be written the index is built anew by
    each process.

    Args:
        progress: Told what is being read while the index is built.
    """
    told = progress or (lambda _: None)
    return Index(_store("programs", told), lambda: _store("lower", told))


@functools.cache
def _opened() -> dict[str, Store]:
    """The stores that this process has opened."""
    return {}


def _store(part: str, progress: Progress) -> Store:
    if part not in _opened():
        _opened()[part] = _read(part, progress)
    return _opened()[part]


def _read(part: str, progress: Progress) -> Store:
    file = _folder() / f"{part}-{sources.key(part)}.sqlite"
    found = Store.open(file)
    if found is None:
        missed: list[str] = []
        found = Store.of(sources.entries(part, progress, missed.append))
        for why in missed:
            progress(f"API index: not kept, since this could not be read: {why}")
        if not missed and found.save(file):
            _forget(part, file.parent)
    return found


def _forget(part: str, folder: Path) -> None:
    """Remove what older installations left, but for the last few: checkouts may take turns."""
    files = sorted(folder.glob(f"{part}-*.sqlite"), key=lambda file: file.stat().st_mtime)
    for file in files[:-_KEPT]:
        file.unlink(missing_ok=True)


def _folder() -> Path:
    home = os.environ.get("XDG_CACHE_HOME", "")
    # The specification has a relative path ignored.
    base = Path(home) if os.path.isabs(home) else Path("~/.cache").expanduser()  # noqa: PTH117
    return base / "wsim" / "api"
