"""Convex parts of a mesh by CoACD (Wei et al. 2022), in a process of its own, kept by content and settings."""

from __future__ import annotations

import hashlib
import json
import os
import subprocess
import sys
import tempfile
import zipfile
from pathlib import Path

import numpy as np
from scipy.spatial import ConvexHull, QhullError

from wsim.intake.fit import MOST_CORNERS
from wsim.intake.model import Array, Mesh

SECONDS = 180.0  # [s] that all tries may take
MEMORY = 8 << 30  # [B] of address space, of which threads take much and use little
MOST_PARTS = 160
_VERSION = 1  # of what is kept


def cache_folder() -> Path:
    """Where parts are kept: $XDG_CACHE_HOME/wsim/parts, or ~/.cache/wsim/parts."""
    base = os.environ.get("XDG_CACHE_HOME") or str(Path.home() / ".cache")
    return Path(base) / "wsim" / "parts"


def decompose(
    mesh: Mesh, threshold: float, preprocess: str = "auto", seconds: float = SECONDS, memory: int = MEMORY
) -> list[Array] | str:
    """Points of each convex part, (N, 3) [m]; or why there are none.

    Args:
        mesh: In metres.
        threshold: The most by which a part may differ from the mesh there [m].
        preprocess: CoACD's: "auto" makes a mesh that is no manifold into one, "on" any, "off" none.
        seconds: Wall time that it may take.
        memory: Address space that it may take [B].
    """
    settings = {
        "threshold": threshold, "preprocess_mode": preprocess, "preprocess_resolution": 60, "seed": 0,
        "real_metric": True, "max_ch_vertex": MOST_CORNERS, "merge": True, "resolution": 2000,
    }  # fmt: skip
    key = hashlib.sha256(json.dumps([_VERSION, settings], sort_keys=True).encode())
    key.update(np.ascontiguousarray(mesh.points, dtype="<f8").tobytes())
    key.update(np.ascontiguousarray(mesh.faces, dtype="<i8").tobytes())
    kept = cache_folder() / f"{key.hexdigest()}.npz"
    found = _load(kept)
    if found is not None:
        return found
    limits = {"memory_bytes": memory, "cpu_seconds": max(1, round(seconds * (os.cpu_count() or 1)))}
    kept.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(prefix=".coacd-", dir=kept.parent) as name:
        folder = Path(name)
        np.savez(folder / "mesh.npz", points=mesh.points, faces=mesh.faces.astype(np.int32))
        (folder / "settings.json").write_text(json.dumps(settings | limits), encoding="utf-8")
        why = _run(folder, seconds)
        if why:
            return why
        found = _load(folder / "parts.npz")
        if not found:
            return "CoACD found no part that has a volume"
        (folder / "parts.npz").replace(kept)
    return found


def _run(folder: Path, seconds: float) -> str:
    """Run the process; why it made nothing, or an empty text."""
    files = [str(folder / name) for name in ("mesh.npz", "settings.json", "parts.npz")]
    command = [sys.executable, "-P", "-m", "wsim.intake.decompose", *files]
    source = str(Path(__file__).parents[2])
    paths = os.pathsep.join([source, *filter(None, [os.environ.get("PYTHONPATH")])])
    environment = {**os.environ, "PYTHONPATH": paths}
    try:
        done = subprocess.run(
            command, env=environment, stdin=subprocess.DEVNULL, capture_output=True, timeout=seconds, check=False
        )
    except subprocess.TimeoutExpired:
        return f"CoACD took more than {seconds:g} s"
    if done.returncode < 0:
        return f"CoACD ended by signal {-done.returncode}"
    if done.returncode:
        lines = done.stderr.decode(errors="replace").strip().splitlines() or [f"status {done.returncode}"]
        return f"CoACD failed: {lines[-1][:120]}"
    return ""


def _load(path: Path) -> list[Array] | None:
    """The parts of a file that have a volume; None if it is not there or is broken."""
    try:
        with np.load(path) as arrays:
            parts = [np.asarray(arrays[name], dtype=np.float64) for name in sorted(arrays.files)]
    except (OSError, ValueError, EOFError, zipfile.BadZipFile):
        return None
    return [part for part in parts if has_volume(part)]


def has_volume(points: Array) -> bool:
    """Whether the hull of points has a volume."""
    try:
        return len(points) > 3 and ConvexHull(points).volume > 1e-13
    except (QhullError, ValueError):
        return False
