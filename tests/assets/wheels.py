"""A wheel of a few files, and pip made to find it in a folder."""

from __future__ import annotations

import hashlib
import stat
import zipfile
from collections.abc import Mapping
from pathlib import Path

import pytest

PACKAGE, VERSION = "stand-in-robot", "1.2"
NAME = "stand_in_robot-1.2-py3-none-any.whl"
ROBOT = """<mujoco model="stand_in">
  <compiler autolimits="true"/>
  <worldbody>
    <body name="base" pos="0 0 0.1">
      <geom type="box" size="0.1 0.1 0.1" mass="2"/>
      <body name="arm" pos="0 0 0.15">
        <joint name="left_hinge" axis="0 1 0" range="-90 90" damping="0.1" armature="0.01"/>
        <geom name="rod" type="capsule" fromto="0 0 0 0.3 0 0" size="0.03" mass="0.5" condim="6"/>
      </body>
    </body>
  </worldbody>
  <actuator><motor joint="left_hinge" ctrlrange="-5 5"/></actuator>
  <keyframe><key name="home" qpos="0.2"/></keyframe>
</mujoco>
"""
FILES = {"stand_in/data/robot.xml": ROBOT, "stand_in/data/LICENSE": "Do as you like.", "stand_in/code.py": "1 / 0"}
SOURCE = """
[stand_in]
about = "A hinge"
package = "{package}"
version = "{version}"
sha256 = "{sha256}"
license = "MIT"
unpack = ["stand_in/data/*"]
licenses = ["stand_in/data/LICENSE"]
robot = "stand_in/data/robot.xml"
[stand_in.servos]
"*_hinge" = {{ stiffness = 20.0, damping = 0.5, max_force = 4.0 }}
[stand_in.poses.home]
"*_hinge" = 0.5
"""


def write(folder: Path, files: Mapping[str, str] = FILES, link: str | None = None) -> str:
    """Write the wheel; its SHA-256 hash. `link` is a member that says that it is a symbolic link."""
    folder.mkdir(parents=True, exist_ok=True)
    about = f"{NAME.split('-py3')[0]}.dist-info"
    metadata = f"Metadata-Version: 2.1\nName: {PACKAGE}\nVersion: {VERSION}\nRequires-Dist: no-such-thing\n"
    said = {
        f"{about}/METADATA": metadata,
        f"{about}/WHEEL": "Wheel-Version: 1.0\nGenerator: test\nRoot-Is-Purelib: true\nTag: py3-none-any\n",
        f"{about}/RECORD": "",
    }
    with zipfile.ZipFile(folder / NAME, "w") as archive:
        for name, text in {**files, **said}.items():
            member = zipfile.ZipInfo(name)
            member.external_attr = ((stat.S_IFLNK if name == link else stat.S_IFREG) | 0o644) << 16
            archive.writestr(member, text)
    return hashlib.sha256((folder / NAME).read_bytes()).hexdigest()


def pip_finds(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Let pip look into a folder alone."""
    monkeypatch.setenv("PIP_NO_INDEX", "1")
    monkeypatch.setenv("PIP_FIND_LINKS", str(folder))
    monkeypatch.setenv("PIP_CONFIG_FILE", "/dev/null")
