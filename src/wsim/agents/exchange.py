"""A request to a model and what came back, as plain data: no times, no random names, pictures by their digest."""

from __future__ import annotations

import hashlib
import json
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from pydantic_ai.messages import ModelMessage, ModelResponse
    from pydantic_ai.models import ModelRequestParameters

Message = dict[str, Any]
LONGEST = 200_000  # characters of a reply that are kept: no plan, patch or review comes near


@dataclass(frozen=True)
class Asked:
    """What a model is asked.

    Attributes:
        messages: Of the whole conversation, oldest first.
        tools: Name, description and parameters of each tool.
        pictures: Their bytes, by digest.
    """

    messages: list[Message]
    tools: list[dict[str, Any]]
    pictures: dict[str, bytes]

    def digest(self, model: str) -> str:
        """Key of this request to this model."""
        return digest(json.dumps([model, self.messages, self.tools], sort_keys=True).encode())


def digest(data: bytes) -> str:
    """A name for some bytes."""
    return hashlib.sha256(data).hexdigest()[:24]


def asked(messages: list[ModelMessage], parameters: ModelRequestParameters) -> Asked:
    """A request as plain data."""
    pictures: dict[str, bytes] = {}
    plain: list[Message] = []
    for message in messages:
        instructions = getattr(message, "instructions", None)
        if instructions and not plain:
            plain.append({"role": "system", "text": instructions})
        plain += [_part(part, pictures) for part in message.parts]
    tools = [
        {"name": tool.name, "description": tool.description, "parameters": tool.parameters_json_schema}
        for tool in (*parameters.function_tools, *parameters.output_tools)
    ]
    return Asked(plain, tools, pictures)


def _part(part: Any, pictures: dict[str, bytes]) -> Message:
    kind = part.part_kind
    if kind == "user-prompt":
        return {"role": "user", "content": _content(part.content, pictures)}
    if kind == "system-prompt":
        return {"role": "system", "text": part.content}
    if kind == "text":
        return {"role": "model", "text": part.content}
    if kind == "tool-call":
        return {"role": "model", "call": part.tool_name, "arguments": _arguments(part.args)}
    if kind == "tool-return":
        return {"role": "tool", "name": part.tool_name, "text": part.model_response_str()}
    if kind in ("retry-prompt", "retry-feedback"):
        return {"role": "retry", "text": part.model_response()}
    return {"role": "model", "other": kind}


def _content(content: Any, pictures: dict[str, bytes]) -> Any:
    if isinstance(content, str):
        return content
    parts: list[Any] = []
    for one in content:
        if isinstance(one, str):
            parts.append(one)
            continue
        name = digest(one.data)
        pictures[name] = one.data
        parts.append({"picture": name, "type": one.media_type})
    return parts


def _arguments(given: Any) -> Any:
    if not isinstance(given, str):
        return given
    try:
        return json.loads(given)
    except (ValueError, RecursionError):
        return given


def said(response: ModelResponse) -> dict[str, Any]:
    """A reply as plain data: its text and its calls, without what the model thought; cut where it is endless."""
    text = "\n".join(part.content for part in response.parts if part.part_kind == "text")
    calls = [
        {"name": _clean(part.tool_name), "arguments": _sent(part.args), "id": _clean(part.tool_call_id)}
        for part in response.parts
        if part.part_kind == "tool-call"
    ]
    reply: dict[str, Any] = {"text": _clean(text)}
    if calls:
        reply["calls"] = calls
    if len(text) > LONGEST:
        reply["finish"] = "length"
    elif response.finish_reason not in (None, "stop", "tool_call"):
        reply["finish"] = response.finish_reason
    return reply


def _sent(arguments: Any) -> Any:
    """The arguments of a call; what is JSON and no object is put into one, for the tool to refuse."""
    text = _clean(arguments) if isinstance(arguments, str) else json.dumps(arguments)
    try:
        given = json.loads(text)
    except (ValueError, RecursionError):
        return text  # no JSON at all: the client says so to the model
    return text if isinstance(given, dict) else {} if given is None else {"arguments": given}


def _clean(text: str) -> str:
    """A text that can be written as UTF-8, not longer than any answer need be."""
    return text[:LONGEST].encode("utf-8", "replace").decode("utf-8")


def response_of(reply: dict[str, Any], model: str, usage: dict[str, int]) -> ModelResponse:
    """The reply that plain data tells of."""
    from pydantic_ai.messages import ModelResponse, TextPart, ToolCallPart  # a second to load: builtin roles need none
    from pydantic_ai.usage import RequestUsage

    parts: list[Any] = [TextPart(reply["text"])] if reply.get("text") else []
    for call in reply.get("calls", []):
        parts.append(ToolCallPart(call["name"], call["arguments"], tool_call_id=call["id"]))
    return ModelResponse(
        parts,
        usage=RequestUsage(input_tokens=usage.get("input_tokens", 0), output_tokens=usage.get("output_tokens", 0)),
        model_name=model,
        finish_reason=reply.get("finish", "stop"),
    )
