"""What the parts of a program that is being written share: the plan, and the variables that are taken."""

from __future__ import annotations

import keyword
import re
import unicodedata
from dataclasses import dataclass, field

from wsim.plan.schema import Material, Plan
from wsim.program.source import tuple_of

AXES = "xyz"  # variables of loops


@dataclass
class Draft:
    """A program that is being written.

    Attributes:
        plan: What it is to build.
        names: Variables that are taken.
        materials: A material as JSON, and its variable.
        handles: An object's name, and its variable; of those only that the program speaks of again.
        imports: What of `wsim.scene` it names beside `Scene`.
        ways: Points of a way, and the constant that they are.
        drivers: Constants that drive a vehicle each.
    """

    plan: Plan
    names: set[str] = field(
        default_factory=lambda: {
            "scene",
            "build",
            "control",
            "world",
            "t",
            "Scene",
            "Drive",
            "run",
            "i",
            *AXES,
            "position",
        }
    )
    materials: dict[str, str] = field(default_factory=dict)
    handles: dict[str, str] = field(default_factory=dict)
    imports: set[str] = field(default_factory=set)
    ways: dict[tuple[tuple[float, float], ...], str] = field(default_factory=dict)
    drivers: list[str] = field(default_factory=list)

    def material(self, material: Material | None) -> str:
        """The variable of a material."""
        return self.materials[material.model_dump_json()] if material is not None else "None"

    def way(self, points: tuple[tuple[float, float], ...]) -> str:
        """The constant of a way's points, (x, y) [m]."""
        if points not in self.ways:
            self.ways[points] = self.variable("way").upper()
        return self.ways[points]

    def constants(self) -> list[str]:
        """The statements of all ways."""
        lines = []
        for points, name in self.ways.items():
            lines += [f"{name} = [  # [m]", *(f"    {tuple_of(point)}," for point in points), "]"]
        return lines

    def variable(self, text: str) -> str:
        """A free variable name like the text; it is taken from now on."""
        plain = unicodedata.normalize("NFKD", text).encode("ascii", "ignore").decode()
        base = re.sub(r"\W+", "_", plain).strip("_").lower() or "thing"
        if base[0].isdigit() or keyword.iskeyword(base) or keyword.issoftkeyword(base):
            base = f"the_{base}"
        name, count = base, 2
        while name in self.names:
            name, count = f"{base}_{count}", count + 1
        self.names.add(name)
        return name
