"""What a policy is: a network, what it sees and sets of a robot, and how it is commanded. Where policies lie.

policies/<id>/policy.json    a `PolicySpec`
policies/<id>/policy.onnx    its network
"""

from __future__ import annotations

import hashlib
from collections.abc import Iterator
from difflib import get_close_matches
from pathlib import Path
from typing import Literal, Self

from pydantic import BaseModel, ConfigDict, Field, ValidationError, model_validator

from wsim.assets.folders import AssetError, user_folder
from wsim.assets.sources import source_of_policy

SPEC, NETWORK = "policy.json", "policy.onnx"
Seen = Literal[
    "linear_velocity", "angular_velocity", "gravity", "command", "joint_position", "joint_velocity", "last_action"
]
Numbers = float | list[float]
AXES = 3  # of a command: forward, to the left [m/s], turning to the left [rad/s]


class _Model(BaseModel):
    model_config = ConfigDict(extra="forbid", allow_inf_nan=False, frozen=True)


class Observation(_Model):
    """A part of what the network sees, as scale (value - offset); a number stands for one of each entry.

    Velocities and the direction of gravity, a unit vector, are of the base in its own frame [m/s], [rad/s].
    """

    of: Seen
    scale: Numbers = 1.0
    offset: Numbers = 0.0


class Trim(_Model):
    """What is added to a command so that the robot goes as fast as it says: the error's integral.

    Measured is the base's velocity along its heading and its yaw rate, smoothed.
    """

    smoothing: float = Field(gt=0.0)  # [s]
    gain: list[float]  # [1/s], an axis each
    limit: list[float]  # [m/s], [m/s], [rad/s]


class PolicySpec(_Model):
    """A policy that sets targets of joints: offset + scale action, as many actions as joints."""

    joints: list[str] = Field(min_length=1)  # in the network's order
    rate: float = Field(gt=0.0, le=1000.0)  # [Hz]
    observations: list[Observation] = Field(min_length=1)
    observation_limit: float = Field(default=1e6, gt=0.0)  # each entry is cut off there, either way
    action_scale: Numbers = 1.0  # [rad] or [m]
    action_offset: Numbers = 0.0
    action_limit: float = Field(default=1e6, gt=0.0)
    stiffness: Numbers | None = None  # of the joints' servos [N m/rad] or [N/m]; None leaves them
    damping: Numbers | None = None  # [N m s/rad] or [N s/m]
    command_limit: list[float] = [1.0, 1.0, 1.0]  # [m/s], [m/s], [rad/s]
    command_slew: list[float] | None = None  # the most it may change [m/s^2], [m/s^2], [rad/s^2]
    trim: Trim | None = None

    @property
    def size(self) -> int:
        """How many numbers the network sees."""
        return sum(self.width(each.of) for each in self.observations)

    def width(self, of: Seen) -> int:
        """How many entries an observation has."""
        return len(self.joints) if of in ("joint_position", "joint_velocity", "last_action") else AXES

    @model_validator(mode="after")
    def _fits(self) -> Self:
        for field, value, count in self._vectors():
            if isinstance(value, list) and len(value) != count:
                raise ValueError(f"{field} has {len(value)} numbers and needs {count}")
        if len(set(self.joints)) != len(self.joints):
            raise ValueError("joints: one is named twice")
        return self

    def _vectors(self) -> Iterator[tuple[str, Numbers | None, int]]:
        for name in ("action_scale", "action_offset", "stiffness", "damping"):
            yield name, getattr(self, name), len(self.joints)
        for each in self.observations:
            yield f"{each.of}: scale", each.scale, self.width(each.of)
            yield f"{each.of}: offset", each.offset, self.width(each.of)
        yield "command_limit", self.command_limit, AXES
        yield "command_slew", self.command_slew, AXES
        if self.trim:
            yield "trim: gain", self.trim.gain, AXES
            yield "trim: limit", self.trim.limit, AXES


def policies_folder() -> Path:
    """The folder of the user's policies, which need not be there."""
    return user_folder() / "policies"


def policies() -> dict[str, Path]:
    """The folders of all policies, by id."""
    return {path.parent.name: path.parent for path in sorted(policies_folder().glob(f"[!.]*/{SPEC}"))}


def read_spec(path: Path) -> PolicySpec:
    """The description in a file.

    Raises:
        AssetError: Naming what is wrong.
    """
    try:
        return PolicySpec.model_validate_json(path.read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError) as error:
        raise AssetError(f"{path} cannot be read: {error}") from None
    except ValidationError as error:
        first = error.errors()[0]
        where = ".".join(map(str, first["loc"]))
        raise AssetError(f"{path.name}: {where}{': ' if where else ''}{first['msg']}") from None


def policy(id: str) -> tuple[PolicySpec, Path, str]:
    """A policy by its id: the description, the file of its network, and that file's SHA-256 hash.

    Raises:
        AssetError: If there is none; it names those that may be meant.
    """
    known = policies()
    if id in known:
        network = known[id] / NETWORK
        try:
            digest = hashlib.sha256(network.read_bytes()).hexdigest()
        except OSError as error:
            raise AssetError(f"{id}: {network} cannot be read ({error.strerror}); take the policy in again") from None
        return read_spec(known[id] / SPEC), network, digest
    pulled = source_of_policy(id)
    if pulled:
        raise AssetError(f"{id!r} is not on this machine yet; `wsim assets pull {pulled}` gets it")
    near = get_close_matches(str(id).lower(), known, n=3, cutoff=0.6)
    hint = f"did you mean {' or '.join(map(repr, near))}?" if near else f"known: {', '.join(known) or 'none'}"
    raise AssetError(f"no policy {str(id)[:60]!r}; {hint}; `wsim assets policy FILE --name ID` takes one in")
