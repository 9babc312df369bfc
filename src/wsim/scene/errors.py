"""The error of a program that asks for what cannot be."""

from __future__ import annotations

import re


class SceneError(ValueError):
    """A call was given something it cannot build: the message names the call, the value and the way out."""


def one_line(error: Exception) -> str:
    """What an error says, in one line: of USD's, the message without the place in USD's own code."""
    text = " ".join(str(error).split()) or type(error).__name__
    found = re.search(r"in file \S+ : '(.*?)'?$", text)
    return found.group(1).strip() if found else text
