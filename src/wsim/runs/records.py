"""What the loop leaves in run.json, review.json and acceptance.json, as data."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from pydantic import BaseModel, Field

BUILTIN = "builtin"


class Tried(BaseModel):
    """A row of run.json's iterations."""

    number: int
    reached: str = ""
    status: str = ""
    summary: str = ""
    failed: list[str] = Field(default_factory=list)  # checks
    kept: bool = True
    repair: str = ""  # what the judge's model wants mended first


class Replan(BaseModel):
    """A row of run.json's replans: the plan was found at fault, and its planner asked."""

    after: int  # the iteration that was the best then
    by: str  # "judge" or "coder"
    fault: str
    why: str = ""  # of the change, or of keeping the plan
    kept: bool = False  # the planner kept it, or had none that asks for as much
    approved: bool = False  # it was changed, and a person, or --yes, agreed


class Account(BaseModel):
    """What one role has used."""

    requests: int = 0  # answered
    cached: int = 0
    failed: int = 0
    input_tokens: int = 0
    output_tokens: int = 0
    cache_read_tokens: int = 0  # of those of the input, what the provider had kept
    seconds: float = 0.0
    dollars: float | None = None  # None: no price is known

    def charge(self, usage: Mapping[str, int]) -> None:
        """Add the tokens of a reply."""
        for name in ("input_tokens", "output_tokens", "cache_read_tokens"):
            setattr(self, name, getattr(self, name) + usage.get(name, 0))


class Usage(BaseModel):
    """What all roles have used."""

    tokens: int = 0
    by_role: dict[str, Account] = Field(default_factory=dict)


class Loop(BaseModel):
    """What run.json says of a run's loop; all of it empty for a program that was only run."""

    iterations: list[Tried] = Field(default_factory=list)
    best: int | None = None
    models: dict[str, str] = Field(default_factory=dict)  # by role
    budget: dict[str, float] = Field(default_factory=dict)
    usage: Usage | None = None  # written as the run ends
    skills: dict[str, list[str]] = Field(default_factory=dict)  # by iteration: "02"
    notes: list[str] = Field(default_factory=list)
    cause: str = ""  # why it is blocked
    replans: list[Replan] = Field(default_factory=list)

    def tried(self, number: int) -> Tried | None:
        """The row of an iteration; None for one that was not finished."""
        return next((row for row in self.iterations if row.number == number), None)

    @property
    def looped(self) -> bool:
        """Whether the run was one of the loop, however it ended."""
        return bool(self.budget or self.iterations) or self.usage is not None

    @property
    def asked(self) -> bool:
        """Whether a language model was to fill a role, or was asked."""
        used = self.usage is not None and bool(self.usage.by_role)
        return used or any(name != BUILTIN for name in self.models.values())


class Difference(BaseModel):
    """Something that the reviewer saw, and that is not as the plan has it."""

    object: str = ""
    what: str = ""
    severity: str = ""


class ClauseSeen(BaseModel):
    """Whether the pictures show a clause of the prompt, by its number from 1."""

    clause: int = 0
    shown: str = ""  # "yes", "no" or "cannot be seen"
    why: str = ""


class Seen(BaseModel):
    """A reviewer's words; or, without a model, the facts of the shape-index images alone."""

    summary: str = ""
    objects: str = ""
    layout: str = ""
    motion: str = ""
    contacts: str = ""
    differences: list[Difference] = Field(default_factory=list)
    clauses: list[ClauseSeen] = Field(default_factory=list)
    facts: list[str] = Field(default_factory=list)

    @property
    def aspects(self) -> list[tuple[str, str]]:
        """(name, text) of what was described."""
        names = ("objects", "layout", "motion", "contacts")
        return [(name, getattr(self, name)) for name in names if getattr(self, name)]


class Review(BaseModel):
    """What was seen in the pictures, and by whom."""

    by: str  # a model's name, or "builtin"
    review: Seen

    @property
    def by_model(self) -> bool:
        """Whether a model looked."""
        return self.by != BUILTIN


class Acceptance(BaseModel):
    """accepted/: the program without what only served the review, and how far a second run was from the first."""

    stripped: bool = False
    largest_distance_m: float
    program: str = ""
    sums: list[tuple[str, str]] = Field(default_factory=list)  # (digest, file)


def review_of(data: dict[str, Any]) -> Review | None:
    """The review in a review.json; None where nobody has looked yet, and it holds the facts alone."""
    return Review.model_validate(data) if "review" in data else None


def sums_of(text: str) -> list[tuple[str, str]]:
    """(digest, file) of each line of a SHA256SUMS."""
    return [(digest, name.strip()) for digest, _, name in (line.partition(" ") for line in text.split("\n")) if name]
