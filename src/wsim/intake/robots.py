"""Take a robot in: from URDF, MJCF or USD to a USD layer among the user's assets, which programs place by its id."""

from __future__ import annotations

import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from wsim.assets import assets_folder
from wsim.assets.robots import SUFFIX, robots_folder
from wsim.intake.model import IntakeError
from wsim.intake.policies import id_of
from wsim.intake.robot_model import Robot
from wsim.intake.robot_read import read_robot
from wsim.intake.robot_usd import read_usd_robot
from wsim.intake.robot_write import write_robot

USD = (".usd", ".usda", ".usdc", ".usdz")


@dataclass(frozen=True)
class TakenIn:
    """A robot's layer, and what was read."""

    id: str
    path: Path
    robot: Robot


def take_in(
    file: Path,
    name: str,
    *,
    replace: bool = False,
    adapt: Callable[[Robot], None] | None = None,
    source: str | None = None,
) -> TakenIn:
    """Make a robot of a file; its layer is there at the end, whole, or nothing is.

    Args:
        file: URDF, MJCF or USD, with its meshes where it names them.
        name: What to call it.
        replace: Take the place of the one of that name.
        adapt: Changes what was read before it is written.
        source: Where it is from; by default the file's name.

    Raises:
        IntakeError: Naming the field, its value and the way out.
    """
    id = id_of(name)
    path = robots_folder() / f"{id}{SUFFIX}"
    if (assets_folder() / "robots" / f"{id}.usda").exists():
        raise IntakeError(f"name = {name!r} is that of a shipped robot; choose another, such as 'own {id}'")
    if path.exists() and not replace:
        raise IntakeError(f"name = {name!r} is there already; --replace takes its place")
    robot = read_usd_robot(file) if file.suffix.lower() in USD else read_robot(file)
    if adapt is not None:
        adapt(robot)
    path.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(prefix=".taking-", dir=path.parent) as folder:
        side = Path(folder) / path.name
        write_robot(side, robot, source or file.name)
        side.replace(path)
    return TakenIn(id, path, robot)
