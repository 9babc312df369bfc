"""CoACD's process: it can abort, hang or eat all memory, and takes nothing else with it.

python -m wsim.intake.decompose MESH.npz SETTINGS.json PARTS.npz
"""

from __future__ import annotations

import json
import resource
import sys
from pathlib import Path
from typing import Any

import coacd
import numpy as np


def main(mesh: str, settings: str, parts: str) -> None:
    """Decompose a mesh within the limits that the settings state, and write the parts' points."""
    given = json.loads(Path(settings).read_text(encoding="utf-8"))
    memory, seconds = int(given.pop("memory_bytes")), int(given.pop("cpu_seconds"))
    resource.setrlimit(resource.RLIMIT_AS, (memory, memory))
    resource.setrlimit(resource.RLIMIT_CPU, (seconds, seconds + 1))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    coacd.set_log_level("error")
    with np.load(mesh) as arrays:
        found = coacd.run_coacd(coacd.Mesh(arrays["points"], arrays["faces"]), **given)
    arrays_by_name: dict[str, Any] = {f"part_{k:04d}": np.asarray(points) for k, (points, _) in enumerate(found)}
    np.savez_compressed(parts, **arrays_by_name)


if __name__ == "__main__":
    main(*sys.argv[1:])
