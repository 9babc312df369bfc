"""The server: what the protocol asks for, answered from the desk's tools, resources and prompts."""

from __future__ import annotations

import base64
import difflib
import logging
import mimetypes
import time
from collections.abc import Callable, Iterable
from typing import Any

import anyio
from anyio import from_thread, to_thread
from mcp import types
from mcp.server import Server, ServerRequestContext
from mcp.shared.exceptions import MCPError

import wsim
from wsim.errors import UserError
from wsim.mcp import prompt_texts
from wsim.mcp.desk import Desk
from wsim.mcp.resources import Readable, readables
from wsim.mcp.run_tools import run_tools
from wsim.tools import TOOLS
from wsim.tools.base import Result, Tool

BETWEEN = 0.5  # seconds between two notices of progress

logger = logging.getLogger(__name__)
Context = ServerRequestContext[Any, Any]


def make_server(desk: Desk) -> Server[Any]:
    """A server for a desk; it speaks over whatever transport runs it."""
    return Answers(desk).server()


class Answers:
    """What the protocol may ask for, and the answers.

    Tools run in a thread, one at a time: they share the run, and the machine. Each is waited for, so that one which was
    cancelled has come to its end before the next begins.
    """

    def __init__(self, desk: Desk) -> None:
        self.desk = desk
        self.tools: dict[str, Tool] = {**run_tools(desk), **TOOLS}
        self._one_at_a_time = anyio.CapacityLimiter(1)

    def server(self) -> Server[Any]:
        """These answers, given by a server."""
        return Server(
            "wsim",
            version=wsim.__version__,
            instructions=prompt_texts.instructions(),
            on_list_tools=self.list_tools,
            on_call_tool=self.call_tool,
            on_list_resources=self.list_resources,
            on_read_resource=self.read_resource,
            on_list_prompts=self.list_prompts,
            on_get_prompt=self.get_prompt,
        )

    async def list_tools(self, context: Context, params: types.PaginatedRequestParams | None) -> types.ListToolsResult:
        """Every tool, with the schema of its arguments."""
        return types.ListToolsResult(tools=[_listed(tool) for tool in self.tools.values()])

    async def call_tool(self, context: Context, params: types.CallToolRequestParams) -> types.CallToolResult:
        """A tool's answer, with progress while it works; a mistake is an answer too."""
        tool = self.tools.get(params.name) or _unknown("tool", params.name, self.tools)
        told = _Teller(context)

        def work() -> Result:
            return self.desk.call(tool, params.arguments or {}, told)

        try:
            result = await to_thread.run_sync(work, limiter=self._one_at_a_time)
        except Exception as error:  # what broke in a tool must not end the server
            logger.exception("%s failed", tool.name)
            result = Result(f"{tool.name} failed: {type(error).__name__}: {error}", ok=False)
        return types.CallToolResult(content=_content(result), is_error=not result.ok)

    async def list_resources(
        self, context: Context, params: types.PaginatedRequestParams | None
    ) -> types.ListResourcesResult:
        """The skills, the plan's schema, and the open run's files."""
        return types.ListResourcesResult(
            resources=[
                types.Resource(uri=item.uri, name=item.name, description=item.description, mime_type=item.kind)
                for item in self._readables().values()
            ]
        )

    async def read_resource(
        self, context: Context, params: types.ReadResourceRequestParams
    ) -> types.ReadResourceResult:
        """A resource's text."""
        known = self._readables()
        item = known.get(str(params.uri)) or _unknown("resource", str(params.uri), known)
        try:
            text = item.read()
        except UserError as error:
            raise MCPError(types.INVALID_PARAMS, str(error)) from error
        return types.ReadResourceResult(
            contents=[types.TextResourceContents(uri=item.uri, mime_type=item.kind, text=text)]
        )

    def _readables(self) -> dict[str, Readable]:
        try:
            return readables(self.desk)
        except UserError as error:  # a skill that someone is just writing
            raise MCPError(types.INTERNAL_ERROR, str(error)) from error

    async def list_prompts(
        self, context: Context, params: types.PaginatedRequestParams | None
    ) -> types.ListPromptsResult:
        """The prompts; each is about a world that a sentence says."""
        told = "What the world must be, in one or a few plain sentences."
        sentence = types.PromptArgument(name="prompt", description=told, required=True)
        return types.ListPromptsResult(
            prompts=[
                types.Prompt(name=name, description=prompt_texts.description(name), arguments=[sentence])
                for name in prompt_texts.NAMES
            ]
        )

    async def get_prompt(self, context: Context, params: types.GetPromptRequestParams) -> types.GetPromptResult:
        """A prompt's text, about the world that is asked for."""
        if params.name not in prompt_texts.NAMES:
            _unknown("prompt", params.name, prompt_texts.NAMES)
        prompt = (params.arguments or {}).get("prompt", "").strip()
        if not prompt:
            raise MCPError(types.INVALID_PARAMS, f"{params.name}: prompt is missing; say what the world must be")
        text = types.TextContent(type="text", text=prompt_texts.fill(params.name, prompt))
        return types.GetPromptResult(
            description=prompt_texts.description(params.name),
            messages=[types.PromptMessage(role="user", content=text)],
        )


class _Teller:
    """Progress from a tool's thread to the client; and, as it is called often, where a cancelled tool stops.

    The protocol wants a number that only grows, and a tool has several stages: each counts as one.
    """

    def __init__(self, context: Context) -> None:
        self._report: Callable[..., Any] = context.session.report_progress
        self._stage, self._begun, self._told = "", 0, 0.0

    def __call__(self, stage: str, done: float, total: float) -> None:
        """Tell the client: every stage once, and then at most every half second.

        Raises:
            CancelledError: If the client called the tool off; not an Exception, so that no tool takes it for its own.
        """
        from_thread.check_cancelled()
        now = time.monotonic()
        if stage == self._stage and now - self._told < BETWEEN:
            return
        self._begun += stage != self._stage
        self._stage, self._told = stage, now
        share = min(done / total, 1.0) if total > 0 else 0.0
        from_thread.run(self._report, self._begun - 1 + share, None, f"{stage}: {share:.0%}")


def _listed(tool: Tool) -> types.Tool:
    return types.Tool(
        name=tool.name,
        description=tool.description,
        input_schema=tool.arguments.model_json_schema(),
        # Nothing in a run is overwritten, and no tool reaches out of this machine.
        annotations=types.ToolAnnotations(
            read_only_hint=not tool.writes, destructive_hint=False, open_world_hint=False
        ),
    )


def _content(result: Result) -> list[types.ContentBlock]:
    content: list[types.ContentBlock] = [types.TextContent(type="text", text=result.text)]
    if result.image is not None:
        kind = mimetypes.guess_type(result.image.name)[0] or "image/png"
        data = base64.b64encode(result.image.read_bytes()).decode("ascii")
        content.append(types.ImageContent(type="image", data=data, mime_type=kind))
    return content


def _unknown(what: str, name: str, known: Iterable[str]) -> Any:
    near = difflib.get_close_matches(name, list(known), n=3, cutoff=0.4) or sorted(known)
    raise MCPError(types.INVALID_PARAMS, f"there is no {what} {name!r}; there is {', '.join(near)}")
