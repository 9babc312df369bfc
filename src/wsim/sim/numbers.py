"""What a world's builder has other than another world's of the same topology: numbers, sent from process to process.

Newton's importer takes some thirty milliseconds a stage and builders cannot be pickled. So the first world of a batch
is imported here, and each other one in a fork that has the first one's builder, too, and sends what differs.
"""

from __future__ import annotations

import copy
import ctypes
from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np

CUSTOM = "custom_attributes"
PARTICLES = "particle_"  # lists of which a world may have more than another, as it has more water


class OtherThanNumbersError(ValueError):
    """Builders differ in what is not sent."""


def texts(builder: Any) -> dict[str, str]:
    """All that a builder holds as text, which tells -0 from 0 and takes NaN for itself."""
    return {name: plain_text(value) for name, value in values_of(builder).items()}


def plain_text(value: Any) -> str:
    """What a builder holds under a name, as text."""
    return repr(_plain(value))


def differences(own: Any, first: Any, known: Mapping[str, str]) -> dict[str, Any]:
    """What `with_numbers` makes a copy of one `newton.ModelBuilder` of, from another.

    Args:
        own: The one.
        first: The other.
        known: Its `texts`, which many are held against.

    Raises:
        OtherThanNumbersError: If it would not be the same to the last bit.
    """
    theirs, mine = values_of(first), values_of(own)
    if theirs.keys() != mine.keys():
        raise OtherThanNumbersError(f"attributes {sorted(theirs.keys() ^ mine.keys())}")
    found = {}
    for name, value in mine.items():
        told = _plain(value)
        text = repr(told)
        if text != known[name]:
            found[name] = told
            if repr(_plain(_like(theirs[name], told, name))) != text:
                raise OtherThanNumbersError(name)
    return found


def with_numbers(first: Any, found: Mapping[str, Any]) -> Any:
    """A copy of a builder with the numbers of another; it shares all else, and is for `add_world` alone."""
    made = copy.copy(first)
    customs = dict(getattr(first, CUSTOM))
    setattr(made, CUSTOM, customs)
    values = values_of(first)
    for name, told in found.items():
        new, (space, _, custom) = _like(values[name], told, name), name.partition("/")
        if space == CUSTOM:
            customs[custom] = copy.copy(customs[custom])
            customs[custom].values = new
        else:
            setattr(made, name, new)
    return made


def values_of(builder: Any) -> dict[str, Any]:
    """All that a builder holds, each custom attribute's values by its name."""
    found = {name: value for name, value in vars(builder).items() if name != CUSTOM}
    customs = getattr(builder, CUSTOM)
    return found | {f"{CUSTOM}/{name}": custom.values for name, custom in customs.items()}


def _plain(value: Any) -> Any:
    """A value as Python's own numbers, texts, lists and dicts; an object as what it holds."""
    if value is None or isinstance(value, bool | int | float | str):
        return value
    if isinstance(value, ctypes.Array):  # Warp's vectors, matrices and transforms
        return [float(number) for number in np.asarray(value).ravel()]
    if isinstance(value, np.ndarray | np.generic):
        return value.tolist()
    if isinstance(value, Mapping):
        return {_plain(key): _plain(each) for key, each in value.items()}
    if isinstance(value, tuple):
        return tuple(map(_plain, value))
    if isinstance(value, set | frozenset):
        return sorted(map(repr, map(_plain, value)))
    if isinstance(value, Iterable):
        return [_plain(each) for each in value]
    if hasattr(value, "__dict__"):
        return {name: _plain(each) for name, each in vars(value).items()}
    return repr(type(value))


def _like(first: Any, told: Any, name: str) -> Any:
    """Plain numbers in the form that the first builder has them in."""
    if isinstance(first, ctypes.Array):
        return type(first)(*told)
    if name.startswith(PARTICLES) and isinstance(first, list) and isinstance(told, list) and first:
        return [_like(first[0], other, "") for other in told]
    if isinstance(first, list | tuple) and isinstance(told, list | tuple) and len(first) == len(told):
        return type(first)(_like(one, other, name) for one, other in zip(first, told, strict=True))
    if name == f"{CUSTOM}/sph:pressure" and isinstance(told, dict):
        return dict(told)
    if isinstance(first, dict) and isinstance(told, dict) and first.keys() == told.keys():
        return {key: _like(one, told[key], name) for key, one in first.items()}
    if type(first) is type(told) and isinstance(told, bool | int | float | str | None):
        return told
    raise OtherThanNumbersError(name)
