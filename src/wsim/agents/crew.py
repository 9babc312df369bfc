"""Who fills the roles of a run: a model where one is named, else what wsim has built in."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import zip_longest
from typing import TYPE_CHECKING, Any

from wsim.agents import coder, judge, planner, replan, reviewer
from wsim.agents.ask import Desk
from wsim.agents.budget import BudgetError
from wsim.agents.failures import ModelError
from wsim.agents.models import BUILTIN
from wsim.judge.repair.order import suggestions
from wsim.judge.repair.steps import steps
from wsim.program.mend import NotMendedError, mended
from wsim.rules.planner import plan
from wsim.runs.attempt import Attempt, Reached
from wsim.tools import Workspace
from wsim.tools.plan import plan_lines
from wsim.tools.verdict import verdict_lines

if TYPE_CHECKING:
    from wsim.agents.replan import Replanned
    from wsim.plan.schema import Plan

SHOWN_DIFF = 14  # lines of a patch that did not help


@dataclass
class Crew:
    """The roles of one run.

    Attributes:
        desk: Asks models.
        workspace: The run's folder.
        notes: What was done without a model that failed, a line each.
        skills: What was picked for each repair, by the iteration that it made.
        tried: All programs that a repair started from or left behind, with their iterations.
    """

    desk: Desk
    workspace: Workspace
    notes: list[str] = field(default_factory=list)
    skills: dict[int, list[str]] = field(default_factory=dict)
    tried: dict[str, int] = field(default_factory=dict)
    reasons: dict[int, str] = field(default_factory=dict)  # of each patch, in the coder's words

    def has(self, role: str) -> bool:
        """Whether a model fills a role."""
        return self.desk.models[role] != BUILTIN

    def plan(self, prompt: str, pictures: Sequence[bytes] = (), image: str = "") -> Plan:
        """A prompt's plan.

        Raises:
            UserError: If the builtin planner does not take the prompt.
            ModelError: If the planner's model gave no plan.
            BudgetError: If tokens or time ran out.
        """
        if self.has("planner"):
            return planner.plan_with(self.desk, prompt, pictures, image)
        return plan(prompt)

    def look(self, tried: Attempt, plan: Plan) -> None:
        """Review an attempt that passed all checks; without a model the facts are the review."""
        if not (tried.folder / "review.json").is_file():
            return
        seen = None
        if self.has("reviewer"):
            try:
                seen = reviewer.review(self.desk, plan, tried.folder, plan_lines(plan))
                unshown = seen.unshown(plan)
                tried.review = "\n".join([seen.text, *unshown])
                tried.seen = [*(one.what for one in seen.differences), *unshown]
            except ModelError as error:
                self.notes.append(f"iteration {tried.number} was reviewed by facts alone: {error}")
        nobody = ["Nobody looked at the pictures; the renderer's facts:", *reviewer.facts(tried.folder)]
        tried.review = tried.review or "\n".join(nobody)
        reviewer.keep(tried.folder, seen, self.desk.models["reviewer"] if seen else BUILTIN)

    def judge(self, tried: Attempt, plan: Plan, undone: Sequence[Attempt] = (), plan_stays: bool = False) -> None:
        """Let the judge's model name what to mend, or object. Checks that failed stay failed.

        It is asked of a world without a fault, too: no check knows whether that is what the prompt asks for. Where no
        check failed and one crashed there is nothing to ask.

        Args:
            tried: What is judged.
            plan: What it must be.
            undone: Patches of it that made it no better: what was asked for before them did not help.
            plan_stays: The planner was asked once already, and is not asked again.
        """
        if not self.has("judge") or tried.reached < Reached.PHYSICS or tried.verdict.status == "blocked":
            return
        settled = tried.verdict.status == "accepted" and tried.seen is not None and not tried.seen
        if settled and not self.desk.answers("judge"):  # a run of before these were asked about
            return
        passed = tried.verdict.status == "accepted"
        found, history = verdict_lines(tried.folder / "verdict.json"), self._history(undone)
        try:
            held = judge.opinion(self.desk, plan, plan_lines(plan), found, tried.review, passed, history, plan_stays)
        except ModelError as error:
            self.notes.append(f"iteration {tried.number} was judged by the checks alone: {error}")
            return
        tried.repair = held.repair.sentence if held.repair else ""
        tried.plan_fault = held.plan if held.plan and not held.accept else ""
        tried.verdict = judge.decide(tried.verdict, held)
        if passed and tried.verdict.status != "accepted":
            tried.reached = Reached.REVIEW
        elif held.accept and not passed:
            self.notes.append(f"iteration {tried.number}: the judge's model would accept; failed checks stay failed")

    def _history(self, undone: Sequence[Attempt]) -> list[str]:
        return [_told(tried, self.reasons.get(tried.number, "")) for tried in undone]

    def repairs(self, best: Attempt, undone: Sequence[Attempt], plan: Plan, count: int = 1) -> list[str]:
        """The best program so far with the coder's edits made: up to so many programs, each of other edits.

        Raises:
            ModelError: If no answer became a program.
            BudgetError: If tokens or time ran out before one did.
        """
        self.tried |= {tried.program: tried.number for tried in (best, *undone)}
        made: dict[str, str] = {}  # programs, with what their edits are for
        while len(made) < max(1, count):
            number = max(self.tried.values()) + 1
            situation = coder.Situation(
                program=best.program,
                verdict=[*verdict_lines(best.folder / "verdict.json"), *_quoted(best)],
                plan=plan_lines(plan),
                repair=best.repair,
                review=best.review,
                history=[
                    *self._history(undone),
                    *(f"is tried beside yours; give other edits: {w}" for w in made.values()),
                ],
                tried=self.tried,
            )
            self.skills[number] = [skill.name for skill in coder.pick(situation)]
            try:
                found = coder.repair(self.desk, situation, plan, self.workspace)
                if not found.program:
                    raise ModelError("gave up", found.why, "coder")
            except (ModelError, BudgetError) as error:
                if not made:
                    raise
                self.notes.append(f"{len(made)} patches were tried side by side and not {count}: {error}")
                break
            self.reasons[number] = found.why
            self.tried[found.program] = number
            made[found.program] = found.why
        return list(made)

    def replan(self, best: Attempt, undone: Sequence[Attempt], plan: Plan, by: str, fault: str) -> Replanned:
        """The plan that the planner's model makes of evidence against the one that is there.

        Args:
            best: The best world of the plan.
            undone: What was tried from there in vain.
            plan: What they were held against.
            by: Who finds the plan at fault.
            fault: Why.

        Raises:
            ModelError: If it gave no plan that asks for as much.
            BudgetError: If tokens or time ran out.
        """
        lines = verdict_lines(best.folder / "verdict.json")
        evidence = [f"The {by}: {fault}", "# Verdict on the best program", "\n".join(lines)]
        evidence += ["# Tried, and undone", *self._history(undone)] if undone else []
        return replan.replan(self.desk, plan, evidence)

    def mends(self, best: Attempt, undone: Sequence[Attempt], plan: Plan, count: int = 1) -> list[str]:
        """The best program so far with one of the judge's suggestions applied: up to so many not tried yet.

        What stands in for a coder: nothing is weighed, and what cannot be applied as it stands is left out. Where
        several are asked for, values along the way that a suggestion points are tried, too (`wsim.judge.repair.steps`):
        a search, of which the best goes on. Empty where none is left.
        """
        self.tried |= {tried.program: tried.number for tried in (best, *undone)}
        made: list[str] = []
        asked = suggestions(best.verdict)
        ways = [(each, each.target) for each in asked]
        if count > 1:
            for along in zip_longest(*(steps(each.target) for each in asked if each.target is not None)):
                ways += [(each, step) for each, step in zip(asked, along, strict=True) if step is not None]
        for finding, target in ways:
            assert target is not None
            try:
                program = mended(best.program, target, plan)
            except NotMendedError:
                continue
            if program not in self.tried:
                number = max(self.tried.values()) + 1
                self.reasons[number], self.tried[program] = f"{finding.check}: {target.sentence}", number
                made.append(program)
                if len(made) == count:
                    break
        return made

    def facts(self) -> dict[str, Any]:
        """For run.json."""
        skills = {f"{number:02d}": names for number, names in self.skills.items()}
        reasons = {f"{number:02d}": why for number, why in self.reasons.items()}
        facts: dict[str, Any] = {
            "models": self.desk.models.facts(),
            "usage": self.desk.ledger.facts(),
            "skills": skills,
        }
        facts["seconds"] = round(self.desk.ledger.seconds_used, 1)
        return facts | {"reasons": reasons} | ({"notes": self.notes} if self.notes else {})


def _quoted(tried: Attempt) -> list[str]:
    """The lines of the program that failed findings point at."""
    lines = tried.program.splitlines()
    found = {}
    for finding in tried.verdict.failures:
        number = (finding.line or "").rpartition(":")[2]
        if number.isdigit() and 0 < int(number) <= len(lines):
            found[finding.line] = f"{finding.line}: {lines[int(number) - 1].strip()}"
    return list(found.values())


def _told(tried: Attempt, why: str) -> str:
    """An attempt that was undone, as the coder reads of it."""
    path = tried.folder / "patch.diff"
    patch = path.read_text(encoding="utf-8").splitlines()[2:] if path.is_file() else []
    changed = [line for line in patch if line[:1] in "+-"][:SHOWN_DIFF]
    failed = "; ".join(dict.fromkeys(f"{f.check}: {f.message}" for f in tried.verdict.failures[:4]))
    head = f"iteration {tried.number}: {why} It failed at {tried.reached.name.lower()}: {failed}"
    return "\n".join([head, *changed])
