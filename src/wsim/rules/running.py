"""What says of a thing that it runs becomes one token: "that runs", "moving" of "a moving belt" or "a belt moving at".

An LALR parser cannot tell whether what follows "a crate on a belt that" is said of the crate. What runs is the belt.
"""

from __future__ import annotations

from lark import Token

_RUN = ("run", "move")
_SPEEDS = ("AT", "SPEEDED")
_ENDS = (*_SPEEDS, "FOR", "BREAK", "JOIN", "VERB")  # after "that runs"; "that moves a crate" is another thing
_BEFORE_NOUNS = ("ART", "THE", "COUNT", "SCALE", "MATERIAL", "COLOR", "EDGES", "MASS")


def with_running(tokens: list[Token]) -> list[Token]:
    """The tokens, with one RUNNING in place of those that say so of the noun beside them."""
    made: list[Token] = []
    at = 0
    while at < len(tokens):
        used = _said_to_run(tokens, at)
        token = tokens[at + max(used - 1, 0)]
        if used:
            token.type = "RUNNING"
        made.append(token)
        at += max(used, 1)
    return made


def _said_to_run(tokens: list[Token], at: int) -> int:
    """How many tokens from one on say that something runs; 0 for none."""
    verb = at
    if tokens[at].type == "REL":
        verb += 2 if _type(tokens, at + 1) == "BE" else 1
    if _type(tokens, verb) != "VERB" or getattr(tokens[verb], "meaning", None) not in _RUN:
        return 0
    before, after = _type(tokens, at - 1), _type(tokens, verb + 1)
    if verb > at:
        return verb + 1 - at if after in _ENDS else 0
    of_noun = before == "NOUN" and after in _SPEEDS
    adjective = before in _BEFORE_NOUNS and after in ("NOUN", *_BEFORE_NOUNS)
    return int(tokens[verb].endswith("ing") and (of_noun or adjective))


def _type(tokens: list[Token], at: int) -> str:
    return tokens[at].type if 0 <= at < len(tokens) else "BREAK"
