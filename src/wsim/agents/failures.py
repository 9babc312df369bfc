"""How a model can fail, in a closed list, and what is tried again."""

from __future__ import annotations

from typing import Literal

Failure = Literal[
    "timeout", "rate limit", "server", "connection", "refused", "unusable", "gave up", "cannot", "end of transcript"
]
AGAIN: frozenset[str] = frozenset({"timeout", "rate limit", "server", "connection"})


class ModelError(Exception):
    """A model gave nothing that can be used.

    Attributes:
        kind: What happened.
        role: Who asked.
    """

    def __init__(self, kind: Failure, message: str, role: str = "") -> None:
        super().__init__(message)
        self.kind: Failure = kind
        self.role = role

    def __str__(self) -> str:
        """What happened, and to whom, where that is known."""
        message = super().__str__()
        return f"the {self.role}'s model: {self.kind}: {message}" if self.role else message


def failure(error: BaseException) -> ModelError:
    """What a client's exception means; anything unknown is the server's."""
    from pydantic_ai import exceptions  # a second to load: builtin roles need none

    text = " ".join(str(error).split())[:300] or type(error).__name__
    if isinstance(error, TimeoutError | exceptions.ModelTimeoutError | exceptions.ModelRequestTimeout):
        said = str(error).strip()
        return ModelError("timeout", text if said else "no answer in time; --model-timeout gives it more")
    if isinstance(error, exceptions.ModelHTTPError):
        if error.status_code == 429:
            return ModelError("rate limit", text)
        return ModelError("server" if error.status_code >= 500 or error.status_code == 408 else "refused", text)
    if isinstance(error, exceptions.ContentFilterError):
        return ModelError("refused", text)
    if isinstance(error, exceptions.ModelAPIError | OSError):
        return ModelError("connection", text)
    return ModelError("server", f"{type(error).__name__}: {text}")
