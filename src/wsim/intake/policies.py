"""Take a policy in: its description and its network to the user's assets, held against each other."""

from __future__ import annotations

import re
import shutil
import tempfile
from pathlib import Path

from wsim.assets.policies import NETWORK, SPEC, PolicySpec, policies_folder, read_spec
from wsim.intake.model import IntakeError
from wsim.sim.networks import read_network


def id_of(name: str) -> str:
    """What programs call what people call so.

    Raises:
        IntakeError: If nothing of it can be one.
    """
    id = re.sub(r"[^a-z0-9]+", "_", name.lower()).strip("_")
    if not re.fullmatch(r"[a-z][a-z0-9_]{0,59}", id):
        raise IntakeError(f"name = {name[:80]!r} must begin with a letter a to z and have at most 60 characters")
    return id


def take_in_policy(description: Path, network: Path, name: str, *, replace: bool = False) -> tuple[str, PolicySpec]:
    """Copy a policy to the user's assets; its folder is there at the end, whole, or nothing is.

    Args:
        description: JSON, a `wsim.assets.policies.PolicySpec`.
        network: ONNX, of dense layers.
        name: What to call it.
        replace: Take the place of the one of that name.

    Returns:
        Its id, and what its description says.

    Raises:
        AssetError: If the description is none.
        UserError: If the network is none that wsim evaluates, or has other sizes than the description says.
    """
    id, spec = id_of(name), read_spec(description)
    read_network(network, spec.size, len(spec.joints))
    target = policies_folder() / id
    if target.exists() and not replace:
        raise IntakeError(f"name = {name!r} is there already; --replace takes its place")
    target.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(prefix=".taking-", dir=target.parent) as folder:
        side = Path(folder) / "new"
        side.mkdir()
        shutil.copyfile(description, side / SPEC)
        shutil.copyfile(network, side / NETWORK)
        if replace and target.exists():
            target.replace(Path(folder) / "old")
        try:
            side.replace(target)
        except OSError:
            raise IntakeError(f"name = {name!r} is there by now; --replace takes its place") from None
    return id, spec
