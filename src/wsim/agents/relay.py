"""The one way to a model: asked live, from the cache, or from a recorded run; all of it is written down."""

from __future__ import annotations

import asyncio
import json
import time
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from pydantic_ai.messages import ModelMessage, ModelRequest, ModelResponse, SystemPromptPart, UserPromptPart
from pydantic_ai.models import Model, ModelRequestParameters
from pydantic_ai.models.wrapper import WrapperModel
from pydantic_ai.settings import ModelSettings

from wsim.agents import cache
from wsim.agents.budget import Ledger
from wsim.agents.exchange import Asked, asked, response_of, said
from wsim.agents.failures import AGAIN, ModelError, failure
from wsim.agents.transcript import Exchange, Transcript, read

Reply = dict[str, Any]
Usage = dict[str, int]
LONGEST_PAUSE = 30.0  # between two attempts [s]


@dataclass
class Replay:
    """A recorded run that answers in place of models, in its order.

    Attributes:
        left: Exchanges that were not asked for yet.
        divergences: Where what was asked differs from what was recorded, a line each.
    """

    left: deque[Exchange]
    divergences: list[str] = field(default_factory=list)

    @classmethod
    def of(cls, folder: Path) -> Replay:
        """The transcript of a run's folder."""
        return cls(deque(read(folder)))

    def next(self, role: str, request: Asked) -> Exchange:
        """The recorded answer to this request, and a note where the request is another one.

        Raises:
            ModelError: If none is left, or the next one was another role's.
        """
        if not self.left:
            raise ModelError("end of transcript", "the recorded run asked nothing more", role)
        exchange = self.left.popleft()
        if exchange.role != role:
            self.divergences.append(f"exchange {exchange.number}: the {role} asks, where the {exchange.role} did")
            raise ModelError("end of transcript", self.divergences[-1], role)
        where = _difference(exchange.messages, request.messages)
        if where:
            self.divergences.append(f"exchange {exchange.number}, {role}: {where}")
        return exchange


class Relay(WrapperModel):
    """A model behind the transcript, the cache and the budget.

    Args:
        wrapped: The model; None in a replay.
        name: What it is called in the transcript.
        role: Who asks.
        transcript: Gets every exchange.
        ledger: Is charged.
        replay: Answers in place of the model.
        sleep: Waits between attempts [s].
        fresh: Ask whatever was asked before, too; replies are kept all the same.
    """

    def __init__(
        self,
        wrapped: Model | None,
        name: str,
        role: str,
        transcript: Transcript,
        ledger: Ledger,
        replay: Replay | None = None,
        sleep: Callable[[float], Any] = asyncio.sleep,
        *,
        fresh: bool = False,
    ) -> None:
        super().__init__(wrapped if wrapped is not None else _absent())
        self.name, self.role, self.transcript, self.ledger, self.replay = name, role, transcript, ledger, replay
        self.sleep, self.fresh = sleep, fresh
        self._kept: list[str] = []

    async def request(
        self,
        messages: list[ModelMessage],
        model_settings: ModelSettings | None,
        model_request_parameters: ModelRequestParameters,
    ) -> ModelResponse:
        """Answer a request.

        Raises:
            ModelError: If every attempt failed.
            BudgetError: If nothing is left to ask with.
        """
        messages = _for_any(messages)
        request = asked(messages, model_request_parameters)
        if self.replay is not None:
            return self._replayed(request)
        key = request.digest(self.name)
        self._kept.append(key)
        known = None if self.fresh else cache.get(key)
        if known is not None:
            self.ledger.account(self.role).cached += 1
            self.transcript.add(self.role, self.name, request, reply=known, cached=True)
            return response_of(known, self.name, {})
        reply, usage = await self._live(request, messages, model_settings, model_request_parameters)
        if "finish" not in reply and (reply["text"] or "calls" in reply):  # what was cut or withheld is asked again
            cache.put(key, reply)
        return response_of(reply, self.name, usage)  # as the cache and a replay give it, so that all go on alike

    def forget(self) -> None:
        """Drop the replies of this conversation from the cache: they came to nothing."""
        for key in self._kept:
            cache.drop(key)

    async def _live(self, request: Asked, messages: Any, settings: Any, parameters: Any) -> tuple[Reply, Usage]:
        budget, account = self.ledger.budget, self.ledger.account(self.role)
        for attempt in range(1, budget.attempts + 1):
            self.ledger.check()
            started = time.monotonic()
            patience = max(min(budget.request_seconds, self.ledger.seconds_left), 0.01)
            try:
                response = await asyncio.wait_for(self.wrapped.request(messages, settings, parameters), patience)
            except Exception as error:  # whatever a client raises is a failed attempt
                seconds = _since(started)
                failed = failure(error)
                account.failed += 1
                account.seconds += seconds
                self.transcript.add(
                    self.role, self.name, request, error={"kind": failed.kind, "message": str(failed)}, seconds=seconds
                )
                if failed.kind not in AGAIN or attempt == budget.attempts:
                    raise ModelError(failed.kind, str(failed), self.role) from error
                await self.sleep(min(2.0**attempt, LONGEST_PAUSE, max(self.ledger.seconds_left, 0.0)))
                continue
            return self._charge(request, response, _since(started))
        raise AssertionError("unreachable")

    def _charge(self, request: Asked, response: ModelResponse, seconds: float) -> tuple[Reply, Usage]:
        account = self.ledger.account(self.role)
        reply = said(response)
        usage = {"input_tokens": response.usage.input_tokens, "output_tokens": response.usage.output_tokens}
        if not any(usage.values()):  # a server that does not count
            usage = {"input_tokens": _tokens(request.messages, request.tools), "output_tokens": _tokens(reply)}
        if response.usage.cache_read_tokens:
            usage["cache_read_tokens"] = response.usage.cache_read_tokens
        account.requests += 1
        account.charge(usage)
        account.seconds += seconds
        price = _price(response)
        if price is not None:
            account.dollars = (account.dollars or 0.0) + price
        self.transcript.add(self.role, self.name, request, reply=reply, usage=usage, seconds=seconds)
        return reply, usage

    def _replayed(self, request: Asked) -> ModelResponse:
        assert self.replay is not None
        while True:
            exchange = self.replay.next(self.role, request)
            account = self.ledger.account(self.role)
            account.seconds += exchange.seconds
            self.transcript.add(
                self.role, exchange.model, request, reply=exchange.reply, error=exchange.error, usage=exchange.usage,
                seconds=exchange.seconds, cached=exchange.cached,
            )  # fmt: skip
            if exchange.reply is not None:
                account.cached += exchange.cached
                account.requests += not exchange.cached
                account.charge(exchange.usage)
                return response_of(exchange.reply, exchange.model, exchange.usage)
            account.failed += 1
            error = exchange.error or {}
            following = self.replay.left[0] if self.replay.left else None
            again = following is not None and following.role == self.role and following.messages == exchange.messages
            if not again:
                raise ModelError(error.get("kind", "server"), error.get("message", ""), self.role)  # type: ignore[arg-type]


