"""What a prompt speaks of: things, where they are, what they are to do."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from wsim.plan.schema import Assumption

if TYPE_CHECKING:
    from wsim.plan.grammar import Phrase


@dataclass(eq=False)
class Thing:
    """One phrase's objects: alike, and doing the same."""

    phrase: Phrase
    count: int
    group: bool = False  # stacked on one another
    place: str | None = None  # "water" or "ground"
    support: Thing | None = None  # what it stands on or drops on, if that is another thing
    does: list[str] = field(default_factory=list)  # float, sink, submerge, drop, rest, roll, topple
    drop_height: float | None = None  # [m] above what it drops on
    target: Thing | None = None  # what it rolls into

    @property
    def kind(self) -> str:
        """What one of them is: a value of words.NOUNS."""
        return self.phrase.kind

    @property
    def words(self) -> str:
        """The prompt's words for it."""
        return self.phrase.words


@dataclass
class Cast:
    """All that the prompt speaks of."""

    things: list[Thing] = field(default_factory=list)
    tank: str | None = None  # the prompt's words for it, if it was named
    water: str | None = None
    assumptions: list[Assumption] = field(default_factory=list)

    def assume(self, subject: str, choice: str, why: str) -> None:
        """Note a choice that the prompt left open."""
        self.assumptions.append(Assumption(subject=subject, choice=choice, why=why))

    @property
    def wet(self) -> bool:
        """Whether the scene has a tank of water."""
        return self.tank is not None or self.water is not None or any(thing.place == "water" for thing in self.things)
