from __future__ import annotations

import pytest

from wsim.program.api.docstring import meanings, said_of, unit

GOOGLE = """Do it.

Args:
    level: Depth above the floor [m].
    density: Rest density
        of it [kg/m^3].

Returns:
    other: Not a parameter.
"""
NUMPY = """Do it.

Parameters
----------
start, stop : float
    Where it [s] goes.

Returns
-------
out : array
    Not a parameter.
"""


def test_both_styles_are_read() -> None:
    assert meanings(GOOGLE) == {"level": "Depth above the floor [m].", "density": "Rest density of it [kg/m^3]."}
    assert meanings(NUMPY) == {"start": "Where it [s] goes.", "stop": "Where it [s] goes."}


@pytest.mark.parametrize(
    ("text", "name", "expected"),
    [
        ("Depth [m].", "", "m"),
        ("Viscosity [Pa s]; water 0.001.", "", "Pa s"),
        ("`position` [deg], `velocity` [deg/s], `stiffness` [N m/rad]", "velocity", "deg/s"),
        ("Either [a, b] of them.", "", ""),
        ("No unit.", "", ""),
    ],
)
def test_units_stand_in_brackets(text: str, name: str, expected: str) -> None:
    assert unit(text, name) == expected


def test_the_sentence_that_speaks_of_a_name() -> None:
    assert said_of("axis", "It turns. `axis` is a direction. `low` is not.") == "`axis` is a direction."
    assert said_of("axis", "It turns about an axis.") == ""
