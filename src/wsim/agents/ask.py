"""Ask a role's model for one thing, checked: what is wrong goes back to it, a few times."""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING, Any, TypeVar

from wsim.agents.budget import BudgetError, Ledger
from wsim.agents.chapters import PROMPTS
from wsim.agents.failures import ModelError
from wsim.agents.models import Models, connect
from wsim.agents.transcript import Transcript
from wsim.errors import UserError

if TYPE_CHECKING:
    from wsim.agents.relay import Replay
    from wsim.tools import Tool, Workspace

T = TypeVar("T")
RETRIES = 4  # answers that are sent back with what is wrong with them
CALLS = 10  # of tools, for one answer; then they answer that it is time to
ROUNDS = 8  # of calls, for one answer
_FENCE = re.compile(r"```[ \t]*(\w*)[ \t\r]*$")


class UnusableError(UserError):
    """An answer that cannot be used: what is wrong with it, for the model to read."""


@dataclass
class Desk:
    """What the roles of a run share; a `fresh` one takes no replies that are kept from before."""

    models: Models
    transcript: Transcript
    ledger: Ledger
    replay: Replay | None = None
    fresh: bool = False

    def answers(self, role: str) -> bool:
        """Whether a role's model would answer now: a recorded run has no word for what it was not asked."""
        return self.replay is None or (bool(self.replay.left) and self.replay.left[0].role == role)

    def ask(
        self,
        role: str,
        request: str,
        accept: Callable[[str], T],
        *,
        pictures: Sequence[bytes] = (),
        tools: Sequence[Tool] = (),
        workspace: Workspace | None = None,
        told: str | None = None,
    ) -> T:
        """What `accept` makes of the model's answer.

        Args:
            role: Whose model is asked, by its prompt in prompts/.
            request: What it is to do.
            accept: Reads the answer; raises UserError with what is wrong, which goes back to the model.
            pictures: JPEGs that it sees.
            tools: What it may call, in `workspace`.
            workspace: The run that the tools work on.
            told: Its instructions; its prompt in prompts/ by default.

        Raises:
            ModelError: If it gave nothing that can be used.
            BudgetError: If tokens or time ran out.
        """
        # a second to load: builtin roles need none
        from pydantic_ai import Agent, BinaryContent, ModelRetry, TextOutput
        from pydantic_ai.capabilities import ProcessHistory  # a second to load: builtin roles need none

        # a second to load: builtin roles need none
        from pydantic_ai.exceptions import ContentFilterError, UnexpectedModelBehavior, UsageLimitExceeded
        from pydantic_ai.usage import UsageLimits  # a second to load: builtin roles need none

        from wsim.agents.history import shortened
        from wsim.agents.relay import Relay

        self.ledger.check()
        wrong: list[str] = []

        def read(text: str) -> T:
            try:
                return accept(text)
            except UserError as error:
                wrong.append(str(error))
                raise ModelRetry(str(error)) from error

        called: list[str] = []
        name = self.models[role]
        model = Relay(
            connect(name, role) if self.replay is None else None, name, role, self.transcript, self.ledger, self.replay,
            fresh=self.fresh,
        )  # fmt: skip
        agent: Agent[None, T] = Agent(
            model,
            output_type=TextOutput(read),
            instructions=told or instructions(role),
            tools=[_offered(tool, workspace, called) for tool in tools if workspace is not None],
            retries={"output": RETRIES, "tools": RETRIES},
            capabilities=[ProcessHistory(shortened)],
            # a provider that keeps the beginning of a conversation takes a tenth for it, or less
            model_settings={"max_retries": 0, "parallel_tool_calls": True, "cache": True},
        )
        content: Any = [request, *(BinaryContent(picture, media_type="image/jpeg") for picture in pictures)]
        limits = UsageLimits(request_limit=RETRIES + ROUNDS + 1)
        try:
            return agent.run_sync(content if pictures else request, usage_limits=limits, infer_name=False).output
        except (ModelError, BudgetError):
            raise
        except ContentFilterError as error:
            raise ModelError("refused", "the model's provider withheld its answer", role) from error
        except UsageLimitExceeded as error:
            model.forget()
            raise ModelError("unusable", f"it went on calling tools: {error}", role) from error
        except UnexpectedModelBehavior as error:
            model.forget()
            last = wrong[-1] if wrong else " ".join(str(error).split())[:300]
            raise ModelError("unusable", f"{len(wrong)} answers could not be used; the last: {last}", role) from error


def _offered(tool: Tool, workspace: Workspace | None, called: list[str]) -> Any:
    """One of wsim's tools, as the model's; `called` is what was called for this answer."""
    from pydantic_ai import Tool as Offered  # a second to load: builtin roles need none

    def call(**given: Any) -> str:
        assert workspace is not None
        called.append(tool.name)
        if len(called) > CALLS:
            return f"no more calls: {CALLS} were made for this answer; give it now, with what you know"
        return tool(workspace, **given).text

    return Offered.from_schema(call, tool.name, tool.description, _schema(tool.arguments.model_json_schema()))


def _schema(schema: dict[str, Any]) -> dict[str, Any]:
    """A JSON schema without titles, which cost tokens and say nothing."""
    return {
        key: {name: _schema(value) for name, value in part.items()}
        if key in ("properties", "$defs")
        else _schema(part)
        if isinstance(part, dict)
        else part
        for key, part in schema.items()
        if key not in ("title", "additionalProperties", "default")
    }


@cache
def instructions(role: str) -> str:
    """The prompt of a role."""
    return (PROMPTS / f"{role}.md").read_text(encoding="utf-8")


def object_in(text: str) -> dict[str, Any]:
    """The JSON object of an answer, in a fence or bare.

    Raises:
        UnusableError: If there is none, or it is not whole.
    """
    body = max(_fenced(text), key=len, default="") or _bare(text)
    if not body.strip():
        raise UnusableError("no JSON object in the answer; give one, between ```json and ```")
    try:
        found = json.loads(body)
    except (ValueError, RecursionError) as error:
        end = (
            " (it breaks off: the answer was cut; give a shorter one)" if "{" in text and "}" not in text[-40:] else ""
        )
        raise UnusableError(f"not JSON: {error}{end}; give one whole JSON object between ```json and ```") from error
    if not isinstance(found, dict):
        raise UnusableError("the answer must be one JSON object")
    return found


def _fenced(text: str) -> list[str]:
    """What stands in the fences of an answer that are of JSON, or say nothing."""
    found: list[str] = []
    inside: list[str] | None = None
    language = ""
    for line in text.split("\n"):
        if inside is not None and line.lstrip().startswith("```"):
            if language in ("", "json"):
                found.append("\n".join(inside))
            inside = None
        elif inside is not None:
            inside.append(line)
        elif opening := _FENCE.search(line):
            inside, language = [], opening[1].lower()
    return found


def _bare(text: str) -> str:
    """From the first brace to the last; to the end, where none closes."""
    begin, end = text.find("{"), text.rfind("}") + 1
    return "" if begin < 0 else text[begin : end if end > begin else len(text)]
