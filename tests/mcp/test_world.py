"""A client drives a whole world: plan, write, validate, run, query, repair, accepted."""

from __future__ import annotations

import json

import pytest

pytestmark = pytest.mark.anyio
PROMPT = "A wooden box slides down a ramp."


async def test_a_world_from_plan_to_accepted(talk) -> None:
    async with talk() as world:
        text = (await world.client.get_prompt("generate", {"prompt": PROMPT})).messages[0].content.text
        assert PROMPT in text

        plan = await world.good("make_plan", prompt=PROMPT)
        assert "wooden_box" in plan
        assert "slides" in plan
        assert "01" in await world.good("draft_program")
        (run,) = world.runs
        draft = (await world.client.read_resource("run://program.py")).contents[0].text
        assert draft == (run / "iterations" / "01" / "program.py").read_text()

        # written with a mistake, told so, mended
        sticky = draft.replace("friction=0.4", "friction=0.9")
        assert sticky != draft
        told = await world.bad("write_program", text=sticky.replace("scene.ground(", "scene.grund("))
        assert "grund" in told
        assert "ground" in told.replace("grund", "")
        assert "02" in await world.good("write_program", text=sticky)

        # run, and found wanting: on wood of this friction nothing slides
        assert "wooden_box" in await world.good("run_program", passes="build")
        assert "rejected" in await world.good("run_program", passes="physics")
        assert any(message.startswith("simulating") for _, message in world.told)
        verdict = await world.good("read_verdict")
        assert verdict.startswith("rejected")
        assert "ObjectiveSlides" in verdict
        speed = await world.good("query_recording", signal="speed", prim="wooden_box", reduction="max")
        assert float(speed.split()[-2]) < 0.05  # [m/s]: it stuck

        # mended where the finding points, and run again
        edit = {"search": "friction=0.9", "replace": "friction=0.4"}
        assert "03" in await world.good("patch_program", edits=[edit])
        assert "accepted" in await world.good("run_program", passes="physics")
        assert (await world.good("read_verdict")).startswith("accepted")
        shown = await world.client.read_resource("run://verdict.json")
        assert json.loads(shown.contents[0].text)["status"] == "accepted"
        assert "accepted" in (run / "iterations" / "03" / "verdict.json").read_text()
        assert "rejected" in (run / "iterations" / "02" / "verdict.json").read_text()
        assert "3 iterations, the newest accepted" in await world.good("open_run")

        # accepted: run again, compared, stamped
        assert "rejected" in await world.bad("accept", iteration=2)
        assert "0 m off" in await world.good("accept")
        assert (run / "accepted" / "program.py").read_text() == (run / "iterations" / "03" / "program.py").read_text()
        assert len((run / "accepted" / "SHA256SUMS").read_text().splitlines()) == 2
