"""A program's text, edited call by call: what is not touched stays as it was written, comments and all."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from typing import Any

from wsim.program.source import number, tuple_of


class NotMendedError(ValueError):
    """The suggestion says too little, or names what the program does not have."""


class Source:
    """The text of a program, and edits of it that do not overlap.

    Args:
        text: A program with a function `build(scene)`.

    Attributes:
        build: The function's node.

    Raises:
        NotMendedError: If it has no such function.
    """

    def __init__(self, text: str) -> None:
        # ast counts columns in bytes of UTF-8.
        self._bytes = text.encode()
        self._starts = [0]
        for line in self._bytes.splitlines(keepends=True):
            self._starts.append(self._starts[-1] + len(line))
        self._edits: list[tuple[int, int, str]] = []
        found = [n for n in ast.parse(text).body if isinstance(n, ast.FunctionDef) and n.name == "build"]
        if not found:
            raise NotMendedError("the program has no build(scene)")
        self.build = found[-1]

    @property
    def text(self) -> str:
        """The program with the edits made."""
        made = self._bytes
        for first, last, new in sorted(self._edits, key=lambda edit: edit[:2], reverse=True):
            made = made[:first] + new.encode() + made[last:]
        return made.decode()

    def said(self, node: ast.AST) -> str:
        """A node as it is written."""
        first, last = self._span(node)
        return self._bytes[first:last].decode()

    def statement(self, node: ast.stmt) -> str:
        """A statement of the function as it is written, without the function's indentation."""
        first, *others = self.said(node).splitlines()
        depth = node.col_offset
        return "\n".join([first, *(line[min(depth, len(line) - len(line.lstrip())) :] for line in others)])

    # ---- calls
    def calls(self) -> Iterator[ast.Call]:
        """All calls of the scene's methods."""
        return (node for node in ast.walk(self.build) if isinstance(node, ast.Call) and method(node))

    def call(self, name: str) -> ast.Call:
        """The call that makes an object.

        Raises:
            NotMendedError: If none does, or its name is not written out.
        """
        for node in self.calls():
            if made_by(node) == name:
                return node
        raise NotMendedError(f"no call of the program makes {name!r}")

    def put(self, call: ast.Call, name: str, value: Any) -> None:
        """Give a keyword a value, whether it has one or not."""
        held = keyword(call, name)
        if held is not None:
            self.replace(held, written(value))
            return
        first, last = self._span(call)
        end = max((self._span(each)[1] for each in (*call.args, *call.keywords)), default=0)
        text = f"{name}={written(value)}"
        if not end:
            self._edit(last - 1, last - 1, text)
            return
        between = self._bytes[end : last - 1]
        if b"\n" not in between:
            self._edit(end, end, f", {text}")
            return
        lines = self._bytes[first:end].splitlines()
        indent = lines[-1][: len(lines[-1]) - len(lines[-1].lstrip())].decode() if len(lines) > 1 else ""
        at = end + between.index(b",") + 1 if b"," in between else end
        self._edit(at, at, ("" if b"," in between else ",") + f"\n{indent}{text},")

    def drop(self, call: ast.Call, name: str) -> bool:
        """Leave out a keyword; whether it was there."""
        nodes = [*call.args, *call.keywords]
        for k, node in enumerate(nodes):
            if isinstance(node, ast.keyword) and node.arg == name:
                first, last = self._span(node)
                if k:  # with the comma before it
                    first = self._span(nodes[k - 1])[1]
                elif k + 1 < len(nodes):
                    last = self._span(nodes[k + 1])[0]
                self._edit(first, last, "")
                return True
        return False

    # ---- statements
    def replace(self, node: ast.AST, text: str) -> None:
        """Write something else in a node's place."""
        self._edit(*self._span(node), text)

    def rewrite(self, statement: ast.stmt, lines: str) -> None:
        """Write another statement in one's place.

        Args:
            statement: What goes.
            lines: Without indentation.
        """
        indent = " " * statement.col_offset
        self.replace(statement, lines.replace("\n", f"\n{indent}"))

    def remove(self, statement: ast.stmt) -> None:
        """Leave out a statement, with its lines."""
        self._edit(self._starts[statement.lineno - 1], self._starts[statement.end_lineno or statement.lineno], "")

    def insert(self, before: ast.stmt | None, lines: str) -> None:
        """Put lines before a statement of the function, or at its end.

        Args:
            before: The statement; None: at the end.
            lines: Without indentation.
        """
        indent = " " * self.build.body[0].col_offset
        text = "".join(f"{indent}{line}\n" if line else "\n" for line in lines.splitlines())
        last = self.build.body[-1]
        at = self._starts[before.lineno - 1] if before else self._starts[last.end_lineno or last.lineno]
        self._edit(at, at, text)

    # ----
    def _span(self, node: Any) -> tuple[int, int]:
        return (
            self._starts[node.lineno - 1] + node.col_offset,
            self._starts[node.end_lineno - 1] + node.end_col_offset,
        )

    def _edit(self, first: int, last: int, text: str) -> None:
        self._edits.append((first, last, text))


def method(node: ast.AST) -> str:
    """The name of a call on the scene; nothing of another node."""
    if isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute) and isinstance(node.func.value, ast.Name):
        return node.func.attr if node.func.value.id == "scene" else ""
    return ""


def made_by(node: ast.AST) -> str:
    """The object that a call makes, if its name is written out."""
    if not method(node) or method(node) in ("material", "param") or not isinstance(node, ast.Call) or not node.args:
        return ""
    first = node.args[0]
    return first.value if isinstance(first, ast.Constant) and isinstance(first.value, str) else ""


def makes(statement: ast.stmt) -> str:
    """The first object that a statement makes."""
    return next((name for node in ast.walk(statement) if (name := made_by(node))), "")


def keyword(call: ast.Call, name: str) -> ast.expr | None:
    """What a keyword of a call is given."""
    return next((each.value for each in call.keywords if each.arg == name), None)


def written(value: Any) -> str:
    """A value as a person writes it."""
    if isinstance(value, bool) or not isinstance(value, int | float | tuple | list):
        return repr(value)
    if isinstance(value, list) and all(isinstance(x, tuple) for x in value):
        return f"[{', '.join(map(written, value))}]"
    return tuple_of([float(x) for x in value]) if isinstance(value, tuple | list) else number(float(value))
