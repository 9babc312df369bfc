"""Compile URDF and MJCF with MuJoCo: meshes of a URDF are looked for where ROS packages have them."""

from __future__ import annotations

import re
import xml.etree.ElementTree as ET
from pathlib import Path
from typing import Any

import mujoco

from wsim.intake.model import IntakeError

READS = (".stl", ".obj", ".msh")


def compiled(path: Path, notes: list[str]) -> Any:
    """MuJoCo's model of a file, all links apart and with what is seen of them.

    Raises:
        IntakeError: With what MuJoCo says of it, or the mesh that is missing.
    """
    if not path.is_file():
        raise IntakeError(f"file = {path} is not there; give the path of a .urdf, .xml or .mjcf file")
    try:
        spec = mujoco.MjSpec.from_string(_located(path, notes)) if path.suffix.lower() == ".urdf" else None
        spec = spec or mujoco.MjSpec.from_file(str(path))
        spec.compiler.discardvisual = False  # what a URDF shows, too
        spec.compiler.fusestatic = False
        return spec.compile()
    except IntakeError:
        raise
    except (ValueError, ET.ParseError) as error:
        why = " ".join(str(error).split())[:200]
        raise IntakeError(f"file = {path.name} cannot be read: {why}; mend the file, or put beside it what it names") \
            from None  # fmt: skip


def _located(path: Path, notes: list[str]) -> str:
    """A URDF's text with the whole path of each mesh; meshes to look at that MuJoCo cannot read are left out."""
    text = path.read_text(encoding="utf-8")
    if "xmlns:" not in text:
        text = re.sub(r"(</?|\s)(\w+):(?=[\w.-]+\s*[=\s/>])", r"\1\2_", text)  # marks of other tools
    root = ET.fromstring(text)
    for other in [child for child in root if child.tag not in ("link", "joint", "material")]:
        root.remove(other)
    for link in root.iter("link"):
        for part in [*link.findall("visual"), *link.findall("collision")]:
            for mesh in part.iter("mesh"):
                named = mesh.get("filename", "")
                if Path(named).suffix.lower() not in READS:
                    if part.tag == "collision":
                        raise IntakeError(
                            f"mesh = {named[:80]} of link {link.get('name')} in {path.name} must be .stl, .obj or .msh"
                        )
                    notes.append(f"looks of {Path(named).suffix} files are left out: what collides is seen instead")
                    link.remove(part)
                    continue
                mesh.set("filename", str(_found(path, named, str(link.get("name")))))
    ET.SubElement(ET.SubElement(root, "mujoco"), "compiler", {"strippath": "false", "balanceinertia": "true"})
    return ET.tostring(root, encoding="unicode")


def _found(path: Path, named: str, link: str) -> Path:
    """Where a mesh is: beside the file, or in the package that the file is in."""
    inside = re.sub(r"^(package|model|file)://", "", named)
    tails = [inside, inside.partition("/")[2], Path(inside).name]
    for folder in [path.parent, *list(path.resolve().parents)[:6]]:
        for tail in tails if folder == path.parent else tails[:2]:
            if tail and (folder / tail).is_file():
                return (folder / tail).resolve()
    raise IntakeError(f"mesh = {named[:120]} of link {link} in {path.name} is not there; put it beside the file")
