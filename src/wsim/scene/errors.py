"""The error of a program that asks for what cannot be."""

from __future__ import annotations


class SceneError(ValueError):
    """A call was given something it cannot build: the message names the call, the value and the way out."""
