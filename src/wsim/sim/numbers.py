"""What a world's builder has other than another world's of the same topology: numbers, sent from process to process.

Newton's importer takes some thirty milliseconds a stage and builders cannot be pickled. So the first world of a batch
is imported here, and each other one in a fork that has the first one's builder, too, and sends what differs.
"""

from __future__ import annotations

import copy
import ctypes
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np

CUSTOM = "custom_attributes"
GRAVITY = "_gravity"
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


def add_worlds(builder: Any, first: Any, others: Sequence[Any]) -> None:
    """Add a world, and others of its topology, to a builder that has none: what `add_world` of each adds.

    Where others differ in rows of numbers alone, the first one is replicated and those are set as arrays: a world costs
    some hundredths of what `add_world` does.

    Args:
        builder: A `newton.ModelBuilder`.
        first: That of the first world.
        others: Of each other one its builder, or its `differences` from the first.
    """
    names = {name for each in others if isinstance(each, Mapping) for name in each} - {GRAVITY}
    values = values_of(first)
    if not all(isinstance(each, Mapping) for each in others) or not all(_is_rows(name, values[name]) for name in names):
        # First all, then all added: a builder that was added somewhere has notes of it.
        for each in [first, *(with_numbers(first, each) if isinstance(each, Mapping) else each for each in others)]:
            builder.add_world(each)
        return
    builder.replicate(first, 1 + len(others))
    for k, each in enumerate(others, start=1):
        if GRAVITY in each:
            builder.world_gravity[k] = _like(values[GRAVITY], each[GRAVITY], GRAVITY)
    for name in names:
        own = _plain(values[name])
        _set_rows(builder, name, values[name], [own, *(each.get(name, own) for each in others)])


def _is_rows(name: str, value: Any) -> bool:
    """Whether an attribute is numbers of things that a world has as many of as any other, none of them an index."""
    return isinstance(value, list | dict) and not name.startswith(PARTICLES) and _is_real(_plain(value))


def _is_real(told: Any) -> bool:
    if isinstance(told, list | tuple | dict):
        return all(map(_is_real, told.values() if isinstance(told, dict) else told))
    return told is None or isinstance(told, float)


def _set_rows(builder: Any, name: str, first: Any, told: Sequence[Any]) -> None:
    """Set what a builder of replicated worlds has under a name, to the plain numbers of each world."""
    space, _, custom = name.partition("/")
    if space != CUSTOM:
        # What Newton replicates as an array it has not as a list.
        is_list = name in vars(builder)
        rows = [row for each in told for row in (_like(first, each, name) if is_list else each)]
        setattr(builder, name, rows if is_list else np.asarray(rows, dtype=np.float64))
        return
    kept, each_world = builder.custom_attributes[custom].values, [_like(first, each, name) for each in told]
    if isinstance(first, dict):  # by things' numbers, world after world
        rows = [row for each in each_world for row in each.values()]
        kept.update(zip(list(kept), rows, strict=True))
        return
    things = (len(kept) - len(first)) // (len(told) - 1)  # of a world: the last of them may have no values
    for k, each in enumerate(each_world):
        kept[k * things : k * things + len(each)] = each


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
