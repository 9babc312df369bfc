"""Which objects a picture shows, from its shape-index image."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from PIL import Image

from wsim.scene.labels import object_of

QUICK = 1  # of zlib's levels: a sixth of the time that its default takes, for a fifth more bytes


class ObjectPixels:
    """Counts the pixels of objects: the children of the root, whose names are the plan's.

    Args:
        shape_prims: Prim path by shape index.
    """

    def __init__(self, shape_prims: Sequence[str]) -> None:
        names, self._object_of = np.unique(
            np.array([object_of(prim) for prim in shape_prims], dtype=str), return_inverse=True
        )
        self.objects = [str(name) for name in names]

    def count(self, shape_index: np.ndarray) -> dict[str, int]:
        """How many pixels of an image (H, W) int32 each object has; -1 is nobody's."""
        shown = shape_index[shape_index >= 0]
        pixels = np.bincount(self._object_of[shown], minlength=len(self.objects))
        return {prim: int(n) for prim, n in zip(self.objects, pixels, strict=True)}


def write_png(path: Path, rgb: np.ndarray) -> None:
    """Write a picture (H, W, 3) uint8 under a side name, then rename it."""
    path.parent.mkdir(parents=True, exist_ok=True)
    partial = path.with_name(path.name + ".partial")
    Image.fromarray(rgb).save(partial, "PNG", compress_level=QUICK)
    partial.replace(path)


def still_name(camera: str, time: float) -> str:
    """The file name of a camera's picture at a time [s]."""
    return f"{camera.rsplit('/', 1)[-1]}_{time:06.3f}s.png"
