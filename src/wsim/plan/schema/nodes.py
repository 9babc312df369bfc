"""How formulas are put together: what every node of the tree has, and the operators of logic and time.

A node's parts may be any formula; which ones there are, `wsim.plan.schema.formula` knows, and tells the operators.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Annotated, Literal, TypeAlias

from pydantic import AfterValidator, ConfigDict, Field, model_validator

from wsim.plan.schema.base import NotNegative, Strict

if TYPE_CHECKING:
    Formula: TypeAlias = "Node"  # what is read from a file is one of the closed list

DEEPEST = 40  # nodes above one another: deeper is no objective that a person reads, and would exhaust the stack


def _ordered(window: tuple[float, float | None]) -> tuple[float, float | None]:
    if window[1] is not None and window[1] < window[0]:
        raise ValueError(f"the window [{window[0]:g}, {window[1]:g}] s ends before it begins; swap the two")
    return window


# From and to, in seconds from the moment at which the formula is asked; None is the end of the recording.
Window = Annotated[tuple[NotNegative, NotNegative | None], AfterValidator(_ordered)]


class Node(Strict):
    """A formula. `&`, `|` and `~` combine formulas; `until` and `then` put them in time."""

    model_config = ConfigDict(extra="forbid", allow_inf_nan=False, frozen=True)

    def parts(self) -> tuple[Formula, ...]:
        """The formulas that this one is made of."""
        return ()

    def walk(self) -> Iterator[Node]:
        """This node and all below it."""
        yield self
        for part in self.parts():
            yield from part.walk()

    def names(self) -> set[str]:
        """Every object that the formula speaks of."""
        return {name for node in self.walk() for name in node.objects_named()}

    def objects_named(self) -> set[str]:
        """The objects that this node itself names."""
        return set()

    @model_validator(mode="after")
    def _shallow(self) -> Node:
        if self.depth() > DEEPEST:
            raise ValueError(f"formulas are nested more than {DEEPEST} deep; split the objective in several")
        return self

    def depth(self) -> int:
        """How many nodes stand above one another."""
        return 1 + max((part.depth() for part in self.parts()), default=0)

    def __and__(self, other: Formula) -> And:
        mine = self.of if isinstance(self, And) else (self,)
        return And.model_validate({"of": (*mine, other)})

    def __or__(self, other: Formula) -> Or:
        mine = self.of if isinstance(self, Or) else (self,)
        return Or.model_validate({"of": (*mine, other)})

    def __invert__(self) -> Not:
        return Not.model_validate({"of": self})

    def until(self, other: Formula, window: tuple[float, float | None] | None = None) -> Until:
        """This holds at each moment until the other does."""
        return Until.model_validate({"hold": self, "goal": other, "window": window})

    def then(self, other: Formula, window: tuple[float, float | None] | None = None) -> Then:
        """First this, and afterwards the other."""
        events, windows = (self.events, self.windows) if isinstance(self, Then) else ((self,), ())
        return Then.model_validate({"events": (*events, other), "windows": (*windows, window)})


# ---- operators
class And(Node):
    """All of them hold."""

    op: Literal["and"] = "and"
    of: tuple[Formula, ...] = Field(min_length=2, max_length=100)

    def parts(self) -> tuple[Formula, ...]:
        """The conjuncts."""
        return self.of


class Or(Node):
    """At least one of them holds."""

    op: Literal["or"] = "or"
    of: tuple[Formula, ...] = Field(min_length=2, max_length=100)

    def parts(self) -> tuple[Formula, ...]:
        """The disjuncts."""
        return self.of


class Not(Node):
    """It does not hold."""

    op: Literal["not"] = "not"
    of: Formula

    def parts(self) -> tuple[Formula, ...]:
        """What is denied."""
        return (self.of,)


class Always(Node):
    """It holds at each frame of the window; without a window, to the end."""

    op: Literal["always"] = "always"
    window: Window | None = None
    of: Formula

    def parts(self) -> tuple[Formula, ...]:
        """What holds."""
        return (self.of,)


class Eventually(Node):
    """It holds at some frame of the window; without a window, up to the end."""

    op: Literal["eventually"] = "eventually"
    window: Window | None = None
    of: Formula

    def parts(self) -> tuple[Formula, ...]:
        """What comes to hold."""
        return (self.of,)


class Finally(Node):
    """It holds over the recording's last seconds, 0 its last frame; without a number, the judge's final window."""

    op: Literal["finally"] = "finally"
    seconds: NotNegative | None = None
    of: Formula

    def parts(self) -> tuple[Formula, ...]:
        """What holds at the end."""
        return (self.of,)


class Until(Node):
    """`hold` holds at each frame before one of the window at which `goal` holds."""

    op: Literal["until"] = "until"
    window: Window | None = None
    hold: Formula
    goal: Formula

    def parts(self) -> tuple[Formula, ...]:
        """What holds, and until what."""
        return (self.hold, self.goal)


class Then(Node):
    """The events happen one after another, each in its window after the one before; None: any time after it."""

    op: Literal["then"] = "then"
    events: tuple[Formula, ...] = Field(min_length=2, max_length=20)
    windows: tuple[Window | None, ...]

    @model_validator(mode="after")
    def _matched(self) -> Then:
        if len(self.windows) != len(self.events) - 1:
            raise ValueError(
                f"then: {len(self.events)} events have {len(self.events) - 1} windows between them, not "
                f"{len(self.windows)}"
            )
        return self

    def parts(self) -> tuple[Formula, ...]:
        """The events."""
        return self.events
