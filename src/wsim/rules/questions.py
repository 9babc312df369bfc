"""What to ask a person before a plan is built: the few open choices on which the outcome turns.

A question comes from an assumption of the plan. Its answer is put into the sentence, and the planner is asked again:
what is built is always the plan of a sentence, and no answer can be forgotten on the way. Where in the sentence the
words go is tried, place by place, until the planner takes them for what they answer. Everything else stays an
assumption, which is listed.
"""

from __future__ import annotations

import json
import re
import tomllib
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import Literal, get_args

from pydantic import BaseModel

from wsim.errors import UserError
from wsim.plan.schema import Assumption, Plan

Kind = Literal["count", "height", "material"]
Planner = Callable[[str], Plan]
LARGEST_FILE = 1_000_000  # bytes of a file of answers
AHEAD = 8  # words after a thing among which its height is put in


class Question(BaseModel):
    """Something to ask.

    Attributes:
        id: What a file of answers calls it.
        kind: What is asked for.
        text: The question, and why it matters.
        choices: Answers to choose from; others of the kind are taken too.
        default: What the plan has assumed.
        subject: The sentence's words for the thing.
        assumption: Which assumption of the plan it replaces, counted from 0.
    """

    id: str
    kind: Kind
    text: str
    choices: list[str]
    default: str
    subject: str
    assumption: int


# kind: what else the answer may be, and what any answer looks like.
_CHOICES: dict[Kind, tuple[str, ...]] = {
    "count": ("2", "3", "5", "10"),
    "height": ("0.2 m", "0.5 m", "1 m", "2 m"),
    "material": ("wood", "steel", "ice", "plastic"),
}
_SHAPE: dict[Kind, tuple[str, str]] = {
    "count": (r"[1-9]\d{0,3}", "a whole number, such as 4"),
    "height": (r"\d+(\.\d+)? ?(mm|cm|m)", "a length, such as 0.5 m"),
    "material": (r"[A-Za-z]+", "a material, such as steel"),
}


def questions(plan: Plan) -> list[Question]:
    """What to ask about a plan of the builtin planner: counts first, since they change the sentence most."""
    found: list[Question] = []
    for kind in get_args(Kind):
        for index, assumption in enumerate(plan.assumptions):
            question = _question(kind, index, assumption, plan)
            if question is None:
                continue
            taken = sum(other.id == question.id or other.id.startswith(question.id + "_") for other in found)
            found.append(question.model_copy(update={"id": f"{question.id}_{taken + 1}"}) if taken else question)
    return found


def _question(kind: Kind, index: int, assumption: Assumption, plan: Plan) -> Question | None:
    default = assumption.value
    if assumption.kind != kind or default is None or not _once(plan.prompt, assumption.subject):
        return None
    reason = _reason(kind, assumption, plan)
    if reason is None:
        return None
    asked = {
        "count": f"How many are {assumption.subject!r}? {reason}",
        "height": f"From how high does {assumption.subject!r} drop? {reason}",
        "material": f"What is {assumption.subject!r} made of? {reason}",
    }[kind]
    return Question(
        id=f"{kind}_{_stem(plan, assumption.subject)}",
        kind=kind,
        text=asked,
        choices=list(dict.fromkeys((default, *_CHOICES[kind]))),
        default=default,
        subject=assumption.subject,
        assumption=index,
    )


def _reason(kind: Kind, assumption: Assumption, plan: Plan) -> str | None:
    """Why it matters, or nothing if it does not."""
    if kind == "count":
        return "The sentence gives no number."
    if kind == "height":
        topples = any(objective.kind == "topples" for objective in plan.objectives)
        return "It decides whether what it hits falls over." if topples else None
    ends = [other.value for other in plan.assumptions if other.subject == assumption.subject and other.kind == "end"]
    return (
        f"It decides whether it floats or sinks; of {assumption.value} it is expected to {ends[0]}." if ends else None
    )


def _stem(plan: Plan, subject: str) -> str:
    """The name of the thing's objects without their number."""
    name = next((item.name for item in plan.objects if item.words == subject), "")
    words = re.sub(r"_\d+$", "", name) or re.sub(r"[^a-z0-9]+", "_", subject.lower()).strip("_")
    return words or "thing"


def _pattern(words: str) -> str:
    return r"(?<!\w)" + r"[\s-]+".join(re.escape(word) for word in words.split()) + r"(?!\w)"


