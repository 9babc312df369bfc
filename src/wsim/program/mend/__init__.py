"""A suggestion of the judge, applied to a program's text by nobody's judgement."""

from wsim.program.mend.apply import mended
from wsim.program.mend.text import NotMendedError

__all__ = ["NotMendedError", "mended"]
