"""A person's word before anything is built: yes, no, an answer to a question, or the plan changed in an editor."""

from __future__ import annotations

import os
import shlex
import subprocess
import tempfile
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from wsim.agents.shorthand import load_given
from wsim.cli.show import console, show_plan
from wsim.errors import UserError
from wsim.plan.drawing.picture import draw_picture
from wsim.plan.layout import layout
from wsim.plan.schema import Plan
from wsim.rules.questions import Planner, Question, answered, questions, read_answers

NO_ANSWER = (
    "nothing was built: there was no answer; --yes builds without asking, --answers FILE answers the questions first"
)


@dataclass
class Proposal:
    """A plan that waits for a person's word.

    Attributes:
        plan: As it stands now.
        planner: Plans a sentence again, with an answer in it; None for a plan that is used as it is written.
        folder: Where its picture goes.
    """

    plan: Plan
    planner: Planner | None
    folder: Path

    def questions(self) -> list[Question]:
        """What to ask."""
        return questions(self.plan) if self.planner is not None else []

    def answer(self, answers: Mapping[str, str]) -> None:
        """Take answers, and plan again."""
        if self.planner is None:
            raise UserError("answers are for the planner's questions; a plan from a file has none: change the file")
        self.plan = answered(self.plan, answers, self.planner)

    def show(self) -> None:
        """All that there is to read before saying yes."""
        show_plan(self.plan, self.questions(), draw(self.plan, self.folder / "plan.png"))


def with_answers(plan: Plan, planner: Planner | None, answers: Path | None) -> Plan:
    """The plan with the answers of a file."""
    if answers is None:
        return plan
    proposal = Proposal(plan, planner, Path())
    given = read_answers(answers)
    if given:
        proposal.answer(given)
    return proposal.plan


def draw(plan: Plan, path: Path) -> Path | None:
    """Draw a plan; None where the picture cannot be written: a plan can be read without it."""
    try:
        draw_picture(plan, path)
    except OSError:
        return None
    return path


def approved(plan: Plan, planner: Planner | None) -> Plan | None:
    """Show a plan, and ask until there is a yes or a no.

    Args:
        plan: What is proposed.
        planner: Plans a sentence; None for a plan that came from a file.

    Returns:
        The plan to build, as the person has made it; None for no.

    Raises:
        UserError: There is nobody to answer.
    """
    with tempfile.TemporaryDirectory(prefix="wsim-plan-") as folder:
        proposal = Proposal(plan, planner, Path(folder))
        proposal.show()
        while True:
            asked = proposal.questions()
            said = _ask(f"Build this world? yes, edit, {'a question by its number, ' if asked else ''}no [yes]: ")
            if said in ("", "y", "yes"):
                return proposal.plan
            if said in ("n", "no"):
                return None
            if said in ("e", "edit"):
                _edit(proposal)
            elif said.isdigit() and 1 <= int(said) <= len(asked):
                _reply(proposal, asked[int(said) - 1])
            else:
                console.print(f"{said!r} is none of these", markup=False)


def _ask(prompt: str) -> str:
    try:
        return console.input(prompt, markup=False).strip().lower()
    except EOFError:
        console.print()
        raise UserError(NO_ANSWER) from None


def _reply(proposal: Proposal, question: Question) -> None:
    said = _ask(f"{question.text} {', '.join(question.choices)} … [{question.default}]: ")
    try:
        proposal.answer({question.id: said or question.default})
    except UserError as error:
        console.print(str(error), style="red", markup=False)
        return
    proposal.show()


def _edit(proposal: Proposal) -> None:
    """Open the plan in the person's editor until it is a plan, or they give up; then it is used as it is written."""
    path = proposal.folder / "plan.json"
    path.write_text(_editable(proposal.plan).model_dump_json(indent=2) + "\n", encoding="utf-8")
    while True:
        if not _opened(path):
            return
        try:
            proposal.plan = load_given(path)
            break
        except UserError as error:
            console.print(str(error), style="red", markup=False)
            if _ask("Edit again? yes, no [yes]: ") not in ("", "y", "yes"):
                console.print("the plan is as it was")
                return
    if proposal.planner is not None:
        console.print("edited: the plan is used as it is written, and asks no more questions")
        proposal.planner = None
    proposal.show()


def _editable(plan: Plan) -> Plan:
    """The plan without the places that its relations give, so that a change of one moves what hangs on it.

    A plan whose places are not those of its relations keeps them.
    """
    open_ = [item.model_copy(update={"pose": None}) if item.relations else item for item in plan.objects]
    try:
        again = layout(plan.model_copy(update={"objects": open_}))
    except UserError:
        return plan
    return plan.model_copy(update={"objects": open_}) if again.objects == plan.objects else plan


def _opened(path: Path) -> bool:
    editor = os.environ.get("VISUAL") or os.environ.get("EDITOR") or "vi"
    try:
        ended = subprocess.run([*shlex.split(editor), str(path)], check=False)
    except (OSError, ValueError) as error:
        console.print(f"the editor {editor!r} cannot be started: {error}; set EDITOR", style="red", markup=False)
        return False
    if ended.returncode:
        console.print(f"{editor} ended with {ended.returncode}; the plan is as it was", style="red", markup=False)
    return ended.returncode == 0
