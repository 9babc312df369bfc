"""Calls of a program, as nodes that a mistake is made in."""

from __future__ import annotations

import ast

from wsim.program.mend.text import made_by, method


def call_of(build: ast.FunctionDef, name: str) -> ast.Call:
    """The call that makes an object; ValueError if there is none."""
    for node in ast.walk(build):
        if isinstance(node, ast.Call) and made_by(node) == name:
            return node
    raise ValueError(f"no call of the program makes {name!r}")


def run_of(build: ast.FunctionDef) -> ast.Call:
    """The call of `scene.simulation`, made if there is none."""
    found = [node for node in ast.walk(build) if isinstance(node, ast.Call) and method(node) == "simulation"]
    if not found:
        build.body.append(ast.parse("scene.simulation()").body[0])
        return build.body[-1].value  # type: ignore[attr-defined, no-any-return]
    return found[-1]


def keyword_of(call: ast.Call, name: str) -> ast.expr | None:
    """What a keyword of a call is given."""
    return next((keyword.value for keyword in call.keywords if keyword.arg == name), None)


def put(call: ast.Call, name: str, value: object) -> None:
    """Give a keyword a value."""
    call.keywords = [keyword for keyword in call.keywords if keyword.arg != name]
    call.keywords.append(ast.keyword(name, ast.parse(repr(value), mode="eval").body))


def literal(call: ast.Call, name: str, otherwise: object = None) -> object:
    """A keyword's value, written out; ValueError if it is not."""
    found = keyword_of(call, name)
    if found is None:
        return otherwise
    try:
        return ast.literal_eval(found)
    except ValueError as error:
        raise ValueError(f"{name} is not written as numbers") from error