def _for_any(messages: list[ModelMessage]) -> list[ModelMessage]:
    """The messages without words of the system in between.

    The client adds some for certain models alone, and many servers refuse them there. Where they are all that is said,
    the user says them.
    """
    plain: list[ModelMessage] = [*messages]
    for k, message in enumerate(messages[1:], start=1):
        if isinstance(message, ModelRequest):
            parts = [part for part in message.parts if not isinstance(part, SystemPromptPart)]
            parts = parts or [UserPromptPart(p.content) for p in message.parts if isinstance(p, SystemPromptPart)]
            plain[k] = replace(message, parts=parts)
    return plain


def _difference(recorded: list[dict[str, Any]], now: list[dict[str, Any]]) -> str:
    """Where two conversations part, in one line; empty if nowhere."""
    if len(recorded) != len(now):
        return f"{len(now)} messages, where there were {len(recorded)}"
    for k, (old, new) in enumerate(zip(recorded, now, strict=True), start=1):
        if old == new:
            continue
        before, after = (_text(message).splitlines() for message in (old, new))
        pairs = zip([*before, *[""] * len(after)], [*after, *[""] * len(before)], strict=True)
        first = next(((a, b) for a, b in pairs if a != b), ("", ""))
        return f"message {k}: {first[1][:120]!r}, where it was {first[0][:120]!r}"
    return ""


def _text(message: dict[str, Any]) -> str:
    content = message.get("content", message.get("text", message.get("arguments", "")))
    if isinstance(content, list):
        return "\n".join(one if isinstance(one, str) else str(one) for one in content)
    return content if isinstance(content, str) else str(content)


def _since(started: float) -> float:
    """Seconds of a request, to the digits that the transcript keeps: a replay adds them up to the same sum."""
    return round(time.monotonic() - started, 2)


def _tokens(*data: Any) -> int:
    """About how many tokens some plain data is: four characters each."""
    return -(-sum(len(json.dumps(one, ensure_ascii=False)) for one in data) // 4)


def _price(response: ModelResponse) -> float | None:
    """In dollars; None where no price is known, as of a model of one's own."""
    try:
        return float(response.cost().total_price)
    except Exception:  # noqa: BLE001 - a price list that lacks a model must not end a run
        return None


def _absent() -> Model:
    from pydantic_ai.models.test import TestModel  # a second to load: builtin roles need none

    return TestModel()
