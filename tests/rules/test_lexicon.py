"""The data of the builtin planner's language: what is misspelled in it is said, and what it names is there."""

import copy

import pytest

from wsim.errors import UserError
from wsim.rules.actions import _RULES
from wsim.rules.data import read
from wsim.rules.lexicon import Lexicon, _groups, _nouns, _relations, _verbs, lexicon

READ = {"relations": [_relations], "verbs": [_verbs], "nouns": [_groups, _nouns]}


def test_every_verb_has_a_rule():
    roots = set(lexicon().particles)
    assert not roots - {*_RULES}, f"name {sorted(roots - {*_RULES})} of verbs.toml in _RULES of rules/actions.py"
    assert not {*_RULES} - roots, (
        f"give {sorted({*_RULES} - roots)} of rules/actions.py words in verbs.toml, or remove it"
    )


@pytest.mark.parametrize(
    ("file", "table", "entry", "key"),
    [
        ("nouns", "noun", "cube", "afloatt"),
        ("nouns", "group", "stack", "axes"),
        ("verbs", "verb", "roll", "particle"),
        ("relations", "side", "behind", "word"),
    ],
)
def test_a_key_that_nobody_reads_is_refused(file, table, entry, key):
    data = copy.deepcopy(read(file))
    data[table][entry][key] = ["x"]
    with pytest.raises(UserError, match=f"^{file}.toml: {table} '{entry}' has no key '{key}'; it may have [^\\n]*$"):
        for enter in READ[file]:
            enter(Lexicon(), data)


def test_a_noun_without_a_size_is_refused():
    data = copy.deepcopy(read("nouns"))
    del data["noun"]["cube"]["size"]
    with pytest.raises(UserError, match=r"^nouns.toml: noun 'cube' has neither an asset nor a size"):
        _nouns(Lexicon(), data)
