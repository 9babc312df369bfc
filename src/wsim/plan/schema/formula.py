"""What must happen, as a tree: signal temporal logic over a closed list of predicates.

This is the JSON form, and its one table. What each node means, and the sentence that it reads as, is in
`wsim.judge.language`; docs/objectives.md explains all of them. A name is a plan object's, or a prim's whole path
("/World/robot/arm").
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, ClassVar, Literal, Union

from pydantic import Field, model_validator

from wsim.plan.schema import formula_contact, formula_fluid, formula_motion, formula_place
from wsim.plan.schema.base import Positive
from wsim.plan.schema.nodes import Always, And, Eventually, Finally, Node, Not, Or, Then, Until, Window
from wsim.plan.schema.predicate import Predicate

__all__ = [
    "VOCABULARY", "Always", "And", "Eventually", "Finally", "Formula", "Mean", "Node", "Not", "Or", "Ordered",
    "Predicate", "Then", "Until",
]  # fmt: skip


class Ordered(Predicate):
    """The events happen for the first time in this order."""

    op: Literal["ordered"] = "ordered"
    alone: ClassVar[Literal["now"]] = "now"
    events: tuple[Formula, ...] = Field(min_length=2, max_length=20)

    def parts(self) -> tuple[Formula, ...]:
        """The events."""
        return self.events


class Mean(Node):
    """The predicate, said of the means of its numbers over the recording's last seconds, the final window, or another.

    The window is in seconds from the recording's start, wherever the mean stands.
    """

    op: Literal["mean"] = "mean"
    seconds: Positive | None = None
    window: Window | None = None
    of: Formula

    @model_validator(mode="after")
    def _of_numbers(self) -> Mean:
        if not isinstance(self.of, Predicate) or isinstance(self.of, Ordered):
            raise ValueError("mean: it takes one predicate, whose numbers have a mean; put it around each of them")
        if self.seconds is not None and self.window is not None:
            raise ValueError("mean: it is over the last seconds or over a window; leave one of the two out")
        return self

    def parts(self) -> tuple[Formula, ...]:
        """Whose numbers' means are looked at."""
        return (self.of,)


_KINDS: tuple[type[Node], ...] = (
    And, Or, Not, Always, Eventually, Finally, Mean, Until, Then,
    *formula_place.PREDICATES, *formula_contact.PREDICATES, *formula_fluid.PREDICATES, *formula_motion.PREDICATES,
    Ordered,
)  # fmt: skip
if TYPE_CHECKING:
    Formula = Node
else:
    Formula = Annotated[Union[_KINDS], Field(discriminator="op")]  # noqa: UP007 - made of a list

for _kind in (And, Or, Not, Always, Eventually, Finally, Mean, Until, Then, Ordered):
    _kind.model_rebuild(_types_namespace={"Formula": Formula})

VOCABULARY: dict[str, type[Predicate]] = {
    kind.model_fields["op"].default: kind for kind in _KINDS if issubclass(kind, Predicate)
}
