"""Read a program without running it, and say what is wrong with it."""

from __future__ import annotations

import ast
import dataclasses
import warnings
from typing import TYPE_CHECKING

from wsim.program.api.lookup import index
from wsim.program.validator import plan_names
from wsim.program.validator.problem import Problem
from wsim.program.validator.reader import Reader

if TYPE_CHECKING:
    from wsim.plan.schema import Plan

_MOST = 1 << 20  # bytes, what the sandbox takes


def validate(text: str, plan: Plan | None = None) -> list[Problem]:
    """What is wrong with a program, as far as it can be known without running it.

    What cannot be known is not complained of. The first call of an installation builds the API index.

    Args:
        text: The program.
        plan: What it is to build; its objects and those of the program are then compared by name.

    Returns:
        The problems in the order of their lines; none for a program that is right.
    """
    if len(text.encode(errors="replace")) > _MOST:
        return [Problem(1, 1, "syntax", f"the program has more than {_MOST} bytes")]
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            tree = ast.parse(text)
            compile(tree, "program.py", "exec", dont_inherit=True)
    except SyntaxError as error:
        return [Problem(error.lineno or 1, error.offset or 1, "syntax", f"this is not Python: {error.msg}")]
    except (ValueError, RecursionError, MemoryError) as error:
        return [Problem(1, 1, "syntax", f"this cannot be read as Python: {error}")]

    reader = Reader(index(), tree)
    reader.read()
    if plan is not None:
        plan_names.check(reader, plan)
    return [dataclasses.replace(each, code=each.code.partition(" ")[0]) for each in reader.problems.sorted()]
