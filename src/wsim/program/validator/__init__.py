"""The static validator: reads a program without running it.

from wsim.program.validator import validate

for problem in validate(text):
    print(problem.sentence)
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from wsim.door import door

if TYPE_CHECKING:
    from wsim.program.validator.problem import Problem
    from wsim.program.validator.validator import validate

__all__ = ["Problem", "validate"]

__getattr__ = door(__name__, {"Problem": "problem", "validate": "validator"})
