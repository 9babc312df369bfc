"""What a prompt demands, found by its words alone: what is to happen or not, how often, numbers, places, manners."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Literal

from wsim.plan.asked import vocabulary as words
from wsim.plan.asked.numbers import Limit, digits, joined, numbers
from wsim.plan.asked.tokens import Token, Words, text_at

Kind = Literal["verb", "state", "beyond", "number", "relation", "manner", "often"]
REQUIRED: tuple[Kind, ...] = ("verb", "state", "beyond", "number")
_VIEWS = words.as_set("wide long close medium single one tracking aerial static establishing camera")  # a "wide shot"
SHOWN: tuple[Kind, ...] = (*REQUIRED, "manner", "often")  # where nothing answers for it, that is said


@dataclass(frozen=True)
class Demand:
    """Something that a prompt asks for.

    Attributes:
        kind: What it is. A "verb" happens, a "state" is so, what is "beyond" nothing in wsim does.
        text: As the prompt has it.
        first: Number of its first token among those that are no punctuation.
        last: Of its last.
        base: Of a verb, its base form.
        value: Of a number, in `unit`.
        unit: SI, angles in degrees; empty of a bare number.
        denied: Of what happens or is so: whether it is not to.
        timed: Of what is not to happen: whether that is said of some time: "does not fall until it is hit".
        bound: Of a time: whether something is to happen by then.
        often: Of a number: whether it says how often.
        gone: Of a number: whether it is how far something goes: "rolls 3 m".
        limit: Of a number: whether it is the "least" or the "most" that something may be, or a time "since" when.
    """

    kind: Kind
    text: str
    first: int
    last: int
    base: str = ""
    value: float | None = None
    unit: str = ""
    denied: bool = False
    timed: bool = False
    bound: bool = False
    often: bool = False
    gone: bool = False
    limit: Limit = ""

    @property
    def quoted(self) -> str:
        """As messages name it."""
        return f"'{self.text}'"


@lru_cache(maxsize=64)
def demands(prompt: str) -> tuple[Demand, ...]:
    """All that a prompt demands, in its order."""
    return tuple(sorted(_found(prompt), key=lambda each: (each.first, each.last)))


def _found(prompt: str) -> Iterator[Demand]:
    read = Words.of(prompt)
    said = read.said

    def made(kind: Kind, first: int, last: int, **more: object) -> Demand:
        return Demand(kind, prompt[said[first].start : said[last].end], first, last, **more)  # type: ignore[arg-type]

    taken: set[int] = set()
    for each in numbers(said):
        taken.update(range(each.first, each.last + 1))
        yield made("number", each.first, each.last, value=each.value, unit=each.unit, bound=each.bound,
                   often=each.often, limit=each.limit, gone=_is_gone(said, each.first))  # fmt: skip
    for k, token in enumerate(said):
        if (first := _how_often(said, k)) is not None:
            yield made("often", first, k)
        if k in taken:
            continue
        base = words.stem(token.text)
        if base is not None and _is_verb(said, k, base, k in read.opens):
            denied = _is_denied(read, k) or _is_missed(read, k)
            yield made(_kind_of(base), k, k, base=base, denied=denied, timed=denied and _is_timed(read, k))
        elif token.text in words.MANNERS or (
            token.text.endswith("ly") and len(token.text) > 4 and token.text not in words.NO_MANNER
        ):
            if not (token.text in ("hard", "fast") and text_at(said, k - 1) in words.DETERMINERS):
                yield made("manner", k, k)
        elif token.text in words.RELATIONS:
            yield made("relation", k, k)


def _is_gone(said: Sequence[Token], k: int) -> bool:
    """Whether a number stands right behind what something does: how far it goes, or how fast."""
    while text_at(said, k - 1) in ("about", "for", "almost", "nearly", "another"):
        k -= 1
    return (words.stem(text_at(said, k - 1)) or "") in words.GOES


def _kind_of(base: str) -> Kind:
    if base in words.BEYOND:
        return "beyond"
    return "verb" if base in words.MOTIONS or base in words.CAUSES else "state"


def _is_verb(said: Sequence[Token], k: int, base: str, opens: bool) -> bool:
    """Whether a word that may be a verb's form is one here: "slides"; not "a slide", "the falls", "a rolling ball"."""
    word, before = said[k].text, text_at(said, k - 1)
    if before in words.DETERMINERS and before != "that":
        return False
    counted = before in words.WORDS or before in words.SCALES or (digits(before) and not joined(said, k - 1))
    beside = before in ("to", "on", "its", "further") or text_at(said, k + 1) == "of"
    apart = word == "close" and text_at(said, k + 1) in ("to", "together", "by", "beside", "behind", "enough")
    if word == "shot" and (before in _VIEWS or text_at(said, k + 1) in ("", "of", "one")):
        return False
    if base == "end" and text_at(said, k + 1) not in ("in", "up", "on", "inside"):
        return False
    if word == "left" and text_at(said, k + 1) not in words.DETERMINERS and before not in ("has", "have", "had"):
        return False  # a side; "it left the table" and "has left" are verbs
    if before == "of" or apart or (counted and word == base) or (word == "left" and beside):
        return False
    if word.endswith("ing") and word != base:
        # Between an article and a noun it describes; after a noun, a comma or a verb it tells what goes on.
        return before not in words.PREPOSITIONS or before in ("by", "without", "before", "after", "while", "from")
    if word == base and word not in words.SAME_PAST:
        if opens or before in words.BEFORE_BASE or before in ("not", "never", "cannot") or before.endswith("n't"):
            return True
        plural = before.endswith("s") and not before.endswith("ss")
        if before == "or" and words.stem(text_at(said, k - 2)) is not None:
            return _is_verb(said, k - 2, words.stem(text_at(said, k - 2)) or "", False)
        return plural or _set_going(said, k) or _is_of_many(said, k)
    if word.endswith("s") and word != base:
        return not (counted or (before in words.PREPOSITIONS and before not in ("out", "over", "down", "up", "off")))
    return True


