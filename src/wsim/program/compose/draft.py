"""What the parts of a program that is being written share: the plan, and the variables that are taken."""

from __future__ import annotations

import keyword
import re
import unicodedata
from dataclasses import dataclass, field

from wsim.plan.schema import Plan

AXES = "xyz"  # variables of loops


@dataclass
class Draft:
    """A program that is being written.

    Attributes:
        plan: What it is to build.
        names: Variables that are taken.
        materials: A material as JSON, and its variable.
        handles: An object's name, and its variable; of those only that the program speaks of again.
    """

    plan: Plan
    names: set[str] = field(default_factory=lambda: {"scene", "build", "Scene", "Drive", "run", "i", *AXES, "position"})
    materials: dict[str, str] = field(default_factory=dict)
    handles: dict[str, str] = field(default_factory=dict)

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
