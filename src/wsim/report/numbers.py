"""Numbers as people read them."""

from __future__ import annotations

import math
from collections.abc import Iterable

LARGE, SMALL = 6, -4  # powers of ten from which a number is written with one
SUPERSCRIPTS = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
MINUS, NARROW_SPACE = "\N{MINUS SIGN}", "\N{NARROW NO-BREAK SPACE}"
MOST_DIGITS = 7


def number(x: float | None, digits: int = 3, sign: bool = False) -> str:
    """A number with so many significant digits, e.g. 0.152, 12 400, 1.3 × 10⁻⁶; nothing for None.

    Digits before the decimal point are all kept, and zeros at the end of decimals dropped.
    """
    if x is None:
        return ""
    if math.isnan(x):
        return "not a number"
    prefix = MINUS if x < 0 else "+" if sign and x > 0 else ""
    x = abs(x)
    if math.isinf(x):
        return prefix + "∞"
    if x == 0:
        return "0"
    power = math.floor(math.log10(float(f"{x:.{digits - 1}e}")))
    if power >= LARGE or power < SMALL:
        return f"{prefix}{_plain(x / 10.0**power, digits - 1)} × 10{str(power).translate(SUPERSCRIPTS)}"
    return prefix + _plain(x, max(0, digits - 1 - power))


def quantity(x: float | None, unit: str = "", digits: int = 3, sign: bool = False) -> str:
    """A number with its unit."""
    text = number(x, digits, sign)
    unit = nice_unit(unit)
    return f"{text}\N{NO-BREAK SPACE}{unit}" if text and unit else text


def nice_unit(unit: str) -> str:
    """kg/m^3 → kg/m³; a plain number's unit, 1, is not shown."""
    if unit == "1":
        return ""
    for power, sup in (("^-1", "⁻¹"), ("^-2", "⁻²"), ("^2", "²"), ("^3", "³")):
        unit = unit.replace(power, sup)
    return unit.replace("*", "·")


def digits_to_tell_apart(values: Iterable[float | None]) -> int:
    """The fewest significant digits, 3 or more, with which different values look different."""
    known = {x for x in values if x is not None and math.isfinite(x)}
    for digits in range(3, MOST_DIGITS):
        if len({number(x, digits) for x in known}) == len(known):
            return digits
    return MOST_DIGITS


def _plain(x: float, decimals: int) -> str:
    text = f"{x:,.{decimals}f}" if x >= 10_000 else f"{x:.{decimals}f}"
    if "." in text:
        text = text.rstrip("0").rstrip(".")
    return text.replace(",", NARROW_SPACE)
