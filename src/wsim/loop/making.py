"""A world in the making: the programs that are tried, the best of them, and what is tried next."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace

from wsim.agents.budget import BudgetError
from wsim.agents.crew import Crew
from wsim.agents.failures import ModelError
from wsim.judge.verdict import Verdict
from wsim.loop.options import Options
from wsim.loop.side_by_side import side_by_side
from wsim.loop.start import change_plan
from wsim.phases import Phases
from wsim.plan.schema import Plan
from wsim.program.compose import compose
from wsim.runs.accept import accept
from wsim.runs.attempt import Attempt, Reached, attempt, numerics
from wsim.runs.bare_run import BareRun
from wsim.runs.folder import RunFolder
from wsim.runs.iteration import Iteration
from wsim.runs.records import Replan, Tried


@dataclass
class Making:
    """A run between its plan and its verdict.

    Attributes:
        run: Its folder.
        crew: Who works on it.
        plan: What the world must be.
        options: How it is made.
        best: The best attempt so far.
        undone: Patches of the best that are no better.
        phases: Where the time goes.
        approve: Shown a plan that was changed on the way, before it is built.
        drafted: Number of the iteration that is the plan's first draft.
    """

    run: RunFolder
    crew: Crew
    plan: Plan
    options: Options
    best: Attempt | None = None
    undone: list[Attempt] = field(default_factory=list)
    phases: Phases = field(default_factory=Phases)
    approve: Callable[[Plan], bool] = lambda plan: True
    drafted: int = 1

    @property
    def tried(self) -> int:
        """How many programs were."""
        return len(self.run.iterations())

    @property
    def ends(self) -> bool:
        """Whether nothing is left to mend in the best, or nothing more may be tried."""
        return self._unfaulted or self.tried >= self.options.budget.iterations

    @property
    def verdict(self) -> Verdict:
        """That of the best; blocked where more was to be tried."""
        assert self.best is not None
        if self._unfaulted or not self.crew.has("coder"):
            return self.best.verdict
        return self.blocked(f"iteration limit: {self.tried} programs were tried")

    @property
    def _unfaulted(self) -> bool:
        """Whether no check found a fault in the best: one that crashed is the judge's to be mended, not the world's.

        So is what the plan does not ask for: no program can show it.
        """
        assert self.best is not None
        verdict = self.best.verdict
        unjudged = bool(verdict.crashes or verdict.not_checked) and verdict.status == "blocked"
        return verdict.status == "accepted" or (unjudged and not verdict.failures)

    def blocked(self, cause: str) -> Verdict:
        """The verdict on a run that could not go on: why, and the best so far."""
        self.run.record(cause=cause)
        if self.best is None:
            return Verdict(status="blocked", summary=cause)
        return Verdict(
            status="blocked",
            summary=f"{cause}. Best so far: iteration {self.best.number}: {self.best.verdict.summary}",
            findings=self.best.verdict.findings,
            crashes=self.best.verdict.crashes,
        )

    def first_draft(self) -> str:
        """The program that the plan composes: what every later one is a patch of."""
        program = compose(self.plan)
        self.crew.desk.transcript.builtin("coder", "plan.json", program)
        return program

    def attempts(self, programs: Sequence[str]) -> list[Attempt]:
        """Programs, each as a new iteration, the best first.

        Of several the physics are tried side by side, without pictures, and the best of them goes on as one alone does.
        """
        iterations = [self._iteration(program) for program in programs]
        if len(iterations) == 1:
            return [self._through(iterations[0])]
        tried = side_by_side(iterations, self.crew.desk.ledger.seconds_left, self.crew.workspace.progress)
        best = max(range(len(tried)), key=lambda k: tried[k].rank)
        tried[best] = self._through(iterations[best])
        return sorted(tried, key=lambda one: one.rank, reverse=True)

    def _iteration(self, program: str) -> Iteration:
        folder = self.run.add(program, self.best.program if self.best else None)
        settings = self.options.settings
        if self.best is not None and numerics(program) != numerics(Iteration(self.run.iteration(self.drafted)).text):
            # A world that a finer computation made right must stand a still finer one.
            settings = replace(settings, verify=True)
        return Iteration(folder, self.plan, settings, self.crew.workspace.progress)

    def _through(self, iteration: Iteration) -> Attempt:
        """All passes, the review, the judge, and acceptance."""
        cheap_first = self.crew.has("coder") or self.best is not None
        if cheap_first or not self.options.confirm:
            return self._concluded(iteration, attempt(iteration, cheap_first))
        with BareRun(self.run.path / "bare.partial", iteration) as bare_run:
            bare_run.start(self.options.standby)  # a first draft is to need no repair
            return self._concluded(iteration, attempt(iteration, cheap_first), bare_run)

    def _concluded(self, iteration: Iteration, tried: Attempt, bare_run: BareRun | None = None) -> Attempt:
        try:
            self._assess(tried, replace(iteration, settings=self.options.settings), bare_run)
        except BudgetError as error:  # what was tried is kept, and what was found of it
            self.run.record(cause=str(error))
            if tried.verdict.status == "accepted":
                summary = f"{error}, before it was confirmed. {tried.verdict.summary}"
                tried.verdict = Verdict(status="blocked", summary=summary, findings=tried.verdict.findings)
        if tried.verdict.status != "accepted" and tried.reached == Reached.ALL:
            tried.reached = Reached.REVIEW
        iteration.conclude(tried.verdict)
        return tried

    def _assess(self, tried: Attempt, iteration: Iteration, bare_run: BareRun | None) -> None:
        """The review, the judge, and acceptance; a program that is no better is not asked about."""
        if tried.verdict.status == "accepted":
            self.crew.look(tried, self.plan)
        if self.best is None or tried.rank > self.best.rank:
            self.crew.judge(tried, self.plan, plan_stays=self._was_replanned)
        if tried.verdict.status == "accepted" and self.options.confirm:
            with self.phases.phase("confirm"):
                tried.verdict = accept(self.run, iteration, tried.earlier, bare_run)
        elif tried.verdict.status == "accepted":
            self.run.stamp(tried.folder)

    def keep(self, attempts: Sequence[Attempt]) -> None:
        """Go on from the best of some attempts if none was better before; run.json has a row for each either way.

        Args:
            attempts: The best first.
        """
        if self.best is None or attempts[0].rank > self.best.rank:
            self.best, self.undone = attempts[0], list(attempts[1:])
        else:
            self.undone += attempts
        rows = [*self.run.facts().get("iterations", []), *(self._row(tried).model_dump() for tried in attempts)]
        self.run.record(iterations=sorted(rows, key=lambda row: row["number"]), best=self.best.number)

    def _row(self, tried: Attempt) -> Tried:
        return Tried(
            number=tried.number,
            reached=tried.reached.name.lower(),
            status=tried.verdict.status,
            summary=tried.verdict.summary,
            failed=list(dict.fromkeys(finding.check for finding in tried.verdict.failures)),
            kept=tried is self.best,
            repair=tried.repair,
        )

    def next(self, last: Attempt) -> list[str]:
        """Programs to try next: patches of the best, or the first draft of a plan that its planner has mended.

        Raises:
            ModelError: If no patch can be had, nor another plan.
            BudgetError: If tokens or time ran out.
        """
        assert self.best is not None
        if self.crew.has("coder") and last is not self.best:
            self.crew.judge(self.best, self.plan, self.undone, self._was_replanned)  # what it asked for did not help
        by, fault, given_up = "judge", self.best.plan_fault, None
        if not fault:
            try:
                return self.repairs()
            except ModelError as error:
                if error.kind != "gave up":
                    raise
                by, fault, given_up = "coder", str(error.args[0]), error
        if self._replans(by, fault):
            return [self.first_draft()]
        if given_up is not None:
            raise given_up
        return self.repairs()

    @property
    def _was_replanned(self) -> bool:
        """Whether the planner was asked for another plan: it is once."""
        return bool(self.run.facts().get("replans"))

    def _replans(self, by: str, fault: str) -> bool:
        """Whether the plan is another now: its planner is asked once, and a person agrees.

        What was found of the old one stays in the run's folder; the best is to be found anew.
        """
        assert self.best is not None
        asked = self._was_replanned or not self.crew.desk.answers("planner")
        if asked or not self.crew.has("planner"):
            return False
        row = Replan(after=self.best.number, by=by, fault=fault)
        try:
            found = self.crew.replan(self.best, self.undone, self.plan, by, fault)
            row.why, row.kept = found.why, found.plan is None
        except ModelError as error:
            found, row.why, row.kept = None, f"no other plan: {error}", True
        agreed = found is not None and found.plan is not None and self.approve(found.plan)
        row.approved = agreed
        self.run.record(replans=[row.model_dump()])
        if found is None or found.plan is None or not agreed:
            return False
        change_plan(self.run, self.plan, found.plan)
        self.plan, self.best, self.undone, self.drafted = found.plan, None, [], self.tried + 1
        return True

    def repairs(self) -> list[str]:
        """Programs to try next: patches of the best, as many as are tried side by side and the budget leaves.

        None where no model is there to write one, and no suggestion of the judge is left that can be applied as it is.
        """
        assert self.best is not None
        count = min(self.options.candidates, self.options.budget.iterations - self.tried)
        if not self.crew.has("coder"):
            return self.crew.mends(self.best, self.undone, self.plan, count)
        return self.crew.repairs(self.best, self.undone, self.plan, count)
