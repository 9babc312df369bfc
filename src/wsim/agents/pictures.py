"""Pictures for models: small, since a model pays for each."""

from __future__ import annotations

import io
from pathlib import Path

from PIL import Image

from wsim.errors import UserError

LARGEST = 640  # px, of the longer edge
QUALITY = 70


def small_jpeg(path: Path) -> bytes:
    """A picture as a JPEG of at most 640 px.

    Raises:
        UserError: If it is not there, or is no picture.
    """
    try:
        with Image.open(path) as picture:
            rgb = picture.convert("RGB")
    except (OSError, ValueError, SyntaxError, Image.DecompressionBombError) as error:
        reason = error.strerror if isinstance(error, OSError) and error.strerror else "it is not a picture"
        raise UserError(f"--image {path}: {reason}; give a PNG or a JPEG") from error
    rgb.thumbnail((LARGEST, LARGEST))
    out = io.BytesIO()
    rgb.save(out, "JPEG", quality=QUALITY, optimize=True)
    return out.getvalue()
