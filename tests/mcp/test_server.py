"""What the server offers, and how its tools run: one at a time, told how far they are, called off, broken."""

from __future__ import annotations

import base64
import io
import json
from functools import partial

import anyio
import pytest
from mcp.shared.exceptions import MCPError
from PIL import Image

from tests.patience import STUCK, until
from wsim.plan.schema import Plan
from wsim.skills import skills
from wsim.tools import TOOLS

pytestmark = pytest.mark.anyio
PROMPT = "A wooden box slides down a ramp."
OWN = {"make_plan", "new_run", "open_run", "draft_program"}


@pytest.mark.parametrize("mode", ["auto", "legacy"])
async def test_every_tool_is_offered_as_it_is(talk, mode: str) -> None:
    """To clients of this protocol's first kind, which shake hands, and of the kind that does not."""
    async with talk(mode=mode) as world:
        assert world.client.server_info.name == "wsim"
        assert "make_plan" in world.client.instructions
        listed = {tool.name: tool for tool in (await world.client.list_tools()).tools}
        assert listed.keys() == TOOLS.keys() | OWN
        for name, tool in TOOLS.items():
            assert listed[name].description == tool.description
            assert listed[name].input_schema == tool.arguments.model_json_schema()
            assert listed[name].annotations.read_only_hint is not tool.writes
        assert "make_plan" in await world.bad("read_plan")  # how to open a run


async def test_every_skill_is_a_resource(talk) -> None:
    async with talk() as world:
        listed = {resource.uri: resource for resource in (await world.client.list_resources()).resources}
        assert skills()
        for skill in skills():
            assert listed[f"skill://{skill.name}"].description == skill.description
            contents = (await world.client.read_resource(f"skill://{skill.name}")).contents[0]
            assert (contents.text, contents.mime_type) == (skill.text, "text/markdown")
            for path in skill.folder.glob("references/*.md"):
                beside = await world.client.read_resource(f"skill://{skill.name}/references/{path.name}")
                assert beside.contents[0].text == path.read_text()
        schema = (await world.client.read_resource("wsim://plan-schema")).contents[0].text
        assert json.loads(schema) == Plan.model_json_schema()


async def test_what_is_not_listed_is_not_read(talk) -> None:
    async with talk() as world:
        for uri in ("run://secret", "skill://../../etc/passwd", "file:///etc/passwd"):
            with pytest.raises(MCPError, match="there is no resource"):
                await world.client.read_resource(uri)
        with pytest.raises(MCPError, match="make_plan"):  # no run is open
            await world.client.read_resource("run://plan.json")


async def test_prompts_carry_the_sentence(talk) -> None:
    async with talk() as world:
        tools = {tool.name for tool in (await world.client.list_tools()).tools}
        for prompt in (await world.client.list_prompts()).prompts:
            assert [(each.name, each.required) for each in prompt.arguments] == [("prompt", True)]
            text = (await world.client.get_prompt(prompt.name, {"prompt": PROMPT})).messages[0].content.text
            assert PROMPT in text
            assert "{" not in text
            named = {word for word in text.split("`")[1::2] if "_" in word}
            assert named
            assert named <= tools
            with pytest.raises(MCPError, match="prompt is missing"):
                await world.client.get_prompt(prompt.name)
        with pytest.raises(MCPError, match="generate"):
            await world.client.get_prompt("generat", {"prompt": PROMPT})