def _once(sentence: str, words: str) -> bool:
    """Whether the words are in the sentence, in one place only: else an answer could be put to the wrong thing."""
    return bool(words.split()) and len(re.findall(_pattern(words), sentence, re.IGNORECASE)) == 1


def answered(plan: Plan, answers: Mapping[str, str], planner: Planner) -> Plan:
    """The plan of the sentence with answers in it.

    Args:
        plan: A plan of the planner's.
        answers: Question's id to answer.
        planner: Makes a plan of a sentence.

    Raises:
        UserError: There is no such question, or the answer is none.
    """
    asked = {question.id: question for question in questions(plan)}
    for name in answers:
        if name not in asked:
            known = ", ".join(asked) or "none"
            raise UserError(f"there is no question {name[:60]!r}; the questions about this sentence: {known}")
    notes = []
    moved: dict[str, str] = {}  # a thing's words: what they have become
    for name, question in asked.items():
        if name not in answers:
            continue
        answer = answers[name].strip()
        shape, example = _SHAPE[question.kind]
        if not re.fullmatch(shape, answer):
            raise UserError(f"{name} = {answer[:60]!r}: expected {example}")
        subject = moved.get(question.subject, question.subject)
        before = plan
        plan, moved[question.subject] = _again(plan, question, subject, answer, planner)
        notes.append(
            Assumption(
                subject=question.subject, choice=answer, why=f"answered; the sentence was {before.prompt!r}"[:4000]
            )
        )
    return plan.model_copy(update={"assumptions": [*notes, *plan.assumptions]}) if notes else plan


def _again(plan: Plan, question: Question, subject: str, answer: str, planner: Planner) -> tuple[Plan, str]:
    """The plan with one answer in its sentence, and the thing's words there."""
    refusal = None
    open_before = _open(plan, question.kind)
    for sentence, words in _sentences(plan.prompt, subject, question.kind, answer):
        try:
            made = planner(sentence)
        except UserError as error:
            refusal = refusal or error
            continue
        if _open(made, question.kind) < open_before:
            return made, words
    told = f": {str(refusal).split('. ')[0][:200]}" if refusal else ""
    raise UserError(f"{question.id} = {answer!r}: the planner cannot take this answer; put it into the sentence{told}")


def _open(plan: Plan, kind: Kind) -> int:
    return sum(assumption.kind == kind for assumption in plan.assumptions)


def _sentences(sentence: str, subject: str, kind: Kind, answer: str) -> Iterable[tuple[str, str]]:
    """The sentence with the answer at each place where it may belong, likeliest first; and the thing's words in it."""
    found = re.search(_pattern(subject), sentence, re.IGNORECASE)
    if found is None:
        return
    start, end = found.span()
    if kind == "height":
        ends = [start + match.end() for match in re.finditer(r"[\w-]+", sentence[start:])]
        for place in [k for k in ends if k >= end][: AHEAD + 1]:
            yield f"{sentence[:place]} from {answer}{sentence[place:]}", subject
        return
    words = sentence[start:end].split()
    for place in [*range(len(words) - 1, -1, -1), len(words)]:
        said = " ".join([*words[:place], answer, *words[place:]])
        yield sentence[:start] + said + sentence[end:], " ".join(said.lower().split())


def read_answers(path: str | Path) -> dict[str, str]:
    """A file of answers: TOML (`material_ball = "steel"`) or JSON, question's id to answer.

    Raises:
        UserError: The file cannot be read, or is no such list.
    """
    path = Path(path)
    try:
        with path.open("rb") as file:
            raw = file.read(LARGEST_FILE + 1)
        text = raw.decode("utf-8-sig")
        if len(raw) > LARGEST_FILE:
            raise UserError(f"{path}: larger than {LARGEST_FILE / 1e6:g} MB; a file of answers has a line for each")
        data = json.loads(text) if text.lstrip().startswith("{") else tomllib.loads(text)
    except OSError as error:
        raise UserError(f"{path}: cannot be read: {error.strerror}") from error
    except (ValueError, RecursionError) as error:
        raise UserError(
            f'{path}: neither TOML nor JSON ({str(error)[:200]}); write a line such as material_ball = "steel"'
        ) from error
    answers = {}
    for name, value in data.items():
        if isinstance(value, bool) or not isinstance(value, str | int | float):
            raise UserError(f"{path}: {name[:60]} must be a text or a number")
        answers[name] = str(value)
    return answers
