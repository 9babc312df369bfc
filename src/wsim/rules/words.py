"""What the builtin planner knows, for people."""

from __future__ import annotations

import textwrap

from wsim.rules.lexicon import lexicon


def known_words() -> str:
    """What the planner knows, for people: a paragraph for each kind of words."""
    known = lexicon()
    things = sorted(
        {
            *(key.replace("_", " ") for key in known.nouns),
            *known.words_of("GROUP"),
            *known.words_of("FLUID"),
            *known.words_of("GROUND"),
        }
    )
    kinds = {
        "things": things,
        "materials": known.words_of("MATERIAL"),
        "colours": known.words_of("COLOR"),
        "sizes": [*known.words_of("SCALE"), "a measure such as 20 cm or 2 kg"],
        "what they do": sorted(known.particles),
        "where": [*known.words_of("SIDE"), "on", "in", "between"],
    }
    return "\n".join(textwrap.fill(f"{kind}: {', '.join(words)}", 80) for kind, words in kinds.items())
