"""Checks of what a call was given. Each raises `SceneError` naming the call, the argument, the value and the limit."""

from __future__ import annotations

import math
import re
from collections.abc import Collection, Iterable, Mapping, Sequence, Set
from dataclasses import dataclass
from difflib import get_close_matches
from typing import Any, NoReturn, SupportsFloat, SupportsIndex, TypeAlias, cast

from wsim.limits import (
    MAX_COUNT,
    MAX_DENSITY,
    MAX_FRICTION,
    MAX_MASS,
    MAX_POSITION,
    MAX_SIZE,
    MAX_SPEED,
    MAX_SPIN,
    MIN_DENSITY,
    MIN_MASS,
    MIN_SIZE,
)
from wsim.scene.errors import SceneError

Number: TypeAlias = SupportsFloat | SupportsIndex
Vector: TypeAlias = Sequence[float]
Vec3 = tuple[float, float, float]

RESERVED = ("PhysicsScene", "Looks", "Parameters", "Contacts")
_NAME = re.compile(r"[A-Za-z_][A-Za-z0-9_]*")


@dataclass(frozen=True)
class Call:
    """One call of a program, as its errors name it: `box("block_0")`."""

    method: str
    name: object = None
    part: str = ""  # before the name of a field, where that is one of something the call was given: "parts[0]."

    def __str__(self) -> str:
        return f"{self.method}({shown(self.name)})" if self.name is not None else f"{self.method}()"

    def fail(self, message: str) -> NoReturn:
        """Raise a `SceneError` that starts with this call."""
        raise SceneError(f"{self}: {self.part}{message}")

    def identifier(self, taken: Collection[str]) -> str:
        """The call's name, if it can name a new prim."""
        name = self.name
        if not isinstance(name, str) or not _NAME.fullmatch(name):
            self.fail(
                f"name {shown(name)} is not a prim name: letters, digits and _ only, not starting with a digit, "
                'e.g. "block_0"'
            )
        if name in RESERVED:
            self.fail(f"name {name!r} is reserved; choose another")
        if len(name) > 128:
            self.fail(f"name has {len(name)} characters; at most 128")
        if name in taken:
            self.fail(f"name {name!r} is already used; give each prim a name of its own")
        return name

    def number(self, field: str, value: object, unit: str = "") -> float:
        """A finite number."""
        if type(value) is float and math.isfinite(value):  # as most are, of a hundred that a small scene gives
            return value
        if isinstance(value, (bool, str, bytes)) or value is None:
            self.fail(f"{field} = {shown(value)} must be a number{_of(unit)}")
        try:
            number = float(cast(Number, value))
        except (TypeError, ValueError):
            self.fail(f"{field} = {shown(value)} must be a number{_of(unit)}")
        except OverflowError:
            self.fail(f"{field} must be finite{_of(unit)}; a number of that many digits is not")
        if not math.isfinite(number):
            self.fail(f"{field} = {number} must be finite{_of(unit)}")
        return number

    def within(self, field: str, value: object, low: float, high: float, unit: str = "") -> float:
        """A number in low..high, both included."""
        number = self.number(field, value, unit)
        if not low <= number <= high:
            bound = f">= {low:g}" if number < low else f"<= {high:g}"
            self.fail(f"{field} = {number:g} must be {bound}{_unit(unit)}")
        return number

    def positive(self, field: str, value: object, high: float, unit: str, low: float = 0.0) -> float:
        """A number > 0, >= low and <= high."""
        number = self.number(field, value, unit)
        if number <= 0.0:
            self.fail(f"{field} = {number:g} must be > 0{_unit(unit)}")
        return self.within(field, number, low, high, unit)

    def size(self, field: str, value: object) -> float:
        """A length [m] that something can have."""
        return self.positive(field, value, MAX_SIZE, "m", low=MIN_SIZE)

    def sizes(self, field: str, value: object) -> Vec3:
        """Three lengths [m]."""
        x, y, z = self._three(field, value, "(x, y, z) in m")
        return (self.size(f"{field}[0]", x), self.size(f"{field}[1]", y), self.size(f"{field}[2]", z))

    def position(self, field: str, value: object) -> Vec3:
        """A point [m]."""
        return self.vector(field, value, MAX_POSITION, "m")

    def velocity(self, value: object) -> Vec3:
        """A velocity [m/s]."""
        return self.vector("velocity", value, MAX_SPEED, "m/s")

    def spin(self, value: object) -> Vec3:
        """An angular velocity [deg/s]."""
        return self.vector("angular_velocity_deg", value, MAX_SPIN, "deg/s")

    def angles(self, value: object) -> Vec3:
        """Roll, pitch and yaw [deg]."""
        return self.vector("rotation_deg", value, 3600.0, "deg")

    def vector(self, field: str, value: object, limit: float, unit: str) -> Vec3:
        """Three numbers in -limit..limit."""
        x, y, z = self._three(field, value, f"(x, y, z){_of(unit)}")
        return (
            self.within(f"{field}[0]", x, -limit, limit, unit),
            self.within(f"{field}[1]", y, -limit, limit, unit),
            self.within(f"{field}[2]", z, -limit, limit, unit),
        )

    def color(self, field: str, value: object) -> Vec3:
        """Linear RGB in 0..1."""
        r, g, b = self._three(field, value, "(red, green, blue), each 0 to 1")
        return (
            self.within(f"{field}[0]", r, 0.0, 1.0),
            self.within(f"{field}[1]", g, 0.0, 1.0),
            self.within(f"{field}[2]", b, 0.0, 1.0),
        )

    def density(self, value: object) -> float:
        """A density [kg/m^3]."""
        return self.positive("density", value, MAX_DENSITY, "kg/m^3", low=MIN_DENSITY)

    def mass(self, value: object) -> float:
        """A mass [kg]."""
        return self.positive("mass", value, MAX_MASS, "kg", low=MIN_MASS)

    def friction(self, value: object) -> float:
        """A coefficient of friction."""
        return self.within("friction", value, 0.0, MAX_FRICTION)

    def fraction(self, field: str, value: object) -> float:
        """A number in 0..1."""
        return self.within(field, value, 0.0, 1.0)

    def integer(self, field: str, value: object, low: int, high: int, unit: str = "") -> int:
        """A whole number in low..high."""
        number = self.within(field, value, low, high, unit)
        if number != int(number):
            self.fail(f"{field} = {number:g} must be a whole number{_of(unit)}")
        return int(number)

    def flag(self, field: str, value: object) -> bool:
        """True or False."""
        if not isinstance(value, bool) and type(value).__name__ not in ("bool", "bool_"):  # NumPy's
            self.fail(f"{field} = {shown(value)} must be True or False")
        return bool(value)

    def axis(self, value: object, field: str = "axis") -> str:
        """X, Y or Z."""
        if not isinstance(value, str) or value.upper() not in ("X", "Y", "Z"):
            self.fail(f'{field} = {shown(value)} must be "X", "Y" or "Z"')
        return value.upper()

    def one_of(self, field: str, value: object, known: Sequence[str]) -> str:
        """A word out of some."""
        if not isinstance(value, str) or value not in known:
            self.fail(f"{field} = {shown(value)} must be one of {', '.join(known)}")
        return value

    def listed(self, field: str, value: object, meaning: str) -> list[Any]:
        """Things in an order, as a list."""
        unordered = isinstance(value, (Set, Mapping))
        if unordered or isinstance(value, (str, bytes)) or not isinstance(value, Iterable) or _is_scalar(value):
            self.fail(f"{field} = {shown(value)} must be {meaning}{', in a list' if unordered else ''}")
        return list(value)

    def range(self, field: str, value: object, limit: float, unit: str) -> tuple[float, float]:
        """(low, high), low <= high."""
        items = self._items(field, value, 2, f"(low, high) in {unit}")
        low = self.within(f"{field}[0]", items[0], -limit, limit, unit)
        high = self.within(f"{field}[1]", items[1], -limit, limit, unit)
        if low > high:
            self.fail(f"{field} = ({low:g}, {high:g}): the low limit must not lie above the high one")
        return low, high

    def particles(self, size: Vec3, spacing: float) -> None:
        """Check that a box of fluid has a number of particles that can be simulated."""
        volume = size[0] * size[1] * size[2]
        count = volume / spacing**3
        if count > MAX_COUNT:
            self.fail(
                f"spacing = {spacing:g} m gives {count:.3g} particles in {size[0]:g} x {size[1]:g} x {size[2]:g} m; "
                f"at most {MAX_COUNT:.3g}: take a spacing above {(volume / MAX_COUNT) ** (1 / 3):.3g} m"
            )

    def _three(self, field: str, value: object, meaning: str) -> Sequence[object]:
        return self._items(field, value, 3, meaning)

    def _items(self, field: str, value: object, count: int, meaning: str) -> Sequence[object]:
        if isinstance(value, (tuple, list)) and len(value) == count:
            return list(value)
        if isinstance(value, Set):
            self.fail(
                f"{field} = {shown(value)} is a set, which has no order; give a list of {count} numbers {meaning}"
            )
        if isinstance(value, (str, bytes, Mapping)) or not isinstance(value, Iterable) or _is_scalar(value):
            self.fail(f"{field} = {shown(value)} must be {count} numbers {meaning}")
        items = list(value)
        if len(items) != count:
            self.fail(f"{field} = {shown(value)} has {len(items)} numbers; it must be {count}: {meaning}")
        return items


def _is_scalar(value: object) -> bool:
    """Whether it is one of NumPy's arrays without axes, which says of itself that it can be iterated."""
    return getattr(value, "shape", None) == ()


def shown(value: object) -> str:
    """A value as an error shows it: short."""
    if isinstance(value, str):
        return '"' + (value if len(value) <= 60 else value[:57] + "...") + '"'
    text = " ".join(repr(value).split())  # NumPy's arrays have lines
    return text if len(text) <= 80 else text[:77] + "..."


def suggestion(name: str, known: Iterable[str]) -> str:
    """What may be meant by an unknown name: `did you mean "tank"?`, or the known names."""
    names = list(known)
    close = get_close_matches(name, names, n=1)
    if close:
        return f'did you mean "{close[0]}"?'
    return f"known: {', '.join(names)}" if names else "none has been made yet"


def _unit(unit: str) -> str:
    return f" {unit}" if unit else ""


def _of(unit: str) -> str:
    return f" in {unit}" if unit else ""
