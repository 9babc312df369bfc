"""Write the layer of each robot that wsim ships from its model: `python usd_assets/robots/make.py`."""

from __future__ import annotations

from pathlib import Path

from wsim.intake.robot_read import read_robot
from wsim.intake.robot_write import write_robot

HERE = Path(__file__).parent


def make(folder: Path = HERE) -> list[Path]:
    """Write all layers into a folder."""
    made = []
    for model in sorted(HERE.glob("*.xml")):
        made.append(folder / f"{model.stem}.usda")
        write_robot(made[-1], read_robot(model), model.name)
    return made


if __name__ == "__main__":
    make()
