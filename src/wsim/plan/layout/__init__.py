"""Relations become poses.

The frame: +X is the front, +Y the left, Z is up. A row says how an object stands to another; the layout finds sizes,
headings, heights and places that keep every row, puts what is free where it hinders nothing, and checks the result.
The same plan and seed give the same poses.
"""

from wsim.plan.layout.bodies import extents, solids
from wsim.plan.layout.boxes import Box
from wsim.plan.layout.check import check_clear, check_floats
from wsim.plan.layout.errors import LayoutError
from wsim.plan.layout.lay_out import layout
from wsim.plan.layout.measure import residual, unsatisfied

__all__ = [
    "Box",
    "LayoutError",
    "check_clear",
    "check_floats",
    "extents",
    "layout",
    "residual",
    "solids",
    "unsatisfied",
]
