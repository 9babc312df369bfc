"""The reviewer: what a run's pictures show, and what of it is not as planned. Without a model, the facts alone."""

from __future__ import annotations

import io
import json
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import AfterValidator, BaseModel, ConfigDict, Field, ValidationError

from wsim.agents.ask import UnusableError, object_in

if TYPE_CHECKING:
    from PIL import Image

    from wsim.agents.ask import Desk
    from wsim.plan.schema import Plan

TILES, COLUMNS = 6, 3
TILE = (256, 144)  # px
QUALITY = 60  # of the JPEG: 15 to 20 kB for six tiles
ROOT = "/World/"
Short = Annotated[str, AfterValidator(lambda text: text[:1200])]  # who says more is heard that far


class Difference(BaseModel):
    """Something that is not as the plan has it."""

    model_config = ConfigDict(extra="forbid")

    object: str
    what: Short
    severity: Literal["minor", "major"] = "minor"


class Review(BaseModel):
    """What was seen."""

    model_config = ConfigDict(extra="forbid")

    summary: Short
    objects: Short = ""
    layout: Short = ""
    motion: Short = ""
    contacts: Short = ""
    differences: list[Difference] = Field(default_factory=list, max_length=20)

    @property
    def text(self) -> str:
        """For the judge and the coder."""
        lines = [self.summary]
        lines += [f"{d.severity}: {d.object}: {d.what}" for d in self.differences]
        return "\n".join(line for line in lines if line)


def facts(folder: Path) -> list[str]:
    """How much of each picture each object takes up, from the shape-index images: at the start, least, and at the end.

    Args:
        folder: An iteration's folder with a review.json.
    """
    path = folder / "review.json"
    rows = json.loads(path.read_text(encoding="utf-8")).get("share_of_picture", []) if path.is_file() else []
    cameras: dict[str, list[dict[str, float]]] = {}
    for row in rows:
        cameras.setdefault(row["camera"], []).append(row["objects"])
    lines = []
    for camera, shares in cameras.items():
        seen = sorted({prim for share in shares for prim in share})
        parts = []
        for prim in seen:
            values = [100.0 * share.get(prim, 0.0) for share in shares]
            parts.append(f"{prim.removeprefix(ROOT)} {values[0]:.2g}/{min(values):.2g}/{values[-1]:.2g}")
        lines.append(f"{camera.removeprefix(ROOT)} (% of picture at start/least/end): {', '.join(parts)}")
    return lines


def review(desk: Desk, plan: Plan, folder: Path, plan_lines: Sequence[str]) -> Review:
    """What the reviewer's model sees in a run's pictures.

    Raises:
        ModelError: If no answer is a review.
        BudgetError: If tokens or time ran out.
    """
    sheet, labels = contact_sheet(folder / "frames", [camera.name for camera in plan.cameras])
    names = {item.name for item in plan.objects}
    request = "\n\n".join(
        [
            "# Plan", "\n".join(line for line in plan_lines if not line.startswith("formula")),
            "# Pictures", f"One sheet, left to right, top to bottom: {', '.join(labels)}" if labels else "none",
            "# Facts from the shape-index images (glass and water have no pixels)",
            "\n".join(facts(folder)) or "none",
        ]
    )  # fmt: skip
    return desk.ask("reviewer", request, lambda text: _read(text, names), pictures=[sheet] if sheet else [])


def _read(text: str, names: set[str]) -> Review:
    try:
        found = Review.model_validate(object_in(text))
    except ValidationError as error:
        problem = error.errors(include_url=False)[0]
        raise UnusableError(f"{'.'.join(map(str, problem['loc']))}: {problem['msg']}") from error
    for difference in found.differences:
        if difference.object not in names:
            raise UnusableError(
                f"differences: the plan has no object {difference.object!r}; it has {', '.join(sorted(names))}"
            )
    return found


def keep(folder: Path, found: Review | None, by: str) -> None:
    """Write a review into review.json, beside the facts."""
    from wsim.runs import write_json

    path = folder / "review.json"
    data: dict[str, Any] = json.loads(path.read_text(encoding="utf-8")) if path.is_file() else {}
    write_json(path, data | {"by": by, "review": found.model_dump() if found else {"facts": facts(folder)}})


def contact_sheet(frames: Path, order: Sequence[str] = ()) -> tuple[bytes, list[str]]:
    """A few stills on one small JPEG, and what each is: the start and the end, then where most has changed.

    Args:
        frames: The folder of stills, `camera_00.000s.png`; first camera over time, others at the end.
        order: Names of cameras, those that come first; others follow by name.
    """
    from PIL import Image

    by_camera: dict[str, list[Path]] = {}
    for path in sorted(frames.glob("*s.png")):
        by_camera.setdefault(path.stem.rpartition("_")[0], []).append(path)
    if not by_camera:
        return b"", []
    named = {name: by_camera[name] for name in (*order, *by_camera) if name in by_camera}
    first, *others = named.values()
    ends = [stills[-1] for stills in others[:2]]
    chosen = [*_changing(first, TILES - len(ends)), *ends]
    rows = -(-len(chosen) // COLUMNS)
    sheet = Image.new("RGB", (TILE[0] * min(COLUMNS, len(chosen)), TILE[1] * rows))
    for k, path in enumerate(chosen):
        sheet.paste(_small(path), (TILE[0] * (k % COLUMNS), TILE[1] * (k // COLUMNS)))
    out = io.BytesIO()
    sheet.save(out, "JPEG", quality=QUALITY, optimize=True)
    return out.getvalue(), [path.stem.replace("_", " ") for path in chosen]


def _changing(stills: Sequence[Path], count: int) -> list[Path]:
    """The first, the last, and in between those that differ most from all that are chosen already."""
    from PIL import ImageChops, ImageStat

    if len(stills) <= count:
        return list(stills)
    small = {path: _small(path) for path in stills}
    chosen = [stills[0], stills[-1]]

    def change(path: Path) -> float:
        return min(sum(ImageStat.Stat(ImageChops.difference(small[path], small[one])).mean) for one in chosen)

    while len(chosen) < count:
        chosen.append(max((path for path in stills if path not in chosen), key=change))
    return sorted(chosen, key=stills.index)


def _small(path: Path) -> Image.Image:
    from PIL import Image

    with Image.open(path) as picture:
        return picture.convert("RGB").resize(TILE, Image.Resampling.LANCZOS)
