"""The plan's free text, in a program's docstring and comments only, where it cannot end them."""

from __future__ import annotations

import textwrap

from wsim.plan.schema import Plan
from wsim.program.source import WIDTH, comment, prose


def docstring(plan: Plan) -> list[str]:
    """The title, what was asked for, and what must happen."""
    title = prose(plan.title).rstrip(".") or "A world"
    title = title[:1].upper() + title[1:]
    first, *rest = textwrap.wrap(title + ".", WIDTH - 6)
    paragraphs = [rest] if rest else []
    prompt = prose(plan.prompt)
    if prompt and prompt.rstrip(".").lower() != title.lower():
        paragraphs.append(textwrap.wrap(f"Asked for: {prompt}", WIDTH))
    sentences = [sentence for sentence in (prose(o.sentence) for o in plan.objectives) if sentence]
    if sentences:
        items = [
            line
            for sentence in dict.fromkeys(sentences)
            for line in textwrap.wrap(sentence, WIDTH, initial_indent="- ", subsequent_indent="  ")
        ]
        paragraphs.append(["What must happen:", *items])
    if not paragraphs:
        return [f'"""{first}"""']
    return [f'"""{first}', *(line for lines in paragraphs for line in ("", *lines)), '"""']


def assumptions(plan: Plan) -> list[str]:
    """A comment for each assumption."""
    lines = []
    for item in plan.assumptions:
        why = prose(item.why)
        text = f"Assumed: {prose(item.subject)}: {prose(item.choice)}" + (f" ({why})" if why else "")
        lines += comment(text)
    return [*lines, ""] if lines else []
