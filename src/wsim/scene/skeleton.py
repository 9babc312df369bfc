"""What two stages of one program have in common: their text without the numbers that descriptions state.

Worlds of one skeleton have the same prims, paths, materials, meshes and time samples, and differ in numbers alone that
`wsim.scene.describe` reads, or that nobody does.
"""

from __future__ import annotations

import functools
import hashlib
import re
from pathlib import Path

# What is left out: numbers of the description, or nothing to Newton's importer. A plane's length and width are neither;
# a line that goes on to say something else is kept.
_NAMES = (
    r"(?:xformOp:[\w:]+|wsim:\w+|size|height|radius|extent|physics:(?:mass|density|centerOfMass|diagonalInertia|"
    r"principalAxes|velocity|angularVelocity|dynamicFriction|staticFriction|restitution|gravityDirection|gravityMagnitude|"
    r"lowerLimit|upperLimit)|newton:friction|drive:\w+:physics:(?:targetPosition|targetVelocity|stiffness|damping))"
)
KNOWN = re.compile(rb"( *(?:uniform )?[a-z0-9]+(?:\[\])? %s = )[-+\w.,() \[\]]*" % _NAMES.encode())
TEXT = b"#usda"
REFERENCE = b"@"  # to a file, which may be another
_MOST_LINES, _LONG = 1 << 16, 256  # that are remembered, and bytes of one that is not
_kept: dict[bytes, bytes] = {}  # lines that were seen, without their numbers


def skeleton(stage: Path) -> str:
    """A digest of a stage's text without its known numbers; "" of what is no text, or names other files."""
    return skeleton_of(stage.read_bytes())


def skeleton_of(text: bytes) -> str:
    """As `skeleton`, of the text itself."""
    if not text.startswith(TEXT) or REFERENCE in text:
        return ""
    if len(_kept) > _MOST_LINES:
        _kept.clear()
    return hashlib.sha256(b"\n".join(map(_without_numbers, text.split(b"\n")))).hexdigest()


@functools.lru_cache(maxsize=1 << 12)
def is_free(name: str) -> bool:
    """Whether an attribute of this name may have another value in a stage of the same skeleton."""
    return re.fullmatch(_NAMES, name) is not None


def _without_numbers(line: bytes) -> bytes:
    kept = _kept.get(line)
    if kept is None:
        found = KNOWN.fullmatch(line)
        kept = found[1] if found else line
        if len(line) < _LONG:
            _kept[line] = kept
    return kept
