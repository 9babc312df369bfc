"""A conversation as short as it can be: what was refused before the last answer is not sent again, why it was is."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from pydantic_ai.messages import ModelMessage, ModelRequest, ModelResponse, RetryFeedbackPart, TextPart

EARLIER = "\nAn earlier answer was refused, and this must hold too: "


def shortened(messages: Sequence[ModelMessage]) -> list[ModelMessage]:
    """The conversation with the last of its refused answers alone.

    A plan that is refused three times would be sent three times, and each is a thousand tokens. What was wrong with
    the earlier ones stands after what is wrong with the last. Calls of tools and their results stay.

    Args:
        messages: Of the whole conversation, oldest first.
    """
    refused = [k for k in range(len(messages) - 1) if _is_refused(messages[k], messages[k + 1])]
    if len(refused) < 2:
        return list(messages)
    *earlier, last = refused
    dropped = {k + step for k in earlier for step in (0, 1)}
    now, *before = (_why(messages[k + 1]) for k in (last, *earlier))
    # One mistake made twice is told twice: else the request would be that before, and so would its kept answer.
    told = EARLIER.join([now, *(line for told in before for line in told.split(EARLIER))])
    return [
        _retold(message, told) if k == last + 1 else message for k, message in enumerate(messages) if k not in dropped
    ]


def _is_refused(answer: ModelMessage, after: ModelMessage) -> bool:
    """Whether an answer is words alone, and what follows says only what is wrong with them."""
    return (
        isinstance(answer, ModelResponse)
        and all(isinstance(part, TextPart) for part in answer.parts)
        and isinstance(after, ModelRequest)
        and len(after.parts) == 1
        and isinstance(after.parts[0], RetryFeedbackPart)
        and isinstance(after.parts[0].content, str)
    )


def _why(message: ModelMessage) -> str:
    return str(message.parts[0].content)  # type: ignore[union-attr]  # of one that `_is_refused` saw


def _retold(message: ModelMessage, text: str) -> ModelMessage:
    part = message.parts[0]
    assert isinstance(message, ModelRequest) and isinstance(part, RetryFeedbackPart)
    return replace(message, parts=[replace(part, content=text)])
