"""A user's own models as assets: read, oriented, mended, given colliders that keep hollows open, weighed, drawn.

from wsim.intake import Placing, Wanted, add

add(Path("armchair.glb"), Wanted("armchair", Placing(height=0.9), density=400.0)).id  # "armchair"
"""

from typing import TYPE_CHECKING

from wsim.door import door

if TYPE_CHECKING:
    from wsim.intake.entry import Wanted, add
    from wsim.intake.model import IntakeError
    from wsim.intake.orient import Placing
    from wsim.intake.removal import remove

__all__ = ["IntakeError", "Placing", "Wanted", "add", "remove"]

__getattr__ = door(
    __name__, {"IntakeError": "model", "Placing": "orient", "Wanted": "entry", "add": "entry", "remove": "removal"}
)
