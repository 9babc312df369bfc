"""The pages' templates, styles and scripts, which lie beside this file."""

from __future__ import annotations

import functools
from importlib.resources import files

from jinja2 import Environment, FunctionLoader, StrictUndefined, Template


def source(name: str) -> str:
    """The text of a file of this package."""
    return files("wsim.report").joinpath(name).read_text(encoding="utf-8")


def template(name: str) -> Template:
    """A page's template; a value that it is not given is an error, and what it shows is escaped."""
    return _environment().get_template(name)


@functools.cache
def _environment() -> Environment:
    return Environment(
        loader=FunctionLoader(source), autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True
    )