async def test_runs_are_started_and_opened(talk) -> None:
    async with talk() as world:
        assert "no runs yet" in await world.bad("open_run")
        drawn = await world.ask("make_plan", prompt=PROMPT)
        text, picture = drawn.content
        assert picture.mime_type == "image/png"
        with Image.open(io.BytesIO(base64.b64decode(picture.data))) as image:
            assert min(image.size) > 100
        (first,) = world.runs
        assert first.name in text.text
        assert (await world.client.read_resource("run://plan.json")).contents[0].text == (
            first / "plan.json"
        ).read_text()
        await world.good("draft_program")
        await world.good("new_run", title="nothing yet")
        assert "no plan" in await world.bad("read_plan")
        assert "no plan" in await world.bad("draft_program")
        with pytest.raises(MCPError, match=r"no plan\.json yet"):
            await world.client.read_resource("run://plan.json")
        assert "1 iteration, the newest not judged yet" in await world.good("open_run", run=first.name)
        assert "wooden_box" in await world.good("read_plan")
        for elsewhere in ("..", str(world.folder), f"../runs/{first.name}", first.name[:-2]):
            assert first.name in await world.bad("open_run", run=elsewhere)
        assert "no iterations" in await world.good("open_run")  # the newest


async def test_mistakes_are_answers(talk) -> None:
    async with talk() as world:
        assert "'giraffe'" in await world.bad("make_plan", prompt="A purple giraffe sings.")
        assert "prompt" in await world.bad("make_plan")
        assert "workspace" in await world.bad("make_plan", prompt=PROMPT, workspace="/")
        assert world.runs == []
        with pytest.raises(MCPError, match="make_plan"):
            await world.ask("make_plans", prompt=PROMPT)


async def test_a_tool_that_breaks_does_not_end_the_server(talk) -> None:
    async with talk(loud=True) as world:
        assert await world.bad("broken") == "broken failed: RuntimeError: the disk is on fire"
        assert "in broken" in world.stderr  # where, for a person
        assert await world.good("loud") == "said"


async def test_tools_run_one_at_a_time_and_tell_how_far(talk) -> None:
    async with talk(loud=True) as world:
        await world.good("new_run", title="waiting")
        answers = []

        async def wait(name: str) -> None:
            answers.append(await world.good("wait", seconds=0.7, name=name))

        async with anyio.create_task_group() as both:
            both.start_soon(wait, "a.wait")
            both.start_soon(wait, "b.wait")
        assert answers == ["beside []", "beside []"]
        world.told.clear()
        await wait("c.wait")
        numbers = [number for number, _ in world.told]
        assert numbers == sorted(set(numbers)), "the protocol wants numbers that grow"
        messages = [message.split(":")[0] for _, message in world.told]
        assert (messages[0], messages[-1]) == ("waiting", "resting")
        assert len(messages) <= 3  # it waits 35 times, and tells of it twice a second at most


@pytest.mark.parametrize("mode", ["auto", "legacy"])
async def test_a_tool_that_is_called_off_stops_before_the_next_begins(talk, mode: str) -> None:
    async with talk(loud=True, mode=mode) as world:
        await world.good("new_run", title="waiting")
        (run,) = world.runs
        async with anyio.create_task_group() as group:
            group.start_soon(partial(world.ask, "wait", seconds=2 * STUCK, name="a.wait"))
            await anyio.to_thread.run_sync(until, (run / "a.wait").is_file)
            group.cancel_scope.cancel()
        assert await world.good("wait", seconds=0.1, name="b.wait") == "beside []"
        assert (run / "a.wait").read_text() == "stopped by CancelledError"


async def test_a_run_that_is_called_off_is_not_broken(talk) -> None:
    """Its iteration has no verdict, and is run again as if it were new."""
    async with talk() as world:
        await world.good("make_plan", prompt=PROMPT)
        await world.good("draft_program")
        (run,) = world.runs
        began = anyio.Event()

        async def told(progress: float, total: float | None, message: str | None) -> None:
            if (message or "").startswith("simulating"):
                began.set()

        async with anyio.create_task_group() as group:
            group.start_soon(world.client.call_tool, "run_program", {"passes": "physics"}, None, told)
            await began.wait()
            group.cancel_scope.cancel()
        assert "no verdict" in await world.bad("read_verdict")
        assert "accepted" in await world.good("run_program", passes="physics")
        assert not list(run.rglob("*.part*"))
