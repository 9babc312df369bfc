"""Whether the scene takes what a plan says: the plan's own draft, built in the sandbox."""

from __future__ import annotations

import tempfile
from pathlib import Path

from wsim.assets import asset_folders
from wsim.errors import UserError
from wsim.plan.schema import Plan
from wsim.program.compose import compose
from wsim.program.sandbox import build


def refuse_unbuildable(plan: Plan, where: Path, isolation: str = "auto") -> None:
    """Refuse a plan that the scene refuses: what the plan's schema alone cannot see, by the scene's own rules.

    A build that fails for want of time, memory or a place says nothing of the plan, and refuses none.

    Args:
        plan: A laid-out plan.
        where: Its file.
        isolation: As of `wsim.program.sandbox.build`.

    Raises:
        UserError: What the scene says, one fault after another; or no isolation works here.
    """
    with tempfile.TemporaryDirectory(prefix="wsim-draft-") as folder:
        program = Path(folder) / "program.py"
        program.write_text(compose(plan), encoding="utf-8")
        built = build(program, Path(folder) / "stage.usda", isolation=isolation, readable=asset_folders())
    if built.kind in ("exception", "stage"):
        told = built.problems or (built.message.removeprefix("SceneError: "),)
        raise UserError(f"{where}: a plan that cannot be built: {'; '.join(told)}")