def _is_of_many(said: Sequence[Token], k: int) -> bool:
    """Whether a base form at its clause's end is said of several: "three boxes on a ramp slide"."""
    after = text_at(said, k + 1)
    if after.isalpha() and after not in words.NO_NOUN and not after.endswith("ly"):
        return False
    i = k - 1
    if i < 0 or not said[i].text.isalpha() or said[i].text in words.NO_NOUN:
        return False
    while i > 0 and (said[i].text in words.DETERMINERS or said[i].text not in words.PREPOSITIONS):
        if said[i].text in words.NO_NOUN - words.DETERMINERS or words.stem(said[i].text) in words.MOTIONS:
            return False
        i -= 1
    head = text_at(said, i - 1)
    return (
        said[i].text in words.PREPOSITIONS
        and head.endswith("s")
        and not head.endswith("ss")
        and head not in words.NO_NOUN
    )


def _is_missed(read: Words, k: int) -> bool:
    """Whether a verb is said not to come about in other words: "almost falls", "fails to reach"."""
    said = read.said
    one, two, three = (text_at(said, k - i) for i in (1, 2, 3))
    if one in ("almost", "nearly") or (two, one) == ("rather", "than"):
        return True
    if one == "to" and (two.startswith("fail") or two in ("refuses", "unable")):
        return True
    stops = {words.stem(text) for text in (two, three)} & {"stop", "halt", "brake", "settle"}
    return one == "before" and said[k].text.endswith("ing") and bool(stops)


def _set_going(said: Sequence[Token], k: int) -> bool:
    """Whether a base form follows "let it ..." or two subjects: "a ball and a cube fall"; "does the ball touch"."""
    here = [token.text for token in said[max(0, k - 5) : k]]
    going = {"let", "lets", "make", "makes", "watch", "see", "and", "does", "do", "did"}
    return bool(going & set(here)) and here[-1:] != ["and"]


def _is_denied(read: Words, k: int) -> bool:
    """Whether a verb is denied: "does not fall", "without touching", "nothing moves", "keeps it from falling"."""
    said, i = read.said, k - 1
    if text_at(said, i) == "from" and words.KEEPS_FROM & {token.text for token in said[max(0, k - 7) : i]}:
        return True
    while i >= 0 and i + 1 not in read.breaks:
        text = said[i].text
        if text.endswith("n't") or text in words.DENIES:
            return text_at(said, i + 1) != "only" and not (text == "no" and text_at(said, i - 1) in words.PREPOSITIONS)
        if text not in words.BETWEEN and not _of_a_verb(read, i, k):
            break
        i -= 1
    return _is_subject_denied(read, i)


def _is_timed(read: Words, k: int) -> bool:
    """Whether the sentence of a word speaks of a time."""
    begin = max(mark for mark in read.opens if mark <= k)
    end = min((mark for mark in read.opens if mark > k), default=len(read.said))
    here = read.said[begin:end]
    return any(token.text in words.OF_TIME for token in here) or any(each.unit == "s" for each in numbers(here))


def _of_a_verb(read: Words, i: int, k: int) -> bool:
    """Whether a word belongs to a denial's verb: a manner, or another verb that "or" ties to it."""
    text = read.said[i].text
    tied = words.stem(text) is not None and "or" in {token.text for token in read.said[i + 1 : k]}
    return tied or (text.endswith("ly") and text != "only")


def _is_subject_denied(read: Words, i: int) -> bool:
    """Whether a verb, of which what is before it ends at a word, is said of nothing: "none of the blocks falls"."""
    said = read.said
    for j in range(i, max(i - 4, -1), -1):
        text = said[j].text
        if text in ("one", "single", "a") and text_at(said, j - 1) in ("not", "a"):  # "not one box", "not a single box"
            continue
        if text == "not":
            return True
        if text in ("no", "nothing", "none", "neither", "nobody"):
            return not (text == "no" and text_at(said, j - 1) in words.PREPOSITIONS)
        partly = text == "of" or (text in words.DETERMINERS and text_at(said, j - 1) == "of")
        if j in read.breaks or not (partly or text not in words.NO_NOUN) or words.stem(text) is not None:
            return False
    return False


def _how_often(said: Sequence[Token], k: int) -> int | None:
    """Where what says how often begins, and no number does: "exactly once", "once only", "only twice", "again"."""
    text, before = said[k].text, text_at(said, k - 1)
    if text == "again":  # "again and again" is no second time
        twice = ("and", "again") in ((before, text_at(said, k - 2)), (text_at(said, k + 1), text_at(said, k + 2)))
        return None if twice else k
    just = before in ("exactly", "only", "just", "precisely")
    if text in ("once", "twice") and (just or (text == "once" and text_at(said, k + 1) in ("only", ""))):
        return k - just
    if text == "times" and text_at(said, k - 2) in ("exactly", "only", "just", "precisely"):
        return k - 2
    return None
