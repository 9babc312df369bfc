"""All that the index is made of, and what tells one installation from another."""

from __future__ import annotations

import dataclasses
import hashlib
import sys
from collections.abc import Callable, Iterable, Iterator
from importlib import metadata
from pathlib import Path

from wsim.program.api.entry import Entry
from wsim.program.api.sources import pxr_bindings, python_package, usd_schemas

Part = str  # "programs" or "lower"
Told = Callable[[str], None]
Read = Callable[[Told], Iterator[Entry]]
PACKAGES = {
    "programs": ("numpy", "usd-core", "newton-usd-schemas", "griffelib"),
    "lower": ("newton", "warp-lang", "griffelib"),
}
_FORMAT = "2"


def key(part: Part) -> str:
    """Changes with what is installed and with what reads it; of what programs may use, with wsim's own files too."""
    parts = [_FORMAT, sys.version]
    for name in PACKAGES[part]:
        try:
            parts.append(f"{name} {metadata.version(name)}")
        except metadata.PackageNotFoundError:
            parts.append(f"{name} -")
    parts += [hashlib.sha256(file.read_bytes()).hexdigest() for file in files(part)]
    return hashlib.sha256("\n".join(parts).encode()).hexdigest()[:24]


def files(part: Part) -> list[Path]:
    """The files of wsim's that a part hangs on: what reads and stems it, and what of it programs may use."""
    home = Path(__file__).parents[3]
    found = sorted([*(home / "program" / "api").rglob("*"), *(home / "search").rglob("*")])
    if part == "programs":
        found += sorted((home / "scene").rglob("*"))
        found += [home / "program" / "control_world.py", *sorted((home / "assets").glob("*.py"))]
    return [file for file in found if file.suffix in (".py", ".usda", ".json", ".toml") and file.is_file()]


def entries(part: Part, progress: Told, missed: Told) -> Iterator[Entry]:
    """Every entry of a part; of two with one name the first counts.

    Args:
        part: Which.
        progress: Told what is being read.
        missed: Told what could not be read this time, and may be the next.
    """
    for title, read in _SOURCES[part].items():
        progress(f"API index: reading {title}")
        yield from read(missed)


def _scene(_: Told) -> Iterator[Entry]:
    from wsim.program.api.sources.python_source import Package  # griffe, for an index that is made anew

    package = Package("wsim", "wsim")
    names = ("wsim.scene", "wsim.program.control_world", "wsim.assets")
    own = tuple(f"wsim.scene.{module}" for module in ("check", "describe", "curves", "sections"))
    yield from _without(package.entries(*names, private=True), own)
    yield Entry("wsim", "module", "wsim")
    yield from package._member("wsim.run", package.modules["wsim.run"])


def _without(found: Iterable[Entry], modules: tuple[str, ...]) -> Iterator[Entry]:
    return (entry for entry in found if not entry.name.startswith(modules))


def _pxr(missed: Told) -> Iterator[Entry]:
    return pxr_bindings.entries(missed)


def _schemas(_: Told) -> Iterator[Entry]:
    return usd_schemas.entries()


def _numpy(_: Told) -> Iterator[Entry]:
    return python_package.entries(python_package.NUMPY, "numpy")


def _standard(_: Told) -> Iterator[Entry]:
    return python_package.entries(python_package.STANDARD, "python")


def _lower(name: str) -> Read:
    def read(missed: Told) -> Iterator[Entry]:
        from wsim.program.api.sources.python_source import Package  # griffe, for an index that is made anew

        try:
            package = Package(name, name, programs=False)
        except ImportError:  # it is not installed
            return
        except OSError as error:
            missed(f"{name}: {error}")
            return
        for entry in package.entries(name):
            yield dataclasses.replace(entry, doc=entry.doc[:1500])

    return read


_SOURCES: dict[Part, dict[str, Read]] = {
    "programs": {
        "wsim.scene": _scene,
        "USD's schemas": _schemas,
        "pxr": _pxr,
        "NumPy": _numpy,
        "the standard library": _standard,
    },
    "lower": {"Newton": _lower("newton"), "Warp": _lower("warp")},
}
