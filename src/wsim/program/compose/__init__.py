"""A plan becomes a program: the text of `program.py`, as a person would write it.

The parts of a program are in a file each: `words`, `materials`, `shapes`, `assets`, `robots`, `fluids`, `joints`,
`cameras`.
"""

from wsim.program.compose.program import compose

__all__ = ["compose"]
