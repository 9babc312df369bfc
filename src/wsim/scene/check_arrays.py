"""Arrays of a stage that must fit one another: what points into one, what divides one, what is as long as one."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pxr import Usd

Indices = NDArray[np.int64]


def integers(attribute: Usd.Attribute) -> Indices | str:
    """The whole numbers of an attribute in one row, none if it is not given; or what is wrong with them."""
    if attribute.GetNumTimeSamples():
        return f"{attribute.GetPath()}: must not change over time"
    value = attribute.Get()
    if value is None or len(value) == 0:
        return np.zeros(0, dtype=np.int64)
    numbers = np.asarray(value)
    if numbers.dtype.kind not in "iu":
        return f"{attribute.GetPath()}: {numbers.dtype.name} numbers; they must be whole"
    return numbers.reshape(-1).astype(np.int64)


def within(attribute: Usd.Attribute, count: int, what: str) -> Iterator[str]:
    """Indices that do not point at one of `count`."""
    numbers = integers(attribute)
    if isinstance(numbers, str):
        yield numbers
        return
    bad = np.flatnonzero((numbers < 0) | (numbers >= count))
    if bad.size:
        limit = f"must be 0 to {count - 1}" if count else "points at nothing"
        yield f"{attribute.GetPath()}: [{bad[0]}] = {numbers[bad[0]]} {limit}; there are {count} {what}"


def sizes(attribute: Usd.Attribute, least: int, total: int, what: str) -> Iterator[str]:
    """Sizes of consecutive parts of an array that are too small, or that do not add up to all of it."""
    numbers = integers(attribute)
    if isinstance(numbers, str):
        yield numbers
        return
    bad = np.flatnonzero(numbers < least)
    if bad.size:
        yield f"{attribute.GetPath()}: [{bad[0]}] = {numbers[bad[0]]} must be >= {least}"
    elif int(numbers.sum()) != total:
        yield f"{attribute.GetPath()}: their sum is {int(numbers.sum())}; there are {total} {what}"


def as_many(attribute: Usd.Attribute, count: int, what: str) -> Iterator[str]:
    """An array, if it is given, that has not one value for each of `count`."""
    value = first_value(attribute)
    if value is not None and len(value) not in (0, count):
        yield f"{attribute.GetPath()}: {len(value)} values; there are {count} {what}"


def first_value(attribute: Usd.Attribute) -> Any:
    """What an attribute has at the default time, else at its first sample; None if it has nothing."""
    if not attribute:
        return None
    value = attribute.Get()
    times = attribute.GetTimeSamples() if value is None else []
    return attribute.Get(times[0]) if times else value


def steady(prim: Usd.Prim) -> Iterator[str]:
    """Arrays of a prim that have more or fewer values at one time than at another."""
    for attribute in prim.GetAuthoredAttributes():
        times = attribute.GetTimeSamples() if attribute.GetTypeName().isArray else []
        if not times:
            continue
        count = len(first_value(attribute))
        other = next((time for time in times if len(attribute.Get(time) or ()) != count), None)
        if other is not None:
            found = len(attribute.Get(other) or ())
            yield f"{attribute.GetPath()}: {found} values at time {other:g}; there are {count} before it"
